"""Figures of a column of numbers, as Table 2 of RNKG has them, and those that the paper prints."""

from __future__ import annotations

import statistics
import tomllib
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

STATISTICS: Final = ("min", "max", "median", "mean", "sd", "cv")
"""Minimum, maximum, median, mean, standard deviation of the sample (n - 1), and that by the mean."""

Figures = dict[str, float]
"""A statistic of `STATISTICS` to its value; what cannot be worked out, or the paper does not print, is missing."""


@dataclass(frozen=True, slots=True)
class PaperFigures:
    """What RNKG prints: `projects` selected, `table` by the name of the figure, and the figures of its `graph`."""

    source: str
    projects: int
    table: Mapping[str, Figures]
    graph: Mapping[str, float]


def figures(values: Sequence[int]) -> Figures:
    """Return the figures of some numbers; none has a deviation when there are fewer than two."""
    if not values:
        return {}
    found: Figures = {
        "min": min(values),
        "max": max(values),
        "median": statistics.median(values),
        "mean": statistics.fmean(values),
    }
    if len(values) > 1:
        found["sd"] = statistics.stdev(values)
    if found.get("mean") and "sd" in found:
        found["cv"] = found["sd"] / found["mean"]
    return found


@cache
def paper_figures() -> PaperFigures:
    """Return the figures of the paper (`corpus/rnkg.toml`)."""
    content = tomllib.loads((folder("corpus") / "rnkg.toml").read_text("utf-8"))
    projects = content["projects"]
    table = {name: dict(one) for name, one in projects.items() if isinstance(one, dict)}
    return PaperFigures(content["source"], projects["count"], table, content["graph"])
