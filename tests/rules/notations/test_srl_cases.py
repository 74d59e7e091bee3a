"""Cases: a rule set `NAME.srl` on `NAME.ttl` infers `NAME.expected.ttl`, or is rejected as in `NAME.error`."""

from __future__ import annotations

from pathlib import Path

import pytest
from rules.notations.srl_running import canonical, infer, load

from kg.errors import RuleError

CASES = Path(__file__).parent / "srl"
EVERY = sorted(CASES.rglob("*.srl"))


def name(path: Path) -> str:
    """Return clause and name of a case."""
    return path.relative_to(CASES).with_suffix("").as_posix()


@pytest.mark.parametrize("rules", [path for path in EVERY if path.with_suffix(".expected.ttl").exists()], ids=name)
def test_a_rule_set_infers_what_is_expected(rules: Path) -> None:
    """A rule set infers exactly the expected graph."""
    data = rules.with_suffix(".ttl")
    found = canonical(infer(rules, load(data) if data.exists() else ()))
    assert found == canonical(load(rules.with_suffix(".expected.ttl")))


@pytest.mark.parametrize("rules", [path for path in EVERY if path.with_suffix(".error").exists()], ids=name)
def test_a_bad_rule_set_is_refused_at_its_place(rules: Path) -> None:
    """An error has the expected code, line, column and words."""
    code, place, words = rules.with_suffix(".error").read_text().strip().split(" ", 2)
    with pytest.raises(RuleError) as caught:
        infer(rules, ())
    error = caught.value
    assert error.place is not None
    assert (error.code, f"{error.place.line}:{error.place.column}") == (code, place)
    assert words in error.message


def test_every_case_says_what_it_expects() -> None:
    """Every rule set among the cases has an expectation."""
    silent = [path for path in EVERY if not path.with_suffix(".error").exists()]
    assert all(path.with_suffix(".expected.ttl").exists() for path in silent)
