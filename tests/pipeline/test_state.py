"""Tests of the state saved for the next build."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kg.facts import Problem, Repository
from kg.pipeline.state import PackageState, SourceState, State, discard, load, save

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE = PackageState(
    "p",
    "a/p",
    "l",
    "s",
    {"local/x:a": "d"},
    ((("is_file", "local/x", "b.bin"), "True"),),
    "r",
    {"nodes": 1},
    {"why": 2},
    (Problem("KG110", "m", "f", 3),),
)
SOURCE = SourceState(
    Repository("local/x", "/x", dirty=True), (Problem("KG102", "m", "."),), {"a/p": PACKAGE}, "<a> .\n", 7
)
STATE = State("v", "h", 3, ("/x",), {"local/x": SOURCE})


def test_round_trip(tmp_path: Path) -> None:
    """The saved state loads unchanged."""
    save(tmp_path, STATE)
    assert load(tmp_path) == STATE


def test_file_names_that_are_not_unicode(tmp_path: Path) -> None:
    """Names of files that are not Unicode are kept: they would otherwise make each build read everything."""
    odd = replace(PACKAGE, path="a/\udcff", inputs={"local/x:\udcff": "d"})
    state = replace(STATE, sources={"local/x": replace(SOURCE, packages={odd.path: odd})})
    save(tmp_path, state)
    assert load(tmp_path) == state


@pytest.mark.parametrize("content", [None, "", "{", "[]", "{}", '{"form": 99}', '{"form": 1, "sources": {"x": 1}}'])
def test_what_cannot_be_read_is_empty(tmp_path: Path, content: str | None) -> None:
    """A state that is missing, damaged or of another form makes the next build read everything."""
    if content is not None:
        (tmp_path / "state.json").write_text(content)
    assert load(tmp_path) == State()


def test_discard(tmp_path: Path) -> None:
    """A discarded state is empty; discarding a missing one is not an error."""
    discard(tmp_path)
    save(tmp_path, STATE)
    discard(tmp_path)
    assert load(tmp_path) == State()
