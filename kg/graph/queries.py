"""Helpers for modules that read the graph: SELECT over the union of all graphs, and VALUES lists."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pyoxigraph import NamedNode

from kg.graph.ntriples import literal
from kg.graph.vocabulary import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.graph.reading import Queryable


def select(graph: Queryable, text: str) -> Iterable[Any]:
    """Return the rows of a SELECT over the union of all graphs; the prefixes are those of `kg.graph.vocabulary`."""
    rows: Iterable[Any] = graph.query(text, prefixes=PREFIXES)
    return rows


def texts(graph: Queryable, text: str) -> Iterator[Any]:
    """Yield the rows of a SELECT as tuples of IRIs and texts, with None for unbound variables."""
    for row in select(graph, text):
        yield tuple(None if term is None else term.value for term in row)


def column(graph: Queryable, text: str) -> set[str]:
    """Return the values in the first column of a SELECT."""
    return {row[0].value for row in select(graph, text)}


def one_of(variable: str, words: Iterable[str]) -> str:
    """Return a VALUES pattern that binds a variable, named without its sign, to each of some texts."""
    return f"VALUES ?{variable} {{ {' '.join(map(literal, sorted(set(words))))} }}"


def among(variable: str, iris: Iterable[str]) -> str:
    """Return the same for IRIs; ValueError for an invalid one."""
    return f"VALUES ?{variable} {{ {' '.join(str(NamedNode(iri)) for iri in sorted(set(iris)))} }}"
