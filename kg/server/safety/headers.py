"""Security headers for browsers: responses load nothing from other sites and cannot be framed.

A response that sets one of them itself keeps it; a page with an import map adds its hash by `policy`.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence

    from starlette.types import Message


def policy(*scripts: str) -> str:
    """Return the Content-Security-Policy; `scripts` are further sources of scripts, such as `'sha256-…'`."""
    return "; ".join(
        (
            "default-src 'none'",
            " ".join(("script-src 'self'", *scripts)),
            "style-src 'self'",
            "img-src 'self' data:",
            "font-src 'self'",
            "connect-src 'self'",
            "manifest-src 'self'",
            "form-action 'self'",
            "frame-ancestors 'none'",
            "base-uri 'none'",
        )
    )


HEADERS: Final[dict[bytes, bytes]] = {
    b"content-security-policy": policy().encode(),
    b"x-content-type-options": b"nosniff",
    b"referrer-policy": b"no-referrer",
    b"x-frame-options": b"DENY",
    b"cross-origin-opener-policy": b"same-origin",
    b"cross-origin-resource-policy": b"same-origin",
}
"""Names and values for every response."""


_PAIRS: Final = tuple(HEADERS.items())
_LINES: Final = b"".join(b"%s: %s\r\n" % pair for pair in _PAIRS)
_CONTROL: Final = re.compile(rb"[\x00-\x08\x0a-\x1f\x7f]")
"""Characters that end a header or are invalid in one (RFC 9110, section 5.5)."""


def with_headers(message: Message) -> Message:
    """Return the start of a response, with the `HEADERS` that it lacks."""
    given = {name.lower() for name, _ in message["headers"]}
    return {**message, "headers": [*message["headers"], *(pair for pair in _PAIRS if pair[0] not in given)]}


def lines_of(headers: Sequence[tuple[bytes, bytes]]) -> bytes | None:
    """Return the lines of the headers of a response with a known length, with all `HEADERS`.

    None for a response that sets one of these itself, names no length, or closes the connection, and for headers that
    are not valid.
    """
    by_name = dict(headers)
    if b"content-length" not in by_name or b"connection" in by_name or not HEADERS.keys().isdisjoint(by_name):
        return None
    pairs = [b"%s: %s" % pair for pair in headers]
    if _CONTROL.search(b"".join(pairs)):
        return None
    return b"\r\n".join((*pairs, _LINES))
