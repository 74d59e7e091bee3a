"""The comparison of systems: declarations of their launch files, the nodes they start, and their connections."""

from __future__ import annotations

from collections import defaultdict
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from kg.facts import Location
from kg.holes import is_known
from kg.launch.comparison.changes import Change, Kind, Level, Side
from kg.launch.comparison.instances import Instances
from kg.launch.comparison.pairing import paired
from kg.launch.comparison.renaming import Renames, instance_pairs
from kg.launch.comparison.values import canonical
from kg.render.text import count

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Iterator

    from kg.facts import InstanceInterface, LaunchArgument, NodeInstance, Role, System
    from kg.launch.comparison.instances import Told

Connection: TypeAlias = tuple[str, str, str, str]
"""The node that gives, the kind of channel, its name, the node that takes."""
_Joined: TypeAlias = "dict[Connection, set[tuple[Hashable, Hashable]]]"


class Wiring:
    """Compares the systems of two states; `code` are the changes of node types, which are reported elsewhere."""

    def __init__(self, code: Iterable[Change], *, every: bool) -> None:
        self._code = frozenset(
            (one.owner, one.kind, one.role, *(side.name if side else None for side in (one.before, one.after)))
            for one in code
            if one.level is Level.INTERFACE
        )
        self._every = every
        self.renames: dict[str, Renames] = {}

    def changes(self, before: Iterable[System], after: Iterable[System]) -> Iterator[Change]:
        """Yield the differences between systems of one name; a whole one added or removed is one change.

        `renames` then contains the renamed nodes by the name of the system.
        """
        for one, other in paired(sorted(before, key=_order), sorted(after, key=_order), _name):
            if one and other:
                found = _Systems(one, other, self._code, every=self._every)
                yield from found.changes()
                self.renames[_name(one)] = found.renames
            elif system := one or other:
                launch = system.configuration
                name = launch.name
                side = Side(name, count(len(system.instances), "node"), Location(launch.path, 1), launch.repository)
                yield _came_or_went(Level.SYSTEM, name, side, name, gone=one is not None)


def _name(system: System) -> str:
    return system.configuration.name


def _order(system: System) -> tuple[str, str]:
    return _name(system), system.configuration.repository


def _came_or_went(  # noqa: PLR0913 - what a change consists of
    level: Level, owner: str, side: Side, system: str, role: str = "", *, gone: bool
) -> Change:
    if gone:
        return Change(level, Kind.GONE, owner, side, None, role, system)
    return Change(level, Kind.NEW, owner, None, side, role, system)


class _Systems:
    """One system at both sides."""

    def __init__(
        self,
        before: System,
        after: System,
        code: Told,
        *,
        every: bool,
    ) -> None:
        self._sides = (before, after)
        self._name = _name(after)
        self._pairs = list(instance_pairs(before.instances, after.instances))
        self.renames = Renames(self._pairs)
        self._instances = Instances(self._sides, self.renames, code, every=every)

    def changes(self) -> Iterator[Change]:
        """Yield its differences."""
        yield from self._arguments()
        for one, other in self._pairs:
            if one and other:
                yield from self._instances.changes(one, other)
            elif found := one or other:
                side = self._started(found, 0 if one else 1)
                yield _came_or_went(Level.INSTANCE, found.name, side, self._name, gone=one is not None)
        shared = ([(each.name, each) for each in side.shared_parameters] for side in self._sides)
        yield from self._instances.settings((self._name, ""), *shared)
        yield from self._connections()
        yield from self._renamed()

    def _started(self, instance: NodeInstance, number: int, value: str | None = None) -> Side:
        told = instance.started_type if value is None else value
        return self._instances.side(number, instance.name, told, instance.started.location)

    def _arguments(self) -> Iterator[Change]:
        both = [{each.name: each for each in side.configuration.arguments} for side in self._sides]
        for name in sorted({*both[0], *both[1]}):
            one, other = (known.get(name) for known in both)
            before, after = self._argument(0, one), self._argument(1, other)
            kind = Kind.NEW if one is None else Kind.GONE if other is None else Kind.DEFAULT
            if one and other and one.fixed and other.fixed:
                kind = Kind.VALUE
            if before is None or after is None or canonical(before.value) != canonical(after.value):
                yield Change(Level.ARGUMENT, kind, self._name, before, after, system=self._name)

    def _argument(self, number: int, argument: LaunchArgument | None) -> Side | None:
        if argument is None:
            return None
        told = (argument.value if argument.fixed else argument.default) or ""
        return self._instances.side(number, argument.name, told, argument.location)

    def _connections(self) -> Iterator[Change]:
        """Yield connections added and removed, except those where only names changed."""
        before, after = (joined(side, partial(self._instances.sign, number)) for number, side in enumerate(self._sides))
        for one, other, gone in ((before, after, True), (after, before, False)):
            for source, kind, channel, target in came_apart(one, other):
                yield _came_or_went(Level.CONNECTION, source, Side(channel, target), self._name, kind, gone=gone)

    def _renamed(self) -> Iterator[Change]:
        """Yield each renamed node once, with the number of names changed only because of that."""
        for (before, after), pairs in self.renames.nodes.items():
            names = self.renames.names[before, after]
            along = [count(names, "name")] if names else []
            if len(pairs) == 1:
                one, other = pairs[0]
                sides = self._started(one, 0, "".join(along)), self._started(other, 1, "".join(along))
                yield Change(Level.INSTANCE, Kind.RENAMED, other.name, *sides, system=self._name, owner_before=one.name)
                continue
            told = " and ".join([count(len(pairs), "node"), *along])
            sides = Side(before or "/", told), Side(after or "/", told)
            yield Change(Level.NAMESPACE, Kind.RENAMED, self._name, *sides, system=self._name)


def joined(system: System, known: Callable[[NodeInstance, InstanceInterface], Hashable | None]) -> _Joined:
    """Return the connections of a system, each with the pairs of ends that make it.

    `known` returns the identity of an end, equal for both its states; None for an end left out.
    """
    givers: defaultdict[tuple[Role, str], list[tuple[str, Hashable]]] = defaultdict(list)
    takers: defaultdict[tuple[Role, str], list[tuple[str, Hashable]]] = defaultdict(list)
    for instance in system.instances:
        for end in instance.interfaces:
            sign = known(instance, end)
            if sign is None or not is_known(end.resolved):
                continue
            role = end.declared.role
            if role.outward:
                givers[role, end.resolved].append((instance.name, sign))
            else:
                takers[role.opposite, end.resolved].append((instance.name, sign))
    found: _Joined = {}
    for (role, name), sources in givers.items():
        for source, one in sources:
            for target, other in takers.get((role, name), ()):
                if target != source:
                    found.setdefault((source, role.channel, name, target), set()).add((one, other))
    return found


def came_apart(one: _Joined, other: _Joined) -> Iterator[Connection]:
    """Yield the connections of one system whose ends are not connected in the other under any name; sorted."""
    still = {ends for pairs in other.values() for ends in pairs}
    for connection in sorted(one):
        if connection not in other and not (one[connection] & still):
            yield connection
