"""`/openapi.json`: the server's OpenAPI 3.1 description, from its routes and the signatures of its views.

This module adds the parameters, bodies and responses of each address.
"""

from __future__ import annotations

import asyncio
import inspect
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route

import kg
from kg.server.addresses import url
from kg.server.errors import PROBLEM
from kg.server.negotiation import GRAPH, RESULTS
from kg.views.calls import CALLS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from starlette.requests import Request

_VIEWS: Final = "/api/{name}"
_LEFT_OUT: Final = {"HEAD", "OPTIONS"}
_PLACEHOLDER: Final = re.compile(r"\{(\w+)(?::\w+)?\}")
_PROBLEM: Final = {"$ref": "#/components/responses/Problem"}

_TEXT: Final = {"type": "string"}
_WHOLE: Final = {"type": "integer", "minimum": 0}
_IRI: Final = {"type": "string", "format": "iri"}
_OBJECT: Final = {"type": "object"}
_DATA: Final = tuple(dict.fromkeys(kind for kind, _ in GRAPH))
_ANSWERS: Final = tuple(dict.fromkeys(kind for kind, _ in (*RESULTS, *GRAPH)))
_DOCUMENTS: Final = ("text/turtle", "application/n-triples", "application/ld+json", "application/rdf+xml")


def _parameter(name: str, schema: Mapping[str, Any], description: str, *, required: bool = False) -> dict[str, Any]:
    return {"name": name, "in": "query", "required": required, "description": description, "schema": dict(schema)}


def _graphs(prefix: str) -> tuple[dict[str, Any], ...]:
    many = {"type": "array", "items": _IRI}
    return (
        _parameter(f"{prefix}-graph-uri", many, "Graphs that are merged into the default graph."),
        _parameter(f"{'using-' * (prefix == 'using')}named-graph-uri", many, "Graphs that GRAPH may name."),
    )


_SNAPSHOT: Final = _parameter("snapshot", _TEXT, "The data wanted; other data is an error (KG512).")
_ONLY_IF: Final = (
    _SNAPSHOT,
    {
        "name": "If-Match",
        "in": "header",
        "required": False,
        "description": "Tags of the data that may be changed, as answers have them, or `*`; else it is 412 (KG536).",
        "schema": dict(_TEXT),
    },
    {
        "name": "If-None-Match",
        "in": "header",
        "required": False,
        "description": "`*` where the graph may not be there yet, or tags of data that may not be changed (KG536).",
        "schema": dict(_TEXT),
    },
)
_TIMEOUT: Final = _parameter("timeout", {"type": "number", "exclusiveMinimum": 0}, "Seconds at most.")
_READING: Final = (
    _parameter("format", _TEXT, "Name or media type of the format, in place of the header Accept."),
    _parameter("limit", _WHOLE, "Rows or triples at most."),
    _parameter("offset", _WHOLE, "How many of them are left out at the beginning."),
    _SNAPSHOT,
    _parameter("stream", {"type": "boolean"}, "Whether the answer is sent while it is found."),
    _TIMEOUT,
)
_JOB: Final = _parameter(
    "job", {"type": "string", "pattern": "^[A-Za-z0-9_-]{16,128}$"}, "An identity to cancel it by."
)
_QUERY: Final = _parameter("query", _TEXT, "The SPARQL query; without one the answer describes the service.")
_GRAPH: Final = (
    _parameter("graph", _IRI, "The name of a graph."),
    _parameter("default", {"type": "string", "maxLength": 0}, "The unnamed graph."),
)


@dataclass(frozen=True, slots=True)
class Operation:
    """A method at an address; `bodies` maps media types to schemas, `answers` statuses to theirs, by default JSON."""

    summary: str
    parameters: tuple[dict[str, Any], ...] = ()
    bodies: Mapping[str, Mapping[str, Any]] | None = None
    answers: Mapping[int, tuple[str, ...]] = field(default_factory=lambda: {200: ("application/json",)})
    token: bool = False


def _form(name: str) -> dict[str, Any]:
    return {"type": "object", "properties": {name: _TEXT}, "required": [name]}


_ASKED: Final = Operation(
    "Answer a SPARQL query.",
    (*_graphs("default"), *_READING, _JOB),
    {"application/sparql-query": _TEXT, "application/x-www-form-urlencoded": _form("query")},
    {200: _ANSWERS},
)
_PUT: Final = dict.fromkeys(_DOCUMENTS, _TEXT)
_JSON: Final = {"application/json": _OBJECT}
_DONE: Final[Mapping[int, tuple[str, ...]]] = {204: ()}
_STORED: Final = {200: ("application/json",), 201: ("application/json",), 204: ()}

OPERATIONS: Final[Mapping[tuple[str, str], Operation]] = {
    ("GET", "/sparql"): Operation(
        "Answer a SPARQL query, or describe the service.",
        (_QUERY, *_graphs("default"), *_READING, _JOB),
        answers={200: _ANSWERS, 303: (), 304: ()},
    ),
    ("POST", "/sparql"): _ASKED,
    ("QUERY", "/sparql"): _ASKED,
    ("POST", "/update"): Operation(
        "Change the store by SPARQL.",
        (*_graphs("using"), *_ONLY_IF, _TIMEOUT),
        {"application/sparql-update": _TEXT, "application/x-www-form-urlencoded": _form("update")},
        token=True,
    ),
    ("GET", "/store"): Operation("Return a graph.", (*_GRAPH, *_READING), answers={200: _DATA, 304: ()}),
    ("PUT", "/store"): Operation("Replace a graph.", (*_GRAPH, *_ONLY_IF), _PUT, _STORED, token=True),
    ("POST", "/store"): Operation("Add to a graph.", (*_GRAPH, *_ONLY_IF), _PUT, _STORED, token=True),
    ("DELETE", "/store"): Operation("Remove a graph.", (*_GRAPH, *_ONLY_IF), answers=_STORED, token=True),
    ("GET", "/store/{path}"): Operation("Return the graph of this name.", _READING, answers={200: _DATA, 304: ()}),
    ("PUT", "/store/{path}"): Operation("Replace the graph of this name.", _ONLY_IF, _PUT, _STORED, token=True),
    ("POST", "/store/{path}"): Operation("Add to the graph of this name.", _ONLY_IF, _PUT, _STORED, token=True),
    ("DELETE", "/store/{path}"): Operation("Remove the graph of this name.", _ONLY_IF, answers=_STORED, token=True),
    ("GET", "/jobs"): Operation("List what runs."),
    ("GET", "/jobs/{identity}"): Operation("Say how far a query is."),
    ("DELETE", "/jobs/{identity}"): Operation("Cancel a query.", answers={204: ()}),
    ("GET", "/health"): Operation("Say whether the store can be read."),
    ("GET", "/metrics"): Operation("Return figures for Prometheus.", answers={200: ("text/plain",)}),
    ("GET", "/openapi.json"): Operation("Describe this server."),
    ("GET", "/errors/{code}"): Operation(
        "Explain the code of an error.", answers={200: ("text/plain", "text/html", "application/json")}
    ),
    ("POST", "/login"): Operation(
        "Log in with the token.",
        bodies={"application/x-www-form-urlencoded": _form("token")},
        answers={303: (), 401: ("text/html",)},
    ),
    ("POST", "/logout"): Operation("Log out.", answers={303: ()}),
    ("GET", "/robot/events"): Operation("Tell what happens on the robot.", answers={200: ("text/event-stream",)}),
    ("GET", "/robot/view"): Operation("Show a simulated robot from above.", answers={200: ("image/svg+xml",)}),
    ("GET", "/robot/why"): Operation(
        "Prove that the robot has a capability.",
        (_parameter("capability", _TEXT, "Its name, its label or its IRI.", required=True),),
    ),
    ("POST", "/robot/check"): Operation(
        "Check a program, given as JSON or as text, and return it as both.",
        bodies=_JSON,
    ),
    ("POST", "/robot/convert"): Operation(
        "Return a program as text, as code for rospy or rclpy, or as a behaviour tree, or a tree as text.",
        bodies=_JSON,
    ),
    ("POST", "/robot/run"): Operation(
        "Run a program, given as JSON or as text.", bodies=_JSON, answers=_DONE, token=True
    ),
    ("POST", "/robot/pause"): Operation("Let the program pause.", answers=_DONE, token=True),
    ("POST", "/robot/resume"): Operation("Resume the program.", answers=_DONE, token=True),
    ("POST", "/robot/stop"): Operation("Stop whatever moves.", answers=_DONE),
    ("POST", "/robot/do"): Operation("Do something, for an open page.", bodies=_JSON, answers=_DONE, token=True),
    ("POST", "/robot/read"): Operation("Let an open page follow values.", bodies=_JSON, answers=_DONE),
    ("POST", "/robot/here"): Operation("Confirm that a page is still open.", bodies=_JSON, answers=_DONE),
}
"""Operations by method and address; pages are described by their routes alone."""


def describe(routes: list[BaseRoute]) -> dict[str, Any]:
    """Return the OpenAPI document of an application with these routes."""
    paths: dict[str, dict[str, Any]] = {}
    for path, method, operation in _operations(routes):
        described = _described(path, operation)
        # OpenAPI 3.1 has no name for the method QUERY; 3.2 calls it so.
        paths.setdefault(path, {})["x-query" if method == "QUERY" else method.lower()] = described
    return {
        "openapi": "3.1.0",
        "info": {
            "title": "kg",
            "version": kg.__version__,
            "summary": "A SPARQL endpoint about ROS nodes.",
        },
        "servers": [{"url": url("") or "/"}],
        "paths": dict(sorted(paths.items())),
        "components": {
            "responses": {
                "Problem": {
                    "description": "An error: RFC 9457, with the code of `kg` and the place in the query.",
                    "content": {"application/problem+json": {"schema": PROBLEM}},
                }
            },
            "securitySchemes": {"token": {"type": "http", "scheme": "bearer"}},
        },
    }


def _operations(routes: list[BaseRoute]) -> Iterator[tuple[str, str, Operation]]:
    for route in routes:
        if not isinstance(route, Route):
            continue
        path = _PLACEHOLDER.sub(r"{\1}", route.path)
        if path == _VIEWS:
            yield from ((f"/api/{name}", method, view) for name, method, view in _views())
        elif path == "/" or not path.endswith("/"):
            for method in sorted((route.methods or set()) - _LEFT_OUT):
                description = inspect.getdoc(route.endpoint) or f"The page {route.path}."
                page = Operation(description.partition("\n")[0], answers={200: ("text/html",)})
                yield path, method, OPERATIONS.get((method, path), page)


def _views() -> Iterator[tuple[str, str, Operation]]:
    for name in sorted(CALLS):
        view = CALLS[name].function
        summary = (inspect.getdoc(view) or name).partition("\n")[0]
        arguments = list(inspect.signature(view).parameters.values())[2:]
        texts = tuple(
            {
                "name": argument.name,
                "in": "query",
                "required": argument.default is argument.empty,
                "schema": {"type": "integer"} if str(argument.annotation).startswith("int") else {"type": "string"},
            }
            for argument in arguments
            if argument.kind not in {argument.VAR_KEYWORD, argument.VAR_POSITIONAL}
        )
        yield name, "GET", Operation(summary, texts)
        body = {
            "type": "object",
            "properties": {text["name"]: {} for text in texts},
            "required": [text["name"] for text in texts if text["required"]],
        }
        yield name, "POST", Operation(summary, bodies={"application/json": body})


def _described(path: str, operation: Operation) -> dict[str, Any]:
    placeholders = [
        {"name": name, "in": "path", "required": True, "schema": {"type": "string", "minLength": 1}}
        for name in _PLACEHOLDER.findall(path)
    ]
    responses: dict[str, Any] = {}
    for status, kinds in operation.answers.items():
        responses[str(status)] = {"description": "Done."}
        if kinds:
            responses[str(status)]["content"] = {kind: {} for kind in kinds}
    described: dict[str, Any] = {
        "summary": operation.summary,
        "parameters": [*placeholders, *operation.parameters],
        "responses": {**responses, "default": _PROBLEM},
    }
    if operation.bodies:
        content = {kind: {"schema": schema} for kind, schema in operation.bodies.items()}
        described["requestBody"] = {"required": True, "content": content}
    if operation.token:
        described["security"] = [{"token": []}]
    return described


async def _openapi(request: Request) -> Response:
    """Respond with the description; the modules of views are loaded in a thread, outside of the event loop."""
    shared = request.app.state
    if not hasattr(shared, "openapi"):
        shared.openapi = await asyncio.to_thread(describe, request.app.routes)
    return JSONResponse(shared.openapi)


ROUTES: Final = [Route("/openapi.json", _openapi)]
"""Addresses of the description."""
