"""Errors as HTTP responses of one shape on every route: RFC 9457 for programs, text for curl, a page for browsers.

The members are those of `KgError` (`code`, `message`, `hint`, the place), `docs` with the address of the explanation,
and `type`, `title` and `status` of RFC 9457. Routes raise errors; only this module writes them.
"""

from __future__ import annotations

import json
import re
from html import escape
from typing import TYPE_CHECKING, Any, Final

from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import Route

from kg.errors import CATALOGUE, KgError, Place, QueryError, RobotError
from kg.render.text import marked
from kg.server.addresses import NAVIGATION, url
from kg.server.leaving import GONE, ClientLeftError
from kg.server.prose import inline
from kg.server.records import record

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Mapping

    from starlette.requests import HTTPConnection, Request


STATUS: Final[Mapping[str, int]] = {
    code: status
    for status, codes in {
        401: "KG529",
        403: "KG502 KG528 KG530 KG534 KG561",
        404: "KG001 KG226 KG422 KG521 KG564 KG845",
        405: "KG522",
        406: "KG504 KG523",
        408: "KG532",
        409: "KG512 KG560 KG847 KG849",
        412: "KG536",
        413: "KG525",
        414: "KG526",
        415: "KG524 KG563",
        421: "KG527",
        429: "KG531",
        431: "KG535",
        500: "KG900",
        501: "KG309",
        502: "KG225",
        503: "KG301 KG302 KG303 KG305 KG306 KG503 KG507 KG508 KG509 KG510 KG533 KG568 KG802 KG803 KG846",
        507: "KG304",
    }.items()
    for code in codes.split()
}
"""HTTP status of each code; codes missing here are client errors: 400."""

_NUMBER: Final = {"type": ["integer", "null"], "minimum": 1}
_SHORT: Final = {"type": "string"}
PROBLEM: Final[Mapping[str, Any]] = {
    "type": "object",
    "properties": {
        **dict.fromkeys(("type", "title", "code", "message", "hint", "docs"), _SHORT),
        "status": {"type": "integer", "minimum": 400, "maximum": 599},
        **dict.fromkeys(("line", "column", "endLine", "endColumn"), _NUMBER),
    },
}
"""JSON Schema of an error; all members are always present."""

_OF_STATUS: Final = {status: code for code, status in STATUS.items() if "KG520" <= code <= "KG533"} | {403: "KG530"}
_PASSING: Final = ("KG302", "KG503", "KG507", "KG508", "KG509", "KG531", "KG533", "KG568", "KG803", "KG846")
"""Codes of errors that may be gone when the request is repeated; a deadline includes time in the queue."""
_HEADERS: Final = {
    **{code: {"Retry-After": "1"} for code in _PASSING},
    "KG529": {"WWW-Authenticate": 'Bearer realm="kg"'},
}
_JSON: Final = re.compile(r"json|application/\*", re.IGNORECASE)


class RequestError(KgError):
    """A refused request; `headers` are added to the response."""

    def __init__(
        self, code: str, message: str, *, hint: str | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        """Raise `LookupError` for a code that is not in the catalogue."""
        super().__init__(code, message, hint=hint)
        self.headers = dict(headers or {})


class DefectError(Exception):
    """A defect in kg, with the identity reported to the client; its `__cause__` is the original error."""


def problem(error: KgError) -> dict[str, Any]:
    """Return the members of the problem (RFC 9457, section 3.1); those that do not apply are null."""
    entry = CATALOGUE[error.code]
    # Start and end of the faulty part as lines and columns, from one in code points, as far as known.
    place = error.place if isinstance(error, QueryError | RobotError) else None
    span = (place.span() or (place.line, None, None, None)) if place else (None, None, None, None)
    line, column, end_line, end_column = span
    return {
        "type": url(f"/errors/{error.code}"),
        "title": entry.title,
        "status": STATUS.get(error.code, 400),
        "code": error.code,
        "message": error.message,
        "hint": error.hint or entry.way_out,
        "line": line,
        "column": column,
        "endLine": end_line,
        "endColumn": end_column,
        "docs": url(f"/errors/{error.code}"),
    }


def answer(request: HTTPConnection, error: KgError) -> Response:
    """Return the response that reports an error, in the form that the client accepts."""
    members = problem(error)
    record(request).outcome = error.code
    headers = {**_HEADERS.get(error.code, {}), **getattr(error, "headers", {}), "Cache-Control": "no-store"}
    headers["Vary"] = "Accept"
    kind = _form(request)
    if kind == "html":
        return Response(_page(members), members["status"], headers, media_type="text/html; charset=utf-8")
    if kind == "text":
        return Response(_text(members, error.place), members["status"], headers, media_type="text/plain; charset=utf-8")
    return Response(json.dumps(members), members["status"], headers, media_type="application/problem+json")


def _form(request: HTTPConnection) -> str:
    """Return `html` for browsers, `text` for terminals, `json` for all others."""
    accept = request.headers.get("accept", "*/*")
    if request.url.path.startswith("/api/") or _JSON.search(accept):
        return "json"
    if "text/html" in accept:
        return "html"
    terminal = request.headers.get("user-agent", "").lower().startswith(("curl/", "wget/"))
    return "text" if terminal or "text/plain" in accept else "json"


def _text(members: Mapping[str, Any], place: Place | None = None) -> str:
    """Return an error for a terminal, with the faulty line underlined if the request contains it."""
    where = f"line {members['line']}, column {members['column']}: " if members["line"] else ""
    lines = [f"{members['code']}: {where}{members['message']}"]
    if where and place and place.excerpt:
        lines += (f"    {line}" for line in marked(place, place.excerpt))
    return "\n".join([*lines, members["hint"], ""])


def _page(members: Mapping[str, Any]) -> str:
    """Return a page without a template, since a template might be what failed."""
    title = f"{members['code']}: {members['title']}"
    start, static = url("/"), url("/static")
    pages = "".join(f'<li><a href="{url(address)}">{name}</a></li>' for address, name in NAVIGATION.items())
    place = f"<p>Line {members['line']}, column {members['column']}</p>" if members["line"] else ""
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>{escape(title)}</title>'
        f'<meta name="viewport" content="width=device-width"><script src="{static}/theme.js"></script>'
        f'<link rel="icon" href="{static}/kg.svg" type="image/svg+xml"><link rel="stylesheet" href="{static}/kg.css">'
        f'<link rel="stylesheet" href="{static}/error.css">'
        f'<header class="bar"><a class="brand" href="{start}">'
        f'<svg viewBox="0 0 32 32" aria-hidden="true"><use href="{static}/kg.svg#mark"></use></svg><span>kg</span></a>'
        f'<form class="find" role="search" action="{url("/search")}"><label class="unseen" for="find">Search</label>'
        '<input id="find" type="search" name="q" placeholder="Search"></form>'
        f'<nav aria-label="Pages"><ul>{pages}</ul></nav></header>'
        f"<main><h1>{escape(title)}</h1><p>{inline(members['message'])}</p>{place}<p>{inline(members['hint'])}</p>"
        f'<p><a href="{escape(members["docs"])}">What {escape(members["code"])} means</a> · '
        f'<a href="{start}">Start</a></p>'
        "</main></html>"
    )


def as_error(request: HTTPConnection, error: HTTPException) -> KgError:
    """Return the error of `kg` for an exception that Starlette raised about a request."""
    code = _OF_STATUS.get(error.status_code, "KG520")
    messages = {
        "KG521": f"no page or endpoint at {request.url.path}",
        "KG522": f"{request.scope['method']} is not allowed at {request.url.path}",
    }
    return RequestError(code, messages.get(code, error.detail), headers=error.headers)


async def _of_kg(request: Request, error: Exception) -> Response:
    assert isinstance(error, KgError)  # noqa: S101 - the key below
    return answer(request, error)


async def _of_http(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)  # noqa: S101 - the key below
    return answer(request, as_error(request, error))


async def _of_nobody(_request: Request, _error: Exception) -> Response:
    return Response(status_code=GONE)


HANDLERS: Final[dict[type[Exception], Callable[[Request, Exception], Awaitable[Response]]]] = {
    KgError: _of_kg,
    HTTPException: _of_http,
    ClientLeftError: _of_nobody,
}
"""Handlers by kind of exception, as Starlette takes them."""


async def handled(request: Request, error: KgError | ClientLeftError) -> Response:
    """Return the response to an error, as the routes do."""
    return await (_of_kg if isinstance(error, KgError) else _of_nobody)(request, error)


async def _explained(request: Request) -> Response:
    entry = CATALOGUE.get(request.path_params["code"])
    if entry is None:
        raise RequestError("KG521", f"no error has the code {request.path_params['code']}")
    members = {
        "code": request.path_params["code"],
        "title": entry.title,
        "message": entry.explanation,
        "hint": entry.way_out,
        "line": None,
        "docs": url("/errors/" + request.path_params["code"]),
    }
    if _form(request) == "html":
        return Response(_page(members), media_type="text/html; charset=utf-8")
    return Response(_text(members), media_type="text/plain; charset=utf-8")


ROUTES: Final = [Route("/errors/{code}", _explained)]
"""Addresses at which codes are explained."""
