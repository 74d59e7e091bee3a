"""`/channel?kind=&name=`: one topic, service or action with all its ends, in launched systems and in code."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from kg.errors import KgError
from kg.server.addresses import url
from kg.server.pages.missing import ABSENT, SEVERAL, missing
from kg.server.pages.node import TAGS
from kg.server.rendering import page, view

if TYPE_CHECKING:
    from starlette.requests import Request

_SEE_OTHER: Final = 303


async def _channel(request: Request) -> Response:
    names = ("kind", "name", "system")
    asked = {name: value for name in names if (value := request.query_params.get(name, ""))}
    name, kind = asked.setdefault("name", ""), asked.setdefault("kind", "topic")
    if not name:
        return RedirectResponse(url("/search"), _SEE_OTHER)
    try:
        found = await view(request, "channel", **asked)
    except KgError as error:
        if error.code not in {*ABSENT, SEVERAL}:
            raise
        return missing(request, error, f"No such {kind}", name, lambda other: url("/channel", kind=kind, name=other))
    twin = url("/api/channel", **asked)
    return page(request, "channel.html", title=found["name"] or name, twin=twin, found=found, asked=asked, tags=TAGS)


ROUTES = [Route("/channel", _channel)]
