"""`/` and `/search?q=`: what the store contains, and nodes by what they do, each with reasons and lines of code.

Above the nodes are things of all kinds by their name; with `names=1` the page has these alone (static/find.js).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from starlette.routing import Route

from kg.errors import KgError
from kg.search.options import FILTERS
from kg.server.addresses import url
from kg.server.errors import STATUS
from kg.server.pages.lists import address_of
from kg.server.rendering import page, view
from kg.server.state import state
from kg.views.lists import LISTS

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response


_EXAMPLES: Final = (
    "merge the scans of two lasers into one",
    "drive to a goal and avoid obstacles",
    "subscribes LaserScan and publishes Odometry",
    "camera driver for ROS 2",
)


async def _search(request: Request) -> Response:
    text = request.query_params.get("q", "")
    alone = "names" in request.query_params
    named = await _named(request, text, "8" if alone else "5")
    if alone:
        return page(request, "names.html", title="Names", named=named)
    filters = {name: value for name in FILTERS if (value := request.query_params.get(name, "").strip())}
    limit = request.query_params.get("limit", "20")
    twin = url("/api/find", text=text, limit=limit, **filters) if text.strip() or filters else ""
    hits, problem, status = None, None, 200
    if twin:
        try:
            hits = await view(request, "find", text=text, limit=limit, **filters)
        except KgError as error:
            if STATUS.get(error.code, 400) != 400:  # noqa: PLR2004 - errors in the words are shown next to them
                raise
            problem, status = error, 400
    return page(
        request,
        "search.html",
        title=f"Search: {text}" if text else "Search",
        twin=twin,
        status=status,
        text=text,
        given=filters,
        limit=limit,
        filters=FILTERS,
        choices=await view(request, "choices"),
        examples=_EXAMPLES,
        found=hits,
        named=named,
        problem=problem,
    )


async def _named(request: Request, text: str, limit: str) -> list[dict[str, Any]]:
    """Return the things whose names have the words of a text, each with `address` and `kind`."""
    found = (await view(request, "named", text=text, limit=limit))["names"] if text.strip() else []
    return [
        {**one, "address": address_of(one["of"], {**one, "node": one["name"]}), "kind": LISTS[one["of"]].one}
        for one in found
    ]


async def _start(request: Request) -> Response:
    empty = state(request).readers.layout.current() is None
    overview = {"sources": []} if empty else await view(request, "overview")
    return page(request, "start.html", title="Nodes, topics and systems", twin=url("/api/overview"), overview=overview)


ROUTES = [Route("/search", _search), Route("/", _start)]
