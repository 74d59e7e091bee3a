"""Places for boxes in columns, joined from left to right: few crossings, short ways, the same places every time.

The usual steps (Sugiyama, Tagawa, Toda, "Methods for visual understanding of hierarchical system structures", 1981):
ways through a column get a place there, columns are ordered by the mean of what they are joined to, then moved
towards it.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from statistics import fmean
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

__all__ = ["Item", "Placed", "arrange"]

_SWEEPS: Final = 12
_GAP: Final = 14
"""Free height between two boxes."""
_THIN: Final = 6
"""Height that a way takes in a column that it passes."""
_BETWEEN: Final = 84
"""Free width between two columns."""

_Way: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Item:
    """A box to be placed: its name, the column it stands in, counted from zero, and its size."""

    key: str
    column: int
    wide: float
    high: float


@dataclass(frozen=True, slots=True)
class Placed:
    """Where boxes stand (left edge, middle), the points between the columns that ways pass, and the whole size."""

    boxes: Mapping[str, tuple[float, float]]
    ways: Mapping[tuple[str, str], tuple[tuple[float, float], ...]]
    wide: float
    high: float


def arrange(items: Sequence[Item], links: Iterable[tuple[str, str]]) -> Placed:
    """Return places for `items`; `links` lead to a later column, those that lead back are left out of the order."""
    plan = _Plan(items)
    ways = {link: plan.join(*link) for link in links}
    plan.sort()
    middles = plan.middles()
    lefts, wide = plan.lefts()
    top = min((middle - plan.height[key] / 2 for key, middle in middles.items()), default=0.0)
    middles = {key: middle - top for key, middle in middles.items()}
    high = max((middle + plan.height[key] / 2 for key, middle in middles.items()), default=0.0)
    width = {item.key: item.wide for item in items}
    passed = {
        link: tuple((lefts[plan.column[key]][edge], middles[key]) for key in way[1:-1] for edge in (0, 1))
        for link, way in ways.items()
    }
    boxes = {key: (_centred(lefts[plan.column[key]], width[key]), middles[key]) for key in (item.key for item in items)}
    return Placed(boxes, passed, wide, high)


def _centred(edges: tuple[float, float], wide: float) -> float:
    return (edges[0] + edges[1] - wide) / 2


@dataclass(slots=True)
class _Plan:
    """Boxes and the places of ways by column, in the order from top to bottom."""

    items: Sequence[Item]
    columns: list[list[str]] = field(init=False)
    column: dict[str, int] = field(init=False)
    height: dict[str, float] = field(init=False)
    joined: dict[str, list[str]] = field(init=False)

    def __post_init__(self) -> None:
        self.columns = [[] for _ in range(max((item.column for item in self.items), default=-1) + 1)]
        self.column = {item.key: item.column for item in self.items}
        self.height = {item.key: item.high for item in self.items}
        self.joined = defaultdict(list)
        for item in self.items:
            self.columns[item.column].append(item.key)

    def join(self, source: str, target: str) -> _Way:
        """Join two boxes by a way, which gets a place in each column between them."""
        start, end = self.column[source], self.column[target]
        between = [f"{source}\n{target}\n{column}" for column in range(start + 1, end)]
        for column, key in enumerate(between, start + 1):
            self.column[key] = column
            self.height[key] = _THIN
            self.columns[column].append(key)
        way = (source, *between, target)
        if start < end:
            for one, other in pairwise(way):
                self.joined[one].append(other)
                self.joined[other].append(one)
        return way

    def sort(self) -> None:
        """Order the columns so that few ways cross."""
        best, least = [list(column) for column in self.columns], self._crossings()
        for sweep in range(_SWEEPS):
            numbers = range(1, len(self.columns)) if sweep % 2 == 0 else range(len(self.columns) - 2, -1, -1)
            for number in numbers:
                self._sort_column(number, number - 1 if sweep % 2 == 0 else number + 1)
            crossings = self._crossings()
            if crossings < least:
                best, least = [list(column) for column in self.columns], crossings
        self.columns = best

    def _sort_column(self, number: int, beside: int) -> None:
        ranks = {key: rank for rank, key in enumerate(self.columns[beside])}
        wanted = {}
        for rank, key in enumerate(self.columns[number]):
            near = [ranks[other] for other in self.joined[key] if other in ranks]
            wanted[key] = fmean(near) if near else float(rank)
        self.columns[number].sort(key=wanted.__getitem__)

    def _crossings(self) -> int:
        """Return how often ways between neighbouring columns cross."""
        total = 0
        for left, right in pairwise(self.columns):
            ranks = {key: rank for rank, key in enumerate(right)}
            ends = [sorted(ranks[other] for other in self.joined[key] if other in ranks) for key in left]
            total += sum(one > other for upper, lower in combinations(ends, 2) for one in upper for other in lower)
        return total

    def middles(self) -> dict[str, float]:
        """Return the height of the middle of each box and way, moved towards what it is joined to."""
        found: dict[str, float] = {}
        for column in self.columns:
            found.update(self._apart(column, [0.0] * len(column)))
        for sweep in range(_SWEEPS):
            for column in self.columns if sweep % 2 == 0 else reversed(self.columns):
                wanted = [
                    fmean(found[other] for other in self.joined[key]) if self.joined[key] else found[key]
                    for key in column
                ]
                found.update(self._apart(column, wanted))
        return found

    def _apart(self, column: Sequence[str], wanted: Sequence[float]) -> dict[str, float]:
        """Return heights near those wanted that keep the order and the gaps.

        One pass moves everything down, one up; the mean of both keeps the gaps as each of them does.
        """
        gaps = [(self.height[one] + self.height[other]) / 2 + _GAP for one, other in pairwise(column)]
        down, up = list(wanted), list(wanted)
        for index, gap in enumerate(gaps, 1):
            down[index] = max(down[index], down[index - 1] + gap)
        for index in range(len(gaps) - 1, -1, -1):
            up[index] = min(up[index], up[index + 1] - gaps[index])
        return {key: (lower + upper) / 2 for key, lower, upper in zip(column, down, up, strict=True)}

    def lefts(self) -> tuple[list[tuple[float, float]], float]:
        """Return the left and right edge of each column, and the width of all."""
        widths = [0.0] * len(self.columns)
        for item in self.items:
            widths[item.column] = max(widths[item.column], item.wide)
        edges, x = [], 0.0
        for wide in widths:
            edges.append((x, x + wide))
            x += wide + _BETWEEN
        return edges, max(x - _BETWEEN, 0.0)
