"""Clients that leave before they are answered: what is done for them ends."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from starlette.types import Receive

_T = TypeVar("_T")

GONE: Final = 499
"""The status that the log has of a client that did not wait; nobody reads it."""
_PATIENCE: Final = 0.05
"""Seconds before it is watched whether the client is still there: most requests are answered by then."""


class ClientLeftError(Exception):
    """Nobody waits for the answer any more."""


async def while_connected(receive: Receive, work: Awaitable[_T]) -> _T:
    """Return what `work` does; when the client closes the connection before, it is cancelled.

    Raises:
        ClientLeftError: the client did.
        RequestError: KG525, KG532 for the body of a request of which none was expected.
    """
    watch = _Watch(receive)
    later = watch.loop.call_later(_PATIENCE, watch.begin)
    try:
        return await work
    except asyncio.CancelledError:
        if watch.ended and watch.task.uncancel() == 0:
            # What it raises is why, else the client left.
            watch.ended.result()
            raise ClientLeftError from None
        raise
    finally:
        later.cancel()
        watch.stop()


class _Watch:
    """Cancels the task that made it when the client leaves; it begins once most requests are answered."""

    def __init__(self, receive: Receive) -> None:
        self.loop = asyncio.get_running_loop()
        task = asyncio.current_task()
        assert task is not None  # noqa: S101 - a coroutine runs in one
        self.task = task
        self.ended: asyncio.Task[None] | None = None
        self._receive = receive
        self._watcher: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """Watch from now on."""
        self._watcher = self.loop.create_task(self._disconnect())
        self._watcher.add_done_callback(self._end)

    def stop(self) -> None:
        """Watch no more."""
        if self._watcher is not None:
            self._watcher.remove_done_callback(self._end)
            self._watcher.cancel()

    def _end(self, watcher: asyncio.Task[None]) -> None:
        if not watcher.cancelled():
            self.ended = watcher
            self.task.cancel()

    async def _disconnect(self) -> None:
        while (await self._receive())["type"] != "http.disconnect":
            pass
