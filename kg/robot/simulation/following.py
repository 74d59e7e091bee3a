"""Driving along a way: which velocity comes next, from the pose and what the laser sees."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.pose import Pose, wrapped
from kg.robot.simulation.robots import Command
from kg.robot.simulation.wheeled import RADIUS, SPEED

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["REACHED", "Follower", "free_ahead"]

REACHED: Final = 0.1
"""A goal is reached within so many metres, and then by the heading within `_TURNED` radians."""

_TURNED: Final = 0.06
_PASSED: Final = 0.25
_ABOUT: Final = 0.6
"""Where the way bends by more radians, the robot turns on the spot."""

_STOP: Final = 0.08


class Follower:
    """Follows points to a last one and its heading; `done` once it is there."""

    def __init__(self, points: Sequence[tuple[float, float]], heading: float) -> None:
        self._points = list(points)
        self._heading = heading
        self.done = False

    def left(self, pose: Pose) -> float:
        """Return how far it still is, in metres."""
        points = [(pose.x, pose.y), *self._points]
        return sum(math.dist(one, two) for one, two in pairwise(points))

    def next(self, pose: Pose, ranges: Sequence[float]) -> Command:
        """Return the velocity for the next tenth of a second."""
        while len(self._points) > 1 and pose.distance(*self._points[0]) < _PASSED:
            self._points.pop(0)
        if self._points and (len(self._points) > 1 or pose.distance(*self._points[0]) > REACHED):
            return self._onwards(pose, ranges)
        self._points.clear()
        off = wrapped(self._heading - pose.heading)
        self.done = abs(off) < _TURNED
        return Command() if self.done else Command(turn=_turning(off))

    def _onwards(self, pose: Pose, ranges: Sequence[float]) -> Command:
        x, y = self._points[0]
        off = wrapped(math.atan2(y - pose.y, x - pose.x) - pose.heading)
        if abs(off) > _ABOUT:
            return Command(turn=_turning(off))
        slow = min(1.0, max(0.25, pose.distance(x, y)))
        room = free_ahead(ranges) - _STOP
        return Command(forward=max(0.0, min(SPEED * slow * math.cos(off) ** 2, 1.2 * room)), turn=2.0 * off)


def _turning(off: float) -> float:
    return math.copysign(min(1.5, max(0.25, 2.0 * abs(off))), off)


def free_ahead(ranges: Sequence[float]) -> float:
    """Return how far the robot can drive straight on, in metres, by a scan that begins behind it."""
    free = math.inf
    for index, length in enumerate(ranges):
        angle = -math.pi + index * math.tau / len(ranges)
        ahead, aside = length * math.cos(angle), length * math.sin(angle)
        if ahead > 0 and abs(aside) <= RADIUS + 0.02:
            free = min(free, ahead - RADIUS)
    return free
