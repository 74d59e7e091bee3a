"""`/openapi.json`: the server described for programs (OpenAPI 3.1), from its routes and the signatures of its views."""

from __future__ import annotations

import asyncio
import inspect
import re
from typing import TYPE_CHECKING, Any, Final

from starlette.responses import JSONResponse
from starlette.routing import Route

import kg
from kg.server.addresses import url
from kg.server.errors import PROBLEM
from kg.server.openapi_operations import OPERATIONS, Operation
from kg.views.calls import CALLS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.requests import Request
    from starlette.responses import Response
    from starlette.routing import BaseRoute

_VIEWS: Final = "/api/{name}"
_LEFT_OUT: Final = {"HEAD", "OPTIONS"}
_PLACEHOLDER: Final = re.compile(r"\{(\w+)(?::\w+)?\}")
_PROBLEM: Final = {"$ref": "#/components/responses/Problem"}


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
    """Yield each address and method with what is known of it."""
    for route in routes:
        if not isinstance(route, Route):
            continue
        path = _PLACEHOLDER.sub(r"{\1}", route.path)
        if path == _VIEWS:
            yield from ((f"/api/{name}", method, view) for name, method, view in _views())
        elif path == "/" or not path.endswith("/"):
            for method in sorted((route.methods or set()) - _LEFT_OUT):
                yield path, method, OPERATIONS.get((method, path)) or _page(route)


def _page(route: Route) -> Operation:
    said = inspect.getdoc(route.endpoint) or f"The page {route.path}."
    return Operation(said.partition("\n")[0], answers={200: ("text/html",)})


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
        answers = {200: ("application/json",)}
        yield name, "GET", Operation(summary, texts, answers=answers)
        body = {
            "type": "object",
            "properties": {text["name"]: {} for text in texts},
            "required": [text["name"] for text in texts if text["required"]],
        }
        yield name, "POST", Operation(summary, bodies={"application/json": body}, answers=answers)


def _described(path: str, operation: Operation) -> dict[str, Any]:
    placeholders = [
        {"name": name, "in": "path", "required": True, "schema": {"type": "string", "minLength": 1}}
        for name in _PLACEHOLDER.findall(path)
    ]
    described: dict[str, Any] = {
        "summary": operation.summary,
        "parameters": [*placeholders, *operation.parameters],
        "responses": {
            **{str(status): _answer(kinds) for status, kinds in (operation.answers or {}).items()},
            "default": _PROBLEM,
        },
    }
    if operation.bodies:
        content = {kind: {"schema": schema} for kind, schema in operation.bodies.items()}
        described["requestBody"] = {"required": True, "content": content}
    if operation.token:
        described["security"] = [{"token": []}]
    return described


def _answer(kinds: tuple[str, ...]) -> dict[str, Any]:
    content: dict[str, Any] = {kind: {} for kind in kinds}
    return {"description": "Done.", **({"content": content} if content else {})}


async def _openapi(request: Request) -> Response:
    """Answer the description; modules of views are loaded for it, beside the loop that answers others."""
    shared = request.app.state
    if not hasattr(shared, "openapi"):
        shared.openapi = await asyncio.to_thread(describe, request.app.routes)
    return JSONResponse(shared.openapi)


ROUTES: Final = [Route("/openapi.json", _openapi)]
"""Where programs learn what there is."""
