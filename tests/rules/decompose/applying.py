"""One application of rules by the store's engine: derivations of parts, and of their original text."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, Quad, Store, Triple

from kg.rules.decompose import decompose
from kg.rules.form import AUXILIARY, Aggregate, Atom, Exists
from kg.rules.sparql import Placed, construct
from kg.syntax.parser import parse_rq

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.rules.form import Element, Rule

__all__ = ["applied", "read", "stated"]

_GRAPH: Final = NamedNode(AUXILIARY + "graph")
"""The graph of auxiliary triples, which hides them from patterns with any predicate."""


def read(text: str) -> tuple[Rule, ...]:
    """Return the rules of a CONSTRUCT query."""
    return decompose(parse_rq(text, "rule.rq").rules[0], "test/rule", "rule.rq", text)


def stated(quads: Iterable[Quad], text: str) -> set[Triple]:
    """Return the engine's own result of a CONSTRUCT query."""
    return _derived(_store(quads), text)


def applied(quads: Iterable[Quad], given: Iterable[Rule]) -> set[Triple]:
    """Return the derivations of rules in one application, after completing their auxiliary predicates."""
    store = _store(quads)
    every = [(_is_auxiliary(rule.head[0]), construct(replace(rule, body=_placed(rule.body)))) for rule in given]
    known: int = -1
    while known != (known := len(store)):
        for auxiliary, text in every:
            if auxiliary:
                store.extend(
                    Quad(triple.subject, triple.predicate, triple.object, _GRAPH) for triple in _derived(store, text)
                )
    return {triple for auxiliary, text in every if not auxiliary for triple in _derived(store, text)}


def _store(quads: Iterable[Quad]) -> Store:
    store = Store()
    store.extend(quads)
    return store


def _derived(store: Store, text: str) -> set[Triple]:
    found = store.query(text)
    return {triple for triple in found if isinstance(triple, Triple)}  # type: ignore[union-attr]  # CONSTRUCT


def _is_auxiliary(atom: Atom) -> bool:
    return isinstance(atom.predicate, NamedNode) and atom.predicate.value.startswith(AUXILIARY)


def _placed(body: tuple[Element, ...]) -> tuple[Element, ...]:
    return tuple(map(_element, body))


def _element(element: Element) -> Element:
    if isinstance(element, Exists | Aggregate):
        return replace(element, body=_placed(element.body))
    if isinstance(element, Atom) and _is_auxiliary(element):
        return Placed(*element.positions, graph=_GRAPH)
    return element
