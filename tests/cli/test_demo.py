from __future__ import annotations

from typing import TYPE_CHECKING

from kg.cli.commands.demo import QUESTIONS
from kg.query.stored import find

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program


def test_the_demo_answers_every_question_with_lines_of_code(kg: Program, tmp_path: Path) -> None:
    """Each of the five questions is shown with its query and an answer that ends in file and line, and then a proof."""
    run = kg("demo")
    assert run.code == 0
    parts = run.out.split("\n\n    SELECT ")
    assert len(parts) == 6
    for part in parts[1:]:
        rows = part.split("file:line\n")[1].splitlines()[1:]
        assert rows[0].rpartition(":")[2].strip().isdigit()
    assert "scan_filter_nodelet.cpp:" in run.out
    assert "by rule capability/general" in run.out
    assert "ros:evokes" in run.out
    assert not list(tmp_path.iterdir())


def test_the_demo_may_be_kept(kg: Program, tmp_path: Path) -> None:
    """With --store, before or behind the command, the store stays and can be asked."""
    kg("demo", "--store", "kept")
    kg("--store", "too", "demo")
    for name in ("kept", "too"):
        assert (tmp_path / name / "current").is_file()
        assert "flight_controller" in kg("--store", name, "nodes").out


def test_the_demo_does_not_write_into_a_store_of_the_settings(kg: Program, tmp_path: Path) -> None:
    """A store in the environment or kg.toml is someone's own."""
    kg("demo", KG_STORE="own")
    assert not (tmp_path / "own").exists()


def test_the_queries_shown_fit_the_terminal() -> None:
    """A query is shown whole on 80 columns, indented by four."""
    for name in QUESTIONS:
        assert all(len(line) <= 76 for line in find(name).text.splitlines() if not line.startswith("#"))
