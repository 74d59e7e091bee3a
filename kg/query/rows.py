"""Rows of internal queries as strings, without guards or deadline, as the text does not come from a user."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.store.interface import Snapshot


def rows(snapshot: Snapshot, text: str, *, union: bool = False) -> Iterator[Any]:
    """Yield the rows of a SELECT as tuples of IRIs and strings; None if unbound.

    The known prefixes (`kg.syntax.names`) need no declaration. Without `union` the default graph is empty, and patterns
    name their graphs: joins over the union of all graphs cost many times as much.
    """
    for row in snapshot.query(text, prefixes=PREFIXES, union=union):  # type: ignore[union-attr]  # a SELECT
        yield tuple(term.value if term is not None else None for term in row)
