"""Open pages, each with its queue of events; and the errors of work for them."""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any, Final

from kg.errors import KgError
from kg.robot.tasks import report
from kg.server.errors import RequestError

MOST: Final = 64
"""Maximum number of open pages."""
_WAITING: Final = 2000
"""Maximum number of queued events per page; a slower page is disconnected, and reloads everything when it
reconnects.
"""
_ALIVE: Final = 15.0  # seconds of silence after which a keep-alive is sent, to detect closed pages


@dataclass(eq=False)
class Listener:
    """An open page; its identity authorises requests for it.

    `reads` are the capabilities that it follows, `seen` is the last picture sent to it.
    """

    identity: str = field(default_factory=lambda: secrets.token_urlsafe(18))
    reads: frozenset[str] = frozenset()
    last_beat: float = 0.0
    seen: str = ""
    waiting: asyncio.Queue[dict[str, Any] | None] = field(default_factory=lambda: asyncio.Queue(_WAITING))

    def queue(self, event: dict[str, Any]) -> bool:
        """Queue an event; return False if the queue is full."""
        try:
            self.waiting.put_nowait(event)
        except asyncio.QueueFull:
            return False
        return True

    def end(self) -> None:
        """End the stream at once, discarding queued events."""
        while self.waiting.full():
            self.waiting.get_nowait()
        self.waiting.put_nowait(None)

    async def events(self) -> AsyncIterator[dict[str, Any] | None]:
        """Yield events as they arrive, and None after a period without any, until `end` is called."""
        while True:
            try:
                event = await asyncio.wait_for(self.waiting.get(), _ALIVE)
            except TimeoutError:
                yield None
                continue
            if event is None:
                return
            yield event


class Listeners:
    """All open pages by identity."""

    def __init__(self) -> None:
        self._all: dict[str, Listener] = {}
        self._closed = False

    def __len__(self) -> int:
        return len(self._all)

    def get(self, identity: str) -> Listener | None:
        """Return the page of an identity, None if it is closed."""
        return self._all.get(identity)

    def add(self) -> Listener:
        """Return a new page; it receives no events once the server is stopping."""
        listener = Listener()
        self._all[listener.identity] = listener
        listener.queue({"event": "hello", "listener": listener.identity})
        if self._closed:
            listener.end()
        return listener

    def remove(self, listener: Listener) -> None:
        """Remove a closed page."""
        self._all.pop(listener.identity, None)

    def publish(self, event: dict[str, Any], *, of: str | None = None, but: Listener | None = None) -> None:
        """Send an event to all pages, or to those that follow the capability `of`; never to `but`."""
        for listener in tuple(self._all.values()):
            if listener is not but and (of is None or of in listener.reads) and not listener.queue(event):
                listener.end()

    def show(self, picture: str) -> None:
        """Send a picture to pages that have not seen it and have an empty queue, since pictures must not accumulate."""
        for listener in tuple(self._all.values()):
            if listener.seen != picture and listener.waiting.empty():
                listener.seen = picture
                listener.queue({"event": "view", "picture": picture})

    def reads(self) -> frozenset[str]:
        """Return the capabilities that any page follows."""
        return frozenset().union(*(one.reads for one in self._all.values()))

    def close(self) -> None:
        """End all streams."""
        self._closed = True
        for listener in self._all.values():
            listener.end()


def failure(task: asyncio.Task[Any], what: str) -> KgError | None:
    """Return the error that ended a task, None if it succeeded; a defect is reported as one of `what`."""
    error = None if task.cancelled() else task.exception()
    if error is None or isinstance(error, KgError):
        return error
    report(what, error)
    return RequestError("KG900", f"a defect in kg ended {what}; the log of the server has more")
