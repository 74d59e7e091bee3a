"""From the ends that a middleware tells to a computation graph: actions folded, what does not fit reported."""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveNode

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Qos
    from kg.robot.connection import LiveEnd
    from kg.robot.ros2.middleware import Neighbourhood

__all__ = ["computation_graph", "misfit"]

_HIDDEN: Final = re.compile(r"(.+)/_action/(send_goal|get_result|cancel_goal|feedback|status)")
_ROLES: Final = {Role.SERVICES: Role.ACTION_SERVERS, Role.CLIENTS: Role.ACTION_CLIENTS}
_MOST: Final = 1000
"""So many problems of ends that do not fit are told; a graph that has more is not made clearer by them."""


def computation_graph(told: Neighbourhood, *, complete: bool) -> ComputationGraph:
    """Return the graph that the ends of others make."""
    ends = {one for end in told.ends if (one := _folded(end)) is not None}
    ordered = sorted(ends, key=lambda one: (one.name, one.role, one.node, one.type or "", str(one.qos)))
    problems = {*told.problems, *_misfits(ordered)}
    return ComputationGraph(2, tuple(_nodes(told.nodes)), tuple(ordered), tuple(sorted(problems)), complete)


def _folded(end: LiveEnd) -> LiveEnd | None:
    found = _HIDDEN.fullmatch(end.name)
    if found is None:
        return end
    if found[2] != "send_goal" or end.role not in _ROLES:
        return None
    kind = end.type.removesuffix("_SendGoal") if end.type else None
    return replace(end, role=_ROLES[end.role], name=found[1], type=kind, qos=None)


def _nodes(nodes: Iterable[LiveNode]) -> list[LiveNode]:
    named: dict[str, list[LiveNode]] = defaultdict(list)
    for node in nodes:
        named[node.name].append(node)
    return [
        each[0] if len(each) == 1 else replace(min(each, key=_where), problem=f"{len(each)} nodes have this name")
        for _, each in sorted(named.items())
    ]


def _where(node: LiveNode) -> str:
    return node.address or ""


def _misfits(ends: list[LiveEnd]) -> list[GraphProblem]:
    topics: dict[str, dict[Role, list[LiveEnd]]] = defaultdict(lambda: defaultdict(list))
    for end in ends:
        if end.role.channel == "topic":
            topics[end.name][end.role].append(end)
    found: list[GraphProblem] = []
    for name, sides in topics.items():
        found += _misfits_of(name, sides[Role.PUBLISHES], sides[Role.SUBSCRIBES])
        if len(found) > _MOST:
            break
    return found[:_MOST]


def _misfits_of(name: str, publishers: list[LiveEnd], subscribers: list[LiveEnd]) -> list[GraphProblem]:
    """Compare kinds of ends, not ends: `/rosout` has hundreds, all alike."""
    offers, asks = _kinds(publishers), _kinds(subscribers)
    found = []
    for (offered, offer), writer in offers.items():
        for (asked, ask), reader in asks.items():
            if offered is not None and asked is not None and offered != asked:
                told = f"{writer.node} publishes {offered}, {reader.node} subscribes to {asked}"
                found.append(GraphProblem("KG806", name, told))
            elif offer and ask and (why := misfit(offer, ask)):
                told = f"{reader.node} receives nothing from {writer.node}: {why}"
                found.append(GraphProblem("KG815", name, told))
    return found


def _kinds(ends: list[LiveEnd]) -> dict[tuple[str | None, Qos | None], LiveEnd]:
    return {(one.type, one.qos): one for one in reversed(ends)}


def misfit(offer: Qos, ask: Qos) -> str | None:
    """Return why an offer does not do for who asks, None when it does.

    Source: DDS 1.4, 2.2.3, "requested / offered" of reliability, durability, deadline and liveliness.
    """
    if offer.reliability == "best_effort" and ask.reliability == "reliable":
        return "it offers best effort, reliable delivery is asked for"
    if offer.durability == "volatile" and ask.durability == "transient_local":
        return "it keeps no messages for those that come later, which is asked for (transient local)"
    if ask.deadline is not None and (offer.deadline is None or offer.deadline > ask.deadline):
        return f"a message every {ask.deadline:g} s is asked for, which it does not promise"
    if offer.liveliness == "automatic" and ask.liveliness == "manual_by_topic":
        return "it does not assert its liveliness by topic, which is asked for"
    if ask.lease_duration is not None and (offer.lease_duration is None or offer.lease_duration > ask.lease_duration):
        return f"a sign of life every {ask.lease_duration:g} s is asked for, which it does not promise"
    return None
