"""Checks that answer a request in place of the server: the gate that asks them, and the check for floods."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Final, TypeAlias

from starlette.requests import HTTPConnection

from kg.errors import KgError
from kg.server.errors import RequestError, answer
from kg.server.safety.hosts import is_loopback
from kg.server.safety.sites import READING
from kg.server.scopes import head_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.responses import Response
    from starlette.types import ASGIApp, Receive, Scope, Send


Check: TypeAlias = "Callable[[HTTPConnection], KgError | Response | None]"

_CREDENTIALS: Final = frozenset({b"authorization", b"cookie"})
_REMEMBERED: Final = 512  # so many heads of requests that passed are remembered
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
    """Pass on a request if all checks do; a check returns None, an error to report, or a response.

    Only the head of a request decides `checks`. A reading request with a head that passed is not checked again, unless
    it has credentials: the token may have changed.
    """

    def __init__(self, app: ASGIApp, checks: tuple[Check, ...], each: tuple[Check, ...] = ()) -> None:
        """`each` are checks of further things."""
        self._app = app
        self._checks = checks
        self._each = each
        self._passed: set[tuple[object, ...]] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Respond to an HTTP request that a check stops; pass on all others."""
        if scope["type"] == "http":
            plain = scope["path"] in READING and _CREDENTIALS.isdisjoint([name for name, _ in scope["headers"]])
            head = head_of(scope) if plain else None
            passed = head is not None and head in self._passed
            request = HTTPConnection(scope)
            for check in self._each if passed else (*self._each, *self._checks):
                if refusal := check(request):
                    stopped = answer(request, refusal) if isinstance(refusal, KgError) else refusal
                    await stopped(scope, receive, send)
                    return
            if head is not None and not passed:
                if len(self._passed) >= _REMEMBERED:
                    self._passed.clear()
                self._passed.add(head)
        await self._app(scope, receive, send)
