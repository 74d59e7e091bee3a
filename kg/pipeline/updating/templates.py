"""Templates of quads with variables, filled with the solutions of a WHERE (SPARQL 1.1 Update, section 3.1.3).

The engine parses a template: each variable is replaced by an unguessable IRI, and the text is inserted, as data, into
an empty store.
"""

from __future__ import annotations

import secrets
from typing import TYPE_CHECKING, Any, Final

import pyoxigraph
from pyoxigraph import BlankNode, DefaultGraph, NamedNode, Quad, Triple

from kg.syntax.lexer import Kind
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.pipeline.updating.operations import Part

_MARK: Final = f"urn:kg:{secrets.token_hex(16)}:"
_RESOURCE: Final = (NamedNode, BlankNode)


def data(prologue: str, quads: str) -> list[Quad]:
    """Return the quads that `INSERT DATA` would insert; blank nodes are new ones."""
    store = pyoxigraph.Store()
    store.update(f"{prologue} INSERT DATA {{ {quads}\n}}", prefixes=dict(PREFIXES))
    return list(store)


def iris(prologue: str, names: Iterable[str]) -> list[NamedNode]:
    """Return the IRIs of names as written in the text (in full or with a prefix)."""
    nodes = []
    for name in names:
        (quad,) = data(prologue, f"<{_MARK}> <{_MARK}> {name}")
        nodes.append(quad.object)
    return nodes  # type: ignore[return-value]  # the grammar has nothing but IRIs there


class Template:
    """Template of a DELETE or an INSERT; `graph` is the graph of quads that do not name one.

    `variables` contains its variables in the order of the values for `fill`; `fresh` is whether each solution creates
    blank nodes.
    """

    def __init__(self, prologue: str, part: Part, text: str, graph: NamedNode | DefaultGraph) -> None:
        self.variables = sorted({token.text[1:] for token in part.tokens if token.kind is Kind.VARIABLE})
        numbers = {name: number for number, name in enumerate(self.variables)}
        self._slots: dict[Any, int] = {NamedNode(f"{_MARK}{number}"): number for number in numbers.values()}
        self._quads = data(prologue, _marked(part, text, numbers))
        self._graph = graph
        self.fresh = any(isinstance(term, BlankNode) for quad in self._quads for term in _terms(quad.triple))

    def fill(self, values: Sequence[Any]) -> Iterator[Quad]:
        """Yield the quads for one solution; invalid RDF and quads with unbound variables are left out."""
        fresh: dict[Any, BlankNode] = {}
        for quad in self._quads:
            subject = self._value(quad.subject, values, fresh)
            predicate = self._value(quad.predicate, values, fresh)
            value = self._value(quad.object, values, fresh)
            graph = quad.graph_name
            graph = self._graph if isinstance(graph, DefaultGraph) else self._value(graph, values, fresh)
            sound = isinstance(subject, _RESOURCE) and isinstance(predicate, NamedNode) and value is not None
            if sound and isinstance(graph, NamedNode | DefaultGraph):
                yield Quad(subject, predicate, value, graph)

    def _value(self, term: Any, values: Sequence[Any], fresh: dict[Any, BlankNode]) -> Any:
        """Return the value of a term of the template; None if unbound."""
        if isinstance(term, BlankNode):
            return fresh.setdefault(term, BlankNode())
        if isinstance(term, Triple):
            parts = [self._value(part, values, fresh) for part in (term.subject, term.predicate, term.object)]
            sound = isinstance(parts[0], _RESOURCE) and isinstance(parts[1], NamedNode) and parts[2] is not None
            return Triple(*parts) if sound else None
        number = self._slots.get(term)
        return term if number is None else values[number]


def _marked(part: Part, text: str, numbers: dict[str, int]) -> str:
    """Return the text of a template with an IRI in place of each variable."""
    pieces = []
    at = part.begin
    for token in part.tokens:
        if token.kind is Kind.VARIABLE:
            pieces += [text[at : token.start], f"<{_MARK}{numbers[token.text[1:]]}>"]
            at = token.end
    return "".join([*pieces, text[at : part.end]])


def _terms(triple: Triple) -> Iterator[Any]:
    for term in (triple.subject, triple.object):
        if isinstance(term, Triple):
            yield from _terms(term)
        else:
            yield term
