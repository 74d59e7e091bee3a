"""Shared parts of the mobile robots: poses in the plane, commands that expire, battery, trail."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Final


@dataclass(frozen=True, slots=True)
class Pose:
    """A position in metres and a heading in radians, counterclockwise from the x axis."""

    x: float
    y: float
    heading: float
    z: float = 0.0

    def distance(self, x: float, y: float) -> float:
        """Return the distance to a point of the floor in metres."""
        return math.hypot(x - self.x, y - self.y)

    def moved(self, ahead: float, left: float, turn: float) -> Pose:
        """Return the pose after a small motion in its own frame."""
        middle = self.heading + turn / 2
        cosine, sine = math.cos(middle), math.sin(middle)
        x, y = self.x + ahead * cosine - left * sine, self.y + ahead * sine + left * cosine
        return Pose(x, y, wrapped(self.heading + turn), self.z)


def wrapped(angle: float) -> float:
    """Return the same angle between -pi and pi."""
    return math.remainder(angle, math.tau)


def quaternion_of(heading: float) -> dict[str, float]:
    """Return the `geometry_msgs/Quaternion` of a heading."""
    return {"x": 0.0, "y": 0.0, "z": math.sin(heading / 2), "w": math.cos(heading / 2)}


def heading_of(quaternion: dict[str, float]) -> float:
    """Return the heading of a `geometry_msgs/Quaternion`; a zero one has heading 0."""
    x, y, z, w = (quaternion[one] for one in "xyzw")
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


_STALE: Final = 0.5  # seconds after which a command expires


@dataclass(frozen=True, slots=True)
class Command:
    """A velocity in the robot's frame, in m/s and rad/s, and its time in seconds."""

    forward: float = 0.0
    left: float = 0.0
    up: float = 0.0
    turn: float = 0.0
    at: float = -math.inf

    def now(self, time: float) -> Command:
        """Return the command in force at a time: zero if it has expired."""
        return self if time - self.at <= _STALE else Command()

    def limited(self, speed: float, turn: float) -> Command:
        """Return the command limited to the robot's speeds; values that are not numbers become zero."""
        forward, left, up = (_bounded(one, speed) for one in (self.forward, self.left, self.up))
        return Command(forward, left, up, _bounded(self.turn, turn), self.at)


def _bounded(value: float, most: float) -> float:
    return max(-most, min(most, value)) if math.isfinite(value) else 0.0


def approached(value: float, target: float, most: float) -> float:
    """Return the value moved towards a target, by at most `most`."""
    return value + max(-most, min(most, target - value))


@dataclass(slots=True)
class Battery:
    """A battery; `charge` is from 0 to 1. An empty one is replaced at once, since the simulation has no charger."""

    idle: float
    moving: float
    charge: float = 1.0

    def drain(self, seconds: float, speed: float) -> None:
        """Discharge by the consumption of some seconds at a speed in m/s."""
        self.charge -= seconds * (self.idle + self.moving * speed)
        if self.charge <= 0:
            self.charge = 1.0


@dataclass(slots=True)
class Trail:
    """The path of a robot, a point every 0.1 m; old points are dropped."""

    points: list[tuple[float, float]] = field(default_factory=list)
    most: int = 2000

    def add(self, pose: Pose) -> None:
        """Add the robot's position."""
        if not self.points or pose.distance(*self.points[-1]) >= 0.1:  # noqa: PLR2004 - the docstring says it
            self.points.append((pose.x, pose.y))
            del self.points[: -self.most]
