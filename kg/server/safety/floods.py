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
"""Paths without a limit: a supervisor must not mistake a busy server for a dead one."""


class Floods:
    """Refuse further requests of an address with `most` unanswered ones: KG531.

    Programs on this machine share one address, so only the readers' queue limits them.
    """

    def __init__(self, app: ASGIApp, most: int) -> None:
        self._app = app
        self._most = most
        self._open: Counter[str] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Count a request while it is handled."""
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
    """Pass on a request if all checks do; a check returns None, an error to report, or a response."""

    def __init__(self, app: ASGIApp, checks: tuple[Check, ...]) -> None:
        self._app = app
        self._checks = checks

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Respond to an HTTP request that a check stops; pass on all others."""
        if scope["type"] == "http":
            request = HTTPConnection(scope)
            for check in self._checks:
                if refusal := check(request):
                    stopped = answer(request, refusal) if isinstance(refusal, KgError) else refusal
                    await stopped(scope, receive, send)
                    return
        await self._app(scope, receive, send)
