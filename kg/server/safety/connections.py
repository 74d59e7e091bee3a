"""Limits on connections below the application: their number, the time of a request, and its size.

The application sees a request when its headers are complete, so incomplete requests have to be ended here.

A connection is *waiting* until its request is complete, and *answering* from then to the end of the response. Each
state has a limit of its own, so idle connections take no capacity from requests. Above the first limit, the oldest
waiting connection of the address with the most of them is closed: a new connection is never refused. Above the second
limit, a request is refused (KG533), except for `/health` and `/metrics`.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from typing import TYPE_CHECKING, Any, Final, cast

from uvicorn.protocols.http.httptools_impl import STATUS_LINE, HttpToolsProtocol, RequestResponseCycle

from kg.server.addresses import rooted
from kg.server.errors import STATUS, RequestError, problem
from kg.server.safety.bodies import ADDRESS_BYTES
from kg.server.safety.floods import ALWAYS
from kg.server.safety.headers import HEADERS
from kg.server.scopes import ARRIVED, WHOLE

if TYPE_CHECKING:
    import asyncio

HEAD_SECONDS: Final = 10.0
"""Maximum seconds for the request line and the headers."""
_HEAD_BYTES: Final = 64 << 10  # maximum size in bytes of the headers, before the application checks them
REST_SECONDS: Final = 10.0
"""Maximum seconds for a client to finish sending the body of a request after its response."""
STALLED_SECONDS: Final = 60.0
"""Maximum seconds for a client to read none of its response."""
_LINGER_SECONDS: Final = 2.0
"""Seconds during which input is discarded after a refusal: closing at once could drop the response."""
_URL_BYTES: Final = 60 << 10
"""Maximum length in bytes of an address that uvicorn parses; the application checks the limit for clients."""
_JOINED_BYTES: Final = 4096  # a larger part of a response is sent at once
_LINGER_BYTES: Final = 1 << 20  # maximum bytes discarded after a refusal


@dataclass(slots=True)
class Crowd:
    """The connections of a server at a root path; at most `most` are waiting, and at most `most` are answering."""

    most: int
    root: str
    waiting: dict[str, dict[Guarded, None]] = field(default_factory=dict)
    answering: set[Guarded] = field(default_factory=set)

    def wait(self, connection: Guarded, address: str) -> None:
        """Count a connection as waiting, and close the oldest one above the limit."""
        self.answering.discard(connection)
        self.waiting.setdefault(address, {})[connection] = None
        if sum(map(len, self.waiting.values())) > self.most:
            longest = max(self.waiting, key=lambda name: len(self.waiting[name]))
            oldest = next(iter(self.waiting[longest]))
            self.forget(oldest, longest)
            oldest.make_room()

    def answer(self, connection: Guarded, address: str) -> None:
        """Count a connection as answering."""
        self.forget(connection, address)
        self.answering.add(connection)

    def forget(self, connection: Guarded, address: str) -> None:
        """Remove a connection."""
        self.answering.discard(connection)
        connections = self.waiting.get(address, {})
        connections.pop(connection, None)
        if not connections:
            self.waiting.pop(address, None)


class _Joined:
    """A transport that sends head and body of a response in one piece, since each piece wakes the client.

    Parts are buffered until `flush`, the next turn of the event loop, or a maximum size.
    """

    def __init__(self, transport: asyncio.Transport, loop: asyncio.AbstractEventLoop) -> None:
        self._transport = transport
        self._loop = loop
        self._pending: list[bytes] = []

    def __getattr__(self, name: str) -> Any:
        return getattr(self._transport, name)

    def write(self, data: bytes) -> None:
        """Buffer data to send together with what follows."""
        if self._pending:
            self._pending.append(data)
            self.flush()
        elif len(data) < _JOINED_BYTES:
            self._pending.append(data)
            self._loop.call_soon(self.flush)
        else:
            self._transport.write(data)

    def send(self, data: bytes) -> None:
        """Send data that nothing follows, after the buffer."""
        self.flush()
        self._transport.write(data)

    def flush(self) -> None:
        """Send the buffer."""
        if self._pending:
            data = b"".join(self._pending)
            self._pending.clear()
            self._transport.write(data)

    def write_eof(self) -> None:
        """Send the buffer and end the stream."""
        self.flush()
        self._transport.write_eof()

    def close(self) -> None:
        """Close after sending the buffer."""
        self.flush()
        self._transport.close()


class Guarded(HttpToolsProtocol):
    """Uvicorn's HTTP/1.1 with limits on time, size and number; `crowd` has all connections of the server."""

    crowd: Crowd

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__(*args, **named)
        self._in_head = True
        self._head = 0
        self._whole = True
        self._refused = False
        self._answering = False
        self._late: tuple[str, str] | None = None
        """The refusal of a request, until all before it are answered."""
        self._timers: dict[str, asyncio.TimerHandle] = {}

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn does
        """Register a connection."""
        super().connection_made(cast("asyncio.Transport", _Joined(transport, self.loop)))
        self._start("head", HEAD_SECONDS, self._head_is_late)
        self.crowd.wait(self, self._address)

    @property
    def _address(self) -> str:
        return self.client[0] if self.client else ""

    def make_room(self) -> None:
        """Close this connection, the one that has waited longest."""
        if self._whole:
            self.transport.close()
        else:
            self.transport.abort()

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove the connection and its timers."""
        for name in tuple(self._timers):
            self._stop(name)
        self.crowd.forget(self, self._address)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Parse received bytes; KG535 if the headers never end."""
        self._head += len(data)
        if self._refused:
            if self._head > _LINGER_BYTES:
                self.transport.abort()
            return
        super().data_received(data)
        if self._in_head and self._head > _HEAD_BYTES and not self._is_address_long():
            self._refuse("KG535", f"the headers have more than {_HEAD_BYTES} bytes")

    def send_400_response(self, msg: str) -> None:  # noqa: ARG002 - uvicorn's signature
        """Respond to malformed HTTP: KG520."""
        if not self._refused:
            self._refuse("KG520", "the request is not valid HTTP")

    def on_message_begin(self) -> None:
        """Start the timer for the headers."""
        self._in_head, self._whole, self._head = True, False, 0
        self._start("head", HEAD_SECONDS, self._head_is_late)
        super().on_message_begin()

    def _is_address_long(self) -> bool:
        """Refuse a request whose address is longer than uvicorn can parse (KG526); return whether it is refused."""
        if not self._refused and len(self.url) > _URL_BYTES:
            self._refuse("KG526", f"the address is longer than {ADDRESS_BYTES} bytes")
        return self._refused

    def on_headers_complete(self) -> None:
        """Pass the request to the application; KG526 for its address, KG533 above the limit of requests."""
        self._in_head = False
        self._stop("head")
        if self._is_address_long():
            return
        path = self.url.partition(b"?")[0].decode("latin-1").removeprefix(self.crowd.root)
        if len(self.crowd.answering) >= self.crowd.most and path not in ALWAYS and not self._refused:
            self._refuse("KG533", f"{self.crowd.most} requests are being answered already")
        if not self._refused:
            super().on_headers_complete()
            self.scope[WHOLE] = partial(self._send_whole, self.cycle)  # type: ignore[typeddict-unknown-key]  # our own
            self._answering = True

    def _send_whole(self, cycle: RequestResponseCycle, status: int, head: bytes, body: bytes) -> bool:
        """Send a response whose length `head` states, as uvicorn does in parts, at a fraction of the cost.

        `head` has lines of headers. Return False, without sending, where the response is not as simple as most.
        """
        usual = cycle.keep_alive and not (cycle.disconnected or cycle.response_started or self.flow.write_paused)
        if not usual or cycle.scope["method"] == "HEAD":
            return False
        cycle.response_started = cycle.response_complete = True
        cycle.waiting_for_100_continue = False
        lines = [b"%s: %s\r\n" % pair for pair in self.server_state.default_headers]
        self.transport.send(b"".join((STATUS_LINE[status], *lines, head, b"\r\n", body)))  # type: ignore[attr-defined]  # `_Joined`
        cycle.message_event.set()
        cycle.on_response()
        cycle.disconnected = True  # middlewares did not see the response: what they send after an error is dropped
        return True

    def on_body(self, body: bytes) -> None:
        """Pass on a part of a body."""
        if not self._refused:
            super().on_body(body)

    def on_message_complete(self) -> None:
        """Record that the request is complete."""
        self._whole = True
        self._stop("rest")
        if self._answering and not self._refused:
            self.crowd.answer(self, self._address)
        if not self._refused:
            self.scope[ARRIVED] = True  # type: ignore[typeddict-unknown-key]  # our own
            super().on_message_complete()

    def on_response_complete(self) -> None:
        """Start the timer for the rest of an unread body."""
        self._answering = bool(self.pipeline)
        super().on_response_complete()
        if not self._answering and not self.transport.is_closing():
            self.crowd.wait(self, self._address)
        if self._late and not self._answering:
            self._refuse(*self._late)
        elif not self._whole and not self._in_head and not self.transport.is_closing():
            self._start("rest", REST_SECONDS, self.transport.abort)

    def pause_writing(self) -> None:
        """Start the timer for a client that does not read."""
        self._start("stalled", STALLED_SECONDS, self.transport.abort)
        super().pause_writing()

    def resume_writing(self) -> None:
        """Resume sending."""
        self._stop("stalled")
        super().resume_writing()

    def _head_is_late(self) -> None:
        if self._head or not self._whole:
            self._refuse("KG532", "the request headers arrived too slowly")
        else:
            self.transport.close()

    def _refuse(self, code: str, message: str) -> None:
        """Refuse a request without the application, and close the connection."""
        self._refused = True
        self._stop("head")
        if self._answering and not self.cycle.more_body:
            self._late = (code, message)
            return
        if self.transport.is_closing() or (self._answering and not self._may_answer()):
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
        self._start("linger", _LINGER_SECONDS, self.transport.abort)

    def _may_answer(self) -> bool:
        """Take over the response to a request whose body is malformed; False if another one has begun."""
        cycle = self.cycle
        if cycle.response_started or self.pipeline:
            return False
        cycle.disconnected = True  # reported to the application, which then sends nothing
        cycle.message_event.set()
        return True

    def _start(self, name: str, seconds: float, then: Any) -> None:
        self._stop(name)
        self._timers[name] = self.loop.call_later(seconds, then)

    def _stop(self, name: str) -> None:
        if timer := self._timers.pop(name, None):
            timer.cancel()


def guarded(most: int, root: str) -> type[Guarded]:
    """Return the protocol of a server at a root path; at most `most` connections wait, and as many are answered."""
    return type("Guarded", (Guarded,), {"crowd": Crowd(most, root)})
