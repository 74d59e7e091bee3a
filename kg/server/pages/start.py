"""`/`: questions to ask first, what the store was read from and in which state, how much there is."""

from __future__ import annotations

from typing import TYPE_CHECKING

from starlette.routing import Route

from kg.server.addresses import url
from kg.server.rendering import page, view
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response


async def _start(request: Request) -> Response:
    empty = state(request).readers.layout.current() is None
    overview = {"sources": []} if empty else await view(request, "overview")
    return page(request, "start.html", title="Nodes, topics and systems", twin=url("/api/overview"), overview=overview)


ROUTES = [Route("/", _start)]
