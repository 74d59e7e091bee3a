"""`kg eval` as users call it, on a store of the example workspace."""

from __future__ import annotations

import csv
import json
import shutil
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from repository import ROOT
from workspaces import example

if TYPE_CHECKING:
    from pathlib import Path

CASES = ROOT / "tests" / "evaluate" / "cases"


@pytest.fixture(scope="module", name="built")
def build(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """Return the program in a folder with a copy of the example workspace in `field` and its store."""
    folder = tmp_path_factory.mktemp("eval")
    shutil.copytree(example(tmp_path_factory, "field"), folder, dirs_exist_ok=True)
    return Program(folder)


def test_references_are_compared_kept_and_forgotten(built: Program) -> None:
    """Tables are given as JSON Lines and as three files; stored references answer the stored query."""
    truth = str(CASES / "truth.jsonl")
    run = built("eval", "completeness", "-r", truth, "--json", "--keep", "-o", "tables")
    assert run.code == 0, run.err
    rows = [json.loads(line) for line in run.out.splitlines()]
    assert {row["entity"]: row["known part"] for row in rows}["topic"] == 8
    assert {path.suffix for path in (built.folder / "tables").iterdir()} == {".md", ".csv", ".svg"}
    assert "not in the store" in run.err
    assert "topic,8,8" in built("query", "reference-entities", "--format", "csv").out.replace("\r", "")
    assert "forgot" in built("eval", "completeness", "--forget").err
    assert "topic" not in built("query", "reference-entities", "--format", "csv").out


def test_relations_are_compared(built: Program) -> None:
    """Precision is given if references name all relations; otherwise a dash with the reason."""
    run = built("eval", "correctness", "-r", str(CASES / "truth.jsonl"))
    assert run.code == 0, run.err
    assert "publishes\t100.0 % (2/2)" in run.out
    assert "closed_world" in run.err


def test_the_code_is_searched(built: Program) -> None:
    """Calls missing from the graph are listed with their places."""
    run = built("eval", "completeness", "--code", "--sample", "500", "--missed", "missed.csv")
    assert run.code == 0, run.err
    with (built.folder / "missed.csv").open() as file:
        assert [row["address"].rpartition("/")[2] for row in csv.DictReader(file)] == [
            "scan_filter_nodelet.cpp:34",
            "scan_filter_nodelet.cpp:33",
        ]


def test_a_sheet_is_drawn_judged_and_scored(built: Program) -> None:
    """A sheet is drawn for a person to judge, and scored afterwards."""
    drawn = built("eval", "sample", "--size", "12", "--relation", "publishes", "--relation", "has function")
    assert drawn.code == 0, drawn.err
    sheet: Path = built.folder / "sheet.csv"
    rows = list(csv.DictReader(drawn.out.splitlines()))
    assert {row["relation"] for row in rows} == {"publishes", "has function"}
    with sheet.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows({**row, "right": "yes"} for row in rows)
    scored = built("eval", "sample", "--score", str(sheet), "--json")
    assert [json.loads(line)["precision"] for line in scored.out.splitlines()] == [1.0, 1.0, 1.0]


def test_the_search_is_compared(built: Program) -> None:
    """Every search method has a row for each measure."""
    pytest.importorskip("sklearn", reason="the extra `evaluate` is not installed")
    run = built("eval", "search", "--queries", str(CASES / "needs.jsonl"))
    assert run.code == 0, run.err
    assert run.out.count("NDCG@5") == 4


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("completeness",), "no references given"),
        (("completeness", "-r", "none.jsonl"), "cannot be read"),
        (("correctness", "-r", str(CASES / "readme.md"), "--package", "nothing"), "has no package"),
        (("sample", "--relation", "publish"), "publishes"),
        (("sample", "--size", "0"), "at least 1"),
        (("search", "--queries", "none.jsonl"), "cannot be read"),
        (("sample", "--score", "none.csv"), "cannot be read"),
    ],
)
def test_mistakes_are_explained(built: Program, arguments: tuple[str, ...], words: str) -> None:
    """A wrong call exits with code 2 and explains the error."""
    run = built("eval", *arguments)
    assert run.code == 2
    assert words in run.err
