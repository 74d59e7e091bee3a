"""The response to a query; a response with status 200 is complete.

A response is buffered until its end is known, in memory or, if it is large, in a temporary file. Status and headers are
then correct, and a failure is an error with its own status. With `stream=true` it is sent as results arrive. A failure
then closes the connection before the end of the body, which HTTP clients report.
"""

from __future__ import annotations

import tempfile
from contextlib import AbstractAsyncContextManager, AsyncExitStack, suppress
from dataclasses import replace
from typing import IO, TYPE_CHECKING, Final

from starlette.responses import Response

from kg.errors import KgError, QueryError
from kg.server.errors import RequestError
from kg.server.leaving import ClientLeftError, while_connected
from kg.server.records import record
from kg.server.safety.tokens import client
from kg.server.scopes import header
from kg.server.state import state
from kg.store.failure import translated

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from starlette.requests import Request
    from starlette.types import Receive, Scope, Send

    from kg.query.readers.cache import CachedResponse
    from kg.query.readers.pool import Answer
    from kg.server.protocol_question import QueryRequest

_IN_MEMORY: Final = 8 << 20
_PIECE: Final = 256 << 10
_SAFE: Final = frozenset({"GET", "HEAD", "QUERY"})
_KEPT: Final = ("ETag", "Vary", "Cache-Control", "X-Kg-Snapshot")
"""Headers of a response without its content (RFC 9110, section 15.4.5)."""


class Buffer:
    """A buffer for bytes: in memory up to 8 MB, beyond that in an unnamed file."""

    def __init__(self, most: int) -> None:
        self.size = 0
        self._most = most
        self._parts: list[bytes] = []
        self._file: IO[bytes] | None = None

    def add(self, part: bytes) -> None:
        """Append bytes.

        Raises:
            QueryError: KG511 the limit of bytes is exceeded.
            StoreError: KG304 the disk is full.
        """
        self.size += len(part)
        if self.size > self._most:
            message = f"the answer has more than the {self._most} bytes that this server sends at once"
            raise QueryError("KG511", message, hint="Ask for fewer rows, or add `stream=true`.")
        self._parts.append(part)
        if self.size > _IN_MEMORY:
            with translated(tempfile.gettempdir()):
                self._file = self._file or tempfile.TemporaryFile()  # noqa: SIM115 - closed by `close`
                self._file.writelines(self._parts)
            self._parts.clear()

    def pieces(self) -> list[bytes] | IO[bytes]:
        """Return the content: as a list of parts, or as a file at its beginning; raises as `add`."""
        if self._file is None:
            return self._parts
        with translated(tempfile.gettempdir()):
            self._file.seek(0)
        return self._file

    def close(self) -> None:
        """Release the buffer."""
        self._parts = []
        if self._file:
            self._file.close()


class _BufferedResponse(Response):
    """The response from a buffer, with its length."""

    def __init__(self, buffer: Buffer, headers: dict[str, str]) -> None:
        super().__init__(None, 200, {**headers, "Content-Length": str(buffer.size)})
        self._buffer = buffer

    def close(self) -> None:
        """Release the buffer without sending it."""
        self._buffer.close()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002 - ASGI's signature
        try:
            pieces = self._buffer.pieces()
            await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
            if isinstance(pieces, list):
                await send({"type": "http.response.body", "body": b"".join(pieces)})
                return
            while piece := pieces.read(_PIECE):
                await send({"type": "http.response.body", "body": piece, "more_body": True})
            await send({"type": "http.response.body", "body": b""})
        finally:
            self._buffer.close()


async def answer(request: Request, parsed: QueryRequest) -> Response:
    """Return the response to a query; raises KgError for failures before the first byte, and ClientLeftError."""
    anything = (header(request.scope, b"if-none-match") or "").strip() == "*"
    if request.method not in _SAFE and (anything or _unchanged(request, parsed)):
        hint = "Send the query with GET, which is answered with 304, or without `If-None-Match`."
        raise RequestError("KG536", "`If-None-Match` fails: the result exists", hint=hint)  # RFC 9110, section 13.1.2
    if not anything:
        return await _answer(request, parsed)
    # The condition fails if there is a response, so an error takes precedence (RFC 9110, section 13.2.1).
    response = await _answer(request, replace(parsed, stream=False))
    if isinstance(response, _BufferedResponse):
        response.close()
    headers = {name: response.headers[name] for name in _KEPT if name in response.headers}
    return Response(status_code=304, headers=headers)


async def _answer(request: Request, parsed: QueryRequest) -> Response:
    record(request).query = parsed.question.text
    readers = state(request).readers
    if _unchanged(request, parsed):
        current = str(readers.layout.current())
        return Response(status_code=304, headers={"ETag": parsed.tag(current), "Vary": "Accept"})
    if parsed.job is not None and parsed.job in readers.jobs:
        raise RequestError("KG520", "the job of this identity still runs", hint="Choose another `job`.")
    if parsed.stream:
        return await _streamed(request, parsed)
    cached = readers.cached(parsed.message)
    record(request).cached = cached is not None
    if (cached := cached or readers.look_up(parsed.question, parsed.message)) is not None:
        return Response(cached.body, headers={**_headers(parsed, cached), **_counted(request, parsed, cached)})
    return await while_connected(request.receive, _whole(request, parsed))


def _unchanged(request: Request, parsed: QueryRequest) -> bool:
    """Return whether the client's copy is current; only repeatable results have an entity tag."""
    tags = header(request.scope, b"if-none-match")
    if tags is None:
        return False
    current = str(state(request).readers.layout.current())
    given = {tag.strip().removeprefix("W/") for tag in tags.split(",")}
    return parsed.question.snapshot in {None, current} and parsed.tag(current) in given


async def _whole(request: Request, parsed: QueryRequest) -> Response:
    options = state(request).options
    buffer = Buffer(options.answer_bytes)
    try:
        async with _asking(request, parsed) as result:
            async for part in result.parts():
                buffer.add(part)
    except QueryError as error:
        buffer.close()
        raise _changed(request, parsed, error) from error
    except BaseException:
        buffer.close()
        raise
    return _BufferedResponse(buffer, {**_headers(parsed, result), **_counted(request, parsed, result)})


def _asking(request: Request, parsed: QueryRequest) -> AbstractAsyncContextManager[Answer]:
    return state(request).readers.ask(parsed.question, seconds=parsed.seconds, job=parsed.job, client=client(request))


def _changed(request: Request, parsed: QueryRequest, error: QueryError) -> KgError:
    """Return the error, with a link added if it reports that the requested data no longer exists."""
    if error.code != "KG512":
        return error
    headers = _link(parsed.link(request, snapshot=None), "latest-version")
    return RequestError(error.code, error.message, hint=error.hint, headers=headers)


def _link(address: str | None, relation: str) -> dict[str, str]:
    return {"Link": f'<{address}>; rel="{relation}"'} if address else {}


def _headers(parsed: QueryRequest, result: Answer | CachedResponse) -> dict[str, str]:
    """Return the headers known at the start of the response."""
    headers = {
        "Content-Type": parsed.choices[result.head.kind].content_type,
        "Vary": "Accept",
        "X-Kg-Snapshot": result.head.snapshot,
    }
    if result.head.repeatable:
        headers |= {"ETag": parsed.tag(result.head.snapshot), "Cache-Control": "no-cache"}
    else:
        headers["Cache-Control"] = "no-store"
    return headers


def _counted(request: Request, parsed: QueryRequest, result: Answer | CachedResponse) -> dict[str, str]:
    """Return the headers known at the end of the response."""
    assert result.end is not None  # noqa: S101 - all its parts were read
    record(request).rows = result.end.rows
    headers = {"X-Kg-Rows": str(result.end.rows), "Server-Timing": f"query;dur={result.end.seconds * 1000:.1f}"}
    if result.end.more:
        behind = parsed.question.offset + result.end.rows
        following = parsed.link(request, offset=str(behind), snapshot=result.head.snapshot)
        headers |= {"X-Kg-Truncated": "true", **_link(following, "next")}
    return headers


async def _streamed(request: Request, parsed: QueryRequest) -> Response:
    """Return a streamed response with its first part ready; earlier failures are reported like any other error."""
    stack = AsyncExitStack()
    try:
        result, parts, first = await while_connected(request.receive, _begun(request, parsed, stack))
    except BaseException as error:
        await stack.aclose()
        if isinstance(error, QueryError):
            raise _changed(request, parsed, error) from error
        raise
    headers = {**_headers(parsed, result), "X-Kg-Job": result.job.identity}
    return _StreamedResponse(first, parts, stack, headers)


async def _begun(
    request: Request, parsed: QueryRequest, running: AsyncExitStack
) -> tuple[Answer, AsyncIterator[bytes], bytes]:
    """Return an answer that `running` closes, its remaining parts, and the first part."""
    result = await running.enter_async_context(_asking(request, parsed))
    parts = result.parts()
    return result, parts, await anext(parts, b"")


class _StreamedResponse(Response):
    """A streamed response; on failure it stops before the end of the body."""

    def __init__(
        self, first: bytes, parts: AsyncIterator[bytes], running: AsyncExitStack, headers: dict[str, str]
    ) -> None:
        super().__init__(None, 200, headers)
        del self.headers["content-length"]
        self._first = first
        self._parts = parts
        self._running = running

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:  # noqa: ARG002 - ASGI's signature
        async with self._running:
            # From here on, a failure closes the connection before the end of the body, which clients detect.
            await send({"type": "http.response.start", "status": self.status_code, "headers": self.raw_headers})
            with suppress(KgError, ClientLeftError):
                await while_connected(receive, self._send(send))

    async def _send(self, send: Send) -> None:
        await send({"type": "http.response.body", "body": self._first, "more_body": True})
        async for part in self._parts:
            await send({"type": "http.response.body", "body": part, "more_body": True})
        await send({"type": "http.response.body", "body": b""})
