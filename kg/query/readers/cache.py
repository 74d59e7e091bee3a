"""Answers that are known already: the same request to the same data has the same answer."""

from __future__ import annotations

import os
from collections import OrderedDict
from typing import TYPE_CHECKING, Final, NamedTuple

import msgspec

from kg.errors import StoreError

if TYPE_CHECKING:
    from kg.query.readers.messages import End, Head
    from kg.store.layout import Layout

_SHARE: Final = 8
"""No answer may take more than the eighth part of a cache, so that one does not drive out all others."""
_ENTRY_BYTES: Final = 1024
"""What an entry takes beside request and answer, about."""


class CacheStats(msgspec.Struct, frozen=True):
    """`hits` and `misses` among requests that could have been answered from it, and what it holds."""

    hits: int
    misses: int
    answers: int
    bytes: int
    most_bytes: int


class Kept(NamedTuple):
    """A whole answer."""

    head: Head
    body: bytes
    end: End


class AnswerCache:
    """Whole answers to requests of one snapshot, of `most` bytes in all; the least recently used go first.

    With 0 bytes nothing is kept. What is asked of another snapshot empties it.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._snapshot: str | None = None
        self._answers: OrderedDict[bytes, Kept] = OrderedDict()
        self._bytes = 0
        self._hits = 0
        self._misses = 0

    @property
    def largest(self) -> int:
        """How many bytes an answer may have to be kept."""
        return self._most // _SHARE

    def get(self, request: bytes, snapshot: str | None) -> Kept | None:
        """Return the answer to the request at the snapshot in force, None when it is not known."""
        if not self._most or snapshot is None:
            return None
        self._move(snapshot)
        found = self._answers.get(request)
        if found is None:
            self._misses += 1
            return None
        self._answers.move_to_end(request)
        self._hits += 1
        return found

    def has(self, request: bytes, snapshot: str) -> bool:
        """Tell whether the answer to a request is known, which counts as no request for it."""
        return snapshot == self._snapshot and request in self._answers

    def put(self, request: bytes, answer: Kept, snapshot: str | None) -> None:
        """Keep an answer, if it is one of the snapshot in force, repeatable, and small enough."""
        fits = len(answer.body) + len(request) <= self.largest
        if not fits or not answer.head.repeatable or answer.head.snapshot != snapshot:
            return
        self._move(snapshot)
        self._drop(request)
        self._answers[request] = answer
        self._bytes += _cost(request, answer)
        while self._bytes > self._most:
            self._drop(next(iter(self._answers)))

    def stats(self) -> CacheStats:
        """Return how it does."""
        return CacheStats(self._hits, self._misses, len(self._answers), self._bytes, self._most)

    def _move(self, snapshot: str) -> None:
        if snapshot != self._snapshot:
            self._snapshot = snapshot
            self._answers.clear()
            self._bytes = 0

    def _drop(self, request: bytes) -> None:
        answer = self._answers.pop(request, None)
        if answer is not None:
            self._bytes -= _cost(request, answer)


def _cost(request: bytes, answer: Kept) -> int:
    return len(request) + len(answer.body) + _ENTRY_BYTES


class Pointer:
    """The snapshot in force, read anew only when the file that names it is another one."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._path = str(layout.pointer)
        self._seen: tuple[int, int] | None = None
        self._snapshot: str | None = None

    def snapshot(self) -> str | None:
        """Return the identity of the data in force; None when there is none, or it cannot be told."""
        try:
            status = os.stat(self._path)  # noqa: PTH116 - for each request, at half the cost
            seen = (status.st_ino, status.st_mtime_ns)
            if seen != self._seen:
                number = self._layout.current()
                self._seen, self._snapshot = seen, None if number is None else str(number)
        except (OSError, StoreError):
            self._seen, self._snapshot = None, None
        return self._snapshot
