"""What people read is sent compressed where they take it: pages, views, scripts and styles.

Answers of the SPARQL protocols stream to programs as they are found, and what a robot sends has to be there at once;
both are sent as they are. No page holds a secret that its length could tell of: the token is in none.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.gzip import GZipMiddleware

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

_AS_THEY_ARE: Final = ("/sparql", "/update", "/store", "/jobs", "/robot/", "/health", "/metrics")
_LEAST: Final = 1 << 10  # bytes below which there is nothing to gain
_LEVEL: Final = 5
_NEVER: Final = re.compile(r"(?:^|,)\s*gzip\s*;\s*q\s*=\s*0(?:\.0*)?\s*(?:,|$)", re.IGNORECASE)
"""The weight that says so (RFC 9110, section 12.5.3)."""


class Compressed:
    """Compress answers with gzip (RFC 9110, section 8.4.1.3), but for those below the paths that stream."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._compressing = GZipMiddleware(app, minimum_size=_LEAST, compresslevel=_LEVEL)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http" or scope["path"].startswith(_AS_THEY_ARE):
            await self._app(scope, receive, send)
            return
        if _refused(Headers(scope=scope)):
            # Through the same middleware: caches have to hear that others get other bytes (`Vary`).
            scope = {**scope, "headers": [pair for pair in scope["headers"] if pair[0] != b"accept-encoding"]}

        async def sending(message: Message) -> None:
            if message["type"] == "http.response.start":
                _weaken(MutableHeaders(raw=message["headers"]))
            await send(message)

        await self._compressing(scope, receive, sending)


def _refused(headers: Headers) -> bool:
    """Tell whether a client says that it does not take gzip, which is another thing than saying nothing of it."""
    return bool(_NEVER.search(", ".join(headers.getlist("accept-encoding"))))


def _weaken(headers: MutableHeaders) -> None:
    """Mark the tag of what was compressed as weak: the bytes are not those that it was made of (RFC 9110, 8.8.1)."""
    if "content-encoding" in headers and (tag := headers.get("etag", "")).startswith('"'):
        headers["etag"] = f"W/{tag}"
