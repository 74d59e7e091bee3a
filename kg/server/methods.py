"""Routes with a handler for each HTTP method, OPTIONS on all, and 405 with `Allow` for other methods.

Source: RFC 9110, sections 9.3.7 and 15.5.6.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.exceptions import HTTPException
from starlette.responses import RedirectResponse, Response
from starlette.routing import Match, Route

from kg.server.addresses import url
from kg.server.errors import HANDLERS

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request

    Endpoint = Callable[[Request], Awaitable[Response]]


def route(path: str, **endpoints: Endpoint) -> Route:
    """Return the route of `path`: `GET=...` handles GET and HEAD, `PUT=...` handles PUT, and so on."""
    if "GET" in endpoints:
        endpoints.setdefault("HEAD", endpoints["GET"])

    async def dispatch(request: Request) -> Response:
        return await endpoints[request.method](request)

    return Route(path, dispatch, methods=list(endpoints), name=path)


async def not_allowed(request: Request, error: Exception) -> Response:
    """Respond to a method without a handler: OPTIONS with the list of methods, any other with 405."""
    headers = error.headers if isinstance(error, HTTPException) else None
    methods = [method.strip() for method in (headers or {}).get("Allow", "").split(",") if method.strip()]
    allowed = ", ".join(sorted({*methods, "OPTIONS"}))
    if request.method == "OPTIONS":
        return Response(status_code=204, headers={"Allow": allowed})
    return await HANDLERS[HTTPException](request, HTTPException(405, headers={"Allow": allowed}))


async def not_found(request: Request, error: Exception) -> Response:
    """Redirect `/nodes/` to `/nodes`, list the methods of all routes for `OPTIONS *`, and respond 404 to the rest."""
    if request.method == "OPTIONS" and request.scope.get("raw_path") == b"*":
        methods = {method for one in request.app.routes if isinstance(one, Route) for method in one.methods or ()}
        return Response(status_code=204, headers={"Allow": ", ".join(sorted({*methods, "OPTIONS"}))})
    path = request.url.path.rstrip("/")
    scope = {**request.scope, "path": path}
    if path != request.url.path and any(one.matches(scope)[0] is not Match.NONE for one in request.app.routes):
        shorter = request.url.replace(path=url(path), scheme="", netloc="")
        return RedirectResponse(shorter, 307)
    return await HANDLERS[HTTPException](request, error)
