"""Tests of selecting projects: cases are folders with a table, criteria, and the expected result."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any, Final

import pytest

from kg.corpus.selection.criteria import default_criteria, read_criteria
from kg.corpus.selection.data import read_dataset
from kg.corpus.selection.select import paper_figures, select
from kg.errors import KgError

CASES: Final = Path(__file__).parents[1] / "cases"
SELECTIONS: Final = sorted(path for path in (CASES / "selections").iterdir() if path.is_dir())
MALFORMED: Final = tomllib.loads((CASES / "malformed" / "cases.toml").read_text("utf-8"))
SHARED: Final = Path(__file__).parents[4] / "shared" / "data" / "robot-projects" / "repos_dataset_all.csv"
CRITERIA: Final = """\
project = "ID"
address = "URL"
closed = ["Kind"]
figures = { commits = ["Commits"] }

[[criterion]]
name = "kind"
column = "Kind"
is = ["x"]

[[criterion]]
name = "commits"
column = "Commits"
most = 10
"""


@pytest.mark.parametrize("case", SELECTIONS, ids=lambda path: path.name)
def test_selection(case: Path) -> None:
    """A table and criteria give the expected projects, removals and figures."""
    expected = json.loads((case / "expected.json").read_text("utf-8"))
    found = select(read_dataset(case / "projects.csv"), read_criteria(case / "criteria.toml"))
    assert [project.cells["ID"] for project in found.selected] == expected["kept"]
    removed = {step.criterion.name: [one.cells["ID"] for one in step.removed] for step in found.steps}
    assert removed == expected["removed"]
    for name, figures in expected["figures"].items():
        assert {one: found.figures[name][one] for one in figures} == figures


@pytest.mark.parametrize("case", MALFORMED["table"], ids=lambda case: case["says"])
def test_malformed_table(case: dict[str, Any], tmp_path: Path) -> None:
    """An error in a table is reported with its line and instructions."""
    (tmp_path / "projects.csv").write_text(case["text"], "utf-8", newline="")
    (tmp_path / "criteria.toml").write_text(CRITERIA, "utf-8")
    with pytest.raises(KgError) as caught:
        select(read_dataset(tmp_path / "projects.csv"), read_criteria(tmp_path / "criteria.toml"))
    _check(caught.value, case)


@pytest.mark.parametrize("case", MALFORMED["criteria"], ids=lambda case: case["says"])
def test_malformed_criteria(case: dict[str, Any], tmp_path: Path) -> None:
    """An error in a file of criteria is reported with its line and instructions."""
    path = tmp_path / "criteria.toml"
    path.write_text(case["text"], "utf-8")
    with pytest.raises(KgError) as caught:
        read_criteria(path)
    _check(caught.value, case)


def _check(error: KgError, case: dict[str, Any]) -> None:
    assert error.code == case["code"]
    assert case["says"] in error.message
    assert error.place is not None
    assert "line" not in case or error.place.line == case["line"]
    assert "hint" not in case or error.hint == case["hint"]


@pytest.mark.parametrize(("content", "code"), [(b"ID\n\xff\n", "KG131"), (None, "KG101")])
def test_table_that_cannot_be_read(content: bytes | None, code: str, tmp_path: Path) -> None:
    """A missing table, or one that is not UTF-8, is an error of its own."""
    path = tmp_path / "projects.csv"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(KgError) as caught:
        read_dataset(path)
    assert caught.value.code == code


def test_the_paper_has_every_figure_that_is_counted() -> None:
    """The criteria shipped with kg compute the figures of Table 2, and the paper's are the printed ones."""
    paper = paper_figures()
    assert list(read_criteria(default_criteria()).figures) == list(paper.table)
    assert paper.projects == 503
    assert paper.table["commits"]["mean"] == 533.99
    assert round(paper.table["commits"]["cv"], 2) == 1.60


@pytest.mark.skipif(not SHARED.exists(), reason="the table of 598 projects is not part of the repository")
def test_the_selection_of_the_paper() -> None:
    """The criteria shipped with kg select 503 of the 598 projects, and every maximum is the paper's."""
    found = select(read_dataset(SHARED), read_criteria(default_criteria()))
    paper = paper_figures()
    assert len(found.dataset.projects) == 598
    assert len(found.selected) == len(set(found.addresses())) == paper.projects
    for name, theirs in paper.table.items():
        assert found.figures[name]["max"] == theirs["max"]
        for one in ("mean", "sd"):
            assert abs(found.figures[name][one] / theirs[one] - 1) < 0.05
