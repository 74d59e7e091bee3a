"""The physics of a world: bodies, rays and cameras of pybullet, and tags by OpenCV's ArUco.

pybullet and OpenCV, the extra `simulate`, are loaded when a simulation starts.
"""

from __future__ import annotations

import ctypes
import math
import os
import sys
import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.robot.simulation.plan import Plan, TagPlace

_STREAMS: Final = (1, 2)


def physics() -> Any:
    """Return a new physics server of pybullet without a window; RobotError KG840 if pybullet is not installed."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    with _silence():
        bullet = _loaded("pybullet")
        return _loaded("pybullet_utils.bullet_client").BulletClient(bullet.DIRECT)


def opencv() -> Any:
    """Return OpenCV with its dictionaries of tags; RobotError KG840 if it is not installed."""
    return _loaded("cv2")


def _loaded(module: str) -> Any:
    try:
        return import_module(module)
    except ImportError:
        name = "opencv-python-headless" if module == "cv2" else "pybullet"
        hint = "Install the extra: pip install 'kg-ros[simulate]'"
        raise RobotError("KG840", f"the simulation needs {name}, which is not installed", hint=hint) from None


@contextmanager
def _silence() -> Iterator[None]:
    """Keep the banner of pybullet's C code off the terminal, and off stdout, which is for data."""
    flush = ctypes.CDLL(None).fflush
    copies = [os.dup(stream) for stream in _STREAMS]
    nothing = os.open(os.devnull, os.O_WRONLY)
    try:
        flush(None)
        for stream in _STREAMS:
            os.dup2(nothing, stream)
        yield
    finally:
        flush(None)
        for stream, copy in zip(_STREAMS, copies, strict=True):
            os.dup2(copy, stream)
            os.close(copy)
        os.close(nothing)


_BORDER: Final = 1 / 6  # white margin around the black square, as a share of its edge: one cell of the dictionary

_CELLS: Final = 6
_PIXELS: Final = 32
_LARGER: Final = 3
"""Enlargement of images before tags are detected, since cells of two pixels are missed otherwise."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """A detected tag: its position in metres in the optical frame (right, down, forward) and its orientation."""

    id: int
    position: tuple[float, float, float]
    orientation: tuple[float, float, float, float]


def picture_of(tag: int) -> bytes:
    """Return a PNG of a tag with its margin."""
    cv = opencv()
    square = cv.aruco.generateImageMarker(_dictionary(), tag, _CELLS * _PIXELS, borderBits=1)
    framed = cv.copyMakeBorder(square, *[_PIXELS] * 4, cv.BORDER_CONSTANT, value=255)
    return bytes(cv.imencode(".png", cv.cvtColor(framed, cv.COLOR_GRAY2BGR))[1])


def find_tags(pixels: np.ndarray[Any, Any], matrix: Sequence[float], size: float) -> list[Sighting]:
    """Return the tags in an image, the nearest first.

    Args:
        pixels: rows of red, green and blue.
        matrix: the camera's K, row by row.
        size: the edge of the black square of every tag, in metres.
    """
    cv = opencv()
    gray = cv.cvtColor(pixels, cv.COLOR_RGB2GRAY)
    large = cv.resize(gray, None, fx=_LARGER, fy=_LARGER, interpolation=cv.INTER_CUBIC)
    corners, numbers, _ = _detector().detectMarkers(large)
    if numbers is None:
        return []
    inner = np.array(matrix, dtype=np.float64).reshape(3, 3)
    sightings = [
        _sighting(int(tag), (four.reshape(4, 2) + 0.5) / _LARGER, inner, size)
        for tag, four in zip(numbers.flatten(), corners, strict=True)
    ]
    return sorted(sightings, key=lambda one: one.position[2])


def _sighting(tag: int, corners: np.ndarray[Any, Any], matrix: np.ndarray[Any, Any], size: float) -> Sighting:
    cv = opencv()
    half = size / 2
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)], dtype=np.float64)
    _, turn, shift = cv.solvePnP(square, corners.astype(np.float64), matrix, None, flags=cv.SOLVEPNP_IPPE_SQUARE)
    x, y, z = (float(one) for one in shift.flatten())
    angle = float(np.linalg.norm(turn))  # a rotation vector: its direction is the axis
    share = math.sin(angle / 2) / angle if angle else 0.0
    i, j, k = (float(one) * share for one in turn.flatten())
    return Sighting(tag, (x, y, z), (i, j, k, math.cos(angle / 2)))


@cache
def _dictionary() -> Any:
    cv = opencv()
    return cv.aruco.getPredefinedDictionary(cv.aruco.DICT_4X4_50)


@cache
def _detector() -> Any:
    cv = opencv()
    settings = cv.aruco.DetectorParameters()
    settings.adaptiveThreshWinSizeMin = 23
    settings.adaptiveThreshWinSizeMax = 43
    settings.adaptiveThreshWinSizeStep = 20
    return cv.aruco.ArucoDetector(_dictionary(), settings)


Vector = tuple[float, float, float]

TAG_SIZE: Final = 0.6
"""Edge of the black square of a tag in metres: large enough for small images."""

_THICK: Final = 0.1
_WALL: Final = (0.91, 0.89, 0.84, 1.0)
_FLOOR: Final = (0.62, 0.62, 0.60, 1.0)


@dataclass(frozen=True, slots=True)
class Camera:
    """A pinhole camera without distortion; `field` is its vertical field of view in degrees."""

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
    """The bodies of a plan in a physics server of their own, ended by `close`.

    Args:
        plan: the world.
        step: the fixed time step, in seconds.
        gravity: whether bodies fall.
    """

    def __init__(self, plan: Plan, step: float, *, gravity: bool) -> None:
        """Raise RobotError KG840 if pybullet or OpenCV is not installed."""
        self.bullet: Any = physics()
        self.bullet.setTimeStep(step)
        self.bullet.setPhysicsEngineParameter(deterministicOverlappingPairs=1)
        self.bullet.setGravity(0, 0, -9.81 if gravity else 0)
        self._things: dict[str, int] = {}
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
            color = (*(int(thing.color[begin : begin + 2], 16) / 255 for begin in (1, 3, 5)), 1.0)  # from `#rrggbb`
            if thing.shape == "box":
                half = (thing.width / 2, thing.depth / 2, thing.height / 2)
                self._things[thing.name] = self.box(half, at, color, thing.mass)
            else:
                self._things[thing.name] = self.cylinder(thing.radius, thing.height, at, color, thing.mass)
        with tempfile.TemporaryDirectory() as folder:
            for tag in plan.tags:
                self._tag(tag, Path(folder))

    def box(self, half: Vector, at: Vector, color: Sequence[float], mass: float = 0) -> int:
        """Add a box, by its half edges, and return its number; without mass it does not move."""
        shape = self.bullet.createCollisionShape(self.bullet.GEOM_BOX, halfExtents=half)
        look = self.bullet.createVisualShape(self.bullet.GEOM_BOX, halfExtents=half, rgbaColor=color)
        return int(self.bullet.createMultiBody(mass, shape, look, at))

    def cylinder(self, radius: float, height: float, at: Vector, color: Sequence[float], mass: float = 0) -> int:
        """Add an upright cylinder, and return its number; without mass it does not move."""
        shape = self.bullet.createCollisionShape(self.bullet.GEOM_CYLINDER, radius=radius, height=height)
        look = self.bullet.createVisualShape(self.bullet.GEOM_CYLINDER, radius=radius, length=height, rgbaColor=color)
        return int(self.bullet.createMultiBody(mass, shape, look, at))

    def _tag(self, tag: TagPlace, folder: Path) -> None:
        half = TAG_SIZE / 2 * (1 + 2 * _BORDER)
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

    def thing_at(self, name: str) -> Vector:
        """Return the centre of an object of the plan in metres; `KeyError` for an unknown name."""
        x, y, z = self.bullet.getBasePositionAndOrientation(self._things[name])[0]
        return float(x), float(y), float(z)

    def model(self, path: str, at: Vector, heading: float) -> int:
        """Add one of pybullet's robot models at a fixed base, by the path of its URDF; return its number."""
        data = _loaded("pybullet_data").getDataPath()
        turned = self.bullet.getQuaternionFromEuler((0, 0, heading))
        with _silence():
            return int(self.bullet.loadURDF(f"{data}/{path}", at, turned, useFixedBase=True))

    def rays(self, begin: Sequence[Vector], end: Sequence[Vector]) -> list[float]:
        """Return the free fraction of each ray, 1 if it hits nothing."""
        return [float(hit[2]) for hit in self.bullet.rayTestBatch(begin, end)]

    def picture(self, camera: Camera, eye: Vector, target: Vector, up: Vector) -> np.ndarray[Any, Any]:
        """Return the image of a camera, as rows of pixels of red, green and blue."""
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
