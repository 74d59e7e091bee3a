"""Compares the functions and the hardware that rules infer for nodes with labels given by hand.

    python benchmarks/classes --store FOLDER [--store FOLDER ...] --labels LABELS.jsonl [--misses]

Labels are JSON Lines as in benchmarks/labels. A node is found by repository, package and name, or by the class of its
plugin, for a node that is a plugin and a program has one of these names; one that no store has counts as a node of
which nothing is inferred. Printed are precision, recall and F1 of each class, and

* micro-F1: over all pairs of node and class;
* macro-F1: the mean of F1 over the classes that some label has. A class that is inferred and that no label has lowers
  micro-F1 and is shown, but has no recall, so it is not part of the mean.

Kinds of hardware are compared in the vocabulary of the labels (benchmarks/labels/README.md). Labels from number 600 on
name the most specific kind of all that there are. Those before chose from a list: an inferred kind that is not in it
counts as the nearest broader one that is (`underwaterSonar` as `rangeSensor`), and as none where there is no such
(`sensor`). Of the inferred kinds of a node only the most specific ones count: no `camera` beside `depthCamera`.
A label is met by itself alone, neither by a broader nor by a narrower kind.
"""

from __future__ import annotations

import argparse
import json
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from kg import api
from kg.query.result import Solutions

if TYPE_CHECKING:
    from collections.abc import Iterator

FUNCTION = "https://w3id.org/rnkg/function#"
HARDWARE = "https://w3id.org/rnkg/hardware#"
INFERRED = """SELECT ?repository ?package ?node ?class WHERE {
  ?node_ a rnkg:NodeType .
  { ?node_ rnkg:name ?node } UNION { ?node_ rnkg:pluginName ?plugin BIND(REPLACE(?plugin, "^.*[/:]", "") AS ?node) }
  ?package_ rnkg:contains ?node_ ; a rnkg:Package ; rnkg:name ?package .
  OPTIONAL { ?node_ rnkg:hasFunction|rnkg:usesHardware ?class }
  BIND(REPLACE(STR(?node_), "^.*?/node/([^/]+/[^/]+/[^/]+)/.*$", "$1") AS ?repository)
}"""
BROADER = "SELECT ?kind ?broader WHERE { ?kind a rnkg:Hardware ; skos:broader ?broader }"
LABELLED = frozenset(
    {
        *("camera", "depthCamera", "stereoCamera", "thermalCamera", "laserScanner", "lidar3d", "rangeSensor", "radar"),
        *("imu", "gnss", "magnetometer", "barometer", "thermometer", "lightSensor", "forceSensor", "contactSensor"),
        *(
            "encoder",
            "microphone",
            "rfid",
            "motionCapture",
            "motor",
            "servo",
            "gripper",
            "arm",
            "mobileBase",
            "thruster",
        ),
        *("pantilt", "loudspeaker", "lamp", "display", "drone", "underwaterVehicle", "humanoid", "car", "board", "bus"),
        *("radio", "joystick", "spaceMouse", "keyboard", "power", "computer"),
    }
)
"""The kinds of hardware that labellers of the nodes before number `SPECIFIC` chose from."""
SPECIFIC = 600
"""The number from which on labels name the most specific kind."""

Key = tuple[str, str, str]


@dataclass
class Counts:
    """How often each class was inferred and labelled, inferred only, and labelled only."""

    right: Counter[str] = field(default_factory=Counter)
    wrong: Counter[str] = field(default_factory=Counter)
    missed: Counter[str] = field(default_factory=Counter)

    def add(self, inferred: set[str], labelled: set[str]) -> None:
        """Count one node."""
        self.right.update(inferred & labelled)
        self.wrong.update(inferred - labelled)
        self.missed.update(labelled - inferred)

    def scores(self, name: str) -> tuple[float, float, float]:
        """Return precision, recall and F1 of a class."""
        right, wrong, missed = self.right[name], self.wrong[name], self.missed[name]
        return (
            _ratio(right, right + wrong),
            _ratio(right, right + missed),
            _ratio(2 * right, 2 * right + wrong + missed),
        )

    def labelled(self) -> list[str]:
        """Return the classes that some label has."""
        return sorted(self.right.keys() | self.missed.keys())

    def macro(self) -> float:
        """Return the mean of F1 over the classes that some label has."""
        names = self.labelled()
        return sum(self.scores(name)[2] for name in names) / max(len(names), 1)

    def micro(self) -> float:
        """Return F1 over all pairs of node and class."""
        right, wrong, missed = (sum(each.values()) for each in (self.right, self.wrong, self.missed))
        return _ratio(2 * right, 2 * right + wrong + missed)


class Taxonomy:
    """Which kinds of hardware are broader than which."""

    def __init__(self, broader: dict[str, str]) -> None:
        """Take the kind above each kind."""
        self._broader = broader

    def above(self, kind: str) -> list[str]:
        """Return the kinds above one, the nearest first."""
        found: list[str] = []
        while kind in self._broader:
            kind = self._broader[kind]
            found.append(kind)
        return found

    def compared(self, kinds: set[str], *, specific: bool) -> set[str]:
        """Return inferred kinds in the vocabulary of the labels, the most specific ones only.

        `specific` labels are of all kinds, others of those in `LABELLED`.
        """
        nearest = (next((each for each in (kind, *self.above(kind)) if each in LABELLED), None) for kind in kinds)
        known = set(kinds) if specific else {kind for kind in nearest if kind is not None}
        return known - {general for kind in known for general in self.above(kind)}


def main() -> None:
    """Read the command line, compare, and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument(
        "--store", required=True, action="append", help="a store in which the rules have run; repeatable"
    )
    parser.add_argument("--labels", required=True, type=Path, help="JSON Lines")
    parser.add_argument("--misses", action="store_true", help="also list where inference and labels differ")
    options = parser.parse_args()
    inferred = read(options.store)
    taxonomy = Taxonomy({_local(kind): _local(broader) for kind, broader in rows(options.store[:1], BROADER)})
    counts = {"functions": Counts(), "hardware": Counts()}
    absent = 0
    for line in options.labels.read_text().splitlines():
        label = json.loads(line)
        key = (label["repository"], label["package"], label["node"])
        functions, kinds = inferred.get(key, (set(), set()))
        absent += key not in inferred
        devices = taxonomy.compared(kinds, specific=label["number"] >= SPECIFIC)
        for name, found in (("functions", functions), ("hardware", devices)):
            counts[name].add(found, set(label[name]))
            if options.misses and found != set(label[name]):
                print(f"{'/'.join(key[1:])}: {name}: missing {sorted(set(label[name]) - found)}", end=" ")
                print(f"too many {sorted(found - set(label[name]))}")
    for name, each in counts.items():
        show(name, each)
    print(f"{absent} labelled nodes are not in a store")


def rows(stores: list[str], query: str) -> Iterator[tuple[str, ...]]:
    """Yield the rows of the answers of stores as texts."""
    for answer in (api.sparql(query, store=store) for store in stores):
        if isinstance(answer, Solutions):
            yield from (tuple(str(getattr(term, "value", "")) for term in row) for row in answer.rows)


def read(stores: list[str]) -> dict[Key, tuple[set[str], set[str]]]:
    """Return the functions and the kinds of hardware of each node of the stores."""
    found: dict[Key, tuple[set[str], set[str]]] = {}
    for repository, package, node, inferred in rows(stores, INFERRED):
        functions, kinds = found.setdefault((repository, package, node), (set(), set()))
        if inferred:
            (functions if inferred.startswith(FUNCTION) else kinds).add(_local(inferred))
    return found


def show(name: str, counts: Counts) -> None:
    """Print a table of the classes."""
    print(f"\n| {name} | precision | recall | F1 | right | too many | missed |\n|---|---|---|---|---|---|---|")
    for each in sorted({*counts.labelled(), *counts.wrong}):
        figures = " | ".join(f"{score:.2f}" for score in counts.scores(each))
        print(f"| `{each}` | {figures} | {counts.right[each]} | {counts.wrong[each]} | {counts.missed[each]} |")
    labelled = len(counts.labelled())
    print(
        f"macro-F1 over the {labelled} classes that are labelled: {counts.macro():.3f}; micro-F1 {counts.micro():.3f}"
    )


def _ratio(part: int, whole: int) -> float:
    return part / whole if whole else 0.0


def _local(iri: str) -> str:
    return iri.rpartition("#")[2]


if __name__ == "__main__":
    main()
