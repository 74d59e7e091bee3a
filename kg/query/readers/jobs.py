"""What was asked of the readers and has not ended."""

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
    """A request that waits or runs: `identity` cannot be guessed, `rows` is how many were found so far.

    `client` is who asked, `cause` why it was ended, `process` what runs it, `place` where it waits. `own` is one that
    nobody asked for.
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
        """Seconds since it was asked for."""
        return time.monotonic() - self.began

    def end(self, cause: KgError) -> None:
        """End it wherever it is; the first cause is the one that is told."""
        if self.cause is None:
            self.cause = cause
        if self.place is not None and not self.place.done():
            self.place.set_exception(self.cause)
        if self.process is not None:
            self.process.kill()

    def wait_at(self, place: asyncio.Future[None]) -> None:
        """Take note of where it waits."""
        self.place = place
        if self.cause is not None:
            place.set_exception(self.cause)

    def run_on(self, process: Process) -> None:
        """Take note of what runs it from now on; raises its cause when it was ended before."""
        if self.cause is not None:
            raise self.cause
        self.process = process
