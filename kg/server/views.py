"""`/api/NAME?...`: each view (`kg.views`) as JSON, the data of the page that shows it.

Arguments are in the address, or in the body of a POST as a JSON object, for long texts and lists.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import msgspec
from starlette.responses import Response

from kg.server.errors import RequestError
from kg.server.methods import route
from kg.server.parameters import media_type, unsupported
from kg.server.safety.tokens import client
from kg.server.state import state
from kg.views.calls import CALLS

if TYPE_CHECKING:
    from starlette.requests import Request


async def answer(request: Request, name: str, /, **arguments: Any) -> bytes:
    """Return the JSON of the view `name`, computed in a reader; raises as `Readers.call`.

    It is not cancelled when the client disconnects: its work is bounded, and killing a reader discards its caches.
    """
    shared = state(request)
    return await shared.readers.call(name, arguments, seconds=shared.options.seconds, client=client(request))


async def _view(request: Request) -> Response:
    name = request.path_params["name"]
    if name not in CALLS:
        raise RequestError("KG521", f"unknown view `{name}`", hint=f"There are {', '.join(sorted(CALLS))}.")
    posted = await _posted(request) if request.method == "POST" else {}
    body = await answer(request, name, **{**request.query_params, **posted})
    return Response(body, media_type="application/json")


async def _posted(request: Request) -> dict[str, Any]:
    """Return the arguments in the body of a request; KG520 if it is not a JSON object, KG524 for another media type."""
    if media_type(request) != "application/json":
        raise unsupported(media_type(request), "application/json")
    try:
        arguments = json.loads(await request.body())
        msgspec.msgpack.encode(arguments)
    except (ValueError, RecursionError, OverflowError):  # no JSON, too deep, or a number that no reader accepts
        arguments = None
    if not isinstance(arguments, dict):
        raise RequestError("KG520", "the body is not a JSON object of arguments")
    return arguments


ROUTES = [route("/api/{name}", GET=_view, POST=_view)]
