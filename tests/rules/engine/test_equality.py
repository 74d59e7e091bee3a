"""Equalities: classes of equal terms give exactly the inferences of their rules one by one."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, assume, given, settings
from rules.engine.comparing import columns, inferred, tuples
from rules.engine.equalities import EQUAL, RULES, equal_facts, equal_rules
from rules.engine.oracle import infer
from rules.forms import rule, triples

from kg.errors import RuleError
from kg.rules.engine import evaluate as evaluating
from kg.rules.engine.equality import equalities
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.form import Atom
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Rule

ALL = list(RULES.values())


def facts(text: str) -> set[Fact]:
    """Parse triples to tuples."""
    return {(triple.subject, triple.predicate, triple.object) for triple in triples(text)}


def chain(length: int) -> set[Fact]:
    """Return a chain of equal terms."""
    return facts("\n".join(f":a{number} =urn:equal :a{number + 1}" for number in range(length)))


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(equal_rules(), equal_facts(1, 9))
def test_an_equality_infers_what_its_rules_infer_one_by_one(rules: list[Rule], asserted: set[Fact]) -> None:
    """With other rules, filters, negation, literals, equal predicates and a second equality."""
    try:
        stratify(rules)
    except RuleError:
        assume(condition=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(evaluating, "equalities", lambda _: ())
        expected = inferred(rules, asserted)
    assert inferred(rules, asserted) == expected


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(equal_rules(), equal_facts(1, 6))
def test_an_equality_infers_what_the_naive_evaluation_does(rules: list[Rule], asserted: set[Fact]) -> None:
    """The same compared with the oracle, which is independent of the engine."""
    try:
        stratify(rules)
    except RuleError:
        assume(condition=False)
    assert inferred(rules, asserted) == infer(rules, asserted)


def test_equalities_are_recognised_by_the_form_of_their_rules() -> None:
    """Names and order of atoms do not matter; a rule of another form is not an equality."""
    (found,) = equalities(ALL)
    assert (found.predicate, found.rules) == (EQUAL, frozenset(ALL))
    assert not equalities([RULES["symmetry"], RULES["subject"]])
    first, *others = RULES["transitivity"].body
    assert isinstance(first, Atom)
    body = (dataclasses.replace(first, asserted=True), *others)
    assert not equalities([RULES["symmetry"], dataclasses.replace(RULES["transitivity"], body=body)])


def test_a_rule_that_replaces_against_the_direction_is_not_part_of_an_equality() -> None:
    """A rule that gives a term the triples of a literal's equals is evaluated as written."""
    backwards = rule("?s ?p ?x", "?x =urn:equal ?y . ?s ?p ?y")
    (found,) = equalities([*ALL, backwards])
    assert backwards not in found.rules
    asserted = facts(":a =urn:equal 1\n:b :p 1")
    assert facts(":b :p :a") <= inferred([*ALL, backwards], asserted)
    assert not facts(":b :p :a") <= inferred(ALL, asserted)


def test_a_long_chain_is_derived_once() -> None:
    """All pairs of 300 terms and one triple for each are derived once and attributed to their rules."""
    dictionary = Dictionary()
    asserted = chain(299) | facts(":a0 :p :b")
    outcome = evaluate(Program(ALL), dictionary, columns(asserted, dictionary))
    assert len(outcome.inferred) == 300 * 300 - 299 + 299
    derived = {report.rule.name: report.derived for report in outcome.reports}
    assert derived["test/equal-symmetry"] == 299
    assert derived["test/equal-subject"] == 299
    assert sum(derived.values()) == len(outcome.inferred)
    assert all(report.rounds == 1 and all(report.matched) for report in outcome.reports)


def test_a_limit_ends_an_equality_before_its_pairs_are_made() -> None:
    """A hundred thousand equal terms have ten thousand million pairs, too many for memory."""
    message = "KG205: more than 1,000 triples are inferred, at rule test/equal-transitivity, round 1;"
    with pytest.raises(RuleError, match=message):
        inferred(ALL, chain(100_000), Limits(max_triples=1000))


def test_what_is_known_does_not_count_towards_a_limit() -> None:
    """A graph that contains all pairs infers nothing."""
    dictionary = Dictionary()
    first = evaluate(Program(ALL), dictionary, columns(chain(5), dictionary)).inferred
    whole = tuples(first, dictionary) | chain(5)
    assert inferred(ALL, whole, Limits(max_triples=0)) == set()
