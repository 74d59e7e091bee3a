"""`/node?iri=`: all of one node."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from kg.errors import KgError
from kg.render.node_graph import node_graph_svg
from kg.server.addresses import url
from kg.server.pages.missing import missing
from kg.server.rendering import page, view
from kg.views.node_graph import node_relations

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from starlette.requests import Request


TAGS: Final = {
    "publishes": "publisher",
    "subscribes": "subscriber",
    "services": "service",
    "clients": "client",
    "action_servers": "action",
    "action_clients": "action",
}
_COUNTED: Final = {
    "publishes": "publishes {} topic",
    "subscribes": "subscribes to {} topic",
    "services": "offers {} service",
    "clients": "calls {} service",
    "action_servers": "offers {} action",
    "action_clients": "calls {} action",
}
_MANY: Final = 14  # above this number of channels, the picture shows fewer neighbours of each
_NEAR: Final = (6, 2)
_SEE_OTHER: Final = 303


async def _node(request: Request) -> Response:
    arguments = {key: request.query_params.get(key, "") for key in ("iri", "name", "package")}
    if not (arguments["iri"] or arguments["name"]):
        return RedirectResponse(url("/search"), _SEE_OTHER)
    try:
        node = await view(request, "node", **arguments)
    except KgError as error:
        if error.code == "KG001" and arguments["iri"]:
            return RedirectResponse(url("/resource", iri=arguments["iri"]), _SEE_OTHER)
        name = arguments["name"] or arguments["iri"]
        return missing(request, error, f"Node {name}", name, lambda other: url("/node", name=other))
    explicit = [one for one in node["interfaces"] if not one["implicit"]]
    numbers = Counter(one["role"] for one in explicit)
    return page(
        request,
        "node.html",
        title=node["name"],
        twin=url("/api/node", iri=node["iri"]),
        node=node,
        explicit=explicit,
        counted=[
            words.format(number) + ("" if number == 1 else "s")
            for role, words in _COUNTED.items()
            if (number := numbers[role])
        ],
        implicit=[one for one in node["interfaces"] if one["implicit"]],
        parameters=[one for one in node["parameters"] if not one["implicit"]],
        more_parameters=[one for one in node["parameters"] if one["implicit"]],
        tags=TAGS,
        picture=_picture(node, explicit),
    )


def _picture(node: Mapping[str, Any], explicit: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the node, its channels and its neighbours in the format of graph.js."""
    own = {"id": node["iri"], "label": node["name"], "kind": "node", "detail": "this node"}
    channels = {_channel(one): one for one in explicit if one["resolved"]}
    nodes = {own["id"]: own}
    for key, one in channels.items():
        href = url("/resource", iri=one["channel_iri"]) if one["channel_iri"] else None
        label, detail = one["resolved"], one["type"] or ""
        nodes[key] = {"id": key, "label": label, "kind": one["kind"], "detail": detail, "href": href}
    edges = [_edge(node["iri"], _channel(one), one) for one in explicit if one["resolved"]]
    most = _NEAR[len(channels) > _MANY]
    for near in node["neighbours"]:
        for other, edge in _near(near, most):
            nodes.setdefault(other["id"], other)
            edges.append(edge)
    return {"nodes": list(nodes.values()), "edges": edges, "groups": []}


def _channel(one: Mapping[str, Any]) -> str:
    return f"{one['kind']} {one['resolved']}"


def _edge(node: str, channel: str, one: Mapping[str, Any], *, reverse: bool = False) -> dict[str, Any]:
    """Return the edge of an endpoint of `node`; with `reverse`, that of a node at the other end."""
    source, target = (node, channel) if one["outward"] != reverse else (channel, node)
    return {"source": source, "target": target, "kind": one["kind"]}


def _near(near: Mapping[str, Any], most: int) -> Iterator[tuple[dict[str, Any], dict[str, Any]]]:
    """Yield some neighbours of a channel with their edges, and one placeholder for all others."""
    channel = f"{near['kind']} {near['channel']}"
    drawn = [
        {"id": one["iri"], "label": one["name"], "kind": "node", "detail": one["package"],
         "href": url("/node", iri=one["iri"])}
        for one in near["nodes"][:most]
    ]  # fmt: skip
    hidden = near["count"] - len(drawn)
    if hidden:
        href = url("/resource", iri=near["channel_iri"])
        side = "out" if near["outward"] else "in"
        drawn.append({"id": f"{channel} more {side}", "label": f"{hidden:,} more", "kind": "resource", "href": href})
    for one in drawn:
        yield one, _edge(one["id"], channel, near, reverse=True)


async def _graph(request: Request) -> Response:
    node = await view(request, "node", iri=request.query_params.get("iri", ""))
    return Response(node_graph_svg(node["name"], node_relations(node)), media_type="image/svg+xml")


ROUTES = [Route("/node", _node), Route("/node/graph.svg", _graph)]
