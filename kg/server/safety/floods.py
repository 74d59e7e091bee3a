"""Checks that answer a request in place of the server: the gate that asks them, and the check for floods."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final, TypeAlias

from starlette.requests import HTTPConnection

from kg.errors import KgError
from kg.server.errors import RequestError, answer
from kg.server.safety.hosts import is_loopback

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.responses import Response
    from starlette.types import ASGIApp, Receive, Scope, Send


Check: TypeAlias = "Callable[[HTTPConnection], KgError | Response | None]"

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


class Gate:
    """Let pass what all checks let pass; a check returns None, an error to be told, or an answer."""

    def __init__(self, app: ASGIApp, checks: tuple[Check, ...]) -> None:
        self._app = app
        self._checks = checks

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer an HTTP request that a check stops; all else goes on."""
        if scope["type"] == "http":
            request = HTTPConnection(scope)
            for check in self._checks:
                if found := check(request):
                    stopped = answer(request, found) if isinstance(found, KgError) else found
                    await stopped(scope, receive, send)
                    return
        await self._app(scope, receive, send)
