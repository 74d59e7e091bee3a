"""Rejected shapes graphs: the first line of each file of `refused` has the code, the place and the message."""

from __future__ import annotations

from pathlib import Path

import pytest

from kg.errors import RuleError
from kg.rules.notations.shacl import rules

FILES = sorted((Path(__file__).parent / "refused").glob("*.ttl"))


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_shapes_graph_is_refused_with_its_place(file: Path) -> None:
    """The error has the code, line and column of the file, its message, and the line itself."""
    text = file.read_text()
    with pytest.raises(RuleError) as raised:
        rules(text, "tests/refused", file.name)
    error = raised.value
    assert error.place is not None
    assert f"# {error.code} {error.place.line}:{error.place.column} {error.message}" == text.splitlines()[0]
    assert error.place.excerpt == text.splitlines()[(error.place.line or 1) - 1]


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_a_refusal_says_the_way_out(file: Path) -> None:
    """Errors raised outside the parsers of Turtle and SPARQL have a hint."""
    if file.stem in {"turtle-syntax", "turtle-prefix", "construct-expression"}:
        return
    with pytest.raises(RuleError) as raised:
        rules(file.read_text(), "tests/refused", file.name)
    assert raised.value.hint
