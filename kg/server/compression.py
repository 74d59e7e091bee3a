"""Gzip compression of pages, views, scripts and styles.

SPARQL results are streamed and robot events must arrive at once, so neither is compressed. Pages contain no secret
whose length could leak: the token is in none of them.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.gzip import GZipMiddleware

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

_AS_THEY_ARE: Final = ("/sparql", "/update", "/store", "/jobs", "/robot/", "/health", "/metrics")
_LEAST: Final = 1 << 10  # size in bytes below which compression gains nothing
_LEVEL: Final = 5
_NEVER: Final = re.compile(r"(?:^|,)\s*gzip\s*;\s*q\s*=\s*0(?:\.0*)?\s*(?:,|$)", re.IGNORECASE)
"""The quality value that refuses gzip (RFC 9110, section 12.5.3)."""


class Compressed:
    """Compress responses with gzip (RFC 9110, section 8.4.1.3), except below the streaming paths."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._compressing = GZipMiddleware(app, minimum_size=_LEAST, compresslevel=_LEVEL)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request."""
        if scope["type"] != "http" or scope["path"].startswith(_AS_THEY_ARE):
            await self._app(scope, receive, send)
            return
        if _refused(Headers(scope=scope)):
            # Through the same middleware: caches need `Vary`, since other clients get other bytes.
            scope = {**scope, "headers": [pair for pair in scope["headers"] if pair[0] != b"accept-encoding"]}

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                _weaken(MutableHeaders(raw=message["headers"]))
            await send(message)

        await self._compressing(scope, receive, sending)


def _refused(headers: Headers) -> bool:
    """Return whether a client refuses gzip explicitly, rather than not mentioning it."""
    return bool(_NEVER.search(", ".join(headers.getlist("accept-encoding"))))


def _weaken(headers: MutableHeaders) -> None:
    """Mark the entity tag of a compressed response as weak, since its bytes differ (RFC 9110, section 8.8.1)."""
    if "content-encoding" in headers and (tag := headers.get("etag", "")).startswith('"'):
        headers["etag"] = f"W/{tag}"
