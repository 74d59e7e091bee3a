"""The comparison of two states of sources; `compare(b, a)` is the mirror of `compare(a, b)`.

Things are paired by their keys: node types by package and name, interfaces by role and name, instances by their
absolute name or the place that starts them. A thing without a partner is added or removed. An interface counts as
renamed only if that is certain: exactly one interface of a role and type was removed from a node and exactly one
added, in the same file. Consequences of a reported change are not reported again.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from kg.launch.comparison.changes import Change, Difference, Kind, Level, Side
from kg.launch.comparison.pairing import paired, relabelled
from kg.launch.comparison.renaming import Renames
from kg.launch.comparison.systems import Wiring
from kg.launch.comparison.values import canonical
from kg.launch.comparison.wording import qos_words

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from kg.facts import Interface, NodeType, Parameter
    from kg.launch.comparison.changes import Finding, Record, Sources


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
            kind = Kind.GONE if one else Kind.NEW
            yield Change(Level.NODE, kind, name, side if one else None, None if one else side)


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
        gone, new = [], []
        for one, other in paired(self._ends(self._before.node), self._ends(self._after.node), _interface_key):
            if one and other:
                yield from self._interface(one, other)
            elif one:
                gone.append(one)
            elif other:
                new.append(other)
        for one, other in [*relabelled(gone, new, _interface_key)]:
            gone.remove(one)
            new.remove(other)
            yield from self._interface(one, other)
        for one, other in _renamed(gone, new):
            gone.remove(one)
            new.remove(other)
            yield self._change(Kind.RENAMED, one, other, lambda end: end.type or "")
            yield from self._interface(one, other)
        for one in gone:
            yield self._change(Kind.GONE, one, None, lambda end: end.type or "")
        for other in new:
            yield self._change(Kind.NEW, None, other, lambda end: end.type or "")

    def _interface(self, one: Interface, other: Interface) -> Iterator[Change]:
        if one.type != other.type:
            yield self._change(Kind.TYPE, one, other, lambda end: end.type or "?")
        if one.qos != other.qos:
            yield self._change(Kind.QOS, one, other, lambda end: qos_words(end.qos))

    def _change(
        self, kind: Kind, one: Interface | None, other: Interface | None, value: Callable[[Interface], str]
    ) -> Change:
        known = one or other
        before = Side(_shown(one), value(one), one.location, self._before.repository) if one else None
        after = Side(_shown(other), value(other), other.location, self._after.repository) if other else None
        return Change(Level.INTERFACE, kind, self._name, before, after, str(known.role) if known else "")

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
        found = _parameters(record.node, every=self._every)
        return {
            name: Side(name, _parameter_detail(accesses), accesses[0].location, record.repository)
            for name, accesses in found.items()
        }


def _interface_key(end: Interface) -> tuple[str, str]:
    return str(end.role), end.name if end.name is not None else f"? {end.written or ''}"


def _shown(end: Interface) -> str:
    return end.name if end.name is not None else f"? {end.written or ''}".strip()


def _renamed(gone: list[Interface], new: list[Interface]) -> list[tuple[Interface, Interface]]:
    """Return the pairs that are certainly one renamed interface."""
    groups: defaultdict[tuple[object, ...], tuple[list[Interface], list[Interface]]] = defaultdict(lambda: ([], []))
    for side, ends in enumerate((gone, new)):
        for end in ends:
            if end.type and end.name is not None:
                groups[end.role, end.type, end.location.path][side].append(end)
    return [(one[0], other[0]) for one, other in groups.values() if len(one) == len(other) == 1]


def _parameters(node: NodeType, *, every: bool) -> dict[str, list[Parameter]]:
    found: defaultdict[str, list[Parameter]] = defaultdict(list)
    for parameter in sorted(
        node.parameters, key=lambda one: (one.default is None, one.default or "", str(one.location))
    ):
        if parameter.name is not None and (every or not parameter.implicit):
            found[parameter.name].append(parameter)
    return dict(found)


def _parameter_detail(accesses: list[Parameter]) -> str:
    """Return type and defaults of a parameter, from all lines that declare them."""
    types = sorted({one.type for one in accesses if one.type})
    defaults = sorted({canonical(one.default) for one in accesses if one.default is not None})
    return " ".join(filter(None, ["|".join(types), f"= {' or '.join(defaults)}" if defaults else ""]))


def _finding_changes(
    before: Iterable[Finding], after: Iterable[Finding], renames: Mapping[str, Renames]
) -> Iterator[Change]:
    """Yield the findings added or removed; a finding about renamed things is the same finding."""

    def known(finding: Finding) -> tuple[str, str, str, str]:
        neutral = renames.get(finding.system, Renames()).neutral
        return finding.system, finding.code, neutral(finding.subject), neutral(finding.message)

    for one, other in paired(sorted(before, key=_finding_key), sorted(after, key=_finding_key), known):
        found = one or other
        if found is None or (one and other):
            continue
        side = Side(found.subject, found.message, found.location, found.repository)
        kind = Kind.GONE if one else Kind.NEW
        sides = side if one else None, None if one else side
        yield Change(Level.FINDING, kind, found.code, sides[0], sides[1], system=found.system)


def _finding_key(finding: Finding) -> tuple[str, str, str, str]:
    return finding.system, finding.code, finding.subject, finding.message
