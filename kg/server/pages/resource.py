"""`/resource?iri=`: packages, types, hardware, functions, capabilities, findings, and the facts about anything."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import NamedNode
from starlette.routing import Route

from kg.errors import KgError
from kg.server.addresses import url
from kg.server.pages.lists import related
from kg.server.pages.missing import missing
from kg.server.rendering import page, view
from kg.views.lists import LISTS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from starlette.requests import Request
    from starlette.responses import Response

_PAGES: Final = {
    "node": ("/node", "iri", "All of this node on one page"),
    "configuration": ("/system", "name", "The nodes that it starts, as a graph"),
    **dict.fromkeys(("topic", "service", "action"), ("/channel", "name", "Who uses it, in every launch file")),
}
"""Kinds of things with pages of their own: path, parameter, and text of the link."""
_LIMIT: Final = "25"

_OF_PACKAGE: Final = ("package", "repository")
_TYPE: Final = ("types", {"nodes": ("type",), "topics": ("type",), "services": ("type",), "actions": ("type",)})
_KINDS: Final[Mapping[str, tuple[str, Mapping[str, Sequence[str]]]]] = {
    "package": (
        "packages",
        {
            "nodes": _OF_PACKAGE,
            "topics": ("package",),
            "systems": _OF_PACKAGE,
            "types": ("package",),
            "findings": _OF_PACKAGE,
        },
    ),
    **dict.fromkeys(("message", "service-type", "action-type"), _TYPE),
    "hardware": ("hardware", {"nodes": ("hardware",)}),
    "function": ("functions", {"nodes": ("function",)}),
    "capability": ("capabilities", {"nodes": ("capability",)}),
}
"""The list of a kind of thing (or prefix of its IRI), and the lists on its page with the facets that select rows."""
_PICTURE: Final = """CONSTRUCT {{ {0} ?to ?object . ?subject ?from {0} }} WHERE {{
  {{
    SELECT * {{ {0} ?to ?object . ?object rdfs:label ?name FILTER(STRSTARTS(STR(?to), STR(rnkg:))) }} LIMIT 60
  }} UNION {{
    SELECT * {{ ?subject ?from {0} ; rdfs:label ?name FILTER(STRSTARTS(STR(?from), STR(rnkg:))) }} LIMIT 60
  }}
}}"""
"""The named things that a thing is related to, without relations that others imply; the picture adds more of each."""
_SHOWN: Final = 20  # number of rows of each list


async def _resource(request: Request) -> Response:
    names = ("iri", "predicate", "direction", "offset", "limit")
    arguments = {name: value for name in names if (value := request.query_params.get(name, ""))}
    iri = arguments.setdefault("iri", "")
    arguments.setdefault("limit", "100" if "predicate" in arguments else _LIMIT)
    try:
        resource = await view(request, "resource", **arguments)
    except KgError as error:
        name = iri.rstrip("/>").rpartition("/")[2].rpartition("#")[2]
        return missing(
            request, error, "No facts about this resource", name, lambda other: url("/search", q=other), several=False
        )
    own = _PAGES.get(resource["kind"]) if "#" not in resource["iri"] else None
    first = {} if "predicate" in arguments else await _first(request, resource)
    finding = first.get("finding")
    return page(
        request,
        "resource.html",
        title=finding["message"] if finding else resource["label"],
        twin=url("/api/resource", **arguments),
        found=resource,
        own=(url(own[0], **{own[1]: resource["iri"]}), own[2]) if own else None,
        first=first,
        picture=_PICTURE.format(NamedNode(resource["iri"])),
        sides=(("out", "Facts about it", resource["out"]), ("in", "Facts that mention it", resource["in"])),
        number=sum(group["count"] for group in (*resource["out"], *resource["in"])),
        chosen=arguments.get("predicate", ""),
        pages=_pages(resource, arguments),
        address=lambda thing: url("/node" if thing["kind"] == "node" else "/resource", iri=thing["iri"]),
    )


async def _first(request: Request, resource: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the page shows before the facts: a finding, or what is known of a thing and the lists about it."""
    system, mark, _ = resource["iri"].partition("#finding/")
    if mark:
        reported = (await view(request, "lint", system=system))["findings"]
        finding = next((one for one in reported if one["iri"] == resource["iri"]), None)
        return {"finding": finding} if finding else {}
    kind = resource["kind"] or resource["short"].partition(":")[0]
    if kind not in _KINDS or (resource["kind"] and "#" in resource["iri"]):
        return {}
    of, lists = _KINDS[kind]
    about = await view(request, "about", iri=resource["iri"])
    facets_of = {"repository": about.get("repository", "")}
    shown = [
        await related(request, name, _SHOWN, {facet: facets_of.get(facet, resource["label"]) for facet in facets})
        for name, facets in lists.items()
    ]
    return {
        "about": about,
        "repository": facets_of["repository"],
        "kind": kind,
        "lists": [one for one in shown if one["found"]["rows"]],
        "of": (of, LISTS[of].title),
    }


def _pages(resource: dict[str, Any], arguments: dict[str, str]) -> dict[str, str]:
    """Return the addresses of the previous and the next page of one property."""
    groups = [*resource["out"], *resource["in"]]
    if "predicate" not in arguments or len(groups) != 1:
        return {}
    (group,) = groups
    limit = int(arguments["limit"]) if arguments["limit"].isdigit() else len(group["facts"])
    parameters = {name: arguments[name] for name in ("iri", "predicate", "direction", "limit") if name in arguments}
    around: dict[str, str] = {}
    if group["offset"] > 0:
        around["before"] = url("/resource", **parameters, offset=max(0, group["offset"] - limit) or "")
    following = group["offset"] + len(group["facts"])
    if group["facts"] and following < group["count"]:
        around["after"] = url("/resource", **parameters, offset=following)
    return around


ROUTES = [Route("/resource", _resource)]
