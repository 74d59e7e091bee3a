"""From what rules inferred of a system or a package to its capabilities with the ways to reach them."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, Literal

from pyoxigraph import NamedNode

from kg.graph import vocabulary as v
from kg.query.binding import bind
from kg.query.stored import internal
from kg.robot.capabilities.definitions import definitions
from kg.robot.capability import Capabilities, Capability, Way
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.robot.capabilities.definitions import Askable, Definition

__all__ = ["capabilities_of", "held", "read"]

_KINDS: Final[Mapping[str, Literal["topic", "service", "action"]]] = {
    v.bare(v.PUBLISHER): "topic",
    v.bare(v.SUBSCRIBER): "topic",
    v.bare(v.SERVICE_SERVER): "service",
    v.bare(v.ACTION_SERVER): "action",
}
_Ways = dict[tuple[str, str, str, str], set[str]]
"""The messages that stand for a capability, by the kind, the name, the type and the node of a way."""


def capabilities_of(graph: Askable, whole: str, of: str) -> Capabilities:
    """Return what the system or package with the IRI `whole` can do, by what a store has inferred; `of` names it."""
    return read(graph, whole, of, definitions(graph))


def held(graph: Askable, whole: str) -> dict[str, str]:
    """Return the IRIs of what the system or package with the IRI `whole` can do, each with its label."""
    return {row["capability"].value: row["label"].value for row in _rows(graph, "capability-holders", whole)}


def read(graph: Askable, whole: str, of: str, known: Mapping[str, Definition]) -> Capabilities:
    """Return the same for definitions that were read before."""
    having = set(held(graph, whole))
    ways: defaultdict[str, _Ways] = defaultdict(dict)
    for row in _rows(graph, "capability-ways", whole):
        key = (_KINDS[row["role"].value], row["channel"].value, row["type"].value, row["node"].value)
        ways[row["capability"].value].setdefault(key, set()).add(row["message"].value)
    found = [_capability(known[iri], ways.get(iri, {}), having, known) for iri in having if iri in known]
    return Capabilities(of=of, capabilities=tuple(sorted(found, key=lambda one: (one.kinds, one.label, one.iri))))


def _rows(graph: Askable, name: str, whole: str) -> Iterable[Any]:
    rows: Iterable[Any] = graph.query(bind(internal(name), {"whole": NamedNode(whole)}), prefixes=PREFIXES)
    return rows


def _capability(definition: Definition, ways: _Ways, having: set[str], known: Mapping[str, Definition]) -> Capability:
    specific = (known[iri] for iri in having if iri in known)
    return definition.capability(
        ways=tuple(_way(definition, key, frozenset(ways[key])) for key in sorted(ways)),
        implied_by=tuple(sorted(one.name for one in specific if definition.iri in one.implied)),
    )


def _way(definition: Definition, key: tuple[str, str, str, str], messages: frozenset[str]) -> Way:
    kind: Any = key[0]
    return Way(
        kind=kind,
        name=key[1],
        type=key[2],
        node=key[3],
        fields=definition.fields_of(messages),
        constants=definition.constants_of(messages),
        rate=definition.rate if kind == "topic" else 0,
    )
