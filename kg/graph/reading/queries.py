"""Helpers for modules that read the graph: SELECT over the union of all graphs, and VALUES lists."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from pyoxigraph import NamedNode

from kg.graph.ntriples import literal
from kg.graph.vocabulary import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.store.interface import Queryable


@runtime_checkable
class Texts(Protocol):
    """A graph that answers with texts, and has whole graphs at hand: the columns of a store (`kg.rules.selecting`)."""

    def texts(self, text: str, *, prefixes: Mapping[str, str]) -> Iterator[Any]:
        """Yield the rows of a SELECT as `values` does."""
        ...

    def grouped(self, text: str, *, prefixes: Mapping[str, str]) -> dict[str, dict[str, list[str]]] | None:
        """Return the rows of a SELECT of three variables as `grouped` does; None if only `texts` has them."""
        ...

    def properties(self, graph: str) -> dict[str, dict[str, list[str]]]:
        """Return the properties of each subject of a graph, as `grouped` does."""
        ...


def select(graph: Queryable, text: str) -> Iterable[Any]:
    """Return the rows of a SELECT over the union of all graphs; the prefixes are those of `kg.graph.vocabulary`."""
    rows: Iterable[Any] = graph.query(text, prefixes=PREFIXES)
    return rows


def texts(graph: Queryable, text: str) -> Iterator[Any]:
    """Yield the rows of a SELECT as `values` does."""
    return graph.texts(text, prefixes=PREFIXES) if isinstance(graph, Texts) else values(select(graph, text))


def values(rows: Iterable[Any]) -> Iterator[Any]:
    """Yield rows of terms as tuples of IRIs and texts, with None for unbound variables."""
    for row in rows:
        yield tuple(None if term is None else term.value for term in row)


def properties_in(graph: Queryable, text: str) -> dict[str, dict[str, list[str]]]:
    """Return the properties of each subject that a SELECT has in its three columns; the keys of properties are IRIs."""
    found = graph.grouped(text, prefixes=PREFIXES) if isinstance(graph, Texts) else None
    return grouped(texts(graph, text)) if found is None else found


def grouped(rows: Iterable[tuple[str, str, str]]) -> dict[str, dict[str, list[str]]]:
    """Return the properties of each subject from rows of texts; the keys of properties are IRIs."""
    found: dict[str, dict[str, list[str]]] = {}
    for subject, predicate, value in rows:
        found.setdefault(subject, {}).setdefault(predicate, []).append(value)
    return found


def column(graph: Queryable, text: str) -> set[str]:
    """Return the values in the first column of a SELECT."""
    return {row[0].value for row in select(graph, text)}


def one_of(variable: str, words: Iterable[str]) -> str:
    """Return a VALUES pattern that binds a variable, named without its sign, to each of some texts."""
    return f"VALUES ?{variable} {{ {' '.join(map(literal, sorted(set(words))))} }}"


def among(variable: str, iris: Iterable[str]) -> str:
    """Return the same for IRIs; ValueError for an invalid one."""
    return f"VALUES ?{variable} {{ {' '.join(str(NamedNode(iri)) for iri in sorted(set(iris)))} }}"
