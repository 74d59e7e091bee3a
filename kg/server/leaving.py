"""Cancellation of work for clients that disconnect before their response."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from starlette.types import Receive

_T = TypeVar("_T")

GONE: Final = 499
"""Status in the log for a client that disconnected; nobody receives it."""
_PATIENCE: Final = 0.05  # seconds before the connection is watched: most requests are finished by then


class ClientLeftError(Exception):
    """The client disconnected."""


async def while_connected(receive: Receive, work: Awaitable[_T]) -> _T:
    """Return the result of `work`; it is cancelled when the client closes the connection.

    Raises:
        ClientLeftError: the client disconnected.
        RequestError: KG525, KG532 for an unexpected request body.
    """
    watch = _Watch(receive)
    later = watch.loop.call_later(_PATIENCE, watch.begin)
    try:
        return await work
    except asyncio.CancelledError:
        if watch.ended and watch.task.uncancel() == 0:
            # Its exception is the reason, or else the client disconnected.
            watch.ended.result()
            raise ClientLeftError from None
        raise
    finally:
        later.cancel()
        watch.stop()


class _Watch:
    """Cancels the task that created it when the client disconnects; it starts after most requests have finished."""

    def __init__(self, receive: Receive) -> None:
        self.loop = asyncio.get_running_loop()
        task = asyncio.current_task()
        assert task is not None  # noqa: S101 - a coroutine runs in one
        self.task = task
        self.ended: asyncio.Task[None] | None = None
        self._receive = receive
        self._watcher: asyncio.Task[None] | None = None

    def begin(self) -> None:
        """Start watching."""
        self._watcher = self.loop.create_task(self._disconnect())
        self._watcher.add_done_callback(self._end)

    def stop(self) -> None:
        """Stop watching."""
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
