"""The world as pybullet has it: what stands there, what a ray hits, what a camera sees."""

from __future__ import annotations

import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.robot.simulation.loading import physics
from kg.robot.simulation.tags import BORDER, picture_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.robot.simulation.plan import Plan, TagPlace

__all__ = ["Camera", "Scene", "Vector"]

Vector = tuple[float, float, float]

TAG_SIZE: Final = 0.6
"""The edge of the black square of a tag, in metres: large, so that small pictures show it."""

_THICK: Final = 0.1
_WALL: Final = (0.91, 0.89, 0.84, 1.0)
_FLOOR: Final = (0.62, 0.62, 0.60, 1.0)


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera without distortion; `field` is its vertical angle in degrees."""

    width: int = 200
    height: int = 150
    field: float = 55.0
    far: float = 14.0

    @property
    def focal(self) -> float:
        """The focal length in pixels."""
        return self.height / 2 / math.tan(math.radians(self.field) / 2)

    @property
    def matrix(self) -> list[float]:
        """The matrix K of `sensor_msgs/CameraInfo`, row by row."""
        return [self.focal, 0.0, self.width / 2, 0.0, self.focal, self.height / 2, 0.0, 0.0, 1.0]


class Scene:
    """The bodies of a plan in a physics server of their own, which `close` ends.

    Args:
        plan: what stands there.
        step: the fixed step of time, in seconds.
        gravity: whether bodies fall.
    """

    def __init__(self, plan: Plan, step: float, *, gravity: bool) -> None:
        """Raise RobotError KG840 when pybullet or OpenCV is not installed."""
        self.bullet: Any = physics()
        self.bullet.setTimeStep(step)
        self.bullet.setPhysicsEngineParameter(deterministicOverlappingPairs=1)
        self.bullet.setGravity(0, 0, -9.81 if gravity else 0)
        self._build(plan)

    def _build(self, plan: Plan) -> None:
        middle = (plan.width / 2, plan.depth / 2, -_THICK / 2)
        self.floor = self.box((plan.width / 2 + 1, plan.depth / 2 + 1, _THICK / 2), middle, _FLOOR)
        for wall in plan.walls:
            for x, y, to_x, to_y in wall.pieces():
                half = (abs(to_x - x) / 2 + _THICK / 2, abs(to_y - y) / 2 + _THICK / 2, plan.height / 2)
                self.box(half, ((x + to_x) / 2, (y + to_y) / 2, plan.height / 2), _WALL)
        for thing in plan.things:
            at = (thing.x, thing.y, thing.height / 2)
            if thing.shape == "box":
                self.box((thing.width / 2, thing.depth / 2, thing.height / 2), at, _color(thing.color))
            else:
                self.cylinder(thing.radius, thing.height, at, _color(thing.color))
        with tempfile.TemporaryDirectory() as folder:
            for tag in plan.tags:
                self._tag(tag, Path(folder))

    def box(self, half: Vector, at: Vector, color: Sequence[float]) -> int:
        """Put a box there that does not move, by half of its edges; return its number."""
        shape = self.bullet.createCollisionShape(self.bullet.GEOM_BOX, halfExtents=half)
        look = self.bullet.createVisualShape(self.bullet.GEOM_BOX, halfExtents=half, rgbaColor=color)
        return int(self.bullet.createMultiBody(0, shape, look, at))

    def cylinder(self, radius: float, height: float, at: Vector, color: Sequence[float], mass: float = 0) -> int:
        """Put a standing cylinder there; without mass it does not move. Return its number."""
        shape = self.bullet.createCollisionShape(self.bullet.GEOM_CYLINDER, radius=radius, height=height)
        look = self.bullet.createVisualShape(self.bullet.GEOM_CYLINDER, radius=radius, length=height, rgbaColor=color)
        return int(self.bullet.createMultiBody(mass, shape, look, at))

    def _tag(self, tag: TagPlace, folder: Path) -> None:
        half = TAG_SIZE / 2 * (1 + 2 * BORDER)
        corners = [(0, -half, -half), (0, half, -half), (0, half, half), (0, -half, half)]
        look = self.bullet.createVisualShape(
            self.bullet.GEOM_MESH,
            vertices=corners,
            indices=[0, 1, 2, 0, 2, 3],
            uvs=[(0, 0), (1, 0), (1, 1), (0, 1)],
            normals=[(1, 0, 0)] * 4,
        )
        turned = (0, -math.pi / 2, 0) if tag.heading is None else (0, 0, math.radians(tag.heading))
        body = self.bullet.createMultiBody(
            0, -1, look, (tag.x, tag.y, tag.z), self.bullet.getQuaternionFromEuler(turned)
        )
        path = folder / f"{tag.id}.png"
        path.write_bytes(picture_of(tag.id))
        self.bullet.changeVisualShape(body, -1, textureUniqueId=self.bullet.loadTexture(str(path)))

    def rays(self, begin: Sequence[Vector], end: Sequence[Vector]) -> list[float]:
        """Return for each ray which share of it is free, 1 where it hits nothing."""
        return [float(hit[2]) for hit in self.bullet.rayTestBatch(begin, end)]

    def picture(self, camera: Camera, eye: Vector, target: Vector, up: Vector) -> np.ndarray[Any, Any]:
        """Return what a camera sees, as rows of pixels of red, green and blue."""
        view = self.bullet.computeViewMatrix(eye, target, up)
        shape = self.bullet.computeProjectionMatrixFOV(camera.field, camera.width / camera.height, 0.05, camera.far)
        flags = self.bullet.ER_NO_SEGMENTATION_MASK
        seen = self.bullet.getCameraImage(
            camera.width, camera.height, view, shape, shadow=0, renderer=self.bullet.ER_TINY_RENDERER, flags=flags
        )
        pixels = np.reshape(np.asarray(seen[2], dtype=np.uint8), (camera.height, camera.width, 4))
        return np.ascontiguousarray(pixels[:, :, :3])

    def close(self) -> None:
        """End the physics server."""
        self.bullet.disconnect()


def _color(text: str) -> tuple[float, ...]:
    return (*(int(text[at : at + 2], 16) / 255 for at in (1, 3, 5)), 1.0)
