"""Actions of ROS 1: five topics and the states of a goal (wiki.ros.org/actionlib/DetailedDescription)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kg.robot.clock import Clock

__all__ = ["ENDED", "Part", "Status", "stamp", "topics"]


class Status(IntEnum):
    """The states of a goal: constants of actionlib_msgs/GoalStatus."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLING = 7
    RECALLED = 8
    LOST = 9


ENDED = frozenset({Status.PREEMPTED, Status.SUCCEEDED, Status.ABORTED, Status.REJECTED, Status.RECALLED, Status.LOST})
"""The states that a goal does not leave."""


@dataclass(frozen=True, slots=True)
class Part:
    """A topic of an action: its last name, its type, and whether the server writes to it."""

    name: str
    type: str
    of_server: bool


def topics(kind: str) -> tuple[Part, ...]:
    """Return the topics of an action of a type `package/Type`."""
    return (
        Part("goal", f"{kind}ActionGoal", of_server=False),
        Part("cancel", "actionlib_msgs/GoalID", of_server=False),
        Part("status", "actionlib_msgs/GoalStatusArray", of_server=True),
        Part("feedback", f"{kind}ActionFeedback", of_server=True),
        Part("result", f"{kind}ActionResult", of_server=True),
    )


def stamp(clock: Clock) -> dict[str, Any]:
    """Return the time of a clock as a value of type `time`."""
    now = max(clock.now(), 0.0)
    return {"sec": int(now), "nanosec": int(now % 1 * 1e9)}
