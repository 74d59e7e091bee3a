"""Lines of the ends of chosen nodes, and the parameters of these nodes."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.facts import Access, Location, Role
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.holes import is_partial

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.facts import Interface
    from kg.search.compose.network import Part, Port
    from kg.store.snapshot import EmbeddedSnapshot

_LIFECYCLE: Final = "~/transition_event"  # what every lifecycle node of ROS 2 publishes


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


def read_details(snapshot: EmbeddedSnapshot, parts: Iterable[Part]) -> Details:
    """Return the details of nodes and of their ends."""
    records = node_records(snapshot, iris={part.iri for part in parts})
    return Details(
        {iri: end.location for record in records for end, iri in record.ends.items()},
        {record.iri: _unset(record) for record in records},
        frozenset(record.iri for record in records if any(map(_of_lifecycle, record.node.interfaces))),
    )


def _of_lifecycle(end: Interface) -> bool:
    return end.role is Role.PUBLISHES and end.name == _LIFECYCLE


def _unset(record: NodeRecord) -> tuple[Unset, ...]:
    """Return the parameters that a node reads and that never have a default, sorted by name."""
    unset: dict[str, Unset] = {}
    has_default: set[str] = set()
    for one, _ in sorted(record.settable.items(), key=lambda pair: pair[1]):
        if one.name is None:
            continue
        if one.default is not None or one.implicit or is_partial(one.name) or "[" in one.name:
            has_default.add(one.name)
        if one.access is Access.WRITE:
            has_default.add(one.name)
        unset.setdefault(one.name, Unset(one.name, one.type, one.location))
    return tuple(one for name, one in sorted(unset.items()) if name not in has_default)
