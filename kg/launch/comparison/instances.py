"""The comparison of one node of a launch file at both sides: its ends, its settings, and its remappings."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.holes import anonymous
from kg.launch.comparison.changes import Change, Kind, Level, Side
from kg.launch.comparison.pairing import all_pairs, canonical, matched, relabelled

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping

    from kg.facts import InstanceInterface, Interface, LaunchParameter, Location, NodeInstance, Remap, System
    from kg.launch.comparison.renaming import Renames

CodeChanges: TypeAlias = frozenset[tuple[str | Kind | None, ...]]
"""Changes of interfaces of node types: node type, kind, role, and the name at both sides."""
_Ends: TypeAlias = "tuple[InstanceInterface | None, InstanceInterface | None]"


class Instances:
    """Compares the nodes of two states of a system."""

    def __init__(self, systems: tuple[System, System], renames: Renames, code: CodeChanges, *, every: bool) -> None:
        self._systems = systems
        self._renames = renames
        self._code = code
        self._every = every
        self._signs: dict[tuple[int, int, int], int] = {}

    def changes(self, one: NodeInstance, other: NodeInstance) -> Iterator[Change]:
        """Yield the differences between two states of a node."""
        owner = other.name, one.name if one.name != other.name else ""
        for kind, aspect in _ASPECTS.items():
            values = aspect(one), aspect(other)
            if not self._same(*values):
                sides = (
                    self.side(0, one.name, values[0], one.started.location),
                    self.side(1, other.name, values[1], other.started.location),
                )
                yield self._change(Level.INSTANCE, kind, owner, *sides)
        causes: set[Remap | None] = set()
        for first, second in self._paired(one, other):
            if first and second:
                yield from self._end(owner, first, second)
                if first.resolved != second.resolved:
                    causes |= {first.remap, second.remap}
            elif end := first or second:
                yield from self._lone(owner, end, gone=first is not None)
        settings = ([(each.name, each.set) for each in instance.parameters] for instance in (one, other))
        yield from self.settings(owner, *settings)
        yield from self._remaps(owner, one, other, causes)

    def settings(
        self,
        owner: tuple[str, str],
        before: Iterable[tuple[str, LaunchParameter]],
        after: Iterable[tuple[str, LaunchParameter]],
    ) -> Iterator[Change]:
        """Yield settings of one side only, or with another value; `owner` are the names after and before."""
        sides = [
            {self._renames.neutral(name): self._setting(number, name, each) for name, each in settings}
            for number, settings in enumerate((before, after))
        ]
        yield from self._values(Level.SETTING, owner, *sides)

    def sign(self, number: int, instance: NodeInstance, end: InstanceInterface) -> Hashable | None:
        """Return the identity of an end of one side, equal for both states of an end; None for an end left out."""
        key = number, id(instance), id(end)
        return self._signs.get(key, key) if self._shown(end) else None

    def side(self, number: int, name: str, value: str, location: Location | None) -> Side:
        """Return a thing of the launch file at one side."""
        return Side(name, value, location, self._systems[number].configuration.repository)

    def _change(  # noqa: PLR0913, PLR0917 - what a change consists of
        self, level: Level, kind: Kind, owner: tuple[str, str], before: Side | None, after: Side | None, role: str = ""
    ) -> Change:
        name = self._systems[1].configuration.name
        return Change(level, kind, owner[0], before, after, role, name, owner_before=owner[1])

    def _values(
        self, level: Level, owner: tuple[str, str], before: Mapping[str, Side], after: Mapping[str, Side]
    ) -> Iterator[Change]:
        for key in sorted({*before, *after}):
            one, other = before.get(key), after.get(key)
            kind = Kind.NEW if one is None else Kind.GONE if other is None else Kind.VALUE
            if one is None or other is None or not self._same(one.value, other.value):
                yield self._change(level, kind, owner, one, other)

    def _same(self, before: str, after: str) -> bool:
        one, other = self._renames.neutral(before), self._renames.neutral(after)
        return one == other or canonical(one) == canonical(other)

    def _setting(self, number: int, name: str, value: LaunchParameter) -> Side:
        return self.side(number, name, "?" if value.value is None else value.value, value.location)

    def _shown(self, end: InstanceInterface) -> bool:
        return self._every or not end.declared.implicit

    def _paired(self, one: NodeInstance, other: NodeInstance) -> Iterator[_Ends]:
        """Yield the ends of both sides; certainly renamed ends share a sign."""
        before, after = (sorted(filter(self._shown, each.interfaces), key=_end_order) for each in (one, other))
        ways = partial(relabelled, key=_end_key), partial(matched, key=_renamed_key)
        for first, second in all_pairs(before, after, _end_key, *ways):
            if first and second:
                number = len(self._signs)
                self._signs[0, id(one), id(first)] = self._signs[1, id(other), id(second)] = number
            yield first, second

    def _end(self, owner: tuple[str, str], one: InstanceInterface, other: InstanceInterface) -> Iterator[Change]:
        for kind, aspect in _END_ASPECTS.items():
            values = aspect(one), aspect(other)
            if values[0] == values[1] or self._is_reported(kind, one, other):
                continue
            if kind is Kind.RENAMED and self._renames.follows(*values):
                continue
            shown = ("", "") if kind is Kind.RENAMED else values
            sides = self._end_side(0, one, shown[0]), self._end_side(1, other, shown[1])
            yield self._change(Level.END, kind, owner, *sides, str(one.declared.role))

    def _lone(self, owner: tuple[str, str], end: InstanceInterface, *, gone: bool) -> Iterator[Change]:
        """Yield an end added or removed, unless its node type reports that."""
        role, value = str(end.declared.role), end.declared.type or ""
        if gone and not self._is_reported(Kind.GONE, end, None):
            yield self._change(Level.END, Kind.GONE, owner, self._end_side(0, end, value), None, role)
        elif not gone and not self._is_reported(Kind.NEW, None, end):
            yield self._change(Level.END, Kind.NEW, owner, None, self._end_side(1, end, value), role)

    def _is_reported(self, kind: Kind, one: InstanceInterface | None, other: InstanceInterface | None) -> bool:
        """Return whether the code of the node type reports the same change."""
        end = one or other
        if end is None or kind is Kind.QOS:
            return False
        names = tuple(code_name(each.declared) if each else None for each in (one, other))
        return (f"{end.owner.package}/{end.owner.node}", kind, str(end.declared.role), *names) in self._code

    def _end_side(self, number: int, end: InstanceInterface, value: str) -> Side:
        """Return an end with the line that determined its name: a remapping, a parameter, or the code."""
        cause = end.remap or end.parameter
        location = cause.location if cause else end.declared.location
        repository = self._systems[number].configuration.repository if cause else end.owner.repository
        return Side(end.resolved or f"? {end.declared.written or ''}".strip(), value, location, repository)

    def _remaps(
        self, owner: tuple[str, str], one: NodeInstance, other: NodeInstance, causes: set[Remap | None]
    ) -> Iterator[Change]:
        """Yield changed remappings, except those behind reported names of ends."""
        sides = [
            {
                self._renames.neutral(each.source): self.side(number, each.source, each.target, each.remap.location)
                for each in reversed(instance.remaps)
                if each.remap not in causes
            }
            for number, instance in enumerate((one, other))
        ]
        yield from self._values(Level.REMAP, owner, *sides)


_ASPECTS: Final[Mapping[Kind, Callable[[NodeInstance], str]]] = {
    Kind.TYPE: lambda instance: instance.started_type,
    Kind.HOST: lambda instance: instance.host or "",
    Kind.CONDITION: lambda instance: instance.started.condition or "",
    Kind.KNOWN: lambda instance: "" if instance.type else instance.reason or "not known",
}
_END_ASPECTS: Final[Mapping[Kind, Callable[[InstanceInterface], str]]] = {
    Kind.RENAMED: lambda end: anonymous(end.resolved or "?"),
    Kind.TYPE: lambda end: end.declared.type or "?",
    Kind.QOS: lambda end: str(end.qos or ""),
}


def code_name(declared: Interface) -> str:
    """Return the name of an interface in code, or its expression behind a question mark."""
    return declared.name if declared.name is not None else f"? {declared.written or ''}".strip()


def renamed_key(declared: Interface) -> Hashable | None:
    """Return a key that interfaces share which may be one under two names; None without a name or type."""
    if not declared.type or declared.name is None:
        return None
    return declared.role, declared.type, declared.location.path


def _renamed_key(end: InstanceInterface) -> Hashable | None:
    key = renamed_key(end.declared)
    return (end.owner.package, end.owner.node, key) if key is not None else None


def _end_key(end: InstanceInterface) -> tuple[str, ...]:
    return end.owner.package, end.owner.node, str(end.declared.role), code_name(end.declared)


def _end_order(end: InstanceInterface) -> tuple[str, ...]:
    return *_end_key(end), end.resolved or "", end.declared.type or "", str(end.declared.location)
