"""Look-ups: queries so small that the server answers them in its own process, without a reader.

A look-up is an ASK or a SELECT with a single triple pattern, no repeated variable, and nothing else but a LIMIT. Each
quad that the engine reads is a row, so a limit on rows also limits the work. It needs no deadline, no memory limit and
no process of its own. It has no nesting and no escapes, and calls no server. Readers answer everything else, including
look-ups with many rows, large terms or errors.
"""

from __future__ import annotations

import asyncio
import re
import time
from contextlib import suppress
from itertools import islice
from typing import TYPE_CHECKING, Final, cast

from pyoxigraph import Triple

from kg.errors import KgError
from kg.query.evaluation import Evaluation, evaluation_of, prefixes_in
from kg.query.formats import BOOLEAN_FORMATS, SOLUTION_FORMATS, write_boolean, write_rows
from kg.query.readers.cache import CachedResponse
from kg.query.readers.messages import End, Head, Question
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.query.result import Row
    from kg.store.layout import Layout

_CHARS: Final = 2048
"""Longer queries are not considered."""
_ROWS: Final = 256
"""Readers answer look-ups with more rows."""
_VALUE_CHARS: Final = 64 << 10
"""Readers answer look-ups whose terms have more characters in all."""

# All quantifiers are possessive: matching takes linear time, because it blocks the event loop of the server.
_GAP: Final = r"(?:[ \t\r\n]++|\#[^\r\n]*+)*+"
_IRI: Final = r"<[^\x00-\x20<>\"{}|^`\\]*+>"
_NAME: Final = r"(?:[a-z][\w-]*+)?+:[a-z_][\w-]*+"
_TERM: Final = rf"([?$][a-z_]\w*+|{_IRI}|{_NAME})"
_OBJECT: Final = (
    rf"([?$][a-z_]\w*+|{_IRI}|{_NAME}|\"[^\"\\\r\n]*+\"(?:@[a-z]++(?:-[a-z0-9]++)*+|\^\^(?:{_IRI}|{_NAME}))?+)"
)
_LOOK_UP: Final = re.compile(
    rf"{_GAP}(?:PREFIX{_GAP}(?:[a-z][\w-]*+)?+:{_GAP}{_IRI}{_GAP})*+"
    rf"(?:ASK|SELECT{_GAP}(?:\*|[?$][a-z_]\w*+(?:{_GAP}[?$][a-z_]\w*+)*+)){_GAP}(?:WHERE{_GAP})?+"
    rf"\{{{_GAP}{_TERM}{_GAP}(?:{_TERM}|a){_GAP}{_OBJECT}{_GAP}\.?+{_GAP}\}}{_GAP}(?:LIMIT{_GAP}[0-9]{{1,9}}{_GAP})?+",
    re.ASCII | re.IGNORECASE,
)


def is_look_up(text: str) -> bool:
    """Return whether a query is a look-up. Texts with an escape are not, as it could be any character."""
    if len(text) > _CHARS or "\\" in text:
        return False
    match = _LOOK_UP.fullmatch(text)
    if match is None:
        return False
    variables = [term[1:] for term in match.groups() if term and term[0] in "?$"]
    return len(variables) == len(set(variables))


class LookUps:
    """Answers look-ups from the current data, which is opened on the first look-up and closed when it changes."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._snapshot: EmbeddedSnapshot | None = None
        self._identity: str | None = None
        """Identity of the data that is open or being opened; None after it changed."""
        self._opening: asyncio.Task[None] | None = None

    def answer(self, question: Question, identity: str) -> CachedResponse | None:
        """Return the response to a look-up on the data `identity`; None if a reader has to answer."""
        plain = not question.parameters and not question.offset and question.snapshot in {None, identity}
        given = question.default_graphs is not None or question.named_graphs is not None
        # A server may be slow to answer, which a reader can wait for.
        if self._layout.address is not None or not plain or given or not is_look_up(question.text):
            return None
        if self._snapshot is None or self._snapshot.identity != identity:
            # In the background, and once for each identity.
            if self._opening is None and self._identity != identity:
                self._identity = identity
                self._opening = asyncio.get_running_loop().create_task(self._opened())
            return None
        # A reader reports the error.
        with suppress(SyntaxError, RuntimeError, OSError, ValueError, KgError):
            return self._evaluate(self._snapshot, question)
        return None

    def release(self, identity: str | None) -> None:
        """Close the open data unless its identity is `identity`, that of the current data."""
        if self._snapshot is not None and self._snapshot.identity != identity:
            self._snapshot.close()
            self._snapshot = None
        if self._identity != identity:
            self._identity = None

    async def close(self) -> None:
        """Close the open data."""
        self.release(None)
        if self._opening is not None:
            await asyncio.gather(self._opening, return_exceptions=True)

    async def _opened(self) -> None:
        try:
            fresh = await asyncio.to_thread(EmbeddedSnapshot, self._layout)
        except (KgError, OSError):
            return
        finally:
            self._opening = None
        self.release(None if self._identity is None else fresh.identity)
        if fresh.identity == self._identity:
            self._snapshot = fresh
        else:
            fresh.close()

    @staticmethod
    def _evaluate(snapshot: EmbeddedSnapshot, question: Question) -> CachedResponse | None:
        began = time.perf_counter()
        text = question.text
        result = snapshot.query(text, prefixes=prefixes_in(text), union=question.union, base=question.base)
        evaluation = evaluation_of(result, snapshot.identity)
        name = question.formats.get(evaluation.kind)
        if name is None or name not in (BOOLEAN_FORMATS if evaluation.kind == "boolean" else SOLUTION_FORMATS):
            return None
        count, body = _written(evaluation, name, question.rows)
        if body is None or (question.size is not None and len(body) > question.size):
            return None
        head = Head(evaluation.kind, name, snapshot.identity, evaluation.variables)
        return CachedResponse(head, body, End(count, time.perf_counter() - began))


def _written(evaluation: Evaluation, name: str, most: int | None) -> tuple[int, bytes | None]:
    """Return the number of rows, and their serialization; None if there are too many for a look-up."""
    parts: list[bytes] = []
    if isinstance(evaluation.result, bool):
        write_boolean(name, parts.append, value=evaluation.result)
        return 1, b"".join(parts)
    rows = _rows(cast("Iterator[Row]", evaluation.result))
    if rows is None or (most is not None and len(rows) > most):
        return 0, None
    write_rows(name, evaluation.variables, rows, parts.append)
    return len(rows), b"".join(parts)


def _rows(source: Iterator[Row]) -> list[Row] | None:
    """Return all rows; None if they are many or large, or contain quoted triples."""
    rows: list[Row] = []
    chars = 0
    for row in islice(source, _ROWS + 1):
        rows.append(row)
        for term in row:
            if term is None or isinstance(term, Triple):
                return None
            chars += len(term.value)
        if chars > _VALUE_CHARS:
            return None
    return rows if len(rows) <= _ROWS else None
