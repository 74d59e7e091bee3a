"""The token: its holder may change the store, and read it where other machines can reach the server.

It comes from the environment or a file, never from the command line. Clients send it as `Authorization: Bearer`. After
a login (`kg.server.safety.login`) browsers send a cookie with a proof of the token, not the token itself.
"""

from __future__ import annotations

import hashlib
import hmac
import secrets
from typing import TYPE_CHECKING, Final

from starlette.responses import RedirectResponse, Response

from kg.server.addresses import url
from kg.server.errors import RequestError
from kg.server.safety.hosts import is_loopback
from kg.server.safety.sites import SAFE
from kg.server.scopes import header

if TYPE_CHECKING:
    from pathlib import Path

    from starlette.requests import HTTPConnection

    from kg.server.options import Options

LEAST: Final = 16
"""Minimum length of a token in characters."""
CHANGING: Final = ("/update", "/store")
"""Addresses at which the store is changed, and those below them."""
MOVING: Final = frozenset({"/robot/do", "/robot/run", "/robot/pause", "/robot/resume"})
"""Addresses at which a robot is moved; every viewer may use `/robot/stop`."""
_OPEN: Final = frozenset({"/login", "/health", "/favicon.ico"})  # addresses that need no token: login and health
_OPEN_BELOW: Final = ("/errors/", "/static/", "/vendor/")
"""Prefixes of addresses that need no token and reveal nothing of the store."""


class Tokens:
    """The token of a server: fixed, or in a file that is read again whenever it changes."""

    def __init__(self, value: str | None, path: Path | None = None) -> None:
        self._value = value
        self._path = path
        self._seen: tuple[int, int, int] | None = None
        self._key = secrets.token_bytes(32)

    @property
    def current(self) -> str | None:
        """The current token; None if there is none, or its file is unusable: then nothing matches."""
        if self._path is None:
            return self._value
        try:
            status = self._path.stat()
            stamp = (status.st_mtime_ns, status.st_size, status.st_ino)
            if stamp != self._seen:
                self._value = self._path.read_text(encoding="utf-8").strip()
                self._seen = stamp
        except (OSError, UnicodeDecodeError):
            self._value, self._seen = None, None
        return self._value if self._value and len(self._value) >= LEAST else None

    @property
    def proof(self) -> str | None:
        """The value of the cookie, valid for this token and this process of the server."""
        token = self.current
        return token and hmac.new(self._key, token.encode(), hashlib.sha256).hexdigest()

    def matches(self, candidate: str) -> bool:
        """Return whether a text is the token, in constant time."""
        return _same(self.current, candidate)

    def proves(self, candidate: str) -> bool:
        """Return whether the value of a cookie proves the token."""
        return _same(self.proof, candidate)


def _same(secret: str | None, candidate: str) -> bool:
    """Compare hashes, which have equal lengths."""
    wanted, given = (hashlib.sha256(text.encode("utf-8", "replace")).digest() for text in (secret or "", candidate))
    return hmac.compare_digest(wanted, given) and bool(secret)


def cookie_name(request: HTTPConnection) -> str:
    """Return the name of the cookie, which contains the port, since browsers share cookies between ports of a host."""
    return f"kg_session_{request.url.port or 0}"


def is_trusted(request: HTTPConnection) -> bool:
    """Return whether a request came with the token."""
    return bool(request.scope.get("kg.trusted"))


def client(request: HTTPConnection) -> str:
    """Return the client that a request counts for: the holder of the token, or the address."""
    return "token" if is_trusted(request) or request.client is None else request.client.host


class Doors:
    """Refuse requests that lack the required token (KG529), and requests that are never allowed (KG530).

    The latter are changes to a read-only server, and moving a robot without a token.
    """

    def __init__(self, options: Options, tokens: Tokens) -> None:
        self._write = options.write
        self._move = options.token is not None or options.token_file is not None
        self._tokens = tokens
        self._all = not options.open_to_all and not is_loopback(options.host)

    def __call__(self, request: HTTPConnection) -> RequestError | Response | None:
        """Return the error for a refused request, and record whether a request has the token."""
        scope = request.scope
        scope["kg.tokens"] = self._tokens
        scope["kg.trusted"] = self._has_token(request)
        changes = _changes(request)
        if changes and not self._write:
            return RequestError("KG530", "this server is read-only")
        moves = scope["method"] not in SAFE and scope["path"].rstrip("/") in MOVING
        if moves and not self._move:
            hint = "Start it with a token, in KG_TOKEN or by --token-file, and log in with that."
            return RequestError("KG530", "moving a robot through this server needs a token, but none is set", hint=hint)
        if scope["kg.trusted"] or not (changes or moves or (self._all and not _is_open(scope["path"]))):
            return None
        if scope["method"] == "GET" and "text/html" in request.headers.get("accept", ""):
            wanted = scope["path"] + ("?" + scope["query_string"].decode("latin-1") if scope["query_string"] else "")
            return RedirectResponse(url("/login", next=wanted), 303)
        return RequestError("KG529", "this request needs the token of the server, which it does not have")

    def _has_token(self, request: HTTPConnection) -> bool:
        kind, _, token = (header(request.scope, b"authorization") or "").partition(" ")
        if kind.lower() == "bearer":
            return self._tokens.matches(token.strip())
        named = header(request.scope, b"cookie") is not None
        proof = request.cookies.get(cookie_name(request)) if named else None
        return proof is not None and self._tokens.proves(proof)


def _is_open(path: str) -> bool:
    return path in _OPEN or path.startswith(_OPEN_BELOW)


def _changes(request: HTTPConnection) -> bool:
    """Return whether a request asks for a change, even in a form that no route accepts."""
    scope = request.scope
    method, path = str(scope["method"]), str(scope["path"])
    if path.rstrip("/") == "/update" or (b"update=" in scope["query_string"] and "update" in request.query_params):
        return method != "OPTIONS"
    return method not in SAFE and path.startswith(CHANGING)
