"""The reader processes that there are: those with nothing to do, and how others come and go."""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING

from kg.errors import QueryError
from kg.query.readers.messages import Refresh, frame

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.readers.processes import Process, Spawner


class Fleet:
    """Readers made by `spawner`, of which `ready` are kept idle, so that no request has to wait for one to start.

    Up to twice as many stay: where requests come and go, none is ended only to be started again.
    A reader whose priority was lowered is not used again. `spawned` is how many there were so far, `ended` how many of
    these by what ended them.
    """

    def __init__(self, spawner: Spawner, ready: int) -> None:
        self._spawner = spawner
        self._ready = ready
        self._idle: list[Process] = []
        self._used: set[Process] = set()
        self._behind: set[Process] = set()
        self._filling: asyncio.Task[None] | None = None
        self._closing = False
        self.spawned = 0
        self.ended: Counter[str] = Counter()

    @property
    def idle(self) -> int:
        """How many have nothing to do."""
        return len(self._idle)

    async def take(self, tell: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return a reader with nothing to do; while one starts, an exception on what `tell` is given ends the waiting.

        Raises:
            QueryError: KG508 when there is none and none can be started.
        """
        process = self._alive() or await self._spawn_unless(tell)
        self._used.add(process)
        self.fill()
        return process

    def put(self, process: Process) -> None:
        """Take a reader back that is ready for the next request."""
        self._used.discard(process)
        if process.ended or process.nice or self._closing or len(self._idle) >= 2 * self._ready:
            self._close(process, "retired")
        else:
            self._idle.append(process)
            if process in self._behind:
                process.send(frame(Refresh()))
        self._behind.discard(process)
        self.fill()

    def drop(self, process: Process, cause: str) -> None:
        """End a reader that still does something, and note the cause."""
        self._used.discard(process)
        self._behind.discard(process)
        self._close(process, cause)
        self.fill()

    def refresh(self) -> None:
        """Notify idle readers that the data has changed; busy ones are notified when they are done."""
        self._behind = set(self._used)
        for process in self._idle:
            process.send(frame(Refresh()))

    def fill(self) -> None:
        """See to it, in the background, that there are enough."""
        if self._filling is None and not self._closing and len(self._idle) < self._ready:
            self._filling = asyncio.get_running_loop().create_task(self._fill())

    async def close(self) -> None:
        """End all of them, and what they are forked from."""
        self._closing = True
        if self._filling is not None:
            self._filling.cancel()
            await asyncio.gather(self._filling, return_exceptions=True)
        for process in [*self._idle, *self._used]:
            process.close()
        self._idle.clear()
        self._used.clear()
        await self._spawner.close()

    def _alive(self) -> Process | None:
        """Take the one that was used last, which has the data in its caches; None when there is none."""
        while self._idle:
            process = self._idle.pop()
            if not process.ended:
                return process
            self._close(process, "crashed")
        return None

    async def _fill(self) -> None:
        try:
            while (missing := self._ready - len(self._idle)) > 0:
                fresh = await asyncio.gather(*(self._spawn() for _ in range(missing)))
                for process in fresh:
                    # The data may have changed since it was opened.
                    process.send(frame(Refresh()))
                self._idle[:0] = fresh
        except QueryError:
            # Whoever needs a reader tries again and is told.
            return
        finally:
            self._filling = None

    async def _spawn_unless(self, tell: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return a new reader; raises what is told meanwhile."""
        told: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        tell(told)
        starting = asyncio.ensure_future(self._spawn())
        told.add_done_callback(lambda _: starting.cancel())
        try:
            return await starting
        except asyncio.CancelledError:
            if starting.done() and not starting.cancelled() and starting.exception() is None:
                # It was ready in the moment that whoever wanted it went away.
                self.put(starting.result())
            if told.done():
                told.result()
            raise
        finally:
            # Nobody else asks what it was told, which would be reported as forgotten.
            if not told.cancel():
                told.exception()

    async def _spawn(self) -> Process:
        # What readers are forked from may end before it has read the order; for the next one it is started anew.
        process = await self._spawn_once() or await self._spawn_once()
        if process is None:
            raise QueryError("KG508", "no process for queries can be started", hint="The log has its output.")
        self.spawned += 1
        return process

    async def _spawn_once(self) -> Process | None:
        """Return a new reader; None when it has ended before it could be asked."""
        process = await self._spawner.spawn()
        try:
            ready = await process.receive()
        except BaseException:
            process.close()
            raise
        if ready is None:
            process.close()
            return None
        process.pid = ready.pid
        return process

    def _close(self, process: Process, cause: str) -> None:
        process.close()
        self.ended[cause] += 1
