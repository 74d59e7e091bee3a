from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from cli.program import Program

from kg.cli.commands.demo import QUESTIONS
from kg.query.stored import find

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Run


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory) -> tuple[Run, Path]:
    """Return the result of the demo with a store named by the environment, and its folder."""
    folder = tmp_path_factory.mktemp("demo")
    return Program(folder)("demo", KG_STORE="own"), folder


def test_the_demo_answers_every_question_with_lines_of_code(shown: tuple[Run, Path]) -> None:
    """Each of the five questions is shown with its query and an answer ending in file and line, followed by a proof."""
    run, _ = shown
    assert run.code == 0
    parts = run.out.split("\n\n    SELECT ")
    assert len(parts) == 6
    for part in parts[1:]:
        rows = part.split("file:line\n")[1].splitlines()[1:]
        assert rows[0].rpartition(":")[2].strip().isdigit()
    assert "scan_filter_nodelet.cpp:" in run.out
    proof = run.out.partition("kg why scan_filter")[2].partition("kg lint")[0]
    assert "by rule hardware/uses" in proof
    assert "scan_filter_nodelet.cpp:30" in proof
    assert len(proof.splitlines()) < 30


def test_the_demo_may_be_kept(kg: Program, tmp_path: Path) -> None:
    """With --store, before or after the command, the store remains and can be queried."""
    kg("demo", "--store", "kept")
    kg("--store", "too", "demo")
    for name in ("kept", "too"):
        assert (tmp_path / name / "current").is_file()
        assert "flight_controller" in kg("--store", name, "nodes").out


def test_the_demo_leaves_the_folder_and_a_store_of_the_settings_alone(shown: tuple[Run, Path]) -> None:
    """The demo uses a temporary store, never one named by the environment or kg.toml."""
    _, folder = shown
    assert not list(folder.iterdir())


def test_the_queries_shown_fit_the_terminal() -> None:
    """A query is shown in full on 80 columns, indented by four."""
    for name in QUESTIONS:
        assert all(len(line) <= 76 for line in find(name).text.splitlines() if not line.startswith("#"))
