"""Selections of repositories, and figures next to those of RNKG: rows of tables and plain values for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any, Final

from kg.cli.output import Column
from kg.corpus.selection.select import STATISTICS, paper_figures

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.selection.select import Selection
    from kg.query.stats import Counted

STEP_COLUMNS: Final = (
    Column("criterion", "name"),
    Column("removes", "number"),
    Column("left", "number"),
    Column("which are", "dim", spare=1),
)
_HEADS: Final = {"median": "median", "mean": "mean", "sd": "SD", "cv": "CV"}
FIGURE_COLUMNS: Final = (
    Column("figure", "name"),
    Column("of"),
    *(Column(_HEADS.get(name, name), "number") for name in STATISTICS),
)
"""The columns of Table 2."""
RNKG_COLUMNS: Final = (Column("as RNKG counts", "name"), Column("here", "number"), Column("RNKG", "number"))


def step_rows(selection: Selection) -> Iterator[tuple[object, ...]]:
    """Yield what each criterion removed, below the number of all projects."""
    yield "all", "", len(selection.dataset.projects), ""
    for step in selection.steps:
        yield step.criterion.name, len(step.removed), step.left, step.criterion.says


def figure_rows(selection: Selection) -> Iterator[tuple[object, ...]]:
    """Yield the rows of Table 2: our figure, the paper's, and the difference in percent."""
    paper = paper_figures()
    for key, ours in selection.figures.items():
        name, theirs = key.replace("_", " "), paper.table.get(key, {})
        yield name, "ours", *(_figure(ours.get(one), one) for one in STATISTICS)
        if theirs:
            yield name, "RNKG", *(_figure(theirs.get(one), one) for one in STATISTICS)
            yield name, "more", *(_more(ours.get(one), theirs.get(one)) for one in STATISTICS)


def _figure(value: float | None, statistic: str) -> str:
    if value is None:
        return "-"
    return f"{value:.2f}" if statistic in {"mean", "sd", "cv"} else f"{value:g}"


def _more(ours: float | None, paper: float | None) -> str:
    return f"{(ours / paper - 1) * 100:+.1f} %" if ours is not None and paper else "-"


def selection_object(selection: Selection) -> dict[str, Any]:
    """Return a selection as plain values for JSON."""
    paper = paper_figures()
    return {
        "dataset": str(selection.dataset.path),
        "criteria": str(selection.criteria.path),
        "projects": len(selection.dataset.projects),
        "selected": len(selection.selected),
        "selected_paper": paper.projects,
        "steps": [
            {
                "criterion": step.criterion.name,
                "says": step.criterion.says,
                "removed": len(step.removed),
                "left": step.left,
                "projects": [project.cells[selection.criteria.project] for project in step.removed],
            }
            for step in selection.steps
        ],
        "figures": {
            name: {"ours": ours, "paper": dict(paper.table.get(name, {}))} for name, ours in selection.figures.items()
        },
        "addresses": list(selection.addresses()),
    }


def rnkg_rows(ours: Counted) -> Iterator[tuple[str, str, str]]:
    """Yield the figures of a graph as RNKG counts them, with those printed in the paper."""
    for name, theirs in paper_figures().graph.items():
        yield name.replace("_", " "), _plain(getattr(ours, name)), _plain(theirs)
    for kind, number in ours.by_kind:
        yield f"of these {kind}", _plain(number), "-"


def _plain(value: float | None) -> str:
    if value is None:
        return "-"
    return f"{value:,}" if isinstance(value, int) else f"{value:,.2f}".removesuffix(".00")


def compared(ours: Counted) -> dict[str, Any]:
    """Return these figures as plain values for JSON."""
    plain = asdict(ours) | {"by_kind": dict(ours.by_kind)}
    return {"here": plain, "paper": dict(paper_figures().graph)}
