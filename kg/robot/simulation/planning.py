"""Ways through a map: A* over its squares, away from walls, and then straight where nothing stands between."""

from __future__ import annotations

import heapq
import math
from itertools import pairwise
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.grid import Cell, Grid

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.simulation.plan import Plan

__all__ = ["Planner"]

_RESOLUTION: Final = 0.1
_DETOUR: Final = 3.0
"""A square beside a wall costs so many times as much: a way keeps to the middle where there is one."""

_STEPS: Final = [(down, right) for down in (-1, 0, 1) for right in (-1, 0, 1) if down or right]


class Planner:
    """Finds ways for a round robot.

    Args:
        plan: where it drives.
        radius: of the robot, in metres.
        margin: how far it would like to stay from what stands there, in metres.
    """

    def __init__(self, plan: Plan, radius: float, margin: float = 0.2) -> None:
        self._grid = Grid(plan, _RESOLUTION)
        self._blocked = self._grid.near(radius + 0.02)
        self._close = self._grid.near(radius + margin)

    def way(self, start: tuple[float, float], goal: tuple[float, float]) -> list[tuple[float, float]] | None:
        """Return the points of the way to a goal without the start; None when the goal cannot be reached."""
        end = self._grid.cell(*goal) if math.isfinite(sum(goal)) else (-1, -1)
        if not self._free(end):
            return None
        begin = self._nearest_free(self._grid.cell(*start))
        cells = self._search(begin, end) if begin else None
        return None if cells is None else [*self._straightened(cells)[1:-1], goal]

    def _free(self, cell: Cell) -> bool:
        row, column = cell
        return 0 <= row < self._grid.rows and 0 <= column < self._grid.columns and not self._blocked[row, column]

    def _nearest_free(self, cell: Cell) -> Cell | None:
        around = range(-4, 5)
        near = sorted((math.hypot(down, right), down, right) for down in around for right in around)
        return next(
            ((cell[0] + one, cell[1] + two) for _, one, two in near if self._free((cell[0] + one, cell[1] + two))), None
        )

    def _search(self, start: Cell, goal: Cell) -> list[Cell] | None:
        cost = {start: 0.0}
        before: dict[Cell, Cell] = {}
        waiting = [(math.dist(start, goal), start)]
        while waiting:
            _, cell = heapq.heappop(waiting)
            if cell == goal:
                return _traced(before, goal)
            for there, length in self._beside(cell):
                now = cost[cell] + length
                if now < cost.get(there, math.inf):
                    cost[there], before[there] = now, cell
                    heapq.heappush(waiting, (now + math.dist(there, goal), there))
        return None

    def _beside(self, cell: Cell) -> Iterator[tuple[Cell, float]]:
        for down, right in _STEPS:
            there = cell[0] + down, cell[1] + right
            if self._free(there):
                yield there, math.hypot(down, right) * (_DETOUR if self._close[there] else 1.0)

    def _straightened(self, cells: list[Cell]) -> list[tuple[float, float]]:
        """Return the points where the way bends, and not where it only follows the squares."""
        kept = [cells[0]]
        for last, cell in pairwise(cells):
            if not self._clear(kept[-1], cell):
                kept.append(last)
        return [self._grid.point(one) for one in (*kept, cells[-1])]

    def _clear(self, start: Cell, end: Cell) -> bool:
        """Tell whether a straight line costs no more than squares that are away from walls."""
        steps = 2 * max(abs(end[0] - start[0]), abs(end[1] - start[1]), 1)
        return not any(
            self._close[
                round(start[0] + (end[0] - start[0]) * index / steps),
                round(start[1] + (end[1] - start[1]) * index / steps),
            ]
            for index in range(steps + 1)
        )


def _traced(before: dict[Cell, Cell], goal: Cell) -> list[Cell]:
    cells = [goal]
    while cells[-1] in before:
        cells.append(before[cells[-1]])
    return cells[::-1]
