from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.lint.finding import Evidence
from kg.lint.lines import Lines

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(("line", "text"), [(1, "one"), (2, "two"), (3, None), (0, None), (None, None)])
def test_lines_are_counted_from_one(tmp_path: Path, line: int | None, text: str | None) -> None:
    """A line that does not exist is empty."""
    (tmp_path / "a.launch").write_text("one\ntwo\n", encoding="utf-8")
    assert Lines({"local/x": str(tmp_path)}).at(Evidence("a.launch", line, "local/x"), line) == text


@pytest.mark.parametrize("path", ["../secret", "gone", ".", "link"])
def test_nothing_outside_of_a_source_is_read(tmp_path: Path, path: str) -> None:
    """A path that leads outside, directly or through a link, has no lines; nor has a non-file."""
    (tmp_path / "secret").write_text("x", encoding="utf-8")
    root = tmp_path / "root"
    root.mkdir()
    (root / "link").symlink_to(tmp_path / "secret")
    assert Lines({"local/x": str(root)}).at(Evidence(path, 1, "local/x"), 1) is None


def test_a_form_feed_is_no_end_of_a_line(tmp_path: Path) -> None:
    """Lines end where compilers and editors end them."""
    (tmp_path / "a.cpp").write_bytes(b"one\x0cstill one\r\ntwo\n")
    assert list(Lines({"local/x": str(tmp_path)}).of("local/x", "a.cpp")) == ["one\x0cstill one", "two"]
