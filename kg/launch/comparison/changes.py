"""Differences as values: parts added, removed or changed, with their lines; every difference has a mirror."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import TYPE_CHECKING, Final, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.facts import Location, NodeType, System


class Level(StrEnum):
    """The subject of a change, from code to systems."""

    NODE = "node"
    INTERFACE = "interface"
    PARAMETER = "parameter"
    SYSTEM = "system"
    ARGUMENT = "argument"
    NAMESPACE = "namespace"
    INSTANCE = "instance"
    END = "end"
    SETTING = "setting"
    REMAP = "remap"
    CONNECTION = "connection"
    FINDING = "finding"


class Kind(StrEnum):
    """Added, removed or changed."""

    NEW = "new"
    GONE = "gone"
    RENAMED = "renamed"
    TYPE = "type"
    QOS = "qos"
    DEFAULT = "default"
    VALUE = "value"
    CONDITION = "condition"
    HOST = "host"
    KNOWN = "known"
    """A name, type or plugin is known now that was not, or the other way."""


_MIRRORED: Final = {Kind.NEW: Kind.GONE, Kind.GONE: Kind.NEW}


@dataclass(frozen=True, slots=True)
class Side:
    """A thing at one side: its name, its detail (a type, a value), and its line."""

    name: str
    value: str = ""
    location: Location | None = None
    repository: str = ""


@dataclass(frozen=True, slots=True)
class Change:
    """One difference: `owner` is the node type or instance, `system` the launch file; `role` what an end does.

    `before` is None for an added thing, `after` for a removed one. `owner_before` is the former name of a renamed
    instance.
    """

    level: Level
    kind: Kind
    owner: str
    before: Side | None
    after: Side | None
    role: str = ""
    system: str = ""
    owner_before: str = ""

    @property
    def name(self) -> str:
        """The current name, or the last one."""
        side = self.after or self.before
        return side.name if side else ""

    def mirrored(self) -> Change:
        """Return the inverse change."""
        owners = (self.owner_before, self.owner) if self.owner_before else (self.owner, "")
        kind = _MIRRORED.get(self.kind, self.kind)
        return replace(self, kind=kind, before=self.after, after=self.before, owner=owners[0], owner_before=owners[1])


@dataclass(frozen=True, slots=True)
class Finding:
    """Finding of a rule in a system: its code, the name it is about, and its message."""

    system: str
    code: str
    subject: str
    message: str
    location: Location | None = None
    repository: str = ""


class Record(Protocol):
    """A node type with its package and source; `kg.graph.reading.nodes.NodeRecord` is one."""

    @property
    def repository(self) -> str:
        """The name of its source."""
        ...

    @property
    def package(self) -> str:
        """The name of its package."""
        ...

    @property
    def node(self) -> NodeType:
        """The node type as declared in code."""
        ...


@dataclass(frozen=True, slots=True)
class Sources:
    """One side of a comparison: a state of sources."""

    nodes: Sequence[Record] = ()
    systems: Sequence[System] = ()
    findings: Sequence[Finding] = ()


@dataclass(frozen=True, slots=True)
class Difference:
    """All changes, in the order of levels, owners and names."""

    changes: tuple[Change, ...] = ()

    @classmethod
    def of(cls, changes: Iterable[Change]) -> Difference:
        """Return changes in their order, each once."""
        return cls(tuple(sorted(set(changes), key=_order)))

    def mirrored(self) -> Difference:
        """Return the inverse difference."""
        return Difference.of(change.mirrored() for change in self.changes)

    def at(self, *levels: Level) -> tuple[Change, ...]:
        """Return the changes of some levels."""
        return tuple(change for change in self.changes if change.level in levels)

    def __bool__(self) -> bool:
        return bool(self.changes)


def _order(change: Change) -> tuple[object, ...]:
    """Return a key that differs for different changes: ties would leave the order to the hashes of a set."""
    sides = tuple((side.name, side.value, str(side.location)) if side else () for side in (change.before, change.after))
    names = min(side[0] for side in sides if side)
    place = change.system, tuple(Level).index(change.level), change.owner, change.role, names
    return *place, tuple(Kind).index(change.kind), sides, repr(change)
