"""What a query answers: rows, yes or no, or a graph."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.store.terms import Term

    Row: TypeAlias = tuple[Term | None, ...]

__all__ = ["Boolean", "Graph", "Result", "Solutions"]


@dataclass(frozen=True, slots=True)
class Solutions:
    """The answer of SELECT: a row has a term, or None where it is unbound, for each of the `variables`.

    `limit` is set when more rows were there than it allowed. `seconds` is the time of the query, `snapshot` the
    identity of the data that it was asked of; both for the other answers too.
    """

    variables: tuple[str, ...]
    rows: tuple[Row, ...]
    seconds: float
    snapshot: str
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Boolean:
    """The answer of ASK."""

    value: bool
    seconds: float
    snapshot: str
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Graph:
    """The answer of CONSTRUCT and DESCRIBE, each triple once."""

    triples: tuple[Triple, ...]
    seconds: float
    snapshot: str
    limit: int | None = None


Result: TypeAlias = Solutions | Boolean | Graph
