"""Cache of responses: the same request for the same data has the same response."""

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
"""A response may take one eighth of the cache at most, so one response cannot evict all others."""
_ENTRY_BYTES: Final = 1024
"""Approximate size of an entry without request and response."""


class CacheStats(msgspec.Struct, frozen=True):
    """Statistics of the cache: `hits` and `misses` of cacheable requests, and its content."""

    hits: int
    misses: int
    answers: int
    bytes: int
    most_bytes: int


class CachedResponse(NamedTuple):
    """A whole response."""

    head: Head
    body: bytes
    end: End


class AnswerCache:
    """Least-recently-used cache of at most `most` bytes, for responses from one snapshot.

    With 0 bytes it is off. A request for another snapshot clears it.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._snapshot: str | None = None
        self._answers: OrderedDict[bytes, CachedResponse] = OrderedDict()
        self._bytes = 0
        self._hits = 0
        self._misses = 0

    @property
    def largest(self) -> int:
        """Largest size of a cached response, in bytes."""
        return self._most // _SHARE

    def get(self, request: bytes, snapshot: str | None) -> CachedResponse | None:
        """Return the cached response to the request at the current snapshot, or None."""
        if not self._most or snapshot is None:
            return None
        self._move(snapshot)
        response = self._answers.get(request)
        if response is None:
            self._misses += 1
            return None
        self._answers.move_to_end(request)
        self._hits += 1
        return response

    def has(self, request: bytes, snapshot: str) -> bool:
        """Return whether the response to a request is cached; not counted as a hit or miss."""
        return snapshot == self._snapshot and request in self._answers

    def put(self, request: bytes, answer: CachedResponse, snapshot: str | None) -> None:
        """Cache a response if it is from the current snapshot, repeatable, and small enough."""
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
        """Return the statistics."""
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


def _cost(request: bytes, answer: CachedResponse) -> int:
    return len(request) + len(answer.body) + _ENTRY_BYTES


class Pointer:
    """Current snapshot; read again only if the pointer file was replaced."""

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self._path = str(layout.pointer)
        self._seen: tuple[int, int] | None = None
        self._snapshot: str | None = None

    def snapshot(self) -> str | None:
        """Return the identity of the current data; None if the store is empty or the pointer file is unreadable."""
        try:
            status = os.stat(self._path)  # noqa: PTH116 - runs for each request, at half the cost
            seen = (status.st_ino, status.st_mtime_ns)
            if seen != self._seen:
                number = self._layout.current()
                self._seen, self._snapshot = seen, None if number is None else str(number)
        except (OSError, StoreError):
            self._seen, self._snapshot = None, None
        return self._snapshot
