"""`/query`: the query editor; its script uses the endpoint and the views.

`query` is a text, or `name` the name of a stored query, whose parameters are the other parameters of the address.
`snapshot` identifies the data of a shared link. With any of these, the query runs at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import msgspec
from starlette.routing import Route

from kg.query.formats import BY_NAME
from kg.query.writing import parquet
from kg.server.addresses import url
from kg.server.rendering import page, view
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import Iterable

    from starlette.requests import Request
    from starlette.responses import Response

_OWN: Final = frozenset({"query", "name", "snapshot", "limit", "timeout"})
_ROWS: Final = ("json", "csv", "tsv", "xml", "markdown")
_GRAPHS: Final = ("turtle", "ntriples", "jsonld", "rdfxml")
_LIMIT: Final = 1000  # default limit of rows


async def _query(request: Request) -> Response:
    given = request.query_params
    name = given.get("name", "")
    values = {key: value for key, value in given.items() if key not in _OWN and value}
    chosen = await view(request, "stored", name=name, values=msgspec.json.encode(values).decode()) if name else None
    options = state(request).options
    data = {
        "text": given.get("query", "") or (chosen["bound"] if chosen else ""),
        "run": bool(given.get("query") or chosen),
        "stored": chosen["query"] if chosen else "",
        "values": values if chosen else {},
        "wanted": given.get("snapshot", ""),
        "snapshot": state(request).readers.layout.current(),
        "prefixes": await view(request, "prefixes"),
        "base": state(request).settings.base,
        "limit": min(_LIMIT, options.rows),
        "rows": options.rows,
        "seconds": options.seconds,
    }
    return page(
        request,
        "query.html",
        title=chosen["title"] if chosen else "Query",
        twin=url("/api/stored"),
        text=data["text"],
        data=msgspec.json.encode(data).decode(),
        rows=_labelled((*_ROWS, *([parquet.NAME] if parquet.is_installed() else []))),
        graphs=_labelled(_GRAPHS),
    )


def _labelled(names: Iterable[str]) -> list[tuple[str, str]]:
    return [(name, BY_NAME[name].label) for name in names]


ROUTES = [Route("/query", _query)]
