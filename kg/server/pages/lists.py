"""`/nodes`, `/topics`, ...: index pages for each kind of thing, with facets, sorting, paging and exports.

All use one template and the declarations of `kg.views.lists`. Query parameters are `q` (words), `sort`, `offset`,
`limit`, one for each facet, and `format`: `json`, `jsonl` or `csv`.
"""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import parse_qsl

import msgspec
from starlette.responses import Response
from starlette.routing import Route

from kg.server.addresses import url
from kg.server.errors import RequestError
from kg.server.negotiation import best, ranges
from kg.server.rendering import page, view
from kg.views.lists import LISTS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from starlette.requests import Request

    from kg.views.lists import Column

_PAGE: Final = 100
_MOST: Final = 1000
_FEW: Final = 6  # maximum number of values of a filter that are links; more are options of a field
_FORMATS: Final = (
    ("text/html", "html"),
    ("application/json", "json"),
    ("text/csv", "csv"),
    ("application/x-ndjson", "jsonl"),
)
_EXPORTS: Final = {"csv": "CSV", "json": "JSON", "jsonl": "JSON Lines"}
_OWN: Final = frozenset({"q", "sort", "offset", "limit", "format"})


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
                "label": listed.label(key),
                "given": parameters.get(key, ""),
                "few": len(values) <= _FEW,
                "values": [{**one, "address": url(address, **{**parameters, key: one["value"]})} for one in values],
            }
            for key, values in rows["facets"].items()
            if len(values) > 1 or key in parameters
        ],
        chosen=[
            (
                listed.label(key),
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
    """Return the address of a thing of the list `name`: the link of its first column, of which `row` has all keys."""
    return _link(LISTS[name].columns[0], row)


async def related(request: Request, name: str, most: int, facets: Mapping[str, str]) -> dict[str, Any]:
    """Return the first rows of a filtered list for `list_table.html`, and the address of the filtered list."""
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
