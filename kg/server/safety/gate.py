"""The gate: checks that look at a request and let it pass, or answer in its place."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from starlette.requests import HTTPConnection

from kg.errors import KgError
from kg.server.errors import answer

if TYPE_CHECKING:
    from collections.abc import Callable

    from starlette.responses import Response
    from starlette.types import ASGIApp, Receive, Scope, Send

    Check: TypeAlias = Callable[[HTTPConnection], KgError | Response | None]


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
