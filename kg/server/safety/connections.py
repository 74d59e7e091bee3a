"""What guards a connection below the application: how many there are, how slowly they may speak, how much at once.

The application sees a request when its headers are whole, so what never gets that far has to be ended here.
"""

from __future__ import annotations

import json
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from kg.server.errors import STATUS, RequestError, problem
from kg.server.safety.headers import HEADERS

if TYPE_CHECKING:
    import asyncio

__all__ = ["Guarded", "guarded"]

HEAD_SECONDS: Final = 10.0
"""How long the first line and the headers of a request may take."""
HEAD_BYTES: Final = 64 << 10
"""How long they may be, before the application looks at them more closely."""
REST_SECONDS: Final = 10.0
"""How long a client may go on sending the body of a request that was answered already."""
STALLED_SECONDS: Final = 60.0
"""How long a client may take nothing of its answer."""
LINGER_SECONDS: Final = 2.0
"""How long we listen, and throw away, after we have said no: closing at once would take our answer from the client."""
LINGER_BYTES: Final = 1 << 20
"""How much we throw away meanwhile."""


class Guarded(HttpToolsProtocol):
    """HTTP/1.1 of uvicorn, with bounds on time, size and number; `most` is how many connections may be open."""

    most = 256

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        self._in_head = True
        self._head = 0
        self._whole = True
        self._refused = False
        self._answering = False
        self._timers: dict[str, asyncio.TimerHandle] = {}

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn does
        """Take a connection, or refuse it where there are too many: KG533."""
        super().connection_made(transport)
        if len(self.connections) > self.most:
            self._refuse("KG533", f"{self.most} connections are open already")
        else:
            self._start("head", HEAD_SECONDS, self._head_is_late)

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget what was waited for."""
        for name in tuple(self._timers):
            self._stop(name)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Read on; KG535 where headers have no end."""
        self._head += len(data)
        if self._refused:
            if self._head > LINGER_BYTES:
                self.transport.abort()
            return
        super().data_received(data)
        if self._in_head and self._head > HEAD_BYTES and not self._refused:
            self._refuse("KG535", f"the headers have more than {HEAD_BYTES} bytes")

    def send_400_response(self, msg: str) -> None:
        """Answer what is no HTTP: KG520."""
        if not self._refused:
            self._refuse("KG520", msg)

    def on_message_begin(self) -> None:
        """Wait for headers, not for ever."""
        self._in_head, self._whole, self._head = True, False, 0
        self._start("head", HEAD_SECONDS, self._head_is_late)
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Hand the request to the application."""
        self._in_head = False
        self._stop("head")
        if not self._refused:
            self._answering = True
            super().on_headers_complete()

    def on_body(self, body: bytes) -> None:
        """Hand on a part of a body."""
        if not self._refused:
            super().on_body(body)

    def on_message_complete(self) -> None:
        """Note that the request is whole."""
        self._whole = True
        self._stop("rest")
        if not self._refused:
            super().on_message_complete()

    def on_response_complete(self) -> None:
        """Wait for the rest of a body that nobody reads, not for ever."""
        self._answering = bool(self.pipeline)
        super().on_response_complete()
        if not self._whole and not self._in_head and not self.transport.is_closing():
            self._start("rest", REST_SECONDS, self.transport.abort)

    def pause_writing(self) -> None:
        """Wait for a client that takes nothing, not for ever."""
        self._start("stalled", STALLED_SECONDS, self.transport.abort)
        super().pause_writing()

    def resume_writing(self) -> None:
        """Go on sending."""
        self._stop("stalled")
        super().resume_writing()

    def _head_is_late(self) -> None:
        if self._head or not self._whole:
            self._refuse("KG532", "the headers came too slowly")
        else:
            self.transport.close()

    def _refuse(self, code: str, message: str) -> None:
        """Say no without the application, and close."""
        self._refused = True
        self._stop("head")
        if self.transport.is_closing() or self._answering:
            self.transport.abort()
            return
        error = RequestError(code, message)
        body = json.dumps(problem(error)).encode()
        status = HTTPStatus(STATUS.get(code, 400))
        headers = {
            **HEADERS,
            b"content-type": b"application/problem+json",
            b"content-length": str(len(body)).encode(),
            b"connection": b"close",
            **({b"retry-after": b"1"} if status == HTTPStatus.SERVICE_UNAVAILABLE else {}),
        }
        lines = (name + b": " + value for name, value in headers.items())
        first = f"HTTP/1.1 {status.value} {status.phrase}".encode()
        self.transport.write(b"\r\n".join((first, *lines, b"", body)))
        if self.transport.can_write_eof():
            self.transport.write_eof()
        self._start("linger", LINGER_SECONDS, self.transport.abort)

    def _start(self, name: str, seconds: float, then: Any) -> None:
        self._stop(name)
        self._timers[name] = self.loop.call_later(seconds, then)

    def _stop(self, name: str) -> None:
        if timer := self._timers.pop(name, None):
            timer.cancel()


def guarded(most: int) -> type[Guarded]:
    """Return the protocol of a server that may have `most` connections open."""
    return type("Guarded", (Guarded,), {"most": most})
