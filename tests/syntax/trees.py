"""Random syntax trees."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from hypothesis import strategies as st
from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Triple
from syntax.printing import NOWHERE

from kg.rules.form import TripleTerm, Variable
from kg.syntax import tree
from kg.syntax.tree import visible

__all__ = ["groups", "templates"]

IRIS = st.sampled_from([NamedNode(f"http://example.org/{name}") for name in ("a", "b%20", "é", "x.y", "#", "?q=1")])
NAMES = st.sampled_from([Variable(name) for name in ("a", "b", "c", "été", "_1", "1x")])
LITERALS = st.one_of(
    st.text(st.characters(exclude_categories=["Cs"]), max_size=6).map(Literal),
    st.sampled_from([Literal(1), Literal(-2.5), Literal(True), Literal("x", language="en-gb")]),
    st.just(Literal("x", language="ar", direction=BaseDirection.RTL)),
    st.builds(lambda value, kind: Literal(value, datatype=kind), st.text("ab\"'\\\n", max_size=4), IRIS),
)
GROUND = st.one_of(IRIS, LITERALS, st.builds(Triple, IRIS, IRIS, LITERALS))


def _positions(nodes: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    inner = st.one_of(nodes, IRIS)
    # A term without variables is the engine's own triple term, so this one has a variable.
    return st.one_of(
        nodes, IRIS, LITERALS, st.builds(TripleTerm, NAMES, IRIS, inner), st.builds(Triple, IRIS, IRIS, LITERALS)
    )


def _triples(
    nodes: st.SearchStrategy[Any], predicates: st.SearchStrategy[Any]
) -> st.SearchStrategy[tree.TriplePattern]:
    positions = _positions(nodes)
    return st.builds(tree.TriplePattern, positions, predicates, positions, st.just(NOWHERE))


LABELS = st.sampled_from([BlankNode("x"), BlankNode("y.z")])
templates = st.lists(_triples(st.one_of(NAMES, LABELS), st.one_of(IRIS, NAMES)), max_size=4).map(tuple)


def _negated(forward: list[NamedNode], backward: list[NamedNode]) -> tree.Negated:
    return tree.Negated(tuple(forward), tuple(backward))


def _extended(paths: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    parts = st.lists(paths, min_size=2, max_size=3).map(tuple)
    kinds = st.sampled_from([(0, True), (1, True), (0, False)])
    return st.one_of(
        st.builds(tree.Inverse, paths),
        st.builds(tree.Sequence, parts),
        st.builds(tree.Alternative, parts),
        st.builds(lambda path, kind: tree.Repeat(path, *kind), paths, kinds),
    )


PATHS = st.recursive(
    st.one_of(IRIS, st.builds(_negated, st.lists(IRIS, min_size=1, max_size=2), st.lists(IRIS, max_size=2))),
    _extended,
    max_leaves=5,
)
TRIPLES = _triples(NAMES, st.one_of(PATHS, NAMES))


def _expression(text: str, variable: Variable) -> tree.Expression:
    return tree.Expression(text.format(variable.name), (variable.name,), NOWHERE)


EXPRESSIONS = st.builds(
    _expression,
    st.sampled_from(
        [
            "?{0}",
            "?{0} < 3 && !(?{0} = <http://example.org/a>)",
            "CONCAT(STR(?{0}), \"(<\", 'x') IN (?{0}, 1)",
            "<http://example.org/f>(?{0} - 1) || true",
            "- ?{0} * (-2 / ?{0})",
        ]
    ),
    NAMES,
)


@st.composite
def groups(draw: st.DrawFn, depth: int = 0) -> tree.Group:
    """Draw a group whose assignments bind new variables."""
    nodes: list[tree.Node] = []
    for _ in range(draw(st.integers(0, 3))):
        nodes.append(draw(_node(tuple(nodes), depth)))
    return tree.Group(tuple(nodes), NOWHERE)


@st.composite
def _node(draw: st.DrawFn, before: tuple[tree.Node, ...], depth: int) -> tree.Node:
    kind = draw(st.sampled_from(["triple", "filter", "values", "bind", *(["inner"] * 3 if depth < 2 else [])]))
    if kind == "filter":
        expression = draw(EXPRESSIONS)
        return tree.Filter(replace(expression, text=f"({expression.text})"), NOWHERE)
    if kind == "values":
        return draw(_tables())
    free = [name for name in "abc" if name not in visible(before)]
    if kind == "bind" and free:
        return tree.Bind(Variable(draw(st.sampled_from(free))), draw(EXPRESSIONS), NOWHERE)
    return draw(_inner(depth)) if kind == "inner" else draw(TRIPLES)


@st.composite
def _tables(draw: st.DrawFn) -> tree.ValuesBlock:
    variables = draw(st.lists(NAMES, max_size=2, unique=True))
    row: st.SearchStrategy[Any] = st.tuples(*(st.one_of(GROUND, st.none()) for _ in variables))
    return tree.ValuesBlock(tuple(variables), tuple(draw(st.lists(row, max_size=2))), NOWHERE)


@st.composite
def _inner(draw: st.DrawFn, depth: int) -> tree.Node:
    group = draw(groups(depth + 1))
    kind = draw(st.sampled_from([tree.Optional, tree.Minus, tree.Union, tree.GraphBlock, tree.Exists, tree.SubSelect]))
    if kind is tree.Union:
        others = draw(st.lists(groups(depth + 1), max_size=1))
        if not others and len(group.nodes) == 1 and isinstance(group.nodes[0], tree.SubSelect):
            return group.nodes[0]  # `{ SELECT ... }` is a sub-SELECT, not a group with one
        return tree.Union((group, *others), NOWHERE)
    if kind is tree.GraphBlock:
        return tree.GraphBlock(draw(st.one_of(IRIS, NAMES)), group, NOWHERE)
    if kind is tree.Exists:
        return tree.Exists(group, draw(st.booleans()), asserted=False, span=NOWHERE)
    if kind is tree.SubSelect:
        return _select(draw, group)
    return tree.Optional(group, NOWHERE) if kind is tree.Optional else tree.Minus(group, NOWHERE)


def _select(draw: st.DrawFn, group: tree.Group) -> tree.SubSelect:
    names = draw(st.lists(NAMES, max_size=2, unique=True))
    distinct, sliced, grouped = draw(st.tuples(st.booleans(), st.booleans(), st.booleans()))
    columns: list[tree.Projection] = [tree.Projection(name, None) for name in names]
    keys = tuple(columns) if grouped else ()
    if keys and "new" not in visible(group.nodes):
        counted = tree.Expression("?a + 1", ("a",), NOWHERE)
        call = tree.AggregateCall("SUM", counted, True, " ", NOWHERE, "SUM(DISTINCT ?a + 1)")
        whole = tree.Expression("SUM(DISTINCT ?a + 1) * 2", (), NOWHERE, aggregates=(call,))
        columns.append(tree.Projection(Variable("new"), whole))
    return tree.SubSelect(tuple(columns), distinct, group, keys, (), sliced, NOWHERE)
