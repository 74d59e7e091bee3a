from __future__ import annotations

import pytest

from kg.errors import Place
from kg.syntax.position import offset_of, place_at, place_of

TEXT = "one\ntwo\n\nthree"


@pytest.mark.parametrize(
    ("offset", "line", "column", "shown"),
    [(0, 1, 1, "one"), (2, 1, 3, "one"), (4, 2, 1, "two"), (8, 3, 1, ""), (9, 4, 1, "three"), (14, 4, 6, "three")],
)
def test_an_offset_is_a_line_and_a_column(offset: int, line: int, column: int, shown: str) -> None:
    """The place has the text of its line, and leads back to the offset."""
    assert place_at(TEXT, offset, "x.rq") == Place("x.rq", line, column, shown)
    assert place_of(TEXT, line, column, "x.rq") == Place("x.rq", line, column, shown)
    assert offset_of(TEXT, line, column) == offset


@pytest.mark.parametrize(("end", "line", "column"), [(3, 1, 4), (6, 2, 3), (0, 1, 2)])
def test_a_place_can_have_an_end(end: int, line: int, column: int) -> None:
    """The end can be in a later line; it is never before the start."""
    found = place_at(TEXT, 1, "x.rq", end)
    assert (found.line, found.column, found.end_line, found.end_column) == (1, 2, line, column)


def test_a_line_after_the_end_has_no_text() -> None:
    """The engine may report a line that the text does not have."""
    assert place_of(TEXT, 9, 1, "x.rq") == Place("x.rq", 9, 1, None)
