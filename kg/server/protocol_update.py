"""`/update`: changes by SPARQL (SPARQL 1.1 Protocol, section 2.2)."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

import msgspec
from starlette.responses import Response

from kg.server.addresses import address
from kg.server.errors import RequestError
from kg.server.methods import route
from kg.server.parameters import FORM, Parameters, body_text, in_utf8, media_type, unsupported
from kg.server.preconditions import on_condition
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request

    from kg.pipeline.updating.changes import Updated
    from kg.pipeline.updating.writer import Writer

_UPDATE: Final = "application/sparql-update"


def writer(request: Request) -> Writer:
    """Return the writer of the store; RequestError KG530 if the server is read-only."""
    shared = state(request).writer
    if shared is None:
        raise RequestError("KG530", "this server is read-only")
    return shared


def patience(request: Request, parameters: Parameters) -> float:
    """Return the deadline of a change in seconds; clients with the token may raise it."""
    return parameters.number("timeout", least=0.001) or state(request).options.update_seconds


def counted(updated: Updated) -> dict[str, str]:
    """Return the headers that report the size of a change."""
    return {
        "X-Kg-Snapshot": updated.snapshot,
        "X-Kg-Added": str(updated.added),
        "X-Kg-Removed": str(updated.removed),
        "Server-Timing": f"update;dur={updated.seconds * 1000:.1f}",
        "Cache-Control": "no-store",
    }


async def _update(request: Request) -> Response:
    changing = writer(request)
    parameters, text = await _parameters(request)
    if text is None:
        raise RequestError("KG520", "the parameter `update` is missing")
    update = partial(
        changing.update,
        text,
        parameters.all("using-graph-uri"),
        parameters.all("using-named-graph-uri"),
        base=address(request),
        seconds=patience(request, parameters),
    )
    updated = await on_condition(request, parameters, lambda snapshot: update(snapshot=snapshot))
    return Response(msgspec.json.encode(updated), headers=counted(updated), media_type="application/json")


async def _parameters(request: Request) -> tuple[Parameters, str | None]:
    query_string = request.scope["query_string"]
    kind = media_type(request)
    if "update" in Parameters(query_string):
        raise RequestError("KG520", "an update must be in the request body, not in the address")
    if kind == _UPDATE:
        return Parameters(query_string), body_text(request, await request.body())
    if kind == FORM:
        in_utf8(request)
        parameters = Parameters(query_string, await request.body())
        return parameters, parameters.one("update")
    raise unsupported(kind, _UPDATE, FORM)


ROUTES = [route(path, POST=_update) for path in ("/update", "/update/")]
