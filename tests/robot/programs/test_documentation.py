"""docs/programs.md describes the actual language."""

from __future__ import annotations

import re

import pytest
from repository import ROOT

from kg.robot.programs.parse import parse
from kg.robot.programs.units import UNITS

PAGE = (ROOT / "docs/programs.md").read_text(encoding="utf-8")
FOUND = re.findall(r"(?:^(?:    .*)?\n)+", PAGE, flags=re.MULTILINE)
BLOCKS = [re.sub(r"^    ", "", one, flags=re.MULTILINE) for one in FOUND]
PROGRAMS = [one for one in BLOCKS if one.strip() and not re.match(r"\s*(kg |program     =)", one)]


@pytest.mark.parametrize("text", PROGRAMS, ids=[one.split("\n")[1][:40] for one in PROGRAMS])
def test_examples_are_programs(text: str) -> None:
    """Every example can be parsed, with three dots for omitted parts."""
    assert parse(re.sub(r"^(\s*)\.\.\.$", r'\1log "..."', text, flags=re.MULTILINE)).body


def test_every_unit_is_named() -> None:
    """The table lists all units."""
    assert [unit for unit in UNITS if f"`{unit}`" not in PAGE] == []
