"""`/resource?iri=`: what the store says of anything that has no page of its own, page by page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from starlette.routing import Route

from kg.errors import KgError
from kg.server.addresses import url
from kg.server.pages.missing import ABSENT, missing
from kg.server.rendering import page, view

if TYPE_CHECKING:
    from starlette.requests import Request
    from starlette.responses import Response

_PAGES: Final = {
    "node": ("/node", "iri", "All of this node on one page"),
    "configuration": ("/system", "name", "The nodes that it starts, as a graph"),
    **dict.fromkeys(("topic", "service", "action"), ("/channel", "name", "Who uses it, in every launch file")),
}
"""Kinds of things that have a page of their own: its path, its parameter, the words of the link to it."""
_LIMIT: Final = "25"


async def _resource(request: Request) -> Response:
    names = ("iri", "predicate", "direction", "offset", "limit")
    asked = {name: value for name in names if (value := request.query_params.get(name, ""))}
    iri = asked.setdefault("iri", "")
    asked.setdefault("limit", "100" if "predicate" in asked else _LIMIT)
    try:
        found = await view(request, "resource", **asked)
    except KgError as error:
        if error.code not in ABSENT:
            raise
        name = iri.rstrip("/>").rpartition("/")[2].rpartition("#")[2]
        return missing(request, error, "No facts about this resource", name, lambda other: url("/search", q=other))
    own = _PAGES.get(found["kind"]) if "#" not in found["iri"] else None
    return page(
        request,
        "resource.html",
        title=found["label"],
        twin=url("/api/resource", **asked),
        found=found,
        own=(url(own[0], **{own[1]: found["iri"]}), own[2]) if own else None,
        sides=(("out", "Facts about it", found["out"]), ("in", "Facts that mention it", found["in"])),
        chosen=asked.get("predicate", ""),
        pages=_pages(found, asked),
        address=lambda thing: url("/node" if thing["kind"] == "node" else "/resource", iri=thing["iri"]),
    )


def _pages(found: dict[str, Any], asked: dict[str, str]) -> dict[str, str]:
    """Return the addresses of the page before and of the one behind, where one property is shown."""
    groups = [*found["out"], *found["in"]]
    if "predicate" not in asked or len(groups) != 1:
        return {}
    (group,) = groups
    limit = int(asked["limit"]) if asked["limit"].isdigit() else len(group["facts"])
    kept = {name: asked[name] for name in ("iri", "predicate", "direction", "limit") if name in asked}
    around: dict[str, str] = {}
    if group["offset"] > 0:
        around["before"] = url("/resource", **kept, offset=max(0, group["offset"] - limit) or "")
    following = group["offset"] + len(group["facts"])
    if group["facts"] and following < group["count"]:
        around["after"] = url("/resource", **kept, offset=following)
    return around


ROUTES = [Route("/resource", _resource)]
