"""One client may not take all the room: a bound on how much of one address is unanswered at a time."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final

from starlette.requests import HTTPConnection

from kg.server.errors import RequestError, answer
from kg.server.safety.hosts import is_loopback

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Receive, Scope, Send

ALWAYS: Final = frozenset({"/health", "/metrics"})
"""Paths that are answered however busy the server is: a supervisor must not take a busy server for a dead one."""


class Floods:
    """Refuse further requests of an address that has `most` of them unanswered: KG531.

    Programs of this machine share one address, so they are bounded by the queue of the readers alone.
    """

    def __init__(self, app: ASGIApp, most: int) -> None:
        self._app = app
        self._most = most
        self._open: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Count a request while it is answered."""
        client = (scope.get("client") or ("localhost", 0))[0] if scope["type"] == "http" else "localhost"
        if is_loopback(client) or scope["path"] in ALWAYS:
            await self._app(scope, receive, send)
            return
        if self._open[client] >= self._most:
            error = RequestError("KG531", f"{self._most} requests of this address are not answered yet")
            await answer(HTTPConnection(scope), error)(scope, receive, send)
            return
        self._open[client] += 1
        try:
            await self._app(scope, receive, send)
        finally:
            self._open[client] -= 1
            if not self._open[client]:
                del self._open[client]
