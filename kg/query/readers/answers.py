"""Requests that wait or run, and the responses of readers."""

from __future__ import annotations

import time
from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.errors import KgError, QueryError
from kg.query.readers.messages import End, Failure, Head, Progress

if TYPE_CHECKING:
    import asyncio
    from collections.abc import AsyncIterator

    from kg.query.readers.cache import CachedResponse
    from kg.query.readers.processes import Process


@dataclass(slots=True, eq=False)
class Job:
    """A request that waits or runs. `identity` cannot be guessed; `rows` is the number of rows found so far.

    `client` identifies the sender, `cause` is the error that ended the request, `process` runs it, and `place` is its
    place in a queue. `own` marks requests that the pool sends itself.
    """

    identity: str
    text: str
    client: str = ""
    began: float = field(default_factory=time.monotonic)
    rows: int = 0
    own: bool = False
    cause: KgError | None = None
    process: Process | None = None
    place: asyncio.Future[None] | None = None

    @property
    def elapsed(self) -> float:
        """Seconds since the request."""
        return time.monotonic() - self.began

    def end(self, cause: KgError) -> None:
        """Cancel the request, waiting or running; the first cause is reported."""
        if self.cause is None:
            self.cause = cause
        if self.place is not None and not self.place.done():
            self.place.set_exception(self.cause)
        if self.process is not None:
            self.process.kill()

    def wait_at(self, place: asyncio.Future[None]) -> None:
        """Store the place in a queue, to cancel the wait."""
        self.place = place
        if self.cause is not None:
            place.set_exception(self.cause)

    def run_on(self, process: Process) -> None:
        """Store the process that runs the request; raises the cause if it was cancelled before."""
        if self.cause is not None:
            raise self.cause
        self.process = process


class Answer:
    """Response to a request: first `head`, then `parts`, then `end`.

    If the query was quick or its response cached, `end` is set from the beginning. Then no error can follow, and `size`
    is the number of bytes of all parts. `job` is the request, `held_bytes` the number of bytes received. If `last` is
    true, the reader must not receive another request.
    """

    head: Head

    def __init__(self, job: Job, process: Process | None, copied: int = 0) -> None:
        """Receive the response of `process` to the request sent to it; retain up to `copied` bytes for `copy`."""
        self.job = job
        self.end: End | None = None
        self.finished = False
        self.last = False
        self._process = process
        self._begun = False
        self._buffered: deque[bytes] = deque()
        self.buffered_bytes = 0
        self._copied: list[bytes] | None = []
        self._room = copied

    @classmethod
    def of(cls, job: Job, cached: CachedResponse) -> Answer:
        """Return a cached response."""
        answer = cls(job, None)
        answer.head, answer.end = cached.head, cached.end
        answer._buffered.append(cached.body)
        answer.buffered_bytes = len(cached.body)
        return answer

    @property
    def size(self) -> int | None:
        """Number of bytes that `parts` will yield; None until the response is complete."""
        return self.buffered_bytes if self.end is not None else None

    @property
    def copy(self) -> bytes | None:
        """The whole body; None if the response is incomplete or larger than the `copied` bytes."""
        return None if self.end is None or self._copied is None else b"".join(self._copied)

    async def parts(self) -> AsyncIterator[bytes]:
        """Yield the body as bytes; `end` is set after the last part.

        Raises KgError: KG303 error of the store, KG503 deadline, KG506 error of the query, KG507 memory limit, KG508
        the reader exited, KG510 cancelled, KG511 response too large.
        """
        while self._buffered or self.end is None:
            if self._buffered:
                yield self._buffered.popleft()
            else:
                await self._receive()

    async def begin(self) -> None:
        """Wait for the head; raises as `parts`."""
        while not self._begun:
            await self._receive()

    async def collect(self, seconds: float, most: int) -> bool:
        """Receive parts for `seconds`, or until `most` bytes; return whether the response is complete.

        Raises as `parts`.
        """
        assert self._process is not None  # noqa: S101 - a cached response is complete
        ends = time.monotonic() + seconds
        while self.end is None and self.buffered_bytes <= most:
            if not await self._process.wait(ends - time.monotonic()):
                return False
            await self._receive()
        return self.end is not None

    async def _receive(self) -> None:
        assert self._process is not None  # noqa: S101 - a cached response is complete
        message = await self._process.receive()
        if message is None:
            raise self._reason(self._process)
        if isinstance(message, bytes):
            self._hold(message)
        elif isinstance(message, Head):
            self.head, self._begun = message, True
        elif isinstance(message, Progress):
            self.job.rows = message.rows
        elif isinstance(message, Failure):
            self.finished, self.last = True, message.last
            raise message.error()
        elif isinstance(message, End):
            self.end, self.finished, self.last = message, True, message.last
            self.job.rows = message.rows

    def _hold(self, part: bytes) -> None:
        self._buffered.append(part)
        self.buffered_bytes += len(part)
        if self._copied is not None:
            self._copied.append(part)
            if self.buffered_bytes > self._room:
                self._copied = None

    def _reason(self, process: Process) -> Exception:
        if self.job.cause is not None:
            return self.job.cause
        if process.out_of_memory:
            hint = "Ask for fewer rows; avoid ORDER BY and patterns that have nothing in common."
            return QueryError("KG507", "the query needs more memory than it may use", hint=hint)
        return QueryError("KG508", "the process that ran the query ended", hint="Ask less at once.")
