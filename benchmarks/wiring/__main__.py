"""Compares the channels of a launched system, labelled by hand, with what `kg` resolves from the sources.

    python benchmarks/wiring --mirrors MIRRORS --truth FILE... [--workspaces FOLDER] [--misses]

A truth file (schema `rnkg-wiring/1`) names a repository with its commit, the launch files with their arguments, the
nodes that start and the channels between them. The repository becomes a workspace, `kg build` reads it, and
`kg instances --launch` says what each launch file starts. A *connection* is (source, sink, kind, name, type): the kind
is topic, service or action, and the source publishes, calls or sends goals. Rows: connections without and with those
whose ends a framework makes, pairs of nodes that a connection joins, and ends (node, side, channel) of the channels
that the truth lists.

A truth that names its `partial` nodes has every end of the others: rows are its nodes and their ends. `optional` ends
(node, kind, name) depend on what happens later, and count neither way. `systems/` has such labels.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from bugs.commands import answers, build
from bugs.workspaces import MissingError, Plan, make

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

ENDS = {
    "publishes": ("topic", "source"),
    "subscribes": ("topic", "sink"),
    "clients": ("service", "source"),
    "services": ("service", "sink"),
    "action_clients": ("action", "source"),
    "action_servers": ("action", "sink"),
}
TRUTH_ENDS = {"publishers": "source", "subscribers": "sink", "clients": "source", "servers": "sink"}
Connection = tuple[str, str, str, str, str]
Row = tuple[str, set[Any], set[Any]]
"""What is compared, what the truth has, and what was found."""


@dataclass(frozen=True)
class End:
    """One end of a channel; `implicit` if a framework makes it."""

    node: str
    side: str
    kind: str
    name: str
    type: str
    implicit: bool

    @property
    def channel(self) -> tuple[str, str, str]:
        """What the other end has in common with this one."""
        return self.kind, self.name, self.type


def main() -> None:
    """Build the workspaces, ask for their instances, print the table."""
    options = _options()
    print("| system | what | labelled | resolved | precision | recall |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as scratch:
        for path in options.truth:
            truth = json.loads(path.read_text(encoding="utf-8"))
            try:
                names, ends = _resolved(path.stem, truth, options.mirrors, options.workspaces or Path(scratch))
            except MissingError as missing:
                print(f"{path.stem}: {missing}", file=sys.stderr)
                continue
            rows = _whole_rows(truth, names, ends) if "partial" in truth else _rows(truth, ends)
            _print(path.stem, rows, misses=options.misses)


def _resolved(system: str, truth: dict[str, Any], mirrors: Path, folder: Path) -> tuple[set[str], list[End]]:
    workspace, store = folder / system, folder / f"{system}.kg"
    if not store.exists():
        make(Plan([(truth["repo"], truth["repo"].split("/")[1], truth["commit"])], []), mirrors, workspace)
        build(workspace, store)
    wanted = {node["name"] for node in truth["nodes"]}
    names: set[str] = set()
    ends: list[End] = []
    for file in truth["launch"]:
        text = next(workspace.glob(f"**/{file}")).read_text(encoding="utf-8")
        declared = set(re.findall(r"(?:DeclareLaunchArgument\(\s*|<arg\s+name\s*=\s*)[\"'](\w+)", text))
        given = truth["arguments"] if "partial" in truth else {}
        arguments = {name: value for name, value in truth["arguments"].items() if name in declared}
        for instance in answers("instances", Path(file), store, truth.get("environment", {}), arguments or given):
            names.add(instance["name"])
            if instance["name"] in wanted:
                ends += _ends_of(instance)
    return names, ends


def _ends_of(instance: dict[str, Any]) -> Iterator[End]:
    for role, (kind, side) in ENDS.items():
        for entry in instance.get(role, ()):
            if entry.get("resolved"):
                yield End(instance["name"], side, kind, entry["resolved"], entry["type"] or "", entry["implicit"])


def _labelled(channels: Iterable[dict[str, Any]]) -> Iterator[End]:
    for channel in channels:
        for role, side in TRUTH_ENDS.items():
            for node in channel.get(role, ()):
                implicit = bool(channel.get("implicit") or (side == "sink" and channel.get("implicit_server")))
                yield End(node, side, channel["kind"], channel["name"], channel["type"], implicit)


def _connections(ends: Iterable[End], *, framework: bool) -> set[Connection]:
    """Return what is connected; without `framework`, at least one end must be written in code."""
    sinks: dict[tuple[str, str, str], list[End]] = {}
    ends = list(ends)
    for end in ends:
        if end.side == "sink":
            sinks.setdefault(end.channel, []).append(end)
    return {
        (source.node, sink.node, *source.channel)
        for source in ends
        if source.side == "source"
        for sink in sinks.get(source.channel, ())
        if framework or not (source.implicit and sink.implicit)
    }


def _rows(truth: dict[str, Any], ends: list[End]) -> list[Row]:
    labelled = list(_labelled(truth["channels"]))
    known, found = _connections(labelled, framework=False), _connections(ends, framework=False)
    listed = {end.channel for end in labelled if not end.implicit}
    open_known = {(end.node, end.side, *end.channel) for end in labelled if not end.implicit}
    open_found = {(end.node, end.side, *end.channel) for end in ends if not end.implicit and end.channel in listed}
    return [
        ("connections", known, found),
        ("pairs of nodes", {row[:2] for row in known}, {row[:2] for row in found}),
        ("connections, with those of frameworks", _connections(labelled, framework=True), _all(ends)),
        ("ends of the channels listed", open_known, open_found),
    ]


def _whole_rows(truth: dict[str, Any], names: set[str], ends: list[End]) -> list[Row]:
    """Return the rows of a truth that has all ends of its nodes, except for those of `partial` ones."""
    nodes = {(node["name"],) for node in truth["nodes"]}
    labelled = {(end.node, end.side, *end.channel) for end in _labelled(truth["channels"])}
    optional = {tuple(one) for one in truth["optional"]}
    loose = {*truth["partial"], *(node["name"] for node in truth["nodes"] if node.get("external"))}
    found = {
        (end.node, end.side, *end.channel)
        for end in ends
        if not end.implicit and (end.node, end.kind, end.name) not in optional
    }
    found = {one for one in found if one in labelled or one[0] not in loose}
    return [("nodes", nodes, {(name,) for name in names if (name,) in nodes}), ("ends", labelled, found)]


def _print(system: str, rows: list[Row], *, misses: bool) -> None:
    for what, wanted, got in rows:
        right = len(wanted & got)
        print(f"| {system} | {what} | {len(wanted)} | {len(got)} | {_share(right, got)} | {_share(right, wanted)} |")
    if misses:
        for what, wanted, got in (rows[0], rows[-1]):
            for sign, items in (("-", wanted - got), ("+", got - wanted)):
                for item in sorted(items):
                    print(f"{what}: {sign} {' '.join(item)}")


def _all(ends: list[End]) -> set[Connection]:
    """Return all connections but those of frameworks alone by the topics that every node of ROS 2 has."""
    every = _connections(ends, framework=True)
    return _connections(ends, framework=False) | {r for r in every if r[3] in ("/tf", "/bond") or r[2] != "topic"}


def _share(part: int, whole: set[Any]) -> str:
    return f"{100 * part / len(whole):.1f} % ({part}/{len(whole)})" if whole else "-"


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="wiring", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--mirrors", type=Path, required=True, help="git directories of the repositories")
    parser.add_argument("--truth", type=Path, nargs="+", required=True, help="labelled systems")
    parser.add_argument("--workspaces", type=Path, help="keep the workspaces and stores here, and use what is there")
    parser.add_argument("--misses", action="store_true", help="list what was missed (-) and what was too much (+)")
    return parser.parse_args()


if __name__ == "__main__":
    main()
