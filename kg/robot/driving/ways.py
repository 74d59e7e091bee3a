"""Which of several ways to a capability is taken."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import RobotError
from kg.robot.capability import role_of
from kg.robot.lifecycle import ACTIVE
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Collection

    from kg.robot.capability import Capability, Way
    from kg.robot.connection import ComputationGraph

__all__ = ["choose", "named"]


def named(capability: Capability, name: str | None) -> list[Way]:
    """Return the ways that can be meant: all, or those of a channel, node or message type.

    Raises:
        RobotError: KG822 when there is none of that name, or the capability cannot be reached at all.
    """
    if not capability.ways:
        because = f"; it is implied by {', '.join(capability.implied_by)}" if capability.implied_by else ""
        raise RobotError("KG822", f"`{capability.name}` cannot be reached: no node of the robot provides it{because}")
    if name is None:
        return list(capability.ways)
    found = [one for one in capability.ways if name in {one.name, one.name.lstrip("/"), one.node, one.type}]
    if not found:
        names = {one.name for one in capability.ways}
        hint = did_you_mean(name, names) or f"Its ways are: {', '.join(sorted(names))}."
        raise RobotError("KG822", f"`{capability.name}` has no way `{name}`", hint=hint)
    return found


def choose(ways: list[Way], arguments: Collection[str], graph: ComputationGraph | None, *, reads: bool) -> Way:
    """Return the way to take.

    One whose node is there, and active, comes before one whose node is not; then one that has a field for every
    argument; then the most specific, which has fields for the most parameters; then an action before a service before a
    topic when something is done (an action tells how it ends), a topic first when something is read; then the first.
    """
    order = ("topic", "service", "action") if reads else ("action", "service", "topic")

    def key(way: Way) -> tuple[bool, int, int, int]:
        lacking = sum(name not in way.fields for name in arguments)
        dead = graph is not None and not _alive(way, graph, reads=reads)
        return dead, lacking, -len(way.fields), order.index(way.kind)

    return min(ways, key=key)


def _alive(way: Way, graph: ComputationGraph, *, reads: bool) -> bool:
    role = role_of(way, reads=reads)
    dead = {one.name for one in graph.nodes if one.problem is not None or one.state not in {None, ACTIVE}}
    return any(one.name == way.name and one.role is role and one.node not in dead for one in graph.ends)
