"""Topics that are written to: one command at a time holds one, and what was moved is stopped."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, TypeVar

from kg.errors import RobotError
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine

    from kg.robot.clock import Clock
    from kg.robot.connection import Publication, Value

__all__ = ["Channel", "Command", "Ending"]

Ending: TypeAlias = Literal["taken over", "stopped"] | RobotError
"""Why something was ended before it was done: by a later command, by `stop`, by what went wrong."""

Result = TypeVar("Result")

_LOOK: Final = 0.02
"""Seconds of the wall between two looks whether a subscriber is connected."""


class Command:
    """Something that is being done; `sent` counts its messages."""

    def __init__(self) -> None:
        self.sent = 0
        self._ending: Ending | None = None
        self._work: asyncio.Future[Any] | None = None

    @property
    def ending(self) -> Ending | None:
        """Why it was ended before it was done."""
        return self._ending

    async def begin(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Do it: return what the work gives; CancelledError when it is ended, or was before."""
        task = asyncio.ensure_future(work)
        self._work = task
        if self._ending is not None:
            task.cancel()
        return await task

    def end(self, why: Ending) -> None:
        """End it; the first reason counts."""
        self._ending = self._ending or why
        if self._work is not None:
            self._work.cancel()

    async def ended(self) -> None:
        """Return when nothing more is done for it."""
        if self._work is not None:
            await asyncio.wait((self._work,))


class Channel:
    """A topic that is written to.

    Messages go out in the order that they are given here, no more than `limit` a second, and each goes out whole even
    when who gave it is cancelled. `zero` makes the message that ends the movement that goes on, None when none does.
    """

    def __init__(self, topic: str, publication: Publication, clock: Clock, limit: float) -> None:
        self.topic = topic
        self.zero: Callable[[], Value] | None = None
        self.last_zero: Callable[[], Value] | None = None
        self._publication = publication
        self._clock = clock
        self._gap = 1 / limit
        self._holder: Command | None = None
        self._free = float("-inf")
        self._order = asyncio.Lock()
        self._sending = Tasks()

    def take(self, command: Command) -> None:
        """Let a command have the channel; the one that had it ends, and its movement becomes the new one's to end."""
        earlier, self._holder = self._holder, command
        if earlier is not None:
            earlier.end("taken over")

    async def heard(self, seconds: float) -> None:
        """Return when a subscriber is connected; RobotError KG824 when none is within so many seconds.

        These are seconds of the wall: connecting takes as long however fast a simulation runs.
        """
        try:
            async with asyncio.timeout(seconds):
                while self._publication.peers == 0:  # noqa: ASYNC110 - nothing tells when a peer comes
                    await asyncio.sleep(_LOOK)
        except TimeoutError:
            raise RobotError("KG824", f"no node listens to `{self.topic}`") from None

    async def send(self, message: Value, command: Command) -> None:
        """Send a message of the command that has the channel; KG824 when nobody listens any more."""
        wait = min(self._free - self._clock.now(), self._gap)
        if wait > 0:
            await self._clock.sleep(wait)
        if self._publication.peers == 0:
            raise RobotError("KG824", f"no node listens to `{self.topic}` any more")
        self._free = self._clock.now() + self._gap
        await self._send(message)
        command.sent += 1

    async def release(self, command: Command) -> None:
        """Give the channel back; a movement that goes on is ended."""
        if self._holder is command:
            await self.still()

    async def still(self, *, again: bool = False) -> None:
        """End the movement that goes on, whoever has the channel; with `again` also one that has ended before."""
        self._holder = None
        zero = self.zero or (self.last_zero if again else None)
        self.zero, self.last_zero = None, zero or self.last_zero
        if zero is not None:
            with suppress(RobotError):  # a robot that is lost cannot be told; what was going on has its own error
                await self._send(zero())

    async def _send(self, message: Value) -> None:
        task = asyncio.ensure_future(self._publish(message))  # its error is raised here, or nobody is there any more
        self._sending.hold(task)
        await asyncio.shield(task)

    async def _publish(self, message: Value) -> None:
        async with self._order:
            await self._publication.publish(message)

    async def aclose(self) -> None:
        """Offer the topic no more, after everything has gone out."""
        await self._sending.done()
        await self._publication.aclose()
