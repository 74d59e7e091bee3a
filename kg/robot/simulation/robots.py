"""What both robots have in common: commands that end when they are not renewed, a battery, a trail."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from kg.robot.simulation.pose import Pose

__all__ = ["STALE", "Battery", "Command", "Trail", "approached"]

STALE: Final = 0.5
"""Seconds after which a command that was not renewed counts no more."""


@dataclass(frozen=True, slots=True)
class Command:
    """A velocity in the robot's frame, in m/s and rad/s, and when it was given in seconds."""

    forward: float = 0.0
    left: float = 0.0
    up: float = 0.0
    turn: float = 0.0
    at: float = -math.inf

    def now(self, time: float) -> Command:
        """Return the command as it counts at a time: none when it is stale."""
        return self if time - self.at <= STALE else Command()

    def limited(self, speed: float, turn: float) -> Command:
        """Return the command with each part within what the robot can do; what is not a number is zero."""
        forward, left, up = (_bounded(one, speed) for one in (self.forward, self.left, self.up))
        return Command(forward, left, up, _bounded(self.turn, turn), self.at)


def _bounded(value: float, most: float) -> float:
    return max(-most, min(most, value)) if math.isfinite(value) else 0.0


def approached(value: float, target: float, most: float) -> float:
    """Return the value moved towards a target, by no more than `most`."""
    return value + max(-most, min(most, target - value))


@dataclass(slots=True)
class Battery:
    """A battery; `charge` is its share from 0 to 1. Empty, it is as good as new: a simulation has no sockets."""

    idle: float
    moving: float
    charge: float = 1.0

    def drain(self, seconds: float, speed: float) -> None:
        """Take out what some seconds at a speed in m/s cost."""
        self.charge -= seconds * (self.idle + self.moving * speed)
        if self.charge <= 0:
            self.charge = 1.0


@dataclass(slots=True)
class Trail:
    """Where a robot was, a point every 0.1 m, of which the last are kept."""

    points: list[tuple[float, float]] = field(default_factory=list)
    most: int = 2000

    def add(self, pose: Pose) -> None:
        """Note where the robot is."""
        if not self.points or pose.distance(*self.points[-1]) >= 0.1:  # noqa: PLR2004 - the docstring says it
            self.points.append((pose.x, pose.y))
            del self.points[: -self.most]
