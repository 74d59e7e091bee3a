"""Addresses of this server: the one module with the path at which a reverse proxy publishes it (`root_path`).

    url("/node", iri=iri)          # "/node?iri=...", or "/kg/node?iri=..." under the root path `/kg`
    address(request, "/update")    # "http://example.org/kg/update"

Routes and request checks see paths without the root path. `Rooted` removes it from requests that have it, so a proxy
may strip or keep it. Addresses in responses come from `url`; scripts of pages use `static/address.js`.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import urlencode

from starlette.datastructures import URL

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.requests import Request
    from starlette.types import ASGIApp, Receive, Scope, Send

_ROOT: Final[ContextVar[str]] = ContextVar("kg_root_path", default="")

NAVIGATION: Final = {
    "/": "Start",
    "/nodes": "Nodes",
    "/systems": "Systems",
    "/query": "Query",
    "/rules": "Rules",
    "/robot": "Robot",
}
"""Address to name: the menu of all pages."""


@contextmanager
def rooted(root: str) -> Iterator[None]:
    """Put a root path, `/kg` or empty, before all addresses created inside the context."""
    token = _ROOT.set(root)
    try:
        yield
    finally:
        _ROOT.reset(token)


def url(path: str, **parameters: Any) -> str:
    """Return the path of a page or endpoint as clients see it; parameters that are None or empty are omitted."""
    given = {name: value for name, value in parameters.items() if value not in (None, "")}
    whole = _ROOT.get() + path
    return f"{whole}?{urlencode(given)}" if given else whole


def address(request: Request, path: str | None = None) -> str:
    """Return the absolute address of a path, by default that of the request, without parameters."""
    scope = request.scope
    server = tuple(scope["server"] or ()) or None
    return _address(scope["scheme"], request.headers.get("host"), server, url(scope["path"] if path is None else path))


@lru_cache(maxsize=64)
def _address(scheme: str, host: str | None, server: tuple[Any, ...] | None, path: str) -> str:
    headers = [] if host is None else [(b"host", host.encode("latin-1"))]
    return str(URL(scope={"scheme": scheme, "headers": headers, "server": server, "path": path}))


class Rooted:
    """Remove the root path from requests, and put it before all addresses in responses."""

    def __init__(self, app: ASGIApp, root: str) -> None:
        self._app = app
        self._root = root

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on; tasks started at application start-up inherit the root path too."""
        with rooted(self._root):
            await self._app(self._inside(scope) if scope["type"] == "http" else scope, receive, send)

    def _inside(self, scope: Scope) -> Scope:
        """Return a request without the root path in `path` and `raw_path`; unchanged if it has none."""
        raw: bytes = scope.get("raw_path") or scope["path"].encode()
        if not f"{scope['path']}/".startswith(f"{self._root}/") or not raw.startswith(self._root.encode()):
            return scope
        cut = len(self._root)  # ASCII, as the setting requires
        return {**scope, "path": scope["path"][cut:] or "/", "raw_path": raw[cut:] or b"/"}
