"""Queries of the readings of the graph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.graph.vocabulary import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.reading import Queryable


def select(graph: Queryable, text: str) -> Iterable[Any]:
    """Return the rows of a SELECT over the union of all graphs; the prefixes are those of `kg.graph.vocabulary`."""
    rows: Iterable[Any] = graph.query(text, prefixes=PREFIXES)
    return rows
