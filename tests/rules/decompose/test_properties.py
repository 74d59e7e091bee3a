from __future__ import annotations

from pathlib import Path
from random import Random
from typing import TYPE_CHECKING

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from rules.decompose.applying import applied, read, stated
from rules.decompose.texts import Texts, graph
from rules.engine.comparing import inferred

from kg.errors import RuleError
from kg.rules.engine.limits import Limits
from kg.rules.form import EngineBlock, is_auxiliary
from kg.rules.printing import to_rq, to_srl, to_turtle
from kg.rules.reading import read_text

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Rule

EXAMPLES = 40
RULES = 20


@settings(max_examples=EXAMPLES, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_parts_derive_what_the_text_derives(seed: int) -> None:
    """The parts of any rule derive the same from any graph as the store's engine from its text.

    The rules are the same in each run: of ten thousand, one or two trigger a defect of the engine, which gives
    different results for two spellings of an OPTIONAL inside an OPTIONAL.
    """
    random = Random(seed)  # noqa: S311 - rules to test with, no secrets
    for _ in range(RULES):
        data, text = graph(random), Texts(random).rule()
        try:
            expected, rules = stated(data, text), read(text)
        except (SyntaxError, RuleError):
            continue
        assert applied(data, rules) == expected, text


@settings(max_examples=EXAMPLES, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_a_rule_in_another_notation_derives_what_it_derives(seed: int) -> None:
    """The text of any rule in any notation that can express it derives the same from any graph, round by round."""
    random = Random(seed)  # noqa: S311 - rules to test with, no secrets
    for _ in range(RULES // 4):
        facts: list[Fact] = [(quad.subject, quad.predicate, quad.object) for quad in graph(random)]
        try:
            rules = read(text := Texts(random).rule())
            expected = derived(rules, facts)
        except RuleError:
            continue
        for printer, ending in ((to_rq, ".rq"), (to_turtle, ".ttl"), (to_srl, ".srl")):
            try:
                printed = printer(rules) if rules else ""
            except RuleError:
                continue
            if not printed:
                continue
            again = read_text(printed, Path(f"rule{ending}"), "test/rule").rules
            try:
                found = derived(again, facts)
            except RuleError as error:
                # Branches that bind different variables of the head can be read back as one block that reads anything.
                if error.code != "KG202" or not any(map(reads_anything, again)):
                    raise
                continue
            assert found == expected, text


def reads_anything(rule: Rule) -> bool:
    """Return whether a rule has a block of SPARQL whose predicates are unknown."""
    return any(isinstance(element, EngineBlock) and element.reads is None for element in rule.body)


def derived(rules: tuple[Rule, ...], facts: list[Fact]) -> set[Fact]:
    """Return what rules derive, without auxiliary triples."""
    return {fact for fact in inferred(rules, facts, Limits(max_triples=3000)) if not is_auxiliary(fact[1])}
