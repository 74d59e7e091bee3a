"""`/system?name=` and `/channel?kind=&name=`: a wired launch file, and a topic, service or action with all its ends."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from kg.errors import KgError
from kg.render.text import count
from kg.server.addresses import url
from kg.server.pages.missing import missing
from kg.server.pages.node import TAGS
from kg.server.rendering import page, view

if TYPE_CHECKING:
    from collections.abc import Mapping

    from starlette.requests import Request


_SEE_OTHER: Final = 303
_LONG: Final = 100  # tables with more rows have pages of their own, which the system's page loads on demand


async def _system(request: Request) -> Response:
    arguments = {key: value for key in ("name", "repository", "every") if (value := request.query_params.get(key, ""))}
    name, chosen = arguments.setdefault("name", ""), request.query_params.get("part", "")
    if not name:
        return RedirectResponse(url("/systems"), _SEE_OTHER)
    try:
        system = await view(request, "system", **arguments)
    except KgError as error:
        return missing(request, error, "No such system", name, lambda other: url("/system", name=other))
    shared = {"twin": url("/api/system", **arguments), "system": system, "tags": TAGS}
    parts = _parts(system)
    if part := next((one for one in parts if one["name"] == chosen), None):
        title = f"{part['title']} of {system['name']}"
        return page(request, "system_part.html", title=title, part=part, whole=url("/system", **arguments), **shared)
    return page(
        request,
        "system.html",
        title=system["name"],
        picture=_picture(system),
        parts=[
            {**one, "address": url("/system", **arguments, part=one["name"]) if len(one["rows"]) > _LONG else ""}
            for one in parts
        ],
        left_out=sum(one["left_out"] for one in system["instances"]),
        every=url("/system", **arguments, every="all") if "every" not in arguments else "",
        **shared,
    )


def _parts(system: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the non-empty tables below that of the nodes, by name, with the text for their number of rows."""
    rows: dict[str, list[Any]] = {
        name: [(one["key"], each) for one in system["instances"] for each in one[key]]
        for name, key in (("connections", "ends"), ("remappings", "remaps"), ("parameters", "parameters"))
    }
    rows["arguments"] = system["arguments"]
    return [
        {"name": name, "rows": listed, "title": count(len(listed), name.removesuffix("s"))}
        for name, listed in rows.items()
        if listed
    ]


def _picture(system: Mapping[str, Any]) -> dict[str, Any]:
    """Return the graph in the format of graph.js: nodes link to their pages, and subjects of findings are marked.

    Empty attributes are omitted, since large systems have many nodes.
    """
    nodes = []
    for one in system["picture"]["nodes"]:
        node = {key: value for key, value in one.items() if value and key not in {"iri", "names"}}
        if one["iri"]:
            node["href"] = url("/node", iri=one["iri"])
        if one["findings"]:
            node["marked"] = True
        nodes.append(node)
    marked = [f"{one.get('group', '')}/" for one in nodes if "marked" in one]
    groups = [
        {**one, "marked": any(space.startswith(f"{one['id']}/") for space in marked)}
        for one in system["picture"]["groups"]
    ]
    return {**system["picture"], "nodes": nodes, "groups": groups}


async def _channel(request: Request) -> Response:
    names = ("kind", "name", "system")
    arguments = {name: value for name in names if (value := request.query_params.get(name, ""))}
    name, kind = arguments.setdefault("name", ""), arguments.setdefault("kind", "topic")
    if not name:
        return RedirectResponse(url("/search"), _SEE_OTHER)
    try:
        channel = await view(request, "channel", **arguments)
    except KgError as error:
        return missing(request, error, f"No such {kind}", name, lambda other: url("/channel", kind=kind, name=other))
    twin = url("/api/channel", **arguments)
    return page(
        request, "channel.html", title=channel["name"] or name, twin=twin, found=channel, asked=arguments, tags=TAGS
    )


ROUTES = [Route("/system", _system), Route("/channel", _channel)]
