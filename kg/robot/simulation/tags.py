"""Tags by OpenCV's ArUco: their pictures, and finding them with their poses in what a camera sees."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.robot.simulation.loading import opencv

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["BORDER", "Sighting", "find_tags", "picture_of"]

BORDER: Final = 1 / 6
"""The white margin beside the black square, as a share of its edge: one cell of the dictionary."""

_CELLS: Final = 6
_PIXELS: Final = 32
_LARGER: Final = 3
"""Pictures are enlarged so much before tags are looked for, since cells of two pixels are lost otherwise."""


@dataclass(frozen=True, slots=True)
class Sighting:
    """A tag that is seen: its position in metres in the optical frame (right, down, ahead) and its orientation."""

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
    """Return the tags in a picture, the nearest first.

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
    found = [
        _sighting(int(tag), (four.reshape(4, 2) + 0.5) / _LARGER, inner, size)
        for tag, four in zip(numbers.flatten(), corners, strict=True)
    ]
    return sorted(found, key=lambda one: one.position[2])


def _sighting(tag: int, corners: np.ndarray[Any, Any], matrix: np.ndarray[Any, Any], size: float) -> Sighting:
    cv = opencv()
    half = size / 2
    square = np.array([(-half, half, 0), (half, half, 0), (half, -half, 0), (-half, -half, 0)], dtype=np.float64)
    _, turn, shift = cv.solvePnP(square, corners.astype(np.float64), matrix, None, flags=cv.SOLVEPNP_IPPE_SQUARE)
    x, y, z = (float(one) for one in shift.flatten())
    return Sighting(tag, (x, y, z), _quaternion(turn.flatten()))


def _quaternion(vector: np.ndarray[Any, Any]) -> tuple[float, float, float, float]:
    angle = float(np.linalg.norm(vector))
    axis = vector / angle if angle else vector
    x, y, z = (float(one) * float(np.sin(angle / 2)) for one in axis)
    return x, y, z, float(np.cos(angle / 2))


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
