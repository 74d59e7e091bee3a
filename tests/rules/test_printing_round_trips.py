from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Final

import pytest
from pyoxigraph import Triple
from rules.decompose.texts import graph
from rules.engine.comparing import inferred
from rules.notations.srl_running import canonical, load

from kg.errors import RuleError
from kg.rules import reading
from kg.rules.engine.limits import Limits
from kg.rules.form import Aggregate, EngineBlock, atoms_of, is_auxiliary
from kg.rules.printing import of_data, to_form, to_rq, to_srl, to_turtle
from kg.rules.reading import read_text, rule_files

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rules.engine.oracle import Fact

    from kg.rules.files import RuleFile
    from kg.rules.form import Rule

ROOT: Final = Path(__file__).parents[2]
CASES: Final = [(path, "case/rule") for path in sorted((ROOT / "tests/rules/decompose/cases").glob("*.rq"))]
SHIPPED: Final = list(
    rule_files(ROOT / "rules", ("owl", "owl-rl", "capability", "communication", "copies", "function"))
)
FILES: Final = [*CASES, *SHIPPED]

each_file = pytest.mark.parametrize(
    ("path", "name"), FILES, ids=[f"{path.parent.name}/{path.name}" for path, _ in FILES]
)


TESTS: Final = ROOT / "tests/rules"
RULELESS: Final = {
    TESTS / "decompose/cases/never.rq",
    TESTS / "notations/shacl/cases/target-none/rules.ttl",
    *(TESTS / "notations/srl/data" / f"{name}.srl" for name in ("lists-and-blank-nodes", "reification")),
    TESTS / "notations/srl/data/what-is-asserted-is-not-inferred.srl",
    TESTS / "notations/srl/structure/base-is-relative-to-base.srl",
    *(TESTS / "notations/srl/structure" / f"{name}.srl" for name in ("comments-and-line-ends", "empty")),
    TESTS / "notations/srl/templates/empty-head.srl",
    *(TESTS / "notations/srl/terms" / f"{name}.srl" for name in ("literals", "names")),
}
"""Files that are read without an error and have no rule; they are listed because reading all files takes a second."""
DERIVING: Final = [
    path
    for path in [
        *sorted((TESTS / "decompose/cases").glob("*.rq")),
        *sorted((TESTS / "notations/shacl/cases").glob("*/rules.ttl")),
        *sorted((TESTS / "notations/srl").rglob("*.srl")),
    ]
    if not path.with_suffix(".error").exists() and path not in RULELESS
]
"""Files with rules, in all notations."""


@cache
def read(path: Path, name: str) -> RuleFile:
    """Return the content of a file, which is read once for all tests."""
    return reading.read(path, name)


def graphs(path: Path) -> Iterator[list[Fact]]:
    """Yield the data of a case; random graphs for the cases of decomposition, which have none."""
    data = path.with_name("data.ttl") if path.name == "rules.ttl" else path.with_suffix(".ttl")
    if path.suffix == ".rq":
        for seed in range(5):
            yield [(quad.subject, quad.predicate, quad.object) for quad in graph(Random(seed))]  # noqa: S311 - test data
    else:
        found = load(data) if data.exists() else []
        yield [(triple.subject, triple.predicate, triple.object) for triple in found]


def shape(rule: Rule) -> list[str]:
    """Return the content of a rule, line by line, without its place and the names of fresh variables.

    The lines are sorted, because the position of a filter after its variables does not matter.
    """
    lines = to_form([rule]).split("\n")[2:]
    return sorted(re.sub(r"\?[\w·]*·[\w·]*|_:\w+", "?fresh", line) for line in lines)


def test_files_without_rules_are_listed() -> None:
    """The files to which tests of derivations do not apply have no rule."""
    assert [path for path in RULELESS if read(path, "case/rule").rules] == []


@each_file
def test_a_rule_printed_as_sparql_reads_back_as_it_was(path: Path, name: str) -> None:
    """Each part, printed as CONSTRUCT, has the same internal form except for the names of fresh variables."""
    for rule in read(path, name).rules:
        if is_auxiliary(rule.head[0].predicate):
            continue
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


def derived(file: RuleFile, facts: list[Fact]) -> set[str]:
    """Return what a file derives, with canonical blank nodes."""
    found = inferred((*file.rules, *of_data(file)), facts, Limits(max_triples=10_000))
    return canonical([Triple(*fact) for fact in found if not is_auxiliary(fact[1])])  # type: ignore[arg-type]  # triples


@pytest.mark.parametrize("notation", [".rq", ".srl", ".ttl"])
@pytest.mark.parametrize("path", DERIVING, ids=lambda path: str(path.relative_to(TESTS)))
def test_a_file_in_another_notation_derives_the_same(path: Path, notation: str) -> None:
    """What is printed is a file of rules that derives the same from the data; or the missing feature is reported."""
    file = read(path, "case/rule")
    rules = (*file.rules, *of_data(file))
    try:
        if notation == ".srl":
            text = to_srl(file.rules, file.prefixes, file.data)
        else:
            text = (to_rq if notation == ".rq" else to_turtle)(rules, file.prefixes)
    except RuleError as error:
        assert error.code == "KG209"  # noqa: PT017 - what the notation lacks
        return
    again = read_text(text, Path(f"again{notation}"), "case/rule")
    for facts in graphs(path):
        assert derived(again, facts) == derived(file, facts)


@pytest.mark.parametrize("path", DERIVING, ids=lambda path: str(path.relative_to(TESTS)))
def test_a_file_has_a_rule_in_sparql(path: Path) -> None:
    """Whatever its alternatives and paths are, unless it reads asserted data alone, or states data."""
    file = read(path, "case/rule")
    if not any(atom.asserted for rule in file.rules for atom, _ in atoms_of(rule.body)) and not file.data:
        assert to_rq(file.rules, file.prefixes)
