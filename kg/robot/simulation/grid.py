"""The map of a plan: which squares of the floor are free, as an occupancy grid has it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

if TYPE_CHECKING:
    from kg.robot.simulation.plan import Plan

__all__ = ["Cell", "Grid"]

Cell = tuple[int, int]
"""Row and column: to the north and to the east."""

_MARGIN: Final = 0.1
_HALF_WALL: Final = 0.05


class Grid:
    """The map of a plan in squares of an edge of `resolution` metres, a little larger than the plan.

    `taken` is true where something stands; `origin` is the corner of the first square, in both directions.
    """

    def __init__(self, plan: Plan, resolution: float) -> None:
        self.resolution = resolution
        self.origin = -_MARGIN
        self.rows = math.ceil((plan.depth + 2 * _MARGIN) / resolution)
        self.columns = math.ceil((plan.width + 2 * _MARGIN) / resolution)
        self._north, self._east = np.indices((self.rows, self.columns)) * resolution + self.origin + resolution / 2
        self.taken: np.ndarray[Any, Any] = np.zeros((self.rows, self.columns), dtype=bool)
        self._draw(plan)

    def _draw(self, plan: Plan) -> None:
        for wall in plan.walls:
            for x, y, to_x, to_y in wall.pieces():
                self._box(
                    (x + to_x) / 2, (y + to_y) / 2, abs(to_x - x) / 2 + _HALF_WALL, abs(to_y - y) / 2 + _HALF_WALL
                )
        for thing in plan.things:
            if thing.shape == "box":
                self._box(thing.x, thing.y, thing.width / 2, thing.depth / 2)
            else:
                self.taken |= np.hypot(self._east - thing.x, self._north - thing.y) <= thing.radius

    def _box(self, x: float, y: float, half_width: float, half_depth: float) -> None:
        slack = 1e-9
        self.taken |= (abs(self._east - x) <= half_width + slack) & (abs(self._north - y) <= half_depth + slack)

    def cell(self, x: float, y: float) -> Cell:
        """Return the square that a point lies in; it may lie outside of the grid."""
        return math.floor((y - self.origin) / self.resolution), math.floor((x - self.origin) / self.resolution)

    def point(self, cell: Cell) -> tuple[float, float]:
        """Return the middle of a square, as x and y."""
        row, column = cell
        return (
            self.origin + (column + 0.5) * self.resolution,
            self.origin + (row + 0.5) * self.resolution,
        )

    def near(self, distance: float) -> np.ndarray[Any, Any]:
        """Return true for the squares that lie within a distance in metres of something."""
        reach = int(distance / self.resolution)
        padded = np.pad(self.taken, reach, constant_values=True)
        found = np.zeros_like(self.taken)
        for down in range(-reach, reach + 1):
            for right in range(-reach, reach + 1):
                if math.hypot(down, right) * self.resolution <= distance:
                    rows = slice(reach + down, reach + down + self.rows)
                    found |= padded[rows, reach + right : reach + right + self.columns]
        return found

    def occupancy(self) -> list[int]:
        """Return the data of a `nav_msgs/OccupancyGrid`: 100 for what is taken, 0 for what is free, row by row."""
        return [int(one) for one in np.where(self.taken, 100, 0).flatten()]
