"""Rows of the lists of classes and properties: what the store has of each, and which of them occur together."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from kg.graph import vocabulary as v
from kg.graph.reading.queries import texts
from kg.query.completion.statistics import SnapshotCache, Statistics
from kg.syntax.names import prefixed, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from kg.store.snapshot import EmbeddedSnapshot

    Rows = Sequence[dict[str, Any]]

_SHOWN: Final = 4  # so many names of the other kind are in a cell, those of most instances
_TYPE: Final = v.bare(v.TYPE)
_PARENTS: Final = "SELECT DISTINCT ?class ?parent { ?class rdfs:subClassOf ?parent FILTER(ISIRI(?parent)) }"


def classes(snapshot: EmbeddedSnapshot, _base: str) -> Rows:
    """Return the classes with instances: how many, what each is a subclass of, and the properties of its instances.

    The properties are those of a sample of the instances (`kg.query.completion.statistics`).
    """
    known = _statistics(snapshot)
    parents: defaultdict[str, list[str]] = defaultdict(list)
    for one, parent in texts(snapshot, _PARENTS):
        if parent != one:
            parents[one].append(shorten(parent))
    rows = []
    for iri, number in sorted(known.classes.items(), key=lambda one: (-one[1], one[0])):
        used = _most({name: users for name, users in known.used.get(iri, {}).items() if name != _TYPE})
        rows.append(
            {
                **_term(iri, known),
                "instances": number,
                "parents": sorted(parents[iri]),
                "properties": len(used),
                "first": used[:_SHOWN],
            }
        )
    return rows


def properties(snapshot: EmbeddedSnapshot, _base: str) -> Rows:
    """Return the properties with facts: how many, and the classes of their subjects and of their values."""
    known = _statistics(snapshot)
    users: defaultdict[str, dict[str, int]] = defaultdict(dict)
    for kind, used in known.used.items():
        for iri, number in used.items():
            users[iri][kind] = number
    rows = []
    for iri, number in sorted(known.properties.items(), key=lambda one: (-one[1], one[0])):
        subjects, values = _most(users[iri]), _most(known.leads.get(iri, {}))
        rows.append(
            {
                **_term(iri, known),
                "facts": number,
                "subjects": subjects,
                "values": values or ["literal"] * (iri in known.literal),
                "first_subjects": subjects[:_SHOWN],
                "first_values": values[:_SHOWN] or ["literal"] * (iri in known.literal),
            }
        )
    return rows


def _statistics(snapshot: EmbeddedSnapshot) -> Statistics:
    folder = snapshot.layout.cache if snapshot.layout is not None else None
    return SnapshotCache(folder, snapshot).statistics(fresh=True)


def _term(iri: str, known: Statistics) -> dict[str, Any]:
    prefix = prefixed(iri)
    return {
        "iri": iri,
        "name": shorten(iri),
        "vocabulary": prefix[0] if prefix else iri.rpartition("#")[0] or iri.rpartition("/")[0],
        "description": known.comments.get(iri),
    }


def _most(numbers: Mapping[str, int]) -> list[str]:
    ordered: Iterable[tuple[str, int]] = sorted(numbers.items(), key=lambda one: (-one[1], one[0]))
    return [shorten(iri) for iri, _ in ordered]
