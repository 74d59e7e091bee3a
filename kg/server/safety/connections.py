"""What guards a connection below the application: how many there are, how slowly they may speak, how much at once.

The application sees a request when its headers are whole, so what never gets that far has to be ended here.

A connection is *waiting* until a request on it is whole, and *answering* from then until the end of the answer. Each
kind has a limit of its own, so that connections without a request use up no capacity for requests. Above the first
limit the oldest waiting connection is closed, of the address that has the most of them: a new connection is never
refused. Above the second limit a request is refused (KG533), but not one for `/health` or `/metrics`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final, cast

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from kg.server.addresses import rooted
from kg.server.errors import STATUS, RequestError, problem
from kg.server.safety.floods import ALWAYS
from kg.server.safety.headers import HEADERS

if TYPE_CHECKING:
    import asyncio

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
JOINED_BYTES: Final = 4096
"""A piece of an answer that is larger is sent at once."""
LINGER_BYTES: Final = 1 << 20
"""How much we throw away meanwhile."""


@dataclass(slots=True)
class Crowd:
    """The connections of a server at a root path; `most` of them may wait, and as many be answered."""

    most: int
    root: str
    waiting: dict[str, dict[Guarded, None]] = field(default_factory=dict)
    answering: set[Guarded] = field(default_factory=set)

    def wait(self, connection: Guarded, address: str) -> None:
        """Count a connection as waiting, and close the oldest one where that is too many."""
        self.answering.discard(connection)
        self.waiting.setdefault(address, {})[connection] = None
        if sum(map(len, self.waiting.values())) > self.most:
            longest = max(self.waiting, key=lambda name: len(self.waiting[name]))
            oldest = next(iter(self.waiting[longest]))
            self.forget(oldest, longest)
            oldest.make_room()

    def answer(self, connection: Guarded, address: str) -> None:
        """Count a connection as one that is answered."""
        self.forget(connection, address)
        self.answering.add(connection)

    def forget(self, connection: Guarded, address: str) -> None:
        """Count a connection no more."""
        self.answering.discard(connection)
        connections = self.waiting.get(address, {})
        connections.pop(connection, None)
        if not connections:
            self.waiting.pop(address, None)


class _Joined:
    """A transport that sends head and body of an answer as one piece: each piece wakes the client.

    Pieces are held until `flush`, the next turn of the event loop, or until they are many bytes.
    """

    def __init__(self, transport: asyncio.Transport, loop: asyncio.AbstractEventLoop) -> None:
        self._transport = transport
        self._loop = loop
        self._held: list[bytes] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def write(self, data: bytes) -> None:
        """Send soon; what is written behind goes along."""
        if self._held:
            self._held.append(data)
            self.flush()
        elif len(data) < JOINED_BYTES:
            self._held.append(data)
            self._loop.call_soon(self.flush)
        else:
            self._transport.write(data)

    def flush(self) -> None:
        """Send what is held."""
        if self._held:
            data = b"".join(self._held)
            self._held.clear()
            self._transport.write(data)

    def write_eof(self) -> None:
        """Send what is held, and no more."""
        self.flush()
        self._transport.write_eof()

    def close(self) -> None:
        """Close when what is held was sent."""
        self.flush()
        self._transport.close()


class Guarded(HttpToolsProtocol):
    """HTTP/1.1 of uvicorn, with bounds on time, size and number; `crowd` has all connections of the server."""

    crowd: Crowd

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        self._in_head = True
        self._head = 0
        self._whole = True
        self._refused = False
        self._answering = False
        self._timers: dict[str, asyncio.TimerHandle] = {}

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn does
        """Take a connection."""
        super().connection_made(cast("asyncio.Transport", _Joined(transport, self.loop)))
        self._start("head", HEAD_SECONDS, self._head_is_late)
        self.crowd.wait(self, self._address)

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    def make_room(self) -> None:
        """Close the connection, which waits for longer than the others."""
        if self._whole:
            self.transport.close()
        else:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget what was waited for."""
        for name in tuple(self._timers):
            self._stop(name)
        self.crowd.forget(self, self._address)
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
        """Answer what is not HTTP: KG520."""
        if not self._refused:
            self._refuse("KG520", msg)

    def on_message_begin(self) -> None:
        """Wait for headers, not for ever."""
        self._in_head, self._whole, self._head = True, False, 0
        self._start("head", HEAD_SECONDS, self._head_is_late)
        super().on_message_begin()

    def on_headers_complete(self) -> None:
        """Hand the request to the application; KG533 where too many are answered already."""
        self._in_head = False
        self._stop("head")
        path = self.url.partition(b"?")[0].decode("latin-1").removeprefix(self.crowd.root)
        if len(self.crowd.answering) >= self.crowd.most and path not in ALWAYS and not self._refused:
            self._refuse("KG533", f"{self.crowd.most} requests are being answered already")
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
        if self._answering and not self._refused:
            self.crowd.answer(self, self._address)
        if not self._refused:
            super().on_message_complete()

    def on_response_complete(self) -> None:
        """Wait for the rest of a body that nobody reads, not for ever."""
        self._answering = bool(self.pipeline)
        super().on_response_complete()
        if not self._answering and not self.transport.is_closing():
            self.crowd.wait(self, self._address)
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
            self._refuse("KG532", "the request headers arrived too slowly")
        else:
            self.transport.close()

    def _refuse(self, code: str, message: str) -> None:
        """Say no without the application, and close."""
        self._refused = True
        self._stop("head")
        if self.transport.is_closing() or self._answering:
            self.transport.abort()
            return
        with rooted(self.crowd.root):
            body = json.dumps(problem(RequestError(code, message))).encode()
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


def guarded(most: int, root: str) -> type[Guarded]:
    """Return the protocol of a server at a root path; `most` connections may wait, and as many be answered."""
    return type("Guarded", (Guarded,), {"crowd": Crowd(most, root)})
