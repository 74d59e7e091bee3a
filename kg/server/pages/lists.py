"""`/nodes`, `/topics`, ...: index pages for each kind of thing, with facets, sorting, paging and exports.

All use one template. `LISTS` has an entry for each, by its name in the view `list`, which is also its path. Query
parameters are `q` (words), `sort`, `offset`, `limit`, one for each facet, and `format`: `json`, `jsonl` or `csv`.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import parse_qsl

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from kg.server.addresses import url
from kg.server.errors import RequestError
from kg.server.negotiation import best, ranges
from kg.server.rendering import page, view

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from starlette.requests import Request

_PAGE: Final = 100
_MOST: Final = 1000
_FEW: Final = 6  # so many values of a filter are links, each one click; more are in a field for choosing
_FORMATS: Final = (
    ("text/html", "html"),
    ("application/json", "json"),
    ("text/csv", "csv"),
    ("application/x-ndjson", "jsonl"),
)
_EXPORTS: Final = {"csv": "CSV", "json": "JSON", "jsonl": "JSON Lines"}
_OWN: Final = frozenset({"q", "sort", "offset", "limit", "format"})


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its title, its key in the rows, the shape of its cells, and their link.

    `shape` is `text`, `mono`, `number`, `tags` or `place`. `to` is a path and its query parameters, each with the key
    in the rows of its value.
    """

    title: str
    key: str
    shape: str = "text"
    to: tuple[str, Mapping[str, str]] | None = None


@dataclass(frozen=True, slots=True)
class Listed:
    """An index page: its title, the singular name of its things, a sentence about it, and its columns."""

    title: str
    one: str
    lead: str
    columns: Sequence[Column]
    many: str = ""
    """The plural, where it is not the title."""

    def called(self, number: int) -> str:
        """Return the name for a number of things."""
        return self.one if number == 1 else self.many or self.title[0].lower() + self.title[1:]


_NODE: Final = ("/node", {"iri": "iri"})
_PACKAGE: Final = Column("Package", "package", to=("/nodes", {"package": "package"}))
_PLACE: Final = Column("Line", "place", "place")
_GRADES: Final = tuple(Column(title, title.lower(), "number") for title in ("Certain", "Strong", "Weak"))


def _channels(kind: str, giving: str, taking: str) -> tuple[Column, ...]:
    return (
        Column("Name", "name", "mono", (f"/channel?kind={kind}", {"name": "name"})),
        Column("Types", "types", "mono"),
        Column(giving, "giving", "number"),
        Column(taking, "taking", "number"),
        Column("Launch files", "systems", "number"),
        Column("Ends", "ends"),
    )


def _classes(parameter: str) -> tuple[Column, ...]:
    return (
        Column("Name", "name", to=("/resource", {"iri": "iri"})),
        Column("Nodes", "nodes", "number", ("/nodes", {parameter: "name"})),
        *_GRADES,
    )


LISTS: Final[Mapping[str, Listed]] = {
    "nodes": Listed(
        "Nodes",
        "node",
        "Every node that code or packages declare. Numbers leave out what frameworks create.",
        (
            Column("Node", "node", to=_NODE),
            _PACKAGE,
            Column("Description", "description"),
            Column("Kind", "kind", "tags"),
            Column("ROS", "ros", "number"),
            *(
                Column(title, key, "number")
                for title, key in (
                    ("Pub", "publishes"),
                    ("Sub", "subscribes"),
                    ("Srv", "services"),
                    ("Cli", "clients"),
                    ("Act", "actions"),
                    ("Par", "parameters"),
                )
            ),
        ),
    ),
    "packages": Listed(
        "Packages",
        "package",
        "Every package of the sources.",
        (
            Column("Package", "name", to=("/resource", {"iri": "iri"})),
            Column("Version", "version"),
            Column("ROS", "ros", "number"),
            Column("Nodes", "nodes", "number", ("/nodes", {"package": "name", "repository": "repository"})),
            Column("Definitions", "definitions", "number"),
            Column("Problems", "problems", "number"),
            Column("Source", "repository", to=("/packages", {"repository": "repository"})),
            Column("Folder", "folder", "mono"),
        ),
    ),
    "topics": Listed(
        "Topics",
        "topic",
        "Names in launched systems, after remapping, and of nodes started alone; none that only frameworks use.",
        _channels("topic", "Publishers", "Subscribers"),
    ),
    "services": Listed(
        "Services",
        "service",
        "Names in launched systems, after remapping, and of nodes started alone; none that only frameworks use.",
        _channels("service", "Servers", "Clients"),
    ),
    "actions": Listed(
        "Actions",
        "action",
        "Names in launched systems, after remapping, and of nodes started alone.",
        _channels("action", "Servers", "Clients"),
    ),
    "types": Listed(
        "Types",
        "type",
        "Types of messages, services and actions that nodes use or packages define.",
        (
            Column("Type", "name", "mono", ("/resource", {"iri": "iri"})),
            Column("Kind", "kind", "tags"),
            Column("Nodes", "nodes", "number", ("/nodes", {"type": "name"})),
            Column("Defined", "defined"),
            Column("Sources", "repositories"),
        ),
    ),
    "hardware": Listed(
        "Hardware",
        "kind of hardware",
        "Kinds of hardware and known devices that nodes work with, with the number of nodes by grade of evidence.",
        _classes("hardware"),
        "kinds of hardware",
    ),
    "functions": Listed(
        "Functions",
        "function",
        "What nodes are for, with the number of nodes by grade of evidence.",
        _classes("function"),
    ),
    "capabilities": Listed(
        "Capabilities",
        "capability",
        "What nodes enable a robot to do, with the number of nodes by grade of evidence. "
        "Nodes with weak evidence alone are not in the first number.",
        _classes("capability"),
    ),
    "systems": Listed(
        "Launch files",
        "launch file",
        "Every launch file, evaluated with the defaults of its arguments: the nodes it starts and their connections.",
        (
            Column("Launch file", "name", to=("/system", {"name": "iri"})),
            Column("Source", "repository", to=("/systems", {"repository": "repository"})),
            Column("ROS", "ros", "number"),
            *(Column(title, title.lower(), "number") for title in ("Nodes", "Topics", "Services", "Actions")),
            Column("Findings", "problems", "number"),
            Column("Worst", "worst", "tags"),
            Column("Use", "use"),
        ),
    ),
    "parameters": Listed(
        "Parameters",
        "parameter",
        "Parameters of nodes, without those that frameworks create.",
        (
            Column("Parameter", "name", "mono", ("/parameters", {"name": "name"})),
            Column("Node", "node", to=_NODE),
            _PACKAGE,
            Column("Type", "type", "mono"),
            Column("Default", "default", "mono"),
            Column("Access", "access", "tags"),
            Column("Description", "description"),
            _PLACE,
        ),
    ),
    "findings": Listed(
        "Findings",
        "finding",
        "Problems in the wiring of launch files, as `kg lint` reports them.",
        (
            Column("Severity", "severity", "tags"),
            Column("Code", "code", "mono", ("/findings", {"code": "code"})),
            Column("Message", "message", to=("/resource", {"iri": "iri"})),
            Column("Launch file", "system", to=("/system", {"name": "system", "repository": "repository"})),
            Column("Other launch files", "others", "number"),
            _PLACE,
        ),
    ),
    "classes": Listed(
        "Classes",
        "class",
        "Classes with instances in this store, and the properties of these, counted in a sample of large classes.",
        (
            Column("Class", "name", "mono", ("/resource", {"iri": "iri"})),
            Column("Instances", "instances", "number", ("/resource?predicate=rdf:type&direction=in", {"iri": "iri"})),
            Column("Subclass of", "parents", "mono"),
            Column("Properties", "properties", "number", ("/properties", {"subject": "name"})),
            Column("Most used", "first", "mono"),
            Column("Meaning", "description"),
        ),
    ),
    "properties": Listed(
        "Properties",
        "property",
        "Properties with facts in this store, and the classes that they connect, the most frequent first.",
        (
            Column("Property", "name", "mono", ("/resource", {"iri": "iri"})),
            Column("Facts", "facts", "number"),
            Column("From", "first_subjects", "mono"),
            Column("To", "first_values", "mono"),
            Column("Meaning", "description"),
        ),
    ),
}
"""Index pages by the name of their list."""
_LABELS: Final = {
    "ros": "ROS version",
    "worst": "Worst finding",
    "repository": "Source",
    "system": "Launch file",
    "parent": "Subclass of",
    "subject": "From",
    "value": "To",
}
"""Labels of facets that differ from their parameter."""


async def _list(request: Request) -> Response:
    name = request.url.path.removeprefix("/")
    listed = LISTS[name]
    given = {key: value.strip() for key, value in request.query_params.items() if value.strip()}
    wanted = _format(request, given)
    number = given.get("limit", "")
    is_whole = number.isascii() and number.isdigit() and len(number) <= len(str(_MOST))
    limit = min(int(number), _MOST) if is_whole else 0
    arguments = {key: value for key, value in given.items() if key not in _OWN}
    arguments |= {"sort": given.get("sort", ""), "offset": given.get("offset", ""), "text": given.get("q", "")}
    limited = str(limit or (_PAGE if wanted == "html" else "")) if wanted in {"html", "json"} else ""
    whole = "yes" if wanted in {"json", "jsonl"} else ""
    rows = await view(request, "list", of=name, limit=limited, whole=whole, **arguments)
    if wanted != "html":
        return _export(rows, wanted, listed.columns, name)
    parameters = {key: value for key, value in given.items() if key not in {"offset", "format"}}
    address = f"/{name}"
    start, end = rows["offset"], rows["offset"] + len(rows["rows"])
    most = limit or _PAGE
    return page(
        request,
        "list.html",
        title=listed.title,
        twin=url(address, **parameters, offset=start or "", format="json"),
        name=name,
        lists=LISTS,
        listed=listed,
        found=rows,
        text=given.get("q", ""),
        hidden={key: parameters[key] for key in ("sort", "limit") if key in parameters},
        facets=[
            {
                "name": key,
                "label": _label(key),
                "given": parameters.get(key, ""),
                "few": len(values) <= _FEW,
                "values": [{**one, "address": url(address, **{**parameters, key: one["value"]})} for one in values],
            }
            for key, values in rows["facets"].items()
            if len(values) > 1 or key in parameters
        ],
        chosen=[
            (
                _label(key),
                parameters[key],
                url(address, **{other: value for other, value in parameters.items() if other != key}),
            )
            for key in rows["facets"]
            if key in parameters
        ],
        columns=[(one, *_sorting(address, parameters, one)) for one in listed.columns],
        link=_link,
        before=url(address, **parameters, offset=max(0, start - most) or "") if start else "",
        after=url(address, **parameters, offset=end) if end < rows["total"] else "",
        last=url(address, **parameters, offset=(rows["total"] - 1) // most * most or "") if end < rows["total"] else "",
        exports=[(label, url(address, **parameters, format=key)) for key, label in _EXPORTS.items()],
    )


def address_of(name: str, row: Mapping[str, Any]) -> str:
    """Return the address of a thing of the list `name`, by the first column, of which `row` has all keys."""
    return _link(LISTS[name].columns[0], row)


async def related(request: Request, name: str, most: int, facets: Mapping[str, str]) -> dict[str, Any]:
    """Return the first rows of a list that facets leave, for `list_table.html`, and the address of the whole list."""
    rows = await view(request, "list", of=name, limit=str(most), **facets)
    columns = [(one, "", "") for one in LISTS[name].columns if one.key not in facets]
    return {
        "listed": LISTS[name],
        "found": rows,
        "columns": columns,
        "address": url(f"/{name}", **facets),
        "link": _link,
    }


def _format(request: Request, given: Mapping[str, str]) -> str:
    """Return the format that a request names or accepts, by default HTML; RequestError KG523 unknown format."""
    names = [name for _, name in _FORMATS]
    if "format" in given:
        if given["format"] not in names:
            raise RequestError("KG523", f"unknown format `{given['format']}`", hint=f"Use one of {', '.join(names)}.")
        return given["format"]
    accepted = ranges(request.headers.get("accept", "") or "*/*")
    chosen = best(accepted, _FORMATS) if accepted else None
    if chosen is None:
        types = ", ".join(kind for kind, _ in _FORMATS)
        raise RequestError("KG523", "no list can be written in an accepted format", hint=f"Accept one of {types}.")
    return chosen.format


def _export(data: Mapping[str, Any], wanted: str, columns: Sequence[Column], name: str) -> Response:
    """Return the rows as JSON with their facets, as JSON Lines, or as a table of the columns."""
    if wanted == "json":
        return Response(msgspec.json.encode(data), media_type="application/json")
    headers = {"Content-Disposition": f'attachment; filename="{name}.{wanted}"'}
    if wanted == "jsonl":
        body = b"".join(msgspec.json.encode(row) + b"\n" for row in data["rows"])
        return Response(body, media_type="application/x-ndjson", headers=headers)
    text = io.StringIO()
    writer = csv.writer(text)
    keys = [key for one in columns for key in (("file", "line") if one.shape == "place" else (one.key,))]
    writer.writerow(keys)
    for row in data["rows"]:
        cells = [row.get(key) for key in keys]
        writer.writerow(" ".join(map(str, cell)) if isinstance(cell, list) else cell for cell in cells)
    return Response(text.getvalue(), media_type="text/csv", headers=headers)


def _label(name: str) -> str:
    return _LABELS.get(name, name.capitalize())


def _sorting(address: str, parameters: Mapping[str, str], column: Column) -> tuple[str, str]:
    """Return the address of the list sorted by a column, and its present order, as `aria-sort` names it.

    The address reverses an order that is in force already, and is empty for places; numbers sort in descending order
    first. The order is empty if rows are not sorted by the column.
    """
    sort, ascending, descending = parameters.get("sort", ""), column.key, f"-{column.key}"
    order = {ascending: "ascending", descending: "descending"}.get(sort, "")
    if column.shape == "place":
        return "", order
    ways = (descending, ascending) if column.shape == "number" else (ascending, descending)
    return url(address, **{**parameters, "sort": ways[sort == ways[0]]}), order


def _link(column: Column, row: Mapping[str, Any]) -> str:
    """Return the link of a cell; empty for an empty cell."""
    if column.to is None or row[column.key] in (None, "", 0):
        return ""
    path, parameters = column.to
    page_path, _, fixed = path.partition("?")
    return url(page_path, **dict(parse_qsl(fixed)), **{name: row[key] for name, key in parameters.items()})


ROUTES = [Route(f"/{name}", _list) for name in LISTS]
