"""The pool of reader processes: idle, busy, starting, retired."""

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
    """Readers started by `spawner`; `ready` of them are idle, so requests rarely wait for a process to start.

    Up to twice as many idle readers remain, to avoid restarts when load varies. A reader with lowered priority is not
    reused. `spawned` counts the readers started so far, `ended` those that exited, by cause.
    """

    def __init__(self, spawner: Spawner, ready: int) -> None:
        self._spawner = spawner
        self._ready = ready
        self._idle: list[Process] = []
        self._used: set[Process] = set()
        self._outdated: set[Process] = set()
        self._filling: asyncio.Task[None] | None = None
        self._closing = False
        self.spawned = 0
        self.ended: Counter[str] = Counter()

    @property
    def idle(self) -> int:
        """Number of idle readers."""
        return len(self._idle)

    async def take(self, register: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return an idle reader, or start one. An exception set on the future passed to `register` ends the wait.

        Raises:
            QueryError: KG508 if no process can be started.
        """
        process = self._pop_idle() or await self._spawn_unless_cancelled(register)
        self._used.add(process)
        self.fill()
        return process

    def put(self, process: Process) -> None:
        """Return a reader that is ready for the next request."""
        self._used.discard(process)
        if process.ended or process.nice or self._closing or len(self._idle) >= 2 * self._ready:
            self._close(process, "retired")
        else:
            self._idle.append(process)
            if process in self._outdated:
                process.send(frame(Refresh()))
        self._outdated.discard(process)
        self.fill()

    def drop(self, process: Process, cause: str) -> None:
        """Kill a busy reader and count the cause."""
        self._used.discard(process)
        self._outdated.discard(process)
        self._close(process, cause)
        self.fill()

    def refresh(self) -> None:
        """Notify idle readers that the data has changed; busy ones are notified when they are done."""
        self._outdated = set(self._used)
        for process in self._idle:
            process.send(frame(Refresh()))

    def fill(self) -> None:
        """Start missing idle readers in the background."""
        if self._filling is None and not self._closing and len(self._idle) < self._ready:
            self._filling = asyncio.get_running_loop().create_task(self._fill())

    async def close(self) -> None:
        """Kill all readers and their fork server."""
        self._closing = True
        if self._filling is not None:
            self._filling.cancel()
            await asyncio.gather(self._filling, return_exceptions=True)
        for process in [*self._idle, *self._used]:
            process.close()
        self._idle.clear()
        self._used.clear()
        await self._spawner.close()

    def _pop_idle(self) -> Process | None:
        """Remove and return the idle reader used last, whose caches are warm; None if all are busy."""
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
                    # The data may have changed after the reader opened it.
                    process.send(frame(Refresh()))
                self._idle[:0] = fresh
        except QueryError:
            # The next request that needs a reader tries again and reports the error.
            return
        finally:
            self._filling = None

    async def _spawn_unless_cancelled(self, register: Callable[[asyncio.Future[None]], object]) -> Process:
        """Return a new reader; raises the exception set on the registered future if that comes first."""
        cancelled: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        register(cancelled)
        starting = asyncio.ensure_future(self._spawn())
        cancelled.add_done_callback(lambda _: starting.cancel())
        try:
            return await starting
        except asyncio.CancelledError:
            if starting.done() and not starting.cancelled() and starting.exception() is None:
                # The reader was ready at the moment when the request was cancelled.
                self.put(starting.result())
            if cancelled.done():
                cancelled.result()
            raise
        finally:
            # Retrieve the exception; otherwise asyncio reports that it was never retrieved.
            if not cancelled.cancel():
                cancelled.exception()

    async def _spawn(self) -> Process:
        # The fork server may exit before it has read the order; the second attempt starts another.
        process = await self._spawn_once() or await self._spawn_once()
        if process is None:
            raise QueryError("KG508", "no process for queries can be started", hint="The log has its output.")
        self.spawned += 1
        return process

    async def _spawn_once(self) -> Process | None:
        """Return a new reader; None if it exited before it was ready."""
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
