"""Sizes: addresses, headers and bodies are bounded before they are read, and while they are."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Final

from kg.server.errors import RequestError
from kg.server.safety.tokens import CHANGING

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kg.server.safety.floods import Check

ADDRESS_BYTES: Final = 8192
"""How long path and query of an address may be together."""
HEADERS: Final = 100
"""How many headers a request may have."""
HEADER_BYTES: Final = 32 << 10
"""How many bytes names and values of its headers may have together."""
QUERY_BYTES: Final = 16 << 20
"""How large a body may be where nothing is changed: a query, the arguments of a view. It is held in memory, several
times over, for whoever may read."""

_PAUSE: Final = 10.0  # seconds that a body may keep us waiting for its next part
_PACE: Final = 1024  # bytes a second that a body comes with at least, once it has had a pause


def announced(most: int) -> Check:
    """Return the check of what a request announces: address, headers, encoding and length of its body."""

    def check(request: HTTPConnection) -> RequestError | None:
        scope = request.scope
        if len(scope.get("raw_path") or b"") + len(scope["query_string"]) > ADDRESS_BYTES:
            return RequestError("KG526", f"the address is longer than {ADDRESS_BYTES} bytes")
        given = scope["headers"]
        if len(given) > HEADERS or sum(len(name) + len(value) for name, value in given) > HEADER_BYTES:
            return RequestError(
                "KG535", f"the request has more than {HEADERS} headers or {HEADER_BYTES} bytes of headers"
            )
        headers = dict(given)
        if headers.get(b"content-encoding", b"identity").lower() != b"identity":
            return RequestError("KG524", "compressed bodies are not read", headers={"Accept-Encoding": "identity"})
        length = headers.get(b"content-length", b"0")
        if not length.isdigit():
            return RequestError("KG520", "the header Content-Length is not a number")
        bound = _bound(scope, most)
        return _too_large(bound) if int(length) > bound else None

    return check


def _bound(scope: Scope, most: int) -> int:
    return most if scope["path"].startswith(CHANGING) else min(most, QUERY_BYTES)


def _too_large(most: int) -> RequestError:
    hint = "A query cannot be longer." if most == QUERY_BYTES else None
    return RequestError("KG525", f"the body has more than {most} bytes", hint=hint)


class Bodies:
    """Count a body while it is read: KG525 when it is too large, KG532 when it comes too slowly."""

    def __init__(self, app: ASGIApp, most: int) -> None:
        self._app = app
        self._most = most

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on with a `receive` that counts, where there is a body."""
        if scope["type"] != "http" or not _has_body(scope):
            await self._app(scope, receive, send)
            return
        await self._app(scope, _counting(receive, _bound(scope, self._most)), send)


def _has_body(scope: Scope) -> bool:
    return any(name in (b"content-length", b"transfer-encoding") for name, _ in scope["headers"])


def _counting(receive: Receive, most: int) -> Receive:
    """Return `receive`, bounded in bytes and time until the body is whole."""
    size, whole, began = 0, False, time.monotonic()

    async def counting() -> Message:
        nonlocal size, whole
        if whole:
            return await receive()
        try:
            async with asyncio.timeout(_PAUSE):
                message = await receive()
        except TimeoutError:
            raise _too_slow() from None
        size += len(message.get("body", b""))
        whole = not message.get("more_body", False)
        if size > most:
            raise _too_large(most)
        if not whole and size < (time.monotonic() - began - _PAUSE) * _PACE:
            raise _too_slow()
        return message

    return counting


def _too_slow() -> RequestError:
    return RequestError("KG532", "the request body arrived too slowly", headers={"Connection": "close"})
