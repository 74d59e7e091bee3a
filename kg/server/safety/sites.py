"""Cross-site requests: refused unless the site is listed (`--cors`).

Browsers report the origin of a request in `Sec-Fetch-Site` (Fetch Metadata), older ones in `Origin`. Programs send
neither and pass. So does `Authorization: Bearer` without a cookie, which a page of another site cannot send on its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from starlette.responses import Response

from kg.server.errors import RequestError
from kg.server.scopes import header

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

SAFE: Final = frozenset({"GET", "HEAD", "OPTIONS", "QUERY"})
"""Methods that change nothing (RFC 9110, section 9.2.1, and the method QUERY)."""
READING: Final = frozenset({"/sparql", "/sparql/"})
"""The addresses at which POST changes nothing."""
_ALLOWED: Final = "GET, HEAD, POST, QUERY, OPTIONS"
_ASKED: Final = "Accept, Authorization, Content-Type, If-None-Match"
_SHOWN: Final = "ETag, Link, Location, Retry-After, X-Kg-Truncated"


class Sites:
    """Refuse cross-site requests: KG528."""

    def __init__(self, origins: tuple[str, ...] = ()) -> None:
        self._origins = frozenset(origins)

    def __call__(self, request: HTTPConnection) -> RequestError | None:
        """Return the error for a request of another site that is not listed, or that would change something."""
        if self._passes(request):
            return None
        return RequestError("KG528", "a page of another site sent this request")

    def _passes(self, request: HTTPConnection) -> bool:
        scope = request.scope
        safe = scope["method"] in SAFE
        bearer = (header(scope, b"authorization") or "").lower().startswith("bearer ")
        if bearer and header(scope, b"cookie") is None:
            return True
        origin = header(scope, b"origin")
        if origin in self._origins and (safe or scope["path"] in READING):
            return True
        site = header(scope, b"sec-fetch-site")
        if safe:
            return site not in {"cross-site", "same-site"} or header(scope, b"sec-fetch-mode") == "navigate"
        if site:
            return site in {"same-origin", "none"}
        return origin is None or origin == f"{scope['scheme']}://{header(scope, b'host')}"


class CrossOrigin:
    """Let pages of the listed origins read (CORS, Fetch Standard): never `*`, never with cookies, never changes."""

    def __init__(self, app: ASGIApp, origins: tuple[str, ...]) -> None:
        self._app = app
        self._origins = frozenset(origins)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Respond to preflights of listed origins, and name the origin in responses to it."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        headers = dict(scope["headers"])
        origin = headers.get(b"origin", b"").decode("latin-1")
        listed = origin in self._origins
        if listed and scope["method"] == "OPTIONS" and b"access-control-request-method" in headers:
            await self._preflight(origin)(scope, receive, send)
            return

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                added = [(b"vary", b"Origin")]
                if listed:
                    added += [
                        (b"access-control-allow-origin", origin.encode("latin-1")),
                        (b"access-control-expose-headers", _SHOWN.encode()),
                        (b"cross-origin-resource-policy", b"cross-origin"),
                    ]
                message = {**message, "headers": [*message["headers"], *added]}
            await send(message)

        await self._app(scope, receive, sending)

    @staticmethod
    def _preflight(origin: str) -> Response:
        return Response(
            status_code=204,
            headers={
                "Access-Control-Allow-Origin": origin,
                "Access-Control-Allow-Methods": _ALLOWED,
                "Access-Control-Allow-Headers": _ASKED,
                "Access-Control-Max-Age": "600",
                "Vary": "Origin, Access-Control-Request-Method, Access-Control-Request-Headers",
            },
        )
