"""Limits on the size of addresses, headers and bodies, checked before and while they are read."""

from __future__ import annotations

import asyncio
import time
from typing import TYPE_CHECKING, Final

from kg.server.errors import RequestError
from kg.server.safety.tokens import CHANGING
from kg.server.scopes import ARRIVED

if TYPE_CHECKING:
    from starlette.requests import HTTPConnection
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

    from kg.server.safety.floods import Check

ADDRESS_BYTES: Final = 8192
"""Maximum length in bytes of path and query of an address."""
HEADERS: Final = 100
"""Maximum number of headers of a request."""
_HEADER_BYTES: Final = 32 << 10  # maximum size in bytes of all header names and values
QUERY_BYTES: Final = 16 << 20
"""Maximum size in bytes of the body of a reading request: a query, or arguments of a view. It is held in memory,
several times over, for any client that may read.
"""

_PAUSE: Final = 10.0  # maximum seconds between two parts of a body
_PACE: Final = 1024  # minimum rate in bytes per second of a body, after its first pause


def announced(request: HTTPConnection) -> RequestError | None:
    """Check the address, the headers and the encoding of the body of a request."""
    scope = request.scope
    if len(scope.get("raw_path") or b"") + len(scope["query_string"]) > ADDRESS_BYTES:
        return RequestError("KG526", f"the address is longer than {ADDRESS_BYTES} bytes")
    given = scope["headers"]
    if len(given) > HEADERS or sum(len(name) + len(value) for name, value in given) > _HEADER_BYTES:
        return RequestError("KG535", f"the request has more than {HEADERS} headers or {_HEADER_BYTES} bytes of headers")
    if dict(given).get(b"content-encoding", b"identity").lower() != b"identity":
        return RequestError("KG524", "compressed bodies are not supported", headers={"Accept-Encoding": "identity"})
    return None


def long(most: int) -> Check:
    """Return the check of the declared length of the body of a request."""

    def check(request: HTTPConnection) -> RequestError | None:
        scope = request.scope
        length = dict(scope["headers"]).get(b"content-length", b"0")
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
    """Limit the body of a request while it is read: KG525 if it is too large, KG532 if it is too slow."""

    def __init__(self, app: ASGIApp, most: int) -> None:
        self._app = app
        self._most = most

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on a request, with a `receive` that counts if it has a body."""
        if scope["type"] != "http" or not _has_body(scope):
            await self._app(scope, receive, send)
            return
        await self._app(scope, _counting(scope, receive, _bound(scope, self._most)), send)


def _has_body(scope: Scope) -> bool:
    return any(name in (b"content-length", b"transfer-encoding") for name, _ in scope["headers"])


def _counting(scope: Scope, receive: Receive, most: int) -> Receive:
    """Return `receive`, limited in bytes and time until the body is complete."""
    size, whole, began = 0, False, time.monotonic()

    async def counting() -> Message:
        nonlocal size, whole
        if whole:
            return await receive()
        if ARRIVED in scope:  # nothing to wait for; a timer would cost more than all else here
            message = await receive()
        else:
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
