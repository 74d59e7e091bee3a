from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, Triple
from rules.engine.comparing import inferred
from rules.engine.oracle import infer

from kg.errors import Place, RuleError
from kg.rules.engine import heads, matching, solve, tables
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Column,
    Exists,
    Expression,
    Filter,
    Rule,
    TripleTerm,
    Values,
    Variable,
    variables_of,
)
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Element, Pattern, Term

PREDICATES = [NamedNode(f"urn:p{number}") for number in range(5)]
NODES = [NamedNode(f"urn:n{number}") for number in range(4)]
STATEMENT = Triple(NODES[0], PREDICATES[0], NODES[1])
TERMS: list[Term] = [*NODES, BlankNode("b"), Literal(1), Literal(2), Literal("x"), *PREDICATES[::3], STATEMENT]
VARIABLES = [Variable(name) for name in "abcd"]
TESTS = [
    "?{0} = ?{1}",
    "?{0} != ?{1}",
    "sameTerm(?{0}, ?{1})",
    "isIRI(?{0})",
    "!isLiteral(?{0})",
    "?{0} < ?{1}",
    "STRLEN(STR(?{0})) > 5",
    "BOUND(?{0})",
    "?{0} IN (<urn:n1>, 1)",
    "(?{0} IN (<urn:n1>, <urn:n2>))",
    "?{0} NOT IN (<urn:n1>)",
    "!BOUND(?{0})",
    'STRSTARTS(STR(?{0}), "urn:n")',
    'REGEX(?{0}, "^x$")',
    "?{0} != <urn:n1>",
    "COALESCE(?{0} > 1, true)",
]
VALUES = ["?{0}", "IF(isIRI(?{0}), ?{1}, ?{0})", "<urn:n1>", "COALESCE(?{0} + 1, 2)", "?{0} + ?{1}", "STR(?{0})"]

facts = st.sets(
    st.tuples(
        st.sampled_from([*NODES, BlankNode("b"), PREDICATES[3]]), st.sampled_from(PREDICATES), st.sampled_from(TERMS)
    ),
    max_size=14,
)


def expression(draw: st.DrawFn, texts: list[str]) -> Expression:
    """Draw an expression over any two variables, bound or not."""
    names = [draw(st.sampled_from("abcd")) for _ in range(2)]
    text = draw(st.sampled_from(texts))
    used = dict.fromkeys(name for index, name in enumerate(names) if f"{{{index}}}" in text)
    return Expression(text.format(*names), tuple(used))


@st.composite
def patterns(draw: st.DrawFn) -> Atom:
    """Draw an atom of a body; one predicate in six is a variable."""
    subjects: list[Pattern] = [*VARIABLES, *VARIABLES, *NODES]
    variable: Variable = draw(st.sampled_from(VARIABLES))
    predicates: list[Pattern] = [*PREDICATES, variable]
    ends: list[Pattern] = [*VARIABLES, NODES[0]]
    inner = TripleTerm(draw(st.sampled_from(VARIABLES)), PREDICATES[0], draw(st.sampled_from(ends)))
    values: list[Pattern] = [*VARIABLES, *VARIABLES, *TERMS, inner, inner]
    subject, predicate, value = (draw(st.sampled_from(each)) for each in (subjects, predicates, values))
    return Atom(subject, predicate, value, asserted=draw(st.integers(0, 9)) == 0)


@st.composite
def bodies(draw: st.DrawFn, depth: int = 0) -> tuple[Element, ...]:
    """Draw a body: atoms first, then other elements, sometimes an atom at the end."""
    found: list[Element] = draw(st.lists(patterns(), min_size=1, max_size=3))
    for _ in range(draw(st.integers(0, 2))):
        found.append(draw(elements(tuple(found), depth)))
    if draw(st.booleans()):
        found.append(draw(patterns()))
    return tuple(found)


@st.composite
def elements(draw: st.DrawFn, before: tuple[Element, ...], depth: int) -> Element:
    """Draw an element that may follow others."""
    kind = draw(st.integers(0, 5 if depth < 2 else 2))
    bound = bound_by(before)
    if kind == 1 and set(VARIABLES) - bound:
        return Assignment(draw(st.sampled_from(sorted(set(VARIABLES) - bound, key=str))), expression(draw, VALUES))
    if kind == 2:
        variables = tuple(draw(st.lists(st.sampled_from(VARIABLES), min_size=1, max_size=2, unique=True)))
        rows = draw(st.lists(st.tuples(*(st.sampled_from(TERMS[:4] + TERMS[5:]) for _ in variables)), max_size=3))
        return Values(variables, tuple(rows))
    if kind in {3, 4}:
        return Exists(draw(bodies(depth + 1)), negated=kind == 3)
    if kind == 5:
        return draw(aggregates(depth))
    return Filter(expression(draw, TESTS))


@st.composite
def aggregates(draw: st.DrawFn, depth: int) -> Aggregate:
    """Draw an aggregate over a body of its own."""
    body = draw(bodies(depth + 1))
    bound = sorted(bound_by(body), key=str)
    keys = tuple(draw(st.lists(st.sampled_from(bound), max_size=2, unique=True))) if bound else ()
    function = draw(st.sampled_from(["COUNT", "COUNT", "SUM", "MIN", "MAX", "AVG", "SAMPLE", "GROUP_CONCAT"]))
    free = [variable for variable in VARIABLES if variable not in keys]
    assume(bool(free))
    value = expression(draw, VALUES) if function != "COUNT" or draw(st.booleans()) else None
    column = Column(draw(st.sampled_from(free)), function, value, distinct=draw(st.booleans()))
    return Aggregate(keys, (column,), body)


def bound_by(body: tuple[Element, ...]) -> set[Variable]:
    """Return the variables that a body binds."""
    found: set[Variable] = set()
    for element in body:
        if isinstance(element, Atom):
            found |= {variable for position in element.positions for variable in variables_of(position)}
        elif isinstance(element, Assignment):
            found.add(element.variable)
        elif isinstance(element, Values):
            found |= set(element.variables)
        elif isinstance(element, Aggregate):
            found |= {*element.keys, *(column.variable for column in element.columns)}
    return found


@st.composite
def rule_sets(draw: st.DrawFn) -> list[Rule]:
    """Draw rules that can be stratified and create no terms in recursion."""
    found = []
    for number in range(draw(st.integers(1, 4))):
        body = draw(bodies())
        bound = sorted(bound_by(body), key=str)
        terms: list[Pattern] = [*bound, *bound, *NODES[:2]]
        predicates: list[Pattern] = [*PREDICATES, *bound[:1]]
        blank: list[Pattern] = [BlankNode("new")]
        head = tuple(
            Atom(draw(st.sampled_from(terms)), draw(st.sampled_from(predicates)), draw(st.sampled_from(terms + blank)))
            for _ in range(draw(st.integers(1, 2)))
        )
        found.append(Rule(f"test/r{number}", head, body, Place("r.rq")))
    return found


def compare(rules: list[Rule], asserted: set[Fact]) -> None:
    """Compare the engine with the naive evaluation; rules that cannot be stratified are skipped."""
    try:
        stratify(rules)
    except RuleError:
        assume(condition=False)
    assert inferred(rules, asserted) == infer(rules, asserted)


@settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
@given(rule_sets(), facts)
def test_the_engine_infers_what_the_naive_evaluation_does(rules: list[Rule], asserted: set[Fact]) -> None:
    """Any rules over any triples: the same triples, including those with new blank nodes."""
    compare(rules, asserted)


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(rule_sets(), facts)
def test_the_sizes_at_which_the_engine_takes_other_ways_do_not_matter(rules: list[Rule], asserted: set[Fact]) -> None:
    """Joins in pieces of two rows, rows always made distinct, indexes always used: the same triples."""
    with pytest.MonkeyPatch.context() as patch:
        for module in (tables, matching, solve):
            patch.setattr(module, "CHUNK", 2)
        patch.setattr(solve, "_DEDUPLICATE", 0)
        patch.setattr(solve, "_SEED", 1)
        patch.setattr(solve, "_COUNTED", 0)
        patch.setattr(solve, "_GAIN", 0)
        patch.setattr(tables, "_MANY", 0)
        patch.setattr(matching, "_MANY", 0)
        patch.setattr(matching, "_DENSE", 1 << 20)
        patch.setattr(heads, "_PIECES", 0)
        compare(rules, asserted)
