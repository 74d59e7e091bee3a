"""The comparison of systems: instances, the names that they have, what they are set to, and who is joined to whom."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeAlias

from kg.compare.changes import Change, Kind, Level, Side
from kg.compare.pairing import paired
from kg.compare.wording import qos_words
from kg.facts import Location, Role
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kg.facts import InstanceInterface, LaunchParameter, NodeInstance, System

__all__ = ["system_changes"]

_Sides: TypeAlias = "tuple[Side | None, Side | None]"


def system_changes(before: Iterable[System], after: Iterable[System], *, every: bool) -> Iterator[Change]:
    """Yield what differs between the systems of one name; a whole system that came or went is one change."""
    for one, other in paired(sorted(before, key=_order), sorted(after, key=_order), _name):
        if one and other:
            yield from _Systems(one, other, every=every).changes()
        elif system := one or other:
            launch = system.configuration
            name = launch.name
            side = Side(name, count(len(system.instances), "node"), Location(launch.path, 1), launch.repository)
            kind = Kind.GONE if one else Kind.NEW
            yield Change(Level.SYSTEM, kind, name, side if one else None, None if one else side, system=name)


def _name(system: System) -> str:
    return system.configuration.name


def _order(system: System) -> tuple[str, str]:
    return _name(system), system.configuration.repository


class _Systems:
    """One configuration at both sides."""

    def __init__(self, before: System, after: System, *, every: bool) -> None:
        self._sides = (before, after)
        self._name = _name(after)
        self._every = every

    def changes(self) -> Iterator[Change]:
        """Yield what differs in it."""
        before, after = (sorted(one.instances, key=_place) for one in self._sides)
        for one, other in paired(before, after, lambda instance: instance.name):
            if one and other:
                yield from self._instance(one, other)
            elif found := one or other:
                side = self._started(found, 0 if one else 1)
                yield self._came_or_went(Level.INSTANCE, found.name, side, gone=one is not None)
        yield from self._connections()

    def _change(self, level: Level, kind: Kind, owner: str, sides: _Sides, role: str = "") -> Change:
        return Change(level, kind, owner, *sides, role=role, system=self._name)

    def _came_or_went(self, level: Level, owner: str, side: Side, role: str = "", *, gone: bool) -> Change:
        if gone:
            return self._change(level, Kind.GONE, owner, (side, None), role)
        return self._change(level, Kind.NEW, owner, (None, side), role)

    def _side(self, number: int, name: str, value: str, location: Location | None) -> Side:
        return Side(name, value, location, self._sides[number].configuration.repository)

    def _started(self, instance: NodeInstance, number: int) -> Side:
        return self._side(number, instance.name, instance.started_type, instance.started.location)

    def _instance(self, one: NodeInstance, other: NodeInstance) -> Iterator[Change]:
        for kind, say in _TOLD.items():
            values = say(one), say(other)
            if values[0] != values[1]:
                sides = (
                    self._side(0, one.name, values[0], one.started.location),
                    self._side(1, other.name, values[1], other.started.location),
                )
                yield self._change(Level.INSTANCE, kind, other.name, sides)
        yield from self._ends(one, other)
        yield from self._settings(one, other)

    def _ends(self, one: NodeInstance, other: NodeInstance) -> Iterator[Change]:
        before, after = (sorted(filter(self._shown, each.interfaces), key=_end_order) for each in (one, other))
        for first, second in paired(before, after, _end_key):
            if first and second:
                yield from self._end(other.name, first, second)
            elif end := first or second:
                side = self._end_side(0 if first else 1, end, end.declared.type or "")
                role = str(end.declared.role)
                yield self._came_or_went(Level.END, other.name, side, role, gone=first is not None)

    def _end(self, owner: str, one: InstanceInterface, other: InstanceInterface) -> Iterator[Change]:
        for kind, say in _END_TOLD.items():
            values = say(one), say(other)
            if values[0] != values[1]:
                shown = ("", "") if kind is Kind.RENAMED else values
                sides = self._end_side(0, one, shown[0]), self._end_side(1, other, shown[1])
                yield self._change(Level.END, kind, owner, sides, str(one.declared.role))

    def _end_side(self, number: int, end: InstanceInterface, value: str) -> Side:
        """Return an end with the line that gave it its name: of the remapping or parameter, else of the code."""
        cause = end.remap or end.parameter
        location = cause.location if cause else end.declared.location
        repository = self._sides[number].configuration.repository if cause else end.owner.repository
        return Side(end.resolved or f"? {end.declared.written or ''}".strip(), value, location, repository)

    def _settings(self, one: NodeInstance, other: NodeInstance) -> Iterator[Change]:
        before, after = (
            {each.name: self._setting(number, each.name, each.set) for each in instance.parameters}
            for number, instance in enumerate((one, other))
        )
        for name in sorted({*before, *after}):
            sides = before.get(name), after.get(name)
            kind = Kind.NEW if sides[0] is None else Kind.GONE if sides[1] is None else Kind.VALUE
            if sides[0] is None or sides[1] is None or sides[0].value != sides[1].value:
                yield self._change(Level.SETTING, kind, other.name, sides)

    def _setting(self, number: int, name: str, value: LaunchParameter) -> Side:
        return self._side(number, name, "?" if value.value is None else value.value, value.location)

    def _connections(self) -> Iterator[Change]:
        """Yield who is joined to whom now and was not, and the other way."""
        joined = [_joined(one.instances, self._shown) for one in self._sides]
        for source, kind, channel, target in sorted(joined[0] ^ joined[1]):
            gone = (source, kind, channel, target) in joined[0]
            yield self._came_or_went(Level.CONNECTION, source, Side(channel, target), kind, gone=gone)

    def _shown(self, end: InstanceInterface) -> bool:
        return self._every or not end.declared.implicit


_TOLD: Final[Mapping[Kind, Callable[[NodeInstance], str]]] = {
    Kind.TYPE: lambda instance: instance.started_type,
    Kind.HOST: lambda instance: instance.host or "",
    Kind.CONDITION: lambda instance: instance.started.condition or "",
    Kind.KNOWN: lambda instance: "" if instance.type else instance.reason or "not known",
}
_END_TOLD: Final[Mapping[Kind, Callable[[InstanceInterface], str]]] = {
    Kind.RENAMED: lambda end: end.resolved or "?",
    Kind.TYPE: lambda end: end.declared.type or "?",
    Kind.QOS: lambda end: qos_words(end.qos),
}


def _place(instance: NodeInstance) -> tuple[str, str]:
    return str(instance.started.location), repr(instance)


def _end_key(end: InstanceInterface) -> tuple[str, ...]:
    declared = end.declared
    return end.owner.package, end.owner.node, str(declared.role), declared.name or f"? {declared.written or ''}"


def _end_order(end: InstanceInterface) -> tuple[str, ...]:
    return *_end_key(end), end.resolved or "", end.declared.type or "", str(end.declared.location)


def _joined(
    instances: Iterable[NodeInstance], shown: Callable[[InstanceInterface], bool]
) -> set[tuple[str, str, str, str]]:
    """Return who gives what to whom: source, kind of channel, its name, target."""
    ends = {
        (end.declared.role, end.resolved, instance.name)
        for instance in instances
        for end in instance.interfaces
        if end.resolved is not None and "{}" not in end.resolved and shown(end)
    }
    takers: dict[tuple[Role, str], set[str]] = {}
    for role, name, instance in ends:
        takers.setdefault((role, name), set()).add(instance)
    return {
        (instance, role.channel, name, target)
        for role, name, instance in ends
        if role.outward
        for target in takers.get((role.opposite, name), ())
        if target != instance
    }
