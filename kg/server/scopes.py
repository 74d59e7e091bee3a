"""Reading of ASGI requests, at a fraction of the cost of Starlette's `Headers` and `Request`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.requests import ClientDisconnect

if TYPE_CHECKING:
    from starlette.types import Receive, Scope


def header(scope: Scope, name: bytes) -> str | None:
    """Return the first header of a name, given in lower case; None if it is missing."""
    for key, value in scope["headers"]:
        if key == name:
            text: str = value.decode("latin-1")
            return text
    return None


async def body_of(receive: Receive) -> bytes:
    """Return the whole body of a request of which nothing was received; raises ClientDisconnect."""
    parts: list[bytes] = []
    more = True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            raise ClientDisconnect
        parts.append(message.get("body", b""))
        more = message.get("more_body", False)
    return parts[0] if len(parts) == 1 else b"".join(parts)
