"""Rule sets that fire: few nodes and predicates, in layers, so most changes affect inferences.

Layer `n` derives `:dn`. Rules read the layers up to their own, and negate or count the layers below it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode
from rules.forms import expression
from rules.forms import test as keep

from kg.errors import Place
from kg.rules.form import Aggregate, Assignment, Atom, Column, EngineBlock, Exists, Rule, Variable

if TYPE_CHECKING:
    from rules.engine.oracle import Fact

    from kg.rules.form import Element, Pattern

__all__ = ["by_class", "classified", "facts", "layered"]

_NODES = [NamedNode(f"urn:x:n{number}") for number in range(3)]
_ASSERTED = [NamedNode("urn:x:p"), NamedNode("urn:x:q")]
_DERIVED = [NamedNode(f"urn:x:d{number}") for number in range(5)]
_IS = NamedNode("urn:x:is")
_CLASSES = [NamedNode(f"urn:x:c{number}") for number in range(9)]
_A, _B, _C, _E, _N = (Variable(name) for name in "abcen")
_FEW = [Literal(1), Literal(2)]


def facts(least: int, most: int) -> st.SearchStrategy[set[Fact]]:
    """Yield triples: mostly of asserted-only predicates, sometimes with a number as object."""
    predicates = st.sampled_from([*_ASSERTED, *_ASSERTED, *_ASSERTED, *_DERIVED[:3]])
    values = st.sampled_from([*_NODES, *_NODES, *_NODES, *_FEW])
    return st.sets(st.tuples(st.sampled_from(_NODES), predicates, values), min_size=least, max_size=most)


@st.composite
def layered(draw: st.DrawFn) -> list[Rule]:
    """Draw two to six rules."""
    count = draw(st.integers(2, 6))
    return [_rule(draw, number, draw(st.integers(0, 4))) for number in range(count)]


def classified(least: int, most: int) -> st.SearchStrategy[set[Fact]]:
    """Yield triples with the classes and links of entities."""
    classes = st.tuples(st.sampled_from(_NODES), st.just(_IS), st.sampled_from(_CLASSES[:6]))
    links = st.tuples(st.sampled_from(_NODES), st.sampled_from(_ASSERTED), st.sampled_from(_NODES))
    return st.sets(st.one_of(classes, classes, links), min_size=least, max_size=most)


@st.composite
def by_class(draw: st.DrawFn) -> list[Rule]:
    """Draw four to nine rules that derive classes from subclasses: a change affects few of them."""
    return [_of_class(draw, number, draw(st.integers(3, 8))) for number in range(draw(st.integers(4, 9)))]


def _of_class(draw: st.DrawFn, number: int, layer: int) -> Rule:
    lower = st.sampled_from(_CLASSES[:layer])
    recursive = draw(st.integers(0, 3)) == 0
    body: list[Element] = [Atom(_A, _IS, _CLASSES[layer] if recursive else draw(lower))]
    kind = draw(st.integers(0, 5))
    if kind == 0 or recursive:
        body.append(Atom(_A, draw(st.sampled_from(_ASSERTED)), _B))
    if kind == 1:
        body.append(Exists((Atom(_A, _IS, draw(lower)),), negated=True))
    if kind == 2:
        apart = (Atom(_A, _ASSERTED[0], _E), Atom(_B, _ASSERTED[0], _C), keep("?e != ?c"))
        body += [Atom(_A, _ASSERTED[1], _B), Exists(apart, negated=draw(st.booleans()))]
    if kind == 3:
        body.append(Aggregate((_A,), (_column(draw),), (Atom(_A, _ASSERTED[0], _E), Atom(_E, _IS, draw(lower)))))
    head: Pattern = _B if recursive else _A
    minted = kind == 4 and layer == 8 and not recursive
    made: Pattern = BlankNode("new") if minted else _CLASSES[layer]
    return Rule(f"test/r{number}", (Atom(head, _IS, made),), tuple(body), Place("r.srl"))


def _rule(draw: st.DrawFn, number: int, layer: int) -> Rule:
    body: list[Element] = [_atom(draw, layer, _A, _B)]
    if draw(st.booleans()):
        body.append(_atom(draw, layer, _B, _C))
    body += [_more(draw, layer) for _ in range(draw(st.integers(0, 2)))]
    bound = {variable for element in body for variable in _bound(element)}
    names: list[Pattern] = sorted(bound, key=str)
    subject = draw(st.sampled_from([_A, *names, _NODES[0]]))
    value = draw(st.sampled_from([*names, _NODES[1]]))
    if layer == 4 and draw(st.integers(0, 3)) == 0:
        value = BlankNode("new")
    return Rule(f"test/r{number}", (Atom(subject, _DERIVED[layer], value),), tuple(_once(body)), Place("r.srl"))


def _once(body: list[Element]) -> list[Element]:
    """Omit elements that would rebind an assigned or aggregated variable."""
    found: list[Element] = []
    for element in body:
        if isinstance(element, Assignment | Aggregate) and any(isinstance(e, Assignment | Aggregate) for e in found):
            continue
        found.append(element)
    return found


def _bound(element: Element) -> set[Variable]:
    if isinstance(element, Atom):
        return {position for position in element.positions if isinstance(position, Variable)} - {_E}
    if isinstance(element, Assignment | Aggregate):
        return {_N}
    return set()


def _predicate(draw: st.DrawFn, layer: int) -> Pattern:
    chosen: Pattern = draw(st.sampled_from([*_ASSERTED, *_DERIVED[:layer]]))
    return chosen


def _atom(draw: st.DrawFn, layer: int, subject: Variable, value: Variable) -> Atom:
    anything = layer == 4 and draw(st.integers(0, 5)) == 0
    predicate: Pattern = _E if anything else _predicate(draw, layer + 1)
    values: list[Pattern] = [value, value, value, value, _NODES[2]]
    target: Pattern = draw(st.sampled_from(values))
    return Atom(subject, predicate, target, asserted=draw(st.integers(0, 7)) == 0)


def _more(draw: st.DrawFn, layer: int) -> Element:
    kind = draw(st.integers(0, 6))
    if kind == 0:
        return keep(draw(st.sampled_from(["?a != ?b", "?a = ?b || ?b = <urn:x:n1>", "isIRI(?b)"])))
    if kind == 1:
        return Assignment(_N, expression(draw(st.sampled_from(["IF(isIRI(?b), ?a, ?b)", "STR(?a)", "?b = 1"]))))
    if kind == 2:
        return Aggregate((_A,), (_column(draw),), _inner(draw, layer, _A))
    if kind == 3:
        return _block(draw, layer)
    return Exists(_inner(draw, layer, draw(st.sampled_from([_A, _B]))), negated=kind != 4)


def _column(draw: st.DrawFn) -> Column:
    function = draw(st.sampled_from(["COUNT", "SUM", "MIN", "MAX"]))
    return Column(_N, function, expression("?e"), distinct=draw(st.booleans()))


def _inner(draw: st.DrawFn, layer: int, outer: Variable) -> tuple[Element, ...]:
    """Draw a body on lower layers that joins the surrounding one in the variable `outer`."""
    found: list[Element] = [Atom(outer, _predicate(draw, layer), _E, asserted=draw(st.integers(0, 7)) == 0)]
    if draw(st.integers(0, 2)) == 0:
        values: list[Pattern] = [outer, Variable("f"), *_NODES[:2]]
        target: Pattern = draw(st.sampled_from(values))
        found.append(Atom(_E, _predicate(draw, layer), target))
    if draw(st.integers(0, 3)) == 0:
        found.append(keep("?e != ?a"))
    if draw(st.integers(0, 2)) == 0:
        found.append(Exists((Atom(_E, _predicate(draw, layer), Variable("g")),), negated=draw(st.booleans())))
    return tuple(found)


def _block(draw: st.DrawFn, layer: int) -> EngineBlock:
    first, second = (_predicate(draw, layer) for _ in range(2))
    text = f"?a {first}/{second}* ?m"
    names = frozenset(each for each in (first, second) if isinstance(each, NamedNode))
    return EngineBlock(text, (_A, Variable("m")), reads=names, monotone=draw(st.booleans()))
