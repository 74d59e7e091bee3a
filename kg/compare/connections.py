"""Who is joined to whom in a system, by the ends that meet."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, TypeAlias

from kg.holes import is_known

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator

    from kg.facts import InstanceInterface, NodeInstance, Role, System

__all__ = ["Connection", "came_apart", "joined"]

Connection: TypeAlias = tuple[str, str, str, str]
"""The node that gives, the kind of channel, its name, the node that takes."""
_Joined: TypeAlias = "dict[Connection, set[tuple[Hashable, Hashable]]]"


def joined(system: System, known: Callable[[NodeInstance, InstanceInterface], Hashable | None]) -> _Joined:
    """Return the connections of a system, each with the pairs of ends that make it.

    `known` gives what stands for an end, the same for both states of it; None for an end that is left out.
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
    """Yield the connections of one system whose ends do not meet in the other, under whatever name; sorted."""
    still = {ends for pairs in other.values() for ends in pairs}
    for connection in sorted(one):
        if connection not in other and not (one[connection] & still):
            yield connection
