"""`/sparql`: queries by GET, POST and QUERY (SPARQL 1.1 Protocol, section 2.1), and the service description."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from kg.errors import KgError
from kg.server.addresses import url
from kg.server.description import description
from kg.server.errors import handled
from kg.server.leaving import ClientLeftError
from kg.server.methods import route
from kg.server.negotiation import prefers_pages
from kg.server.protocol_answer import answer
from kg.server.protocol_question import parse_request
from kg.server.scopes import header

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Receive, Scope, Send

_PATHS: Final = ("/sparql", "/sparql/")
_METHODS: Final = frozenset({"GET", "HEAD", "POST", "QUERY"})


class Endpoint:
    """Handle queries before routing, which costs more than a cheap query; pass other requests on."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request; raises errors that occur after the response has begun."""
        if scope["type"] != "http" or scope["path"] not in _PATHS or scope["method"] not in _METHODS:
            await self._app(scope, receive, send)
            return
        request = Request(scope, receive)
        try:
            response = await _query(request)
        except (KgError, ClientLeftError) as error:
            response = await handled(request, error)
        await response(scope, receive, send)


async def _query(request: Request) -> Response:
    if _is_followed(request):
        return RedirectResponse(request.url.replace(path=url("/query"), scheme="", netloc=""), 303, {"Vary": "Accept"})
    parsed = await parse_request(request)
    return await description(request) if parsed is None else await answer(request, parsed)


def _is_followed(request: Request) -> bool:
    """Return whether a person followed a link to the endpoint in a browser, which the query page handles."""
    if request.method != "GET" or not prefers_pages(header(request.scope, b"accept")):
        return False
    return "format" not in request.query_params and "output" not in request.query_params


ROUTES = [route(path, GET=_query, POST=_query, QUERY=_query) for path in _PATHS]
"""The same route for methods other than those of queries, which are refused or described."""
