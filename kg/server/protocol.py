"""`/sparql`: queries by GET, POST and QUERY (SPARQL 1.1 Protocol, section 2.1), and the service description."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.responses import RedirectResponse

from kg.server.description import description
from kg.server.methods import route
from kg.server.negotiation import prefers_pages
from kg.server.protocol_answer import answer
from kg.server.protocol_question import asked

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

__all__ = ["ROUTES"]


async def _query(request: Request) -> Response:
    if _is_followed(request):
        return RedirectResponse(request.url.replace(path="/query", scheme="", netloc=""), 303, {"Vary": "Accept"})
    found = await asked(request)
    return await description(request) if found is None else await answer(request, found)


def _is_followed(request: Request) -> bool:
    """Tell whether a person followed a link to the endpoint in a browser: the page of queries shows the same."""
    if request.method != "GET" or not prefers_pages(request.headers.get("accept")):
        return False
    return "format" not in request.query_params and "output" not in request.query_params


ROUTES = [route(path, GET=_query, POST=_query, QUERY=_query) for path in ("/sparql", "/sparql/")]
