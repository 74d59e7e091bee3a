"""After any changes, the inferred triples equal an evaluation from scratch."""

from __future__ import annotations

from random import Random
from typing import TYPE_CHECKING, cast

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from patience import examples
from rules.engine.comparing import columns, tuples
from rules.engine.equalities import equal_facts, equal_rules
from rules.engine.oracle import infer
from rules.engine.test_properties import facts, rule_sets
from rules.maintain.generating import by_class, classified, layered
from rules.maintain.generating import facts as dense
from rules.programs import Programs
from rules.programs import facts as program_facts

from kg.errors import RuleError
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.maintain import Maintained, maintaining
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Rule


@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(rule_sets(), facts, st.data())
def test_any_rules_under_any_changes_equal_starting_over(
    rules: list[Rule], asserted: set[Fact], data: st.DataObject
) -> None:
    """Rules of any shape, most of which seldom fire."""
    compare(rules, asserted, data, cast("st.SearchStrategy[set[Fact]]", facts))


@settings(max_examples=examples(30, 80), deadline=None, suppress_health_check=list(HealthCheck))
@given(layered(), dense(8, 16), st.data())
def test_any_changes_equal_starting_over(rules: list[Rule], asserted: set[Fact], data: st.DataObject) -> None:
    """Insertions and deletions of asserted, inferred or other triples, with effects across layers."""
    compare(rules, asserted, data, dense(1, 4))


@settings(max_examples=examples(30, 80), deadline=None, suppress_health_check=list(HealthCheck))
@given(by_class(), classified(4, 14), st.data())
def test_changes_that_reach_few_rules_equal_starting_over(
    rules: list[Rule], asserted: set[Fact], data: st.DataObject
) -> None:
    """Classes derived from classes: by links, negation, counts, created nodes, and bodies of two parts."""
    compare(rules, asserted, data, classified(1, 3))


@settings(max_examples=examples(25, 60), deadline=None, suppress_health_check=list(HealthCheck))
@given(equal_rules(), equal_facts(3, 9), st.sampled_from([-1, 3, 1 << 16]), st.data())
def test_changes_of_equal_terms_equal_starting_over(
    rules: list[Rule], asserted: set[Fact], rows: int, data: st.DataObject
) -> None:
    """Maintained rule by rule, evaluated again, or alternating between both."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(maintaining, "_FEW_ROWS", rows)
        patch.setattr(maintaining, "_ROWS_PER_TRIPLE", 0)
        compare(rules, asserted, data, equal_facts(1, 3))


@settings(max_examples=examples(60, 300), deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_changes_under_rules_in_sparql_equal_starting_over(seed: int) -> None:
    """OPTIONAL, MINUS, NOT EXISTS, aggregates, string functions, triple terms, paths, and blocks of SPARQL."""
    random = Random(seed)  # noqa: S311 - rules to test with, no secrets
    rules = Programs(random).rules()
    assume(rules is not None)
    try:
        compare_runs(rules or [], random)
    except RuleError as error:
        assume(error.code != "KG209")  # a block that the store's engine cannot evaluate
        raise


def compare_runs(rules: list[Rule], random: Random) -> None:
    """Apply changes and compare each with the engine from scratch."""
    program, dictionary, asserted = Program(rules), Dictionary(), program_facts(random, 4, 14)
    begin, limits = columns(asserted, dictionary), Limits(max_triples=3000)
    state = Maintained(program, dictionary, begin, evaluate(program, dictionary, begin, limits=limits).inferred)
    for _ in range(random.randint(1, 4)):
        inferred = sorted(tuples(state.inferred, dictionary), key=str)
        pool = sorted(asserted.union(inferred), key=str)
        deleted = set(random.sample(pool, min(len(pool), random.randint(0, 3))))
        inserted = program_facts(random, 0, 3).union(random.sample(inferred, min(len(inferred), random.randint(0, 1))))
        state.apply(columns(inserted, dictionary), columns(deleted, dictionary), limits=limits)
        asserted = (asserted - deleted) | inserted
        again = Dictionary()
        expected = evaluate(Program(rules), again, columns(asserted, again), limits=limits).inferred
        assert tuples(state.inferred, dictionary) == tuples(expected, again)


def compare(rules: list[Rule], asserted: set[Fact], data: st.DataObject, few: st.SearchStrategy[set[Fact]]) -> None:
    """Apply changes and compare each with the naive evaluation, and with the engine, from scratch."""
    try:
        stratify(rules)
    except RuleError:
        assume(condition=False)
    program, dictionary = Program(rules), Dictionary()
    begin = columns(asserted, dictionary)
    state = Maintained(program, dictionary, begin, evaluate(program, dictionary, begin).inferred)
    for _ in range(data.draw(st.integers(1, 4))):
        inferred = tuples(state.inferred, dictionary)
        pool = sorted(asserted | inferred, key=str)
        deleted = data.draw(st.sets(st.sampled_from(pool), max_size=4)) if pool else set()
        inserted = data.draw(st.sets(st.sampled_from(sorted(inferred, key=str)), max_size=1)) if inferred else set()
        inserted |= set(sorted(data.draw(few), key=str)[:4])
        change = state.apply(columns(inserted, dictionary), columns(deleted, dictionary))
        asserted = (asserted - deleted) | inserted
        expected = infer(rules, asserted)
        assert tuples(state.asserted, dictionary) == asserted
        assert tuples(state.inferred, dictionary) == expected
        assert tuples(change.added, dictionary) == expected - inferred
        assert tuples(change.removed, dictionary) == inferred - expected
        assert tuples(evaluate(program, dictionary, state.asserted).inferred, dictionary) == expected
