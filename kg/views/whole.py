"""Queries that were typed and concern the whole store, answered from its columns (`kg.rules.selecting`)."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from kg.lazily import lazily
from kg.query.result import Row, Solutions
from kg.query.runner import in_thread
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

with lazily():
    from kg.rules.selecting import Columns, columns_of

__all__ = ["answer"]

_BYTES: Final = 2 << 20  # with smaller columns the store answers anything sooner than they are loaded


def answer(
    snapshot: EmbeddedSnapshot, text: str, *, timeout: float | None = None, limit: int | None = None
) -> Solutions | None:
    """Return the answer to a query; None where the store answers as fast, or it alone can. Raises as `in_thread`."""
    if snapshot.layout is None or "DISTINCT" not in text.upper():
        return None
    columns = snapshot.layout.cache / "columns"
    if not columns.is_dir() or sum(path.stat().st_size for path in columns.iterdir()) < _BYTES:
        return None

    def find() -> tuple[tuple[str, ...], list[Row]] | None:
        columns = columns_of(snapshot)
        return columns.answer(text, prefixes=PREFIXES) if isinstance(columns, Columns) else None

    began = time.perf_counter()
    result = in_thread(find, timeout)
    if result is None:
        return None
    names, rows = result
    cut = limit if limit is not None and len(rows) > limit else None
    return Solutions(names, tuple(rows[:limit]), time.perf_counter() - began, snapshot.identity, cut)
