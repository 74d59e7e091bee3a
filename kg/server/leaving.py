"""Clients that leave before they are answered: what is done for them ends."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from starlette.types import Receive

__all__ = ["GONE", "ClientLeftError", "while_connected"]

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
    running = asyncio.ensure_future(work)
    try:
        await asyncio.wait({running}, timeout=_PATIENCE)
        if not running.done():
            watcher = asyncio.ensure_future(_disconnect(receive))
            try:
                await asyncio.wait({running, watcher}, return_when=asyncio.FIRST_COMPLETED)
                if not running.done():
                    watcher.result()
            finally:
                watcher.cancel()
        if running.done():
            return running.result()
        raise ClientLeftError
    finally:
        if not running.done():
            running.cancel()
            await asyncio.wait({running})


async def _disconnect(receive: Receive) -> None:
    while (await receive())["type"] != "http.disconnect":
        pass
