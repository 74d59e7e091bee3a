"""The ontologies shipped with `kg` as graphs of rdflib, read once for all tests and read-only.

Each worker reads them while it collects tests, so stores of pyoxigraph hold them, which takes a tenth of the time.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import pyoxigraph
from rdflib import BNode, Graph, Literal, URIRef
from rdflib.store import Store

from kg.graph.ontology_files import default_ontologies

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

__all__ = ["named", "together"]

_TEXT = "http://www.w3.org/2001/XMLSchema#string"


class _Kept(Store):
    """A store of rdflib over one of pyoxigraph."""

    def __init__(self, paths: Iterable[Path]) -> None:
        super().__init__()
        self._content = pyoxigraph.Store()
        for path in paths:
            self._content.load(path=path)

    def __len__(self, context: object = None) -> int:
        """Return the number of triples."""
        return len(self._content)

    def triples(
        self,
        triple_pattern: tuple[Any, Any, Any],
        context: object = None,  # noqa: ARG002 - of the interface
    ) -> Iterator[tuple[tuple[Any, Any, Any], Iterator[None]]]:
        """Yield the triples that match a pattern."""
        for quad in self._content.quads_for_pattern(*map(_without_rdflib, triple_pattern)):
            yield (_with_rdflib(quad.subject), _with_rdflib(quad.predicate), _with_rdflib(quad.object)), iter(())


@cache
def _with_rdflib(term: Any) -> Any:
    if isinstance(term, pyoxigraph.NamedNode):
        return URIRef(term.value)
    if isinstance(term, pyoxigraph.BlankNode):
        return BNode(term.value)
    kind = None if term.language or term.datatype.value == _TEXT else URIRef(term.datatype.value)
    return Literal(term.value, lang=term.language, datatype=kind, normalize=False)


@cache
def _without_rdflib(term: Any) -> Any:
    if term is None:
        return None
    if isinstance(term, Literal):
        kind = pyoxigraph.NamedNode(term.datatype) if term.datatype else None
        return pyoxigraph.Literal(str(term), language=term.language, datatype=kind)
    return (pyoxigraph.BlankNode if isinstance(term, BNode) else pyoxigraph.NamedNode)(str(term))


@cache
def named() -> dict[str, Graph]:
    """Return each ontology by its file name without the suffix."""
    return {path.stem: Graph(_Kept([path])) for path in default_ontologies()}


@cache
def together(beginning: str = "") -> Graph:
    """Return the triples of all ontologies whose names begin with a prefix."""
    return Graph(_Kept(path for path in default_ontologies() if path.stem.startswith(beginning)))
