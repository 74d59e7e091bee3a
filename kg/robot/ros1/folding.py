"""The five topics of an action of ROS 1 as one end of the action."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.connection import LiveEnd

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["fold"]

_GOAL: Final = "ActionGoal"
_TOPICS: Final = frozenset({"goal", "cancel", "status", "feedback", "result"})
_SERVER: Final = {(Role.PUBLISHES, "result"), (Role.PUBLISHES, "status"), (Role.SUBSCRIBES, "goal")}
_CLIENT: Final = (Role.PUBLISHES, "goal")


def fold(ends: Iterable[LiveEnd]) -> list[LiveEnd]:
    """Return ends with actions in the place of their topics.

    A node is a server that hears goals and tells states and results; a client is one that gives goals. Who only listens
    to the state, feedback or result of an action stays the subscriber that it is.
    """
    ends = list(ends)
    kinds = {
        one.name.removesuffix("/goal"): one.type.removesuffix(_GOAL)
        for one in ends
        if one.name.endswith("/goal") and one.type is not None and one.type.endswith(_GOAL)
    }
    parts: dict[tuple[str, str], set[tuple[Role, str]]] = {}
    for one in ends:
        action, _, part = one.name.rpartition("/")
        if action in kinds and part in _TOPICS and one.role.channel == "topic":
            parts.setdefault((action, one.node), set()).add((one.role, part))
    found = {
        (action, node): Role.ACTION_SERVERS if having >= _SERVER else Role.ACTION_CLIENTS
        for (action, node), having in parts.items()
        if having >= _SERVER or _CLIENT in having
    }
    left = [one for one in ends if not _is_of(one, found)]
    return left + [LiveEnd(node, role, action, kinds[action]) for (action, node), role in found.items()]


def _is_of(end: LiveEnd, found: dict[tuple[str, str], Role]) -> bool:
    action, _, part = end.name.rpartition("/")
    return part in _TOPICS and end.role.channel == "topic" and (action, end.node) in found
