from __future__ import annotations

from typing import TYPE_CHECKING
from unicodedata import category

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.cli.diagnostics import render
from kg.errors import CATALOGUE, KgError, Place, QueryError

if TYPE_CHECKING:
    from pathlib import Path


def test_an_error_shows_code_place_line_carets_and_way_out(tmp_path: Path) -> None:
    """Carets mark the word at the column; the line comes from the file."""
    file = tmp_path / "q.rq"
    file.write_text("# first\nSELECT WHERE\n")
    shown = render(QueryError("KG501", "expected a variable", place=Place(str(file), 2, 8), hint="name one"))
    assert shown.splitlines() == [
        "error[KG501]: expected a variable",
        f"  --> {file}:2:8",
        "  |",
        "2 | SELECT WHERE",
        "  |        ^^^^^",
        "help: name one",
    ]


def test_without_a_hint_the_catalogue_gives_the_way_out() -> None:
    """An error without a hint shows the instructions of the catalogue."""
    assert render(KgError("KG301", "none")).splitlines()[-1] == f"help: {CATALOGUE['KG301'].way_out}"


def test_a_place_may_bring_its_line_along() -> None:
    """A place may carry its line, because a query typed by hand has no file."""
    shown = render(KgError("KG501", "m", place=Place("query", 3, 2, "ASK {")))
    assert "3 | ASK {\n  |  ^" in shown


@pytest.mark.parametrize("place", [Place("gone.txt", 3, 1), Place("gone.txt"), Place("/", 1)])
def test_a_place_that_cannot_be_read_is_still_named(place: Place) -> None:
    """A missing file or a folder causes no second error."""
    assert f"--> {place}" in render(KgError("KG110", "m", place=place))


def test_wide_characters_and_tabs_keep_the_caret_in_place() -> None:
    """The caret marks the character at the column, despite wide characters and tabs."""
    lines = render(KgError("KG501", "m", place=Place("q", 1, 4, "東\t京x"))).splitlines()
    assert lines[3] == "1 | 東 京x"
    assert lines[4] == "  |      ^"


def test_what_has_an_end_is_marked_to_its_end() -> None:
    """A range has carets along its displayed width; a range of several lines has them to the end of the first."""
    lines = render(KgError("KG501", "m", place=Place("q", 1, 2, "a東京 b", 1, 4))).splitlines()
    assert lines[4] == "  |  ^^^^"
    lines = render(KgError("KG501", "m", place=Place("q", 1, 2, "abc", 3, 1))).splitlines()
    assert lines[4] == "  |  ^^"


def test_long_lines_are_shown_around_the_column() -> None:
    """A line of minified text is cut around the column, and the caret is right."""
    text = "".join(chr(97 + i % 26) for i in range(1000))
    shown, caret = render(KgError("KG501", "m", place=Place("q", 1, 501, text))).splitlines()[3:5]
    assert len(shown) < 200
    assert shown[caret.index("^")] == text[500]


@given(st.text(), st.text(), st.integers(1, 300))
def test_hostile_text_never_reaches_the_terminal(message: str, line: str, column: int) -> None:
    """Escape sequences in messages, paths and source lines are shown, never emitted."""
    shown = render(KgError("KG501", message, place=Place(message, 1, column, line)))
    assert "\x1b" not in shown
    assert not {category(sign) for sign in shown.replace("\n", "")} & {"Cc", "Cf", "Cs", "Zl", "Zp"}
