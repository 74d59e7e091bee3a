"""Derivations of rules rewritten for goals, compared with the naive evaluation of the original rules."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Final

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from patience import examples
from pyoxigraph import Literal, NamedNode, RdfFormat, parse
from rules.engine.comparing import columns, tuples
from rules.engine.oracle import infer
from rules.engine.test_properties import facts, patterns, rule_sets
from rules.programs import Programs
from rules.programs import facts as program_facts

from kg.errors import Place, RuleError
from kg.rules.demand.magic import demanded
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.terms import Dictionary
from kg.rules.form import AUXILIARY, Atom, Exists, Rule, TripleTerm, Values, Variable
from kg.rules.notations import srl
from kg.rules.reading import read_text
from kg.rules.stratify import stratify
from kg.syntax.parser import parse_srl

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.demand.magic import Goal
    from kg.rules.form import Pattern, Term

PREFIX: Final = "PREFIX : <urn:>\n"
NODE: Final = NamedNode("urn:a")
NODES: Final = [NamedNode(f"urn:n{number}") for number in range(5)]
P, UP = NamedNode("urn:p"), NamedNode("urn:up")
CLASSES: Final = [NamedNode(f"urn:C{number}") for number in range(4)]
TYPE: Final = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")

SHAPES: Final = {
    "right recursive": "RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :p ?y . ?y :up ?z }",
    "left recursive": "RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :p ?z }",
    "double recursive": "RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :up ?z }",
    "backwards": "RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :up ?y . ?z :p ?y }",
    "both ends": """RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :q ?y . ?y :up ?z }
        RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :p ?w . ?w :q ?z }""",
    "two of double": """RULE { ?x :reach ?y } WHERE { ?x :p ?y }
        RULE { ?x :reach ?z } WHERE { ?x :reach ?y . ?y :reach ?z }
        RULE { ?x :up ?y } WHERE { ?x :reach ?y . ?y a :C1 } RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :up ?z }""",
    "steps of derived triples": """RULE { ?x :reach ?y } WHERE { ?x :p ?y }
        RULE { ?x :reach ?z } WHERE { ?x :p ?y . ?y :reach ?z } RULE { ?x :up ?y } WHERE { ?x :q ?y }
        RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :reach ?z . ?z a ?c }""",
    "same generation": """RULE { ?x :up ?y } WHERE { ?x :p ?z . ?y :p ?z }
        RULE { ?x :up ?y } WHERE { ?x :p ?v . ?v :up ?w . ?y :p ?w }""",
    "mutually recursive": """RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :q ?y . ?y :odd ?z }
        RULE { ?x :odd ?z } WHERE { ?x :up ?y . ?y :p ?z }""",
    "classes": "RULE { ?x a ?d } WHERE { ?x a ?c . ?c :under ?d }",
    "classes by name": """RULE { ?x a :C1 } WHERE { ?x a :C0 } RULE { ?x a :C2 } WHERE { ?x a :C1 ; :p ?y . ?y a :C1 }
        RULE { ?x :up ?y } WHERE { ?x :p ?y . ?y a :C2 }""",
    "negation over recursion": """RULE { ?x :reach ?y } WHERE { ?x :p ?y }
        RULE { ?x :reach ?z } WHERE { ?x :reach ?y . ?y :p ?z }
        RULE { ?x :up ?y } WHERE { ?x :q ?y NOT { ?y :reach ?x } }
        RULE { ?x :up ?z } WHERE { ?x :up ?y . ?y :up ?z FILTER(?x != ?z) }""",
}
"""Rule sets of `:up`, `:reach` and classes over `:p`, `:q`, `:under`."""


def rules_of(text: str) -> list[Rule]:
    """Return the rules of a text of SPARQL 1.2 RL."""
    whole = PREFIX + text
    return list(srl.rules(parse_srl(whole, "test.srl"), "test/rules", "test.srl", whole))


def on_demand(rules: list[Rule], goals: list[Goal], asserted: set[Fact]) -> set[Fact]:
    """Return the triples of the rules' own predicates that the rewritten rules infer."""
    rewritten, dictionary = demanded(rules, goals), Dictionary()
    copies = {
        (fact[0], copy, fact[2]) for copy, predicate in rewritten.copies for fact in asserted if fact[1] == predicate
    }
    outcome = evaluate(Program(rewritten.rules), dictionary, columns(asserted | copies, dictionary))
    found = tuples(outcome.inferred, dictionary)
    return {fact for fact in found if not str(getattr(fact[1], "value", "")).startswith(AUXILIARY)}


def answers(goal: Goal, known: set[Fact]) -> list[dict[Variable, Term]]:
    """Return the solutions of a goal over triples, by nested loops."""
    solutions: list[dict[Variable, Term]] = [{}]
    for element in goal:
        rows: list[tuple[tuple[Pattern, ...], tuple[Term, ...]]]
        if isinstance(element, Values):
            rows = [(element.variables, row) for row in element.rows]
        else:
            rows = [(element.positions, fact) for fact in known]
        found = (matched(pattern, row, solution) for solution in solutions for pattern, row in rows)
        solutions = [each for each in found if each is not None]
    return solutions


def matched(
    pattern: tuple[Pattern, ...], row: tuple[Term, ...], solution: dict[Variable, Term]
) -> dict[Variable, Term] | None:
    """Return a solution extended by a compatible row, or None."""
    extended = dict(solution)
    for position, term in zip(pattern, row, strict=True):
        if isinstance(position, Variable):
            if extended.setdefault(position, term) != term:
                return None
        elif position != term:
            return None
    return extended


def compare(rules: list[Rule], goals: list[Goal], asserted: set[Fact]) -> None:
    """Compare the solutions of each goal with those over all inferences of the rules."""
    everything = infer(rules, asserted)
    derived = on_demand(rules, goals, asserted)
    assert derived <= everything
    for goal in goals:
        expected = answers(goal, asserted | everything)
        found = answers(goal, asserted | derived)
        assert sorted(map(repr, found)) == sorted(map(repr, expected))


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_goals_over_rules_in_sparql_have_all_their_triples(seed: int) -> None:
    """Rules with every construct give the triples of a goal that a full run gives, and no others."""
    random = Random(seed)  # noqa: S311 - rules to test with, no secrets
    rules = Programs(random).rules()
    assume(rules is not None)
    asserted, dictionary = program_facts(random, 4, 14), Dictionary()
    try:
        whole = tuples(evaluate(Program(rules or ()), dictionary, columns(asserted, dictionary)).inferred, dictionary)
    except RuleError:  # rules that create terms without end, and blocks that the store's engine cannot evaluate
        assume(condition=False)
    subject: Pattern = NODE if random.randint(0, 1) else Variable("a")
    value: Pattern = NODE if random.randint(0, 1) else Variable("b")
    predicate = NamedNode(f"urn:d{random.randint(0, 2)}")
    derived = on_demand(rules or [], [(Atom(subject, predicate, value),)], asserted)
    assert derived <= whole

    def asked(known: set[Fact]) -> set[Fact]:
        return {fact for fact in known if matched((subject, predicate, value), fact, {}) is not None}

    assert asked(derived) == asked(whole)


@st.composite
def goals_of(draw: st.DrawFn) -> list[Goal]:
    """Draw goals about the predicates of `SHAPES`: most start with a pattern that binds one end of `:up`."""
    ends: list[Pattern] = [Variable("a"), Variable("b"), *NODES[:2]]
    values: list[Pattern] = [*ends, Literal(1)]
    pairs: list[tuple[Pattern, list[Pattern]]] = [(NamedNode(f"urn:{name}"), values) for name in ("up", "reach", "p")]
    pairs.append((TYPE, [Variable("c"), *CLASSES]))

    def element() -> Atom | Values:
        if draw(st.integers(0, 6)) == 0:
            rows = draw(st.lists(st.sampled_from(NODES), max_size=2, unique=True))
            return Values((draw(st.sampled_from([Variable("a"), Variable("b")])),), tuple((row,) for row in rows))
        predicate, objects = draw(st.sampled_from(pairs))
        return Atom(draw(st.sampled_from(ends)), predicate, draw(st.sampled_from(objects)))

    def first() -> Atom | Values:
        if draw(st.integers(0, 3)) == 0:
            return element()
        one, other = draw(st.sampled_from(values)), Variable("b")
        backwards = isinstance(one, Literal) or draw(st.booleans())
        return Atom(other, UP, one) if backwards else Atom(one, UP, other)

    def goal() -> Goal:
        return (first(), *(element() for _ in range(draw(st.sampled_from([0, 0, 0, 1, 2])))))

    return [goal() for _ in range(draw(st.sampled_from([1, 1, 2])))]


edges = st.tuples(
    st.sampled_from(NODES), st.sampled_from([NamedNode(f"urn:{name}") for name in "ppq"]), st.sampled_from(NODES)
)
graphs = st.builds(
    lambda edges, others: edges | others,
    st.sets(edges, min_size=5, max_size=12),
    st.sets(
        st.one_of(
            st.tuples(st.sampled_from(NODES), st.sampled_from([P, UP]), st.sampled_from([*NODES, Literal(1)])),
            st.tuples(st.sampled_from(NODES), st.just(TYPE), st.sampled_from(CLASSES)),
            st.tuples(st.sampled_from(CLASSES), st.just(NamedNode("urn:under")), st.sampled_from(CLASSES)),
        ),
        max_size=8,
    ),
)


@pytest.mark.parametrize("shape", SHAPES)
@settings(max_examples=examples(30, 120), deadline=None, suppress_health_check=list(HealthCheck))
@given(goals=goals_of(), asserted=graphs)
def test_recursive_rules_give_a_goal_the_same_answers(shape: str, goals: list[Goal], asserted: set[Fact]) -> None:
    """Closures, generations, classes and negation over them: the same solutions as over all inferences."""
    compare(rules_of(SHAPES[shape]), goals, asserted)


@settings(max_examples=examples(75, 300), deadline=None, suppress_health_check=list(HealthCheck))
@given(
    rules=rule_sets(),
    asserted=facts,
    goals=st.lists(st.lists(patterns(), min_size=1, max_size=2).map(tuple), max_size=2),
)
def test_any_rules_give_a_goal_the_same_answers(
    rules: list[Rule], asserted: set[Fact], goals: list[tuple[Atom, ...]]
) -> None:
    """Rules with negation, aggregates, variable predicates and new blank nodes: the same solutions."""
    try:
        stratify(rules)
    except RuleError:
        assume(condition=False)
    plain = [goal for goal in goals if not any(isinstance(end, TripleTerm) for atom in goal for end in atom.positions)]
    compare(rules, [tuple(replace(atom, asserted=False) for atom in goal) for goal in plain], asserted)


REACH: Final = """RULE { ?x :reach ?y } WHERE { ?x :p ?y }
    RULE { ?x :reach ?z } WHERE { ?x :p ?y . ?y :reach ?z }"""
ENDS: Final = [
    Atom(Variable("a"), UP, NODES[1]),
    Atom(NODES[0], UP, Variable("a")),
    Atom(NODES[0], UP, NODES[1]),
]


def graph(text: str) -> set[Fact]:
    """Return the triples of a text of Turtle."""
    prefixes = "@prefix : <urn:> .\n"
    found = parse((prefixes + text).encode(), RdfFormat.TURTLE)
    return {(quad.subject, quad.predicate, quad.object) for quad in found}


def compare_ends(rules: list[Rule], text: str) -> set[Fact]:
    """Compare goals for either end of `:up`, and for both; return the inferences of the rules."""
    asserted = graph(text)
    for end in ENDS:
        compare(rules, [(end,)], asserted)
    return {fact for fact in infer(rules, asserted) if fact[1] == UP}


def test_a_step_may_pass_a_literal() -> None:
    """The value passed along a recursion may be a literal, although no triple has it as subject."""
    rules = rules_of("RULE { ?x :up ?y } WHERE { ?x :p ?y } RULE { ?x :up ?z } WHERE { ?x :up ?y . ?z :p ?y }")
    assert (NODES[0], UP, NODES[1]) in compare_ends(rules, ":n0 :p 1 . :n1 :p 1 .")


def test_a_value_in_error_is_not_what_a_goal_asks_for() -> None:
    """A sum with an error leaves its variable unbound, so a demand does not bind it."""
    text = """PREFIX : <urn:> CONSTRUCT { ?x :up ?n } WHERE { SELECT ?x (SUM(?v) AS ?n) { ?x :p ?v } GROUP BY ?x }"""
    assert not compare_ends(list(read_text(text, Path("sum.rq"), "test/sum").rules), ":n0 :p :n1 .")


def test_a_variable_of_an_exists_is_not_one_behind_it() -> None:
    """A goal that binds a variable after EXISTS does not bind one of the same name inside."""
    x, y, w = (Variable(name) for name in "xyw")
    body = (Atom(x, P, w), Exists((Atom(x, NamedNode("urn:reach"), y),)), Atom(x, NamedNode("urn:q"), y))
    rules = [*rules_of(REACH), Rule("test/exists", (Atom(x, UP, y),), body, Place("r.srl"))]
    assert compare_ends(rules, ":n0 :p :n2 ; :q :n1 .")


def test_a_variable_predicate_does_not_match_auxiliary_triples() -> None:
    """Demands and stored recursive predicates are not part of the data."""
    rules = rules_of(f"{REACH} RULE {{ ?x :any ?y }} WHERE {{ ?x ?p ?y FILTER(?p NOT IN (:reach, :any)) }}")
    goals: list[Goal] = [(Atom(NODES[0], NamedNode(f"urn:{name}"), Variable("a")),) for name in ("reach", "any")]
    assert demanded(rules, goals).copies
    compare(rules, goals, graph(":n0 :reach :n3 ; :p :n1 . :n1 :p :n2 ; :reach :n4 ."))


def test_what_is_denied_is_derived_whole_through_other_rules() -> None:
    """A negation needs all possible matches of its pattern, including triples that rules derive on the way."""
    rules = rules_of(
        f"{REACH} RULE {{ ?x :far ?y }} WHERE {{ ?y :reach ?x }}"
        "RULE { ?x :up ?y } WHERE { ?x :q ?y NOT { ?y :far ?x } }"
    )
    assert not compare_ends(rules, ":n0 :q :n1 ; :p :n2 . :n2 :p :n1 .")


@pytest.mark.parametrize(
    "step",
    ["?x :p ?y . ?y :up ?z", "?x :up ?y . ?y :p ?z", "?x :up ?y . ?y :up ?z"],
    ids=["right", "left", "double"],
)
def test_one_end_of_a_long_chain_costs_no_closure(step: str) -> None:
    """Of the pairs along a chain, only those of the requested end are derived, in any form of the recursion."""
    length = 60
    nodes = [NamedNode(f"urn:n{number}") for number in range(length)]
    asserted: set[Fact] = {(one, P, other) for one, other in pairwise(nodes)}
    rules = rules_of(f"RULE {{ ?x :up ?y }} WHERE {{ ?x :p ?y }} RULE {{ ?x :up ?z }} WHERE {{ {step} }}")
    for goal in (Atom(nodes[0], UP, Variable("z")), Atom(Variable("x"), UP, nodes[-1])):
        assert len(on_demand(rules, [(goal,)], asserted)) == length - 1


def test_a_join_restricts_what_is_derived() -> None:
    """A stored triple of the goal, or rows, restrict one end of a derived one."""
    asserted = graph(":n0 :p :n1 . :n1 :p :n2 . :n2 :p :n3 . :n3 :p :n4 . :n3 :q :n0 .")
    rules = rules_of(REACH)
    reach = Atom(Variable("a"), NamedNode("urn:reach"), Variable("b"))
    by_triple: Goal = (Atom(Variable("a"), NamedNode("urn:q"), NODES[0]), reach)
    by_rows: Goal = (reach, Values((Variable("a"),), ((NODES[3],),)))
    assert (
        on_demand(rules, [by_triple], asserted)
        == on_demand(rules, [by_rows], asserted)
        == {(NODES[3], NamedNode("urn:reach"), NODES[4])}
    )


def test_nothing_is_derived_for_a_goal_that_no_rule_answers() -> None:
    """Goals about stored triples need no rule."""
    assert not demanded(rules_of(REACH), [(Atom(NODES[0], P, Variable("a")),)]).rules
