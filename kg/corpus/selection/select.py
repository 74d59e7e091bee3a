"""Selection of projects in a table, and the number removed by each criterion (RNKG, section 3.1 and Table 1).

Statistics of the columns of numbers are those of Table 2 of RNKG, next to the paper's own.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

from kg.errors import Place, SourceError
from kg.resources import table_of
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.corpus.selection.criteria import Criteria, Criterion
    from kg.corpus.selection.data import Dataset, Project

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


@dataclass(frozen=True, slots=True)
class Step:
    """The effect of a criterion: what it removed of the remaining projects."""

    criterion: Criterion
    removed: tuple[Project, ...]
    left: int


@dataclass(frozen=True, slots=True)
class Selection:
    """The remaining projects of a table, the steps that removed others, and figures of the remaining ones by name."""

    dataset: Dataset
    criteria: Criteria
    steps: tuple[Step, ...]
    selected: tuple[Project, ...]
    figures: Mapping[str, Figures]

    def addresses(self) -> tuple[str, ...]:
        """Return the addresses of the remaining projects, in the order of the table."""
        return tuple(project.cells[self.criteria.address] for project in self.selected)


def select(dataset: Dataset, criteria: Criteria) -> Selection:
    """Apply the criteria in their order.

    Raises SourceError: KG131 a missing column, an invalid number, a value that no criterion names.
    """
    _check(dataset, criteria)
    left, steps = dataset.projects, []
    for criterion in criteria.criteria:
        if criterion.applies:
            removed = tuple(project for project in left if criterion.removes(project, dataset))
            gone = {project.line for project in removed}
            left = tuple(project for project in left if project.line not in gone)
            steps.append(Step(criterion, removed, len(left)))
    counted: dict[str, Figures] = {}
    for name, columns in criteria.figures.items():
        rows = ([dataset.number(project, column) for column in columns] for project in left)
        whole = ([value for value in row if value is not None] for row in rows if None not in row)
        counted[name] = figures([sum(row) for row in whole])
    return Selection(dataset, criteria, tuple(steps), left, counted)


def _check(dataset: Dataset, criteria: Criteria) -> None:
    whole = Place(str(criteria.path))
    dataset.need((criteria.project, criteria.address, *criteria.closed), whole)
    for columns in criteria.figures.values():
        dataset.need(columns, whole)
    for criterion in criteria.criteria:
        dataset.need((criterion.column,), Place(str(criteria.path), criterion.line))
    for column in criteria.closed:
        _check_values(dataset, criteria, column)


def _check_values(dataset: Dataset, criteria: Criteria, column: str) -> None:
    """Refuse a value of a closed column that no criterion names, since a typo would select silently."""
    about = [criterion for criterion in criteria.criteria if criterion.column == column]
    listed = sorted({value for one in about for values in (one.equal, one.unequal) for value in values or ()})
    for project in dataset.projects:
        cell = project.cells[column]
        if cell and cell not in listed:
            hint = did_you_mean(cell, listed) or f"{criteria.path} names {', '.join(listed) or 'none'}."
            place = Place(str(dataset.path), project.line)
            raise SourceError("KG131", f"no criterion is about `{column}` = {cell!r}", place=place, hint=hint)
