"""Security headers for browsers: responses load nothing from other sites and cannot be framed.

A response that sets one of them itself keeps it; a page with an import map adds its hash by `policy`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
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


def with_headers(message: Message) -> Message:
    """Return the start of a response, with the `HEADERS` that it lacks."""
    given = {name.lower() for name, _ in message["headers"]}
    return {**message, "headers": [*message["headers"], *(pair for pair in _PAIRS if pair[0] not in given)]}
