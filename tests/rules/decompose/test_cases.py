"""Each case is a rule, NAME.rq, and its internal form, NAME.form."""

from __future__ import annotations

from pathlib import Path
from random import Random
from typing import Final

import pytest
from rules.decompose.applying import applied, read, stated
from rules.decompose.texts import graph

from kg.rules.decompose import decompose
from kg.rules.printing import to_form
from kg.syntax.parser import parse_rq

CASES: Final = sorted((Path(__file__).parent / "cases").glob("*.rq"))
GRAPHS: Final = 20

pytestmark = pytest.mark.parametrize("case", CASES, ids=lambda case: case.stem)


def test_a_rule_becomes_this_form(case: Path) -> None:
    """The internal form of the rule is the one in the file next to it."""
    text = case.read_text(encoding="utf-8")
    found = decompose(parse_rq(text, case.name).rules[0], f"case/{case.stem}", case.name, text)
    assert to_form(found, {"": "urn:"}) + "\n" == case.with_suffix(".form").read_text(encoding="utf-8")


def test_the_form_derives_what_the_rule_derives(case: Path) -> None:
    """The parts of the rule derive the same from any graph as the store's engine from its text."""
    text = case.read_text(encoding="utf-8")
    for seed in range(GRAPHS):
        quads = graph(Random(seed))  # noqa: S311 - data to test with, no secrets
        if "[ :k" not in text:
            assert applied(quads, read(text)) == stated(quads, text)
