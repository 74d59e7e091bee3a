"""Lines of the ends of chosen nodes, and the parameters of these nodes, read by one query."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.facts import Location
from kg.graph import vocabulary as v
from kg.graph.fields import Properties, place_of
from kg.graph.fields import one as value_of
from kg.holes import is_partial
from kg.query.rows import rows

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.search.compose.network import Part, Port
    from kg.store.interface import Snapshot

_QUERY: Final = """
SELECT ?n ?s ?p ?o {
  { VALUES ?s { %s } GRAPH ?g { ?s ?p ?o } }
  UNION
  { VALUES ?n { %s } GRAPH ?g { ?n rnkg:hasParameter ?s . ?s ?p ?o } }
}"""
_LIFECYCLE: Final = "publisher/~/transition_event"  # what every lifecycle node of ROS 2 has


@dataclass(frozen=True, slots=True)
class Unset:
    """A parameter without a known default; `type` is that of `kg.facts.Parameter`."""

    name: str
    type: str | None
    location: Location


@dataclass(slots=True)
class Details:
    """Places by the IRI of an end, parameters by the IRI of a node, and the lifecycle nodes."""

    places: Mapping[str, Location] = field(default_factory=dict)
    unset: Mapping[str, tuple[Unset, ...]] = field(default_factory=dict)
    lifecycle: frozenset[str] = frozenset()

    def place(self, port: Port, part: Part) -> Location:
        """Return the line of an end, or of its node if the former is unknown."""
        return self.places.get(port.iri, Location(part.path, part.line))


def read_details(snapshot: Snapshot, parts: Iterable[Part], ports: Iterable[Port]) -> Details:
    """Return the details of nodes and of ends."""
    nodes = {part.iri for part in parts}
    cycles = {f"{node}{'/' if '#' in node else '#'}{_LIFECYCLE}": node for node in nodes}
    ends = {port.iri for port in ports}
    values = (" ".join(f"<{iri}>" for iri in sorted(chosen)) for chosen in (ends | set(cycles), nodes))
    by_subject: defaultdict[tuple[str, str], defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for node, subject, predicate, value in rows(snapshot, _QUERY % tuple(values)):
        by_subject[node or "", subject][predicate].append(value)
    places = {
        subject: place_of(properties)
        for (node, subject), properties in by_subject.items()
        if not node and subject in ends
    }
    cycling = frozenset(cycles[subject] for _, subject in by_subject if subject in cycles)
    return Details(places, _unset(by_subject), cycling)


def _unset(by_subject: Mapping[tuple[str, str], Properties]) -> dict[str, tuple[Unset, ...]]:
    """Return the parameters that each node reads and that never have a default, sorted by name."""
    unset: defaultdict[str, dict[str, Unset]] = defaultdict(dict)
    has_default: set[tuple[str, str]] = set()
    for (node, _), properties in sorted(by_subject.items()):
        name = value_of(properties, v.NAME)
        if not node or name is None:
            continue
        if (
            value_of(properties, v.DEFAULT_VALUE) is not None
            or value_of(properties, v.IMPLICIT) == "true"
            or is_partial(name)
            or "[" in name
        ):
            has_default.add((node, name))
        if (value_of(properties, v.ACCESS) or "").removeprefix(v.RNKG) == "write":
            has_default.add((node, name))
        unset[node].setdefault(name, Unset(name, value_of(properties, v.PARAMETER_TYPE), place_of(properties)))
    return {
        node: tuple(one for name, one in sorted(named.items()) if (node, name) not in has_default)
        for node, named in unset.items()
    }
