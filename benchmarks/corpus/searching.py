"""The search: figures of every union of groups, from what each group adds to sums and histograms."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from kg.corpus.selection.criteria import Criteria
    from kg.corpus.selection.data import Dataset
    from kg.corpus.selection.select import PaperFigures

__all__ = ["Found", "Search"]

_NEAR = 15
"""Selections are looked at whose number of projects is at most so far from the paper's."""
_KEPT = 200
"""So many of the closest are kept of each pair of bounds."""


@dataclass(frozen=True, slots=True)
class Found:
    """A selection: its distance, how many projects it has, which criteria remove, and which bounds hold."""

    distance: float
    projects: int
    without: tuple[str, ...]
    bounds: tuple[str, ...]

    def plain(self) -> dict[str, Any]:
        """Return plain values, ready for JSON."""
        return asdict(self)


class Search:
    """All selections of one table. `tried` counts those that were compared with the paper."""

    def __init__(self, dataset: Dataset, criteria: Criteria, paper: PaperFigures) -> None:
        """Read the figures of the projects and sort them into groups."""
        self.tried = 0
        self._paper = paper
        self._names = tuple(criteria.figures)
        self._values = np.array(
            [
                [sum(dataset.number(one, column) or 0 for column in columns) for columns in criteria.figures.values()]
                for one in dataset.projects
            ]
        )
        labels = [
            one.cells["Violated criterion"] or ("" if one.cells["Included"] == "YES" else "undecided")
            for one in dataset.projects
        ]
        self._groups = sorted({label for label in labels if label}, key=lambda name: (name[0], len(name), name))
        self._member = np.array([[label == group for label in labels] for group in ["", *self._groups]])
        subsets = np.arange(2 ** len(self._groups))
        chosen = (subsets[:, None] >> np.arange(len(self._groups))) & 1
        self._chosen = np.hstack([np.ones((len(subsets), 1), dtype=int), chosen])

    def run(self, least: Mapping[str, Sequence[int]], *, population: bool) -> Iterator[Found]:
        """Yield the closest selections of each choice of bounds."""
        self.tried = 0
        for below in (None, *((name, value) for name, values in least.items() for value in values)):
            for capped in (False, True):
                allowed = np.ones(len(self._values), dtype=bool)
                if below:
                    allowed &= self._values[:, self._names.index(below[0])] >= below[1]
                if capped:
                    most = np.array([self._paper.table[name]["max"] for name in self._names])
                    allowed &= (self._values <= most).all(axis=1)
                bounds = (
                    *([f"{below[0]} >= {below[1]}"] if below else []),
                    *(["the paper's maxima"] if capped else []),
                )
                yield from self._closest(allowed, bounds, population=population)

    def _closest(self, allowed: NDArray[np.bool_], bounds: tuple[str, ...], *, population: bool) -> Iterator[Found]:
        member = self._member & allowed
        counts = self._chosen @ member.sum(axis=1)
        near = np.abs(counts - self._paper.projects) <= _NEAR
        chosen, count = self._chosen[near], counts[near]
        self.tried += len(chosen)
        if not len(chosen):
            return
        distances = [np.abs(count / self._paper.projects - 1)]
        for index, name in enumerate(self._names):
            ours = _statistics(self._values[:, index], member, chosen, count, population=population)
            paper = self._paper.table[name]
            distances += [np.abs(ours[one] / paper[one] - 1) for one in ours if one in paper]
        mean = np.sqrt(np.mean(np.square(distances), axis=0))
        for index in np.argsort(mean)[:_KEPT]:
            without = tuple(group for group, one in zip(self._groups, chosen[index][1:], strict=True) if not one)
            yield Found(float(mean[index]), int(count[index]), without, bounds)


def _statistics(
    values: NDArray[np.int_],
    member: NDArray[np.bool_],
    chosen: NDArray[np.int_],
    count: NDArray[np.int_],
    *,
    population: bool,
) -> dict[str, NDArray[np.float64]]:
    """Return the figures of one column for each choice of groups."""
    total = chosen @ np.array([values[one].sum() for one in member])
    squares = chosen @ np.array([(values[one].astype(float) ** 2).sum() for one in member])
    mean = total / count
    spread = np.sqrt((squares - count * mean**2) / (count if population else count - 1))
    steps = np.unique(values)
    histogram = np.array([(values[one][:, None] == steps).sum(axis=0) for one in member])
    reached = np.cumsum(chosen @ histogram, axis=1)
    middle = [steps[(reached > at[:, None]).argmax(axis=1)] for at in ((count - 1) // 2, count // 2)]
    return {
        "min": steps[(reached > 0).argmax(axis=1)],
        "max": steps[(reached >= count[:, None]).argmax(axis=1)],
        "median": (middle[0] + middle[1]) / 2,
        "mean": mean,
        "sd": spread,
    }
