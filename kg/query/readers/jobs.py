"""Requests that wait or run."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import asyncio

    from kg.errors import KgError
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
