"""Who looks on: pages that are open, each with what waits to be told to it; and how work for them ended."""

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
"""How many pages may look on at a time."""
_WAITING: Final = 2000
"""How many events may wait for a page; one that takes less is ended, and asks for everything anew when it is back."""
_ALIVE: Final = 15.0  # seconds after which something is sent, so that a page that has gone is noticed


@dataclass(eq=False)
class Listener:
    """An open page; whoever knows its identity speaks for it.

    `reads` are the capabilities that it follows, `seen` is the picture that it was told.
    """

    identity: str = field(default_factory=lambda: secrets.token_urlsafe(18))
    reads: frozenset[str] = frozenset()
    heard: float = 0.0
    seen: str = ""
    waiting: asyncio.Queue[dict[str, Any] | None] = field(default_factory=lambda: asyncio.Queue(_WAITING))

    def tell(self, event: dict[str, Any]) -> bool:
        """Let an event wait; False when there are too many already."""
        try:
            self.waiting.put_nowait(event)
        except asyncio.QueueFull:
            return False
        return True

    def end(self) -> None:
        """End the stream, whatever waits."""
        while self.waiting.full():
            self.waiting.get_nowait()
        self.waiting.put_nowait(None)

    async def events(self) -> AsyncIterator[dict[str, Any] | None]:
        """Yield events as they come, None when nothing has come for a while; it ends with `end`."""
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
    """All open pages, by their identities."""

    def __init__(self) -> None:
        self._all: dict[str, Listener] = {}
        self._closed = False

    def __len__(self) -> int:
        return len(self._all)

    def get(self, identity: str) -> Listener | None:
        """Return the page of an identity, None when it has gone."""
        return self._all.get(identity)

    def add(self) -> Listener:
        """Return a new page; when the server stops it is told nothing more."""
        made = Listener()
        self._all[made.identity] = made
        made.tell({"event": "hello", "listener": made.identity})
        if self._closed:
            made.end()
        return made

    def remove(self, listener: Listener) -> None:
        """Forget a page that has gone."""
        self._all.pop(listener.identity, None)

    def tell(self, event: dict[str, Any], *, of: str | None = None, but: Listener | None = None) -> None:
        """Tell an event to all, or to those who follow the capability `of`; never to `but`."""
        for listener in tuple(self._all.values()):
            if listener is not but and (of is None or of in listener.reads) and not listener.tell(event):
                listener.end()

    def show(self, picture: str) -> None:
        """Tell a picture to those who have not seen it, and took what was told before: they never heap up."""
        for listener in tuple(self._all.values()):
            if listener.seen != picture and listener.waiting.empty():
                listener.seen = picture
                listener.tell({"event": "view", "picture": picture})

    def reads(self) -> frozenset[str]:
        """Return the capabilities that anybody follows."""
        return frozenset().union(*(one.reads for one in self._all.values()))

    def close(self) -> None:
        """End all streams."""
        self._closed = True
        for listener in self._all.values():
            listener.end()


def failure(task: asyncio.Task[Any], what: str) -> KgError | None:
    """Return the error that ended a task, None where none did; a defect is reported as that of `what`."""
    error = None if task.cancelled() else task.exception()
    if error is None or isinstance(error, KgError):
        return error
    report(what, error)
    return RequestError("KG900", f"a defect in kg ended {what}; the log of the server has more")
