"""Reading of ASGI requests, at a fraction of the cost of Starlette's `Headers` and `Request`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from starlette.requests import ClientDisconnect

if TYPE_CHECKING:
    from starlette.types import Receive, Scope


ARRIVED: Final = "kg.arrived"
"""Key of a scope: whether the request has arrived with its whole body."""
WHOLE: Final = "kg.whole"
"""Key of a scope: sends a whole response (status, lines of headers, body); False if it has to be sent in parts."""


_HEAD: Final = "kg.head"
_MOST_BYTES: Final = 4096


def head_of(scope: Scope) -> tuple[object, ...] | None:
    """Return what a request says besides its body and its length, to remember what followed from the same head.

    None for a large one.
    """
    if _HEAD not in scope:
        given = [part for pair in scope["headers"] if pair[0] != b"content-length" for part in pair]
        parts = (scope["path"], scope.get("raw_path") or b"", scope["query_string"], *given)
        small = sum(map(len, parts)) <= _MOST_BYTES
        scope[_HEAD] = (scope["method"], scope["scheme"], scope["http_version"], *parts) if small else None
    head: tuple[object, ...] | None = scope[_HEAD]
    return head


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
