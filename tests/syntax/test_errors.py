"""Cases: `NAME.rq` is rejected with the first line of `NAME.error`, and the hint in its second line."""

from __future__ import annotations

from pathlib import Path

import pytest

from kg.errors import RuleError
from kg.syntax.parser import parse_rq

CASES = sorted((Path(__file__).parent / "cases").glob("*.rq"))


@pytest.mark.parametrize("rule", CASES, ids=lambda path: path.stem)
def test_a_bad_rule_is_refused_at_its_place(rule: Path) -> None:
    """An error has the expected syntax, the place, and a suggestion."""
    said, _, hint = rule.with_suffix(".error").read_text().strip().partition("\n")
    code, place, words = said.split(" ", 2)
    with pytest.raises(RuleError) as caught:
        parse_rq(rule.read_text(), str(rule))
    error = caught.value
    assert error.place is not None
    assert (error.code, f"{error.place.line}:{error.place.column}") == (code, place)
    assert words in error.message
    assert not hint or error.hint == hint


def test_an_error_shows_the_line() -> None:
    """The place of an error has the text of its line, for any line ends."""
    with pytest.raises(RuleError) as caught:
        parse_rq("CONSTRUCT { }\r\nWHERE { ?s ?p }", "x.rq")
    assert caught.value.place is not None
    assert caught.value.place.excerpt == "WHERE { ?s ?p }"
