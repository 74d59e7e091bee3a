"""Parsing of query requests: SPARQL 1.1 Protocol, section 2.1, and our own parameters.

`format`, `timeout`, `limit`, `offset`, `snapshot`, `stream`, `job` and `$variable` are described in docs/endpoint.md.
"""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final
from urllib.parse import urlencode

import msgspec

from kg.query.readers.messages import Question, frame
from kg.server.addresses import address, url
from kg.server.errors import RequestError
from kg.server.negotiation import Choice, choose
from kg.server.parameters import FORM, Parameters, body_text, decoded, in_utf8, media_type, unsupported
from kg.server.safety.bodies import ADDRESS_BYTES
from kg.server.safety.tokens import is_trusted
from kg.server.scopes import body_of, head_of, header
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import Mapping

    from starlette.requests import Request


QUERY: Final = "application/sparql-query"
"""The media type of a query."""

_REMEMBERED: Final = 512  # how many parsed requests are cached by their text
_REMEMBERED_BYTES: Final = 4096  # maximum size in bytes of the body of a cached request
_JOB: Final = re.compile(r"[A-Za-z0-9_-]{16,128}")


@dataclass(frozen=True, slots=True)
class QueryRequest:
    """A parsed query request: `message` is `question` encoded for a reader.

    `choices` has the format for each kind of result, and `sent` identifies them. `seconds` is the deadline, `job` the
    identity that the client chose. With `stream`, the response is sent as results arrive. `pairs` are the parameters of
    the same request as GET. If the query is the body of the request (`is_body`), it is the last of them. `digest`
    distinguishes requests whose responses are not the same bytes.
    """

    question: Question
    choices: Mapping[str, Choice]
    sent: bytes
    seconds: float
    job: str | None
    stream: bool
    pairs: tuple[tuple[str, str], ...]
    is_body: bool
    message: bytes = field(init=False)
    digest: str = field(init=False)

    def __post_init__(self) -> None:
        message = frame(self.question)
        object.__setattr__(self, "message", message)
        object.__setattr__(self, "digest", hashlib.sha256(message + self.sent).hexdigest()[:24])

    def asking(self, text: str) -> QueryRequest:
        """Return the request with the same head and another query as its body."""
        question = msgspec.structs.replace(self.question, text=text)
        pairs = (*self.pairs[:-1], ("query", text))
        return QueryRequest(question, self.choices, self.sent, self.seconds, self.job, self.stream, pairs, self.is_body)

    def tag(self, snapshot: str) -> str:
        """Return the entity tag of the response for the data of an identity (RFC 9110, section 8.8.3)."""
        return f'"{snapshot}-{self.digest}"'

    def link(self, request: Request, **changed: str | None) -> str | None:
        """Return the address of the same request as GET with some parameters changed; None if it is too long.

        Parameters that are None are removed.
        """
        pairs = [(name, value) for name, value in self.pairs if name not in changed]
        pairs += [(name, value) for name, value in changed.items() if value is not None]
        linked = f"{url(request.url.path)}?{urlencode(pairs)}"
        return linked if len(linked) <= ADDRESS_BYTES else None


def sent_as(choices: Mapping[str, Choice]) -> bytes:
    """Return bytes that are the same for responses in the same formats only."""
    return msgspec.msgpack.encode(sorted((kind, choice.content_type) for kind, choice in choices.items()))


async def parse_request(request: Request) -> QueryRequest | None:
    """Return the query of a request; None for a GET without one, which requests the service description.

    Raises:
        RequestError: KG520 invalid parameter, KG523 no acceptable format, KG524 unsupported media type of the body,
            KG534 above a limit.
    """
    scope = request.scope
    body = b"" if scope["method"] in {"GET", "HEAD"} else await body_of(request.receive)
    if len(body) > _REMEMBERED_BYTES or (head := head_of(scope)) is None:
        return _parse_request(request, body)
    parsed = state(request).parsed
    alike = (head, is_trusted(request))
    key = (alike, body)
    if key not in parsed:
        if len(parsed) >= _REMEMBERED:
            parsed.clear()
        before = parsed.get(alike)
        parsed[key] = result = before.asking(decoded(body)) if before else _parse_request(request, body)
        if result is not None and result.is_body:
            parsed[alike] = result
    return parsed[key]


def _parse_request(request: Request, body: bytes) -> QueryRequest | None:
    parameters, text = _parameters(request, body)
    if "update" in parameters:
        raise RequestError(
            "KG520", "updates go to /update, by POST", hint="Send it as `update=` in the body of a POST."
        )
    if text is None:
        if request.method in {"GET", "HEAD"}:
            return None
        raise RequestError("KG520", "the parameter `query` is missing")
    job = parameters.one("job")
    if job is not None and not _JOB.fullmatch(job):
        raise RequestError("KG520", "`job` must be 16 to 128 letters, digits, `_` and `-`, and hard to guess")
    choices = choose(header(request.scope, b"accept"), parameters.formats)
    is_body = "query" not in parameters
    return QueryRequest(
        question=_question(request, parameters, text, choices),
        choices=choices,
        sent=sent_as(choices),
        seconds=_seconds(request, parameters),
        job=job,
        stream=parameters.flag("stream") and request.scope["http_version"] != "1.0",
        pairs=(*parameters.pairs(), *([("query", text)] if is_body else ())),
        is_body=is_body,
    )


def _parameters(request: Request, body: bytes) -> tuple[Parameters, str | None]:
    query_string = request.scope["query_string"]
    if request.method in {"GET", "HEAD"}:
        parameters = Parameters(query_string)
        return parameters, parameters.one("query")
    kind = media_type(request)
    if kind == QUERY:
        parameters = Parameters(query_string)
        if "query" in parameters:
            raise RequestError("KG520", "the address and the body each contain a query")
        return parameters, body_text(request, body)
    if kind == FORM:
        in_utf8(request)
        parameters = Parameters(query_string, body)
        return parameters, parameters.one("query")
    raise unsupported(kind, QUERY, FORM)


def _question(request: Request, parameters: Parameters, text: str, choices: Mapping[str, Choice]) -> Question:
    options = state(request).options
    default_graphs, named_graphs = parameters.all("default-graph-uri"), parameters.all("named-graph-uri")
    given = default_graphs or named_graphs
    return Question(
        text=text,
        formats={kind: choice.format for kind, choice in choices.items()},
        parameters=parameters.starting("$"),
        default_graphs=default_graphs if given else None,
        named_graphs=named_graphs if given else None,
        union=not options.no_union,
        rows=_rows(request, parameters),
        offset=parameters.whole("offset") or 0,
        snapshot=parameters.one("snapshot"),
        size=options.answer_bytes,
        base=address(request),
    )


def _seconds(request: Request, parameters: Parameters) -> float:
    most = state(request).options.seconds
    wanted = parameters.number("timeout", least=0.001)
    if wanted is not None and wanted > most and not is_trusted(request):
        raise RequestError("KG534", f"`timeout={wanted:g}` is above the {most:g} s of this server")
    return most if wanted is None else wanted


def _rows(request: Request, parameters: Parameters) -> int | None:
    """Return the limit of rows; a streamed response has only the client's own limit."""
    most = state(request).options.rows
    wanted = parameters.whole("limit")
    if wanted is not None and wanted > most and not is_trusted(request) and not parameters.flag("stream"):
        raise RequestError("KG534", f"`limit={wanted}` is above the {most} rows of this server")
    return wanted if wanted is not None or parameters.flag("stream") else most
