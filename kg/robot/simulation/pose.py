"""Poses in the plane, angles and quaternions."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["Pose", "heading_of", "quaternion_of", "wrapped"]


@dataclass(frozen=True, slots=True)
class Pose:
    """A position in metres and a heading in radians, from the x axis to the left."""

    x: float
    y: float
    heading: float
    z: float = 0.0

    def distance(self, x: float, y: float) -> float:
        """Return how far a point of the floor is, in metres."""
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
    """Return the heading of a `geometry_msgs/Quaternion`; one of zeros heads along the x axis."""
    x, y, z, w = (quaternion[one] for one in "xyzw")
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
