from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import UsageError
from kg.evaluate.tables import Score, Share, Table, as_csv, as_markdown, as_objects, draw, with_paper, write

if TYPE_CHECKING:
    from pathlib import Path

TABLE = Table(
    "demo",
    "A title & more",
    ("what", "number", "share", "score"),
    (
        ("one|two", 1200, Share(1, 4, (0.1, 0.5)), Score(0.5, (0.4, 0.6))),
        ("three", None, Share(0, 0), Score(-0.25, (-0.5, 0.0), signed=True)),
        ("four", 0.5, Share(3, 3), None),
    ),
    ("A note.",),
)


def test_a_table_in_markdown() -> None:
    """Cells are formatted for people: shares with their counts and intervals, differences with a sign."""
    text = as_markdown(TABLE)
    assert "| one\\|two | 1,200 | 25.0 % (1/4) [10.0, 50.0] | 0.500 [0.400, 0.600] |" in text
    assert "| three | - | - | -0.250 [-0.500, +0.000] |" in text
    assert text.endswith("\n\nA note.\n")


def test_a_table_as_csv_and_objects() -> None:
    """A share fills columns for its value, its counts and its interval, the same in both forms."""
    rows = list(csv.DictReader(io.StringIO(as_csv(TABLE))))
    first, *_ = as_objects(TABLE)
    assert first["share"] == 0.25
    assert rows[0]["share part"] == "1"
    assert rows[0]["score high"] == "0.6"
    assert rows[1]["share"] == ""


@given(st.lists(st.tuples(st.text(), st.integers(0, 50), st.integers(0, 50)), max_size=8), st.text())
def test_any_table_is_a_well_formed_figure(rows: list[tuple[str, int, int]], title: str) -> None:
    """For any texts, a table gives XML with a title and a description and without a script."""
    cells = tuple((name, Share(min(part, whole), whole, (0.0, 1.0))) for name, part, whole in rows)
    root = ET.fromstring(draw(Table("t", title, ("name", "share"), cells)))  # noqa: S314 - our own
    tags = [element.tag.rpartition("}")[2] for element in root.iter()]
    assert tags[1:3] == ["title", "desc"]
    assert "script" not in tags


def test_the_figures_of_the_paper_stand_beside() -> None:
    """A column of the paper is present if and only if one of its figures is known."""
    assert with_paper(TABLE, ("what",), {}) == TABLE
    found = with_paper(TABLE, ("what",), {"three": 0.75})
    assert found.columns[-1] == "RNKG"
    assert [row[-1] for row in found.rows] == [None, 0.75, None]


def test_a_table_is_written_as_three_files(tmp_path: Path) -> None:
    """Markdown, CSV and SVG are written to a new or existing folder; an impossible folder is an error."""
    written = write(TABLE, tmp_path / "new" / "folder")
    assert [path.name for path in written] == ["demo.md", "demo.csv", "demo.svg"]
    (tmp_path / "file").write_text("")
    with pytest.raises(UsageError, match="cannot be written"):
        write(TABLE, tmp_path / "file")
