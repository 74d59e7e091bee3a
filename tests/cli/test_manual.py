from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.cli.manual import Entry, Page, plain

if TYPE_CHECKING:
    from cli.program import Program


def test_examples_are_kept_and_paragraphs_filled() -> None:
    """Indented blocks are preserved; other text is filled to the width."""
    text = "one two\nthree\n\n    kg  query   'X'\n\nlast"
    shown = plain(Page("kg x", "kg x", text, (("Options", (Entry("--a", "about a"),)),), ""), 40)
    assert shown.split("\n\n") == [
        "Usage: kg x",
        "one two three",
        "    kg  query   'X'",
        "last",
        "Options:\n  --a  about a",
    ]


@pytest.mark.parametrize("columns", [40, 80, 100])
def test_long_names_and_sentences_wrap_inside_the_width(columns: int) -> None:
    """No line exceeds the width, and wrapped sentences stay in their column."""
    entries = (Entry("--a-rather-long-option NAME", "word " * 40), Entry("-b", "word " * 40))
    lines = plain(Page("kg", "kg", "", (("Options", entries),), ""), columns).splitlines()
    assert max(map(len, lines)) <= columns
    assert len({len(line) - len(line.lstrip()) for line in lines if line.startswith("   ")}) == 1


def test_help_of_a_command_shows_its_example_and_options(kg: Program) -> None:
    """The help of a command is its docstring."""
    out = kg("explain", "--help").out
    assert "Usage: kg explain [OPTIONS] [CODE]" in out
    assert "    kg explain KG301" in out
    assert "--json" in out
