from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

from kg.errors import RuleError
from kg.rules.form import Aggregate, EngineBlock
from kg.rules.printing import to_form, to_rq, to_srl, to_turtle
from kg.rules.reading import read, read_text, rule_files

if TYPE_CHECKING:
    from kg.rules.form import Rule

ROOT: Final = Path(__file__).parents[3]
CASES: Final = [(path, "case/rule") for path in sorted((ROOT / "tests/rules/decompose/cases").glob("*.rq"))]
SHIPPED: Final = list(
    rule_files(ROOT / "rules", ("owl", "owl-rl", "capability", "communication", "copies", "function"))
)
FILES: Final = [*CASES, *SHIPPED]

each_file = pytest.mark.parametrize(
    ("path", "name"), FILES, ids=[f"{path.parent.name}/{path.name}" for path, _ in FILES]
)


def shape(rule: Rule) -> list[str]:
    """Return the content of a rule, line by line, without its place and the names of fresh variables.

    The lines are sorted, because the position of a filter after its variables does not matter.
    """
    lines = to_form([rule]).split("\n")[2:]
    return sorted(re.sub(r"\?[\w·]*·[\w·]*|_:\w+", "?fresh", line) for line in lines)


@each_file
def test_a_rule_printed_as_sparql_reads_back_as_it_was(path: Path, name: str) -> None:
    """Each part, printed as CONSTRUCT, has the same internal form except for the names of fresh variables."""
    for rule in read(path, name).rules:
        try:
            text = to_rq([rule])
        except RuleError as error:
            assert error.code == "KG209"  # noqa: PT017 - asserted data
            continue
        if any(isinstance(element, EngineBlock | Aggregate) for element in rule.body):
            continue
        (again,) = read_text(text, Path("again.rq"), name).rules
        assert shape(again) == shape(rule)


@each_file
def test_a_rule_printed_as_rule_language_reads_back_as_it_was(path: Path, name: str) -> None:
    """All rules of a file, printed as SPARQL RL, have the same internal form, or the missing feature is reported."""
    file = read(path, name)
    try:
        text = to_srl(file.rules, file.prefixes)
    except RuleError as error:
        assert error.code == "KG209"  # noqa: PT017 - what SPARQL RL lacks
        return
    again = read_text(text, Path("again.srl"), name)
    assert [shape(rule) for rule in again.rules] == [shape(rule) for rule in file.rules]


@each_file
def test_a_rule_printed_as_shacl_is_read(path: Path, name: str) -> None:
    """The printed SHACL is parsed to one rule for each."""
    file = read(path, name)
    try:
        text = to_turtle(file.rules, file.prefixes)
    except RuleError as error:
        assert error.code == "KG209"  # noqa: PT017 - asserted data
        return
    assert {rule.head for rule in read_text(text, Path("again.ttl"), name).rules} or not file.rules
