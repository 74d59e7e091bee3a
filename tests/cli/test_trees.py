"""Trees of explanations on narrow terminals: text wraps inside its branches, places are never broken."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.cli import output
from kg.cli.commands import why
from kg.cli.links import Links
from kg.rules.explain.proof import Evidence
from kg.rules.explain.text import Line

if TYPE_CHECKING:
    from collections.abc import Sequence

PLACE = "src/a_rather_long_name_of_a_file.cpp:128"
LINE = Line("│  ├─ ", "camera_monitor#publisher/image rnkg:connectsTo /camera/image", "fact", Evidence(PLACE[:-4], 128))


def rows(width: int, monkeypatch: pytest.MonkeyPatch, lines: Sequence[Line] = (LINE,)) -> list[str]:
    """Return the rows that lines occupy on a terminal of some width."""
    monkeypatch.setattr(output, "line_width", lambda: width)
    return [row.plain for line in lines for row in why._folded(line, Links.of([]))]


@pytest.mark.parametrize("width", [20, 40, 60, 80, 200])
def test_places_are_never_broken(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A place is whole on one row, however narrow the terminal, for clicking and copying."""
    assert sum(PLACE in row for row in rows(width, monkeypatch)) == 1


@pytest.mark.parametrize("width", [40, 60, 80])
def test_what_does_not_fit_goes_on_inside_the_branches(width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Continuation rows keep the lines of their branches, and no row exceeds the terminal except for a place."""
    first, *others = rows(width, monkeypatch)
    assert first.startswith("│  ├─ ")
    assert all(row.startswith("│  │    ") for row in others)
    assert all(len(row) <= width for row in (first, *others) if PLACE not in row)


def test_wide_terminals_fold_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a wide terminal a line is one row."""
    assert len(rows(200, monkeypatch)) == 1
