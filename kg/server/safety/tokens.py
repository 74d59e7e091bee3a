"""The token: who has it may change the store, and read it where others can reach the server.

It comes from the environment or a file, never from the command line, and is said by `Authorization: Bearer` or, once a
person has logged in (`kg.server.safety.login`), by a cookie that holds a proof of it and not the token itself.
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
"""How many characters a token has at least."""
CHANGING: Final = ("/update", "/store")
"""The addresses at which the store is changed, and those below them."""
MOVING: Final = frozenset({"/robot/do", "/robot/run", "/robot/pause", "/robot/resume"})
"""The addresses at which a robot is moved; at `/robot/stop` whoever may look on may stop it."""
_OPEN: Final = frozenset({"/login", "/health", "/favicon.ico"})
"""The addresses that need no token: for logging in, and whether the server lives."""
_OPEN_BELOW: Final = ("/errors/", "/static/", "/vendor/")
"""Where all addresses need none: nothing there is of the store."""


class Tokens:
    """The token of a server: a fixed one, or that in a file, which is read again whenever the file changes."""

    def __init__(self, value: str | None, path: Path | None = None) -> None:
        self._value = value
        self._path = path
        self._seen: tuple[int, int, int] | None = None
        self._key = secrets.token_bytes(32)

    @property
    def current(self) -> str | None:
        """The token in force; None when there is none, or the file of it cannot be used: then nothing matches."""
        if self._path is None:
            return self._value
        try:
            found = self._path.stat()
            stamp = (found.st_mtime_ns, found.st_size, found.st_ino)
            if stamp != self._seen:
                self._value = self._path.read_text(encoding="utf-8").strip()
                self._seen = stamp
        except (OSError, UnicodeDecodeError):
            self._value, self._seen = None, None
        return self._value if self._value and len(self._value) >= LEAST else None

    @property
    def proof(self) -> str | None:
        """What a cookie holds: it ends with the token that it proves, and with this server."""
        token = self.current
        return token and hmac.new(self._key, token.encode(), hashlib.sha256).hexdigest()

    def matches(self, candidate: str) -> bool:
        """Tell whether a text is the token, in a time that does not depend on where they differ."""
        return _same(self.current, candidate)

    def proves(self, candidate: str) -> bool:
        """Tell whether the value of a cookie proves the token."""
        return _same(self.proof, candidate)


def _same(secret: str | None, candidate: str) -> bool:
    """Compare by hashes, whose lengths are equal."""
    wanted, given = (hashlib.sha256(text.encode("utf-8", "replace")).digest() for text in (secret or "", candidate))
    return hmac.compare_digest(wanted, given) and bool(secret)


def cookie_name(request: HTTPConnection) -> str:
    """Return the name of the cookie; browsers do not tell the ports of one host apart, so the name does."""
    return f"kg_session_{request.url.port or 0}"


def is_trusted(request: HTTPConnection) -> bool:
    """Tell whether a request came with the token, for what only its holder may ask."""
    return bool(request.scope.get("kg.trusted"))


def client(request: HTTPConnection) -> str:
    """Return the client that a request counts for: the holder of the token, or the address."""
    return "token" if is_trusted(request) or request.client is None else request.client.host


class Doors:
    """Refuse what needs the token and has none (KG529), and what nobody may do here (KG530).

    That is changes where the server is read-only, and moving a robot where there is no token.
    """

    def __init__(self, options: Options, tokens: Tokens) -> None:
        self._write = options.write
        self._move = options.token is not None or options.token_file is not None
        self._tokens = tokens
        self._all = not options.open_to_all and not is_loopback(options.host)

    def __call__(self, request: HTTPConnection) -> RequestError | Response | None:
        """Return what stops a request, and note whether it came with the token."""
        scope = request.scope
        scope["kg.tokens"] = self._tokens
        scope["kg.trusted"] = self._has_token(request)
        changes = _changes(request)
        if changes and not self._write:
            return RequestError("KG530", "this server reads only")
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
        kind, _, said = (header(request.scope, b"authorization") or "").partition(" ")
        if kind.lower() == "bearer":
            return self._tokens.matches(said.strip())
        named = header(request.scope, b"cookie") is not None
        proof = request.cookies.get(cookie_name(request)) if named else None
        return proof is not None and self._tokens.proves(proof)


def _is_open(path: str) -> bool:
    return path in _OPEN or path.startswith(_OPEN_BELOW)


def _changes(request: HTTPConnection) -> bool:
    """Tell whether a request asks for a change, be it in a form that no route takes."""
    scope = request.scope
    method, path = str(scope["method"]), str(scope["path"])
    if path.rstrip("/") == "/update" or (b"update=" in scope["query_string"] and "update" in request.query_params):
        return method != "OPTIONS"
    return method not in SAFE and path.startswith(CHANGING)
