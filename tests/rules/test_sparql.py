from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, QueryBoolean, Store
from pyoxigraph import Variable as Name

from kg.errors import Place, RuleError
from kg.rules.form import Aggregate, Assignment, Atom, Column, Exists, Expression, Filter, Rule, Values, Variable
from kg.rules.sparql import construct, group, select, spelling, substitutions

if TYPE_CHECKING:
    from collections.abc import Iterable

X, Y, Z, N = (Variable(name) for name in "xyzn")
P, Q, H = (NamedNode(f"urn:{name}") for name in "pqh")
A, B, C = (NamedNode(f"urn:{name}") for name in "abc")
GRAPH: Final = NamedNode("urn:inferred")


@pytest.fixture
def store() -> Store:
    """Return a small graph, with one triple in a graph of its own."""
    made = Store()
    made.extend([Quad(A, P, B), Quad(B, P, C), Quad(A, Q, C), Quad(C, Q, Literal(2)), Quad(B, Q, C, GRAPH)])
    return made


def rows(store: Store, text: str, names: str = "xyz", **options: bool) -> set[tuple[object, ...]]:
    """Return the solutions of a query, projected to its variables."""
    found = store.query(text, use_default_graph_as_union=options.get("union", False))
    columns = [name for name in names if f"?{name} " in text.split("WHERE", maxsplit=1)[0]]
    return {tuple(solution[name] for name in columns) for solution in found}  # type: ignore[union-attr]  # SELECT


def count(found: Iterable[object] | QueryBoolean) -> int:
    """Return the number of solutions or triples of a query."""
    assert not isinstance(found, QueryBoolean)
    return len(list(found))


def test_a_filter_sees_only_what_stands_before_it(store: Store) -> None:
    """A variable of NOT that a later element binds is a different one in the body, and in the text."""
    body = (Atom(X, P, Y), Exists((Atom(Y, Q, Z),), negated=True), Atom(A, Q, Z))
    assert rows(store, select(body, (X, Z))) == {(A, C)}
    assert group(body).startswith("{")


def test_an_assignment_in_error_takes_its_solution_away(store: Store) -> None:
    """BIND alone would keep the solution without a value."""
    body = (Atom(X, Q, Y), Assignment(Z, Expression("?y + 1", ("y",))))
    assert rows(store, select(body, (X, Z))) == {(C, Literal(3))}


@pytest.mark.parametrize(
    ("body", "variables", "bindings", "expected"),
    [
        ((Atom(X, P, Y), Atom(Y, P, Z)), (X, Z), {Y: B}, {(A, C)}),
        ((Atom(X, P, Y), Filter(Expression("?y != <urn:b>", ("y",)))), (X, Y), {Y: B}, set()),
        ((Atom(X, Q, Y), Assignment(Z, Expression("?y + 1", ("y",)))), (X, Z), {Z: Literal(3)}, {(C, Literal(3))}),
        ((Atom(X, P, Y), Exists((Atom(Y, P, Z),))), (X, Y), {X: A}, {(A, B)}),
        ((Atom(X, P, Y), Values((Y,), ((B,), (C,)))), (X, Y), {Y: C}, {(B, C)}),
        ((Aggregate((X,), (Column(N, "COUNT", None),), (Atom(X, P, Y),)),), (X,), {X: B}, {(B,)}),
    ],
)
def test_bindings_cut_the_solutions_down(
    store: Store,
    body: tuple[Atom, ...],
    variables: tuple[Variable, ...],
    bindings: dict[Variable, NamedNode | Literal],
    expected: set[tuple[object, ...]],
) -> None:
    """The query has only the solutions of the body with these values."""
    assert rows(store, select(body, variables, bindings)) == expected


def test_bindings_to_blank_nodes_are_for_the_engine(store: Store) -> None:
    """SPARQL cannot express a blank node of the data, so the engine takes it as a substitution."""
    blank = BlankNode("b")
    store.extend([Quad(blank, P, A), Quad(BlankNode("other"), P, A)])
    bindings = {Variable(".x"): blank}
    text = select((Atom(Variable(".x"), P, Y),), (Variable(".x"), Y), bindings)
    given = {Name(name): value for name, value in substitutions(bindings).items()}
    found = store.query(text, substitutions=given)
    assert count(found) == 1
    with pytest.raises(RuleError, match="blank node"):
        group((Atom(blank, P, Y),))


def test_asserted_atoms_are_written_as_asked_for(store: Store) -> None:
    """They are restricted to the graph without inferences, or written like any other."""
    body = (Atom(X, Q, C, asserted=True),)
    assert rows(store, select(body, (X,)), union=True) == {(A,), (B,)}
    assert rows(store, select(body, (X,), inferred=GRAPH), union=True) == {(A,)}


def test_a_blank_node_of_a_head_is_new_once_for_each_solution(store: Store) -> None:
    """The query creates as many as the body has solutions."""
    rule = Rule("a/b", (Atom(BlankNode("n"), H, X),), (Atom(X, P, Y),), Place("a/b.rq"))
    assert count(store.query(construct(rule))) == 2


def test_different_variables_are_spelt_differently() -> None:
    """Generated names never clash with those of a rule."""
    names = [".x", "x", "_·x", "_··_·x", ".x-y", ".x.y", ".xy", ".·x"]
    assert len({spelling(Variable(name)) for name in names}) == len(names)
