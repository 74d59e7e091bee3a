"""The comparison of two states of sources; `compare(b, a)` is the mirror of `compare(a, b)`.

Things are paired by their keys: node types by package and name, interfaces by role and name, instances by their
absolute name or the place that starts them. A thing without a partner is added or removed. An interface counts as
renamed only if that is certain: exactly one interface of a role and type was removed from a node and exactly one
added, in the same file. Consequences of a reported change are not reported again.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.facts import (
    InstanceInterface,
    Interface,
    LaunchArgument,
    Location,
    NodeInstance,
    NodeType,
    Parameter,
    Role,
    System,
)
from kg.holes import anonymous, is_known
from kg.launch.comparison.changes import Change, Difference, Finding, Kind, Level, Record, Side, Sources
from kg.launch.comparison.pairing import Renames, all_pairs, canonical, instance_pairs, matched, paired, relabelled
from kg.render.text import count

if TYPE_CHECKING:
    from kg.facts import LaunchParameter, Remap

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
                yield _added_or_removed(Level.SYSTEM, name, side, name, gone=one is not None)


def _name(system: System) -> str:
    return system.configuration.name


def _order(system: System) -> tuple[str, str]:
    return _name(system), system.configuration.repository


def _added_or_removed(  # noqa: PLR0913 - what a change consists of
    level: Level, owner: str, side: Side, system: str, role: str = "", *, gone: bool
) -> Change:
    if gone:
        return Change(level, Kind.GONE, owner, side, None, role, system)
    return Change(level, Kind.NEW, owner, None, side, role, system)


class _Systems:
    """One system at both sides."""

    def __init__(self, before: System, after: System, code: CodeChanges, *, every: bool) -> None:
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
            elif instance := one or other:
                side = self._started(instance, 0 if one else 1)
                yield _added_or_removed(Level.INSTANCE, instance.name, side, self._name, gone=one is not None)
        shared = ([(each.name, each) for each in side.shared_parameters] for side in self._sides)
        yield from self._instances.settings((self._name, ""), *shared)
        yield from self._connections()
        yield from self._renamed()

    def _started(self, instance: NodeInstance, number: int, value: str | None = None) -> Side:
        shown = instance.started_type if value is None else value
        return self._instances.side(number, instance.name, shown, instance.started.location)

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
        shown = (argument.value if argument.fixed else argument.default) or ""
        return self._instances.side(number, argument.name, shown, argument.location)

    def _connections(self) -> Iterator[Change]:
        """Yield connections added and removed, except those where only names changed."""
        before, after = (joined(side, partial(self._instances.sign, number)) for number, side in enumerate(self._sides))
        for one, other, gone in ((before, after, True), (after, before, False)):
            for source, kind, channel, target in lost_connections(one, other):
                yield _added_or_removed(Level.CONNECTION, source, Side(channel, target), self._name, kind, gone=gone)

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
            summary = " and ".join([count(len(pairs), "node"), *along])
            sides = Side(before or "/", summary), Side(after or "/", summary)
            yield Change(Level.NAMESPACE, Kind.RENAMED, self._name, *sides, system=self._name)


def joined(system: System, identify: Callable[[NodeInstance, InstanceInterface], Hashable | None]) -> _Joined:
    """Return the connections of a system, each with the pairs of ends that make it.

    `identify` returns the identity of an end, equal for both its states; None for an end left out.
    """
    givers: defaultdict[tuple[Role, str], list[tuple[str, Hashable]]] = defaultdict(list)
    takers: defaultdict[tuple[Role, str], list[tuple[str, Hashable]]] = defaultdict(list)
    for instance in system.instances:
        for end in instance.interfaces:
            sign = identify(instance, end)
            if sign is None or not is_known(end.resolved):
                continue
            role = end.declared.role
            if role.outward:
                givers[role, end.resolved].append((instance.name, sign))
            else:
                takers[role.opposite, end.resolved].append((instance.name, sign))
    connections: _Joined = {}
    for (role, name), sources in givers.items():
        for source, one in sources:
            for target, other in takers.get((role, name), ()):
                if target != source:
                    connections.setdefault((source, role.channel, name, target), set()).add((one, other))
    return connections


def lost_connections(one: _Joined, other: _Joined) -> Iterator[Connection]:
    """Yield the connections of one system whose ends are not connected in the other under any name; sorted."""
    still = {ends for pairs in other.values() for ends in pairs}
    for connection in sorted(one):
        if connection not in other and not (one[connection] & still):
            yield connection


def compare(before: Sources, after: Sources, *, every: bool = False) -> Difference:
    """Return the differences; without `every`, interfaces that frameworks create by themselves are left out."""
    code = list(_node_changes(before.nodes, after.nodes, every=every))
    wiring = Wiring(code, every=every)
    systems = list(wiring.changes(before.systems, after.systems))
    return Difference.of([*code, *systems, *_finding_changes(before.findings, after.findings, wiring.renames)])


def _node_changes(before: Iterable[Record], after: Iterable[Record], *, every: bool) -> Iterator[Change]:
    for one, other in paired(_sorted(before), _sorted(after), lambda record: (record.package, record.node.name)):
        if one and other:
            yield from _Node(one, other, every=every).changes()
        elif record := one or other:
            name = f"{record.package}/{record.node.name}"
            side = Side(name, str(record.node.kind), record.node.location, record.repository)
            yield _added_or_removed(Level.NODE, name, side, "", gone=one is not None)


def _sorted(records: Iterable[Record]) -> list[Record]:
    return sorted(records, key=lambda one: (one.repository, str(one.node.location), repr(one.node)))


class _Node:
    """A node type of both sides."""

    def __init__(self, before: Record, after: Record, *, every: bool) -> None:
        self._before, self._after = before, after
        self._every = every
        self._name = f"{after.package}/{after.node.name}"

    def changes(self) -> Iterator[Change]:
        """Yield its changes."""
        before, after = self._kind(self._before), self._kind(self._after)
        if before.value != after.value:
            yield Change(Level.NODE, Kind.TYPE, self._name, before, after)
        yield from self._interfaces()
        yield from self._parameters()

    def _kind(self, record: Record) -> Side:
        return Side(self._name, str(record.node.kind), record.node.location, record.repository)

    def _interfaces(self) -> Iterator[Change]:
        before, after = self._ends(self._before.node), self._ends(self._after.node)
        ways = partial(relabelled, key=_interface_key), partial(matched, key=renamed_key)
        for one, other in all_pairs(before, after, _interface_key, *ways):
            if one is None or other is None:
                yield self._change(Kind.GONE if one else Kind.NEW, one, other, lambda end: end.type or "")
                continue
            if anonymous(code_name(one)) != anonymous(code_name(other)):  # labels of unknown parts are not names
                yield self._change(Kind.RENAMED, one, other, lambda end: end.type or "")
            if one.type != other.type:
                yield self._change(Kind.TYPE, one, other, lambda end: end.type or "?")
            if one.qos != other.qos:
                yield self._change(Kind.QOS, one, other, lambda end: str(end.qos or ""))

    def _change(
        self, kind: Kind, one: Interface | None, other: Interface | None, value: Callable[[Interface], str]
    ) -> Change:
        end = one or other
        before = Side(code_name(one), value(one), one.location, self._before.repository) if one else None
        after = Side(code_name(other), value(other), other.location, self._after.repository) if other else None
        return Change(Level.INTERFACE, kind, self._name, before, after, str(end.role) if end else "")

    def _ends(self, node: NodeType) -> list[Interface]:
        ends = [end for end in node.interfaces if self._every or not end.implicit]
        return sorted(ends, key=lambda end: (_interface_key(end), end.type or "", str(end.location)))

    def _parameters(self) -> Iterator[Change]:
        both = self._settable(self._before), self._settable(self._after)
        gone, new = sorted(both[0].keys() - both[1].keys()), sorted(both[1].keys() - both[0].keys())
        for one, other in relabelled(gone, new, lambda name: (name,)):
            both[1][one] = both[1].pop(other)
        for name in sorted({*both[0], *both[1]}):
            before, after = (known.get(name) for known in both)
            kind = Kind.NEW if before is None else Kind.GONE if after is None else Kind.DEFAULT
            if before is None or after is None or before.value != after.value:
                yield Change(Level.PARAMETER, kind, self._name, before, after)

    def _settable(self, record: Record) -> dict[str, Side]:
        parameters = _parameters(record.node, every=self._every)
        return {
            name: Side(name, _parameter_detail(accesses), accesses[0].location, record.repository)
            for name, accesses in parameters.items()
        }


def _interface_key(end: Interface) -> tuple[str, str]:
    return str(end.role), code_name(end)


def _parameters(node: NodeType, *, every: bool) -> dict[str, list[Parameter]]:
    by_name: defaultdict[str, list[Parameter]] = defaultdict(list)
    for parameter in sorted(
        node.parameters, key=lambda one: (one.default is None, one.default or "", str(one.location))
    ):
        if parameter.name is not None and (every or not parameter.implicit):
            by_name[parameter.name].append(parameter)
    return dict(by_name)


def _parameter_detail(accesses: list[Parameter]) -> str:
    """Return type and defaults of a parameter, from all lines that declare them."""
    types = sorted({one.type for one in accesses if one.type})
    defaults = sorted({canonical(one.default) for one in accesses if one.default is not None})
    return " ".join(filter(None, ["|".join(types), f"= {' or '.join(defaults)}" if defaults else ""]))


def _finding_changes(
    before: Iterable[Finding], after: Iterable[Finding], renames: Mapping[str, Renames]
) -> Iterator[Change]:
    """Yield the findings added or removed; a finding about renamed things is the same finding."""

    def identity(finding: Finding) -> tuple[str, str, str, str]:
        neutral = renames.get(finding.system, Renames()).neutral
        return finding.system, finding.code, neutral(finding.subject), neutral(finding.message)

    for one, other in paired(sorted(before, key=_finding_key), sorted(after, key=_finding_key), identity):
        found = one or other
        if found is None or (one and other):
            continue
        side = Side(found.subject, found.message, found.location, found.repository)
        yield _added_or_removed(Level.FINDING, found.code, side, found.system, gone=one is not None)


def _finding_key(finding: Finding) -> tuple[str, str, str, str]:
    return finding.system, finding.code, finding.subject, finding.message
