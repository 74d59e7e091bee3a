"""Statistics of a column of numbers, as in Table 2 of RNKG, and the paper's own."""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.resources import table_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

STATISTICS: Final = ("min", "max", "median", "mean", "sd", "cv")
"""Minimum, maximum, median, mean, standard deviation of the sample (n - 1), and coefficient of variation."""

Figures = dict[str, float]
"""Statistics by name; those that are undefined, or not printed in the paper, are missing."""


@dataclass(frozen=True, slots=True)
class PaperFigures:
    """Figures of RNKG: the number of selected `projects`, `table` by figure, and the figures of its `graph`."""

    source: str
    projects: int
    table: Mapping[str, Figures]
    graph: Mapping[str, float]


def figures(values: Sequence[int]) -> Figures:
    """Return the statistics of some numbers; the deviation needs at least two."""
    if not values:
        return {}
    result: Figures = {
        "min": min(values),
        "max": max(values),
        "median": statistics.median(values),
        "mean": statistics.fmean(values),
    }
    if len(values) > 1:
        result["sd"] = statistics.stdev(values)
    if result.get("mean") and "sd" in result:
        result["cv"] = result["sd"] / result["mean"]
    return result


@cache
def paper_figures() -> PaperFigures:
    """Return the figures of the paper (`corpus/rnkg.toml`)."""
    content = table_of("corpus", "rnkg.toml")
    projects = content["projects"]
    table = {name: dict(one) for name, one in projects.items() if isinstance(one, dict)}
    return PaperFigures(content["source"], projects["count"], table, content["graph"])
