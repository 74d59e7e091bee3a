"""`/store`: graphs as resources (SPARQL 1.1 Graph Store HTTP Protocol).

A graph is named by `?graph=IRI`, or is the default graph (`?default`), or is a resource below `/store/`, whose name is
the address of the request.
"""

from __future__ import annotations

import secrets
from functools import partial
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode, RdfFormat
from starlette.datastructures import UploadFile
from starlette.responses import Response

from kg.query.readers.messages import Question
from kg.server.addresses import address
from kg.server.errors import RequestError
from kg.server.methods import route
from kg.server.negotiation import GRAPH, choose
from kg.server.parameters import Parameters, in_utf8, media_type, unsupported
from kg.server.preconditions import on_condition
from kg.server.protocol_answer import answer
from kg.server.protocol_question import QueryRequest, sent_as
from kg.server.protocol_update import counted, patience, writer
from kg.server.safety.tokens import client
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from starlette.requests import Request

    from kg.pipeline.updating.changes import Updated

_ROOT: Final = "/store"
_MULTIPART: Final = "multipart/form-data"
_ALL: Final = "CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }"


def _graph(request: Request, parameters: Parameters) -> NamedNode | None:
    """Return the graph that a request is about; None for the default graph.

    Raises:
        RequestError: KG520 none or several are named, or the name is not an IRI.
    """
    path = _raw_path(request)
    below = path.partition(_ROOT)[2] not in {"", "/"}
    if below + ("graph" in parameters) + ("default" in parameters) != 1:
        raise RequestError(
            "KG520", "the request names no graph, or more than one", hint="Add `?graph=IRI` or `?default`."
        )
    if "default" in parameters:
        return None
    name = f"{address(request, '')}{path}" if below else parameters.one("graph") or ""
    try:
        return NamedNode(name)
    except ValueError as error:
        raise RequestError("KG520", f"`{name}` is not an IRI: {error}") from error


def _raw_path(request: Request) -> str:
    """Return the path as it was sent, since `%2F` and `/` name different graphs."""
    raw: bytes = request.scope.get("raw_path") or request.scope["path"].encode()
    return raw.partition(b"?")[0].decode("ascii", "replace")


async def _get(request: Request) -> Response:
    parameters = Parameters(request.scope["query_string"])
    graph = _graph(request, parameters)
    choices = choose(request.headers.get("accept"), parameters.formats)
    if "graph" not in choices:
        types = ", ".join(dict.fromkeys(media_type for media_type, _ in GRAPH))
        raise RequestError("KG523", "graphs are written in other formats", hint=f"Accept one of {types}.")
    if graph is not None and not await _exists(request, graph):
        hint = "The service description at /sparql lists all graphs."
        raise RequestError("KG521", f"unknown graph {graph}", hint=hint)
    text = _ALL if graph is None else f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ GRAPH {graph} {{ ?s ?p ?o }} }}"
    question = Question(
        text=text,
        formats={"graph": choices["graph"].format},
        union=False,
        rows=parameters.whole("limit"),
        offset=parameters.whole("offset") or 0,
        snapshot=parameters.one("snapshot"),
    )
    seconds = state(request).options.seconds
    stream = parameters.flag("stream") and request.scope["http_version"] != "1.0"
    chosen = {"graph": choices["graph"]}
    pairs = tuple(parameters.pairs())
    parsed = QueryRequest(question, chosen, sent_as(chosen), seconds, None, stream, pairs, is_body=False)
    return await answer(request, parsed)


async def _exists(request: Request, graph: NamedNode) -> bool:
    """Return whether a graph exists, even without triples."""
    shared = state(request)
    question = Question(text=f"ASK {{ GRAPH {graph} {{ }} }}", formats={"boolean": "csv"}, union=False)
    async with shared.readers.ask(question, seconds=shared.options.seconds, client=client(request)) as response:
        return b"true" in b"".join([part async for part in response.parts()])


async def _put(request: Request) -> Response:
    changing = writer(request)
    parameters = Parameters(request.scope["query_string"])
    graph = _graph(request, parameters)
    put = partial(changing.put_graph, graph and graph.value, await _parts(request), base=_base(request, graph))
    return _done(await _on_condition(request, parameters, graph, put))


async def _post(request: Request) -> Response:
    changing = writer(request)
    parameters = Parameters(request.scope["query_string"])
    is_new = _raw_path(request).rstrip("/") == _ROOT and "graph" not in parameters and "default" not in parameters
    new = NamedNode(address(request, f"{_ROOT}/{secrets.token_hex(8)}"))
    graph = new if is_new else _graph(request, parameters)
    post = partial(changing.post_graph, graph and graph.value, await _parts(request), base=_base(request, graph))
    updated = await _on_condition(request, parameters, None if is_new else graph, post)
    return _done(updated, new.value if is_new else None)


async def _delete(request: Request) -> Response:
    changing = writer(request)
    parameters = Parameters(request.scope["query_string"])
    graph = _graph(request, parameters)
    delete = partial(changing.delete_graph, graph and graph.value)
    return _done(await _on_condition(request, parameters, graph, delete))


async def _on_condition(
    request: Request, parameters: Parameters, graph: NamedNode | None, change: Callable[..., Awaitable[Updated]]
) -> Updated:
    """Make a change if its condition holds; the default graph and the store (None) always exist."""
    exists = partial(_exists, request, graph) if graph else None
    change = partial(change, seconds=patience(request, parameters))
    return await on_condition(request, parameters, lambda snapshot: change(snapshot=snapshot), exists)


def _base(request: Request, graph: NamedNode | None) -> str:
    """Return the base of the relative IRIs of the content (section 4.1 of the protocol)."""
    return graph.value if graph else address(request)


def _done(updated: Updated, created: str | None = None) -> Response:
    headers = counted(updated) | ({"Location": created} if created else {})
    return Response(status_code=201 if updated.created or created else 204, headers=headers)


async def _parts(request: Request) -> list[tuple[bytes, str]]:
    """Return the RDF of a request in parts, each with its media type.

    Raises:
        RequestError: KG524 unsupported media type or encoding, KG520 a form without files.
    """
    in_utf8(request)
    kind = media_type(request)
    if kind != _MULTIPART:
        return [(await request.body(), _supported(kind))]
    parts = []
    async with request.form() as form:
        for name, file in form.multi_items():
            if not isinstance(file, UploadFile):
                raise RequestError("KG520", f"the field `{name}` of the form is not a file")
            kind = (file.content_type or "").partition(";")[0].strip().lower()
            if not kind and (by_name := RdfFormat.from_extension((file.filename or "").rpartition(".")[2])):
                kind = by_name.media_type
            parts.append((await file.read(), _supported(kind)))
    if not parts:
        raise RequestError("KG520", "the form has no file")
    return parts


def _supported(kind: str) -> str:
    if not kind or RdfFormat.from_media_type(kind) is None:
        raise unsupported(kind, "text/turtle", "another format of RDF")
    return kind


_METHODS: Final = {"GET": _get, "PUT": _put, "POST": _post, "DELETE": _delete}
ROUTES = [route(_ROOT, **_METHODS), route(_ROOT + "/{path:path}", **_METHODS)]
