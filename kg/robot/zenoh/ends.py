"""Ends of topics and services over Zenoh, and the attachments of their messages.

Callbacks of the library's threads are passed to the event loop. Attachments have the number of a message, the time and
the sender. Two forms are read: that since version 0.2.4 of rmw_zenoh_cpp, and the earlier one, which names each part.
Numbers are little endian; lists and texts are prefixed with their length (`zenoh-ext`).
"""

from __future__ import annotations

import asyncio
import hashlib
import struct
import time
from collections.abc import Awaitable, Callable
from functools import partial
from typing import Any, Final, NamedTuple

import zenoh
from zenoh import CongestionControl, ConsolidationMode, Query, QueryTarget, Reply, Session

from kg.errors import RobotError
from kg.robot.tasks import Tasks, call_in, outcome

_GID: Final = 16
_FORM: Final = struct.Struct("<qqB16s")
_LABELS: Final = (b"sequence_number", b"source_timestamp", b"source_gid")


class Attachment(NamedTuple):
    """The number of a message, nanoseconds since 1970, and the identity of its sender."""

    number: int
    time: int
    sender: bytes

    def write(self) -> bytes:
        """Return the encoded attachment."""
        return _FORM.pack(self.number, self.time, _GID, self.sender)

    @classmethod
    def read(cls, content: bytes) -> Attachment:
        """Return the decoded attachment; ValueError for neither form."""
        plain = content
        for label in _LABELS:
            plain = plain.replace(bytes([len(label)]) + label, b"", 1)
        if len(plain) != _FORM.size or plain[16] != _GID:
            raise ValueError(f"{len(content)} bytes are not an attachment of ROS 2")
        number, time, _, sender = _FORM.unpack(plain)
        return cls(number, time, sender)


_EVER: Final = 30 * 24 * 3600.0
"""Timeout of a request in seconds: callers have their own, and results of actions take long."""


class End:
    """An end, such as a reader: a token that announces it, and the number of ends at the other side.

    Args:
        token: the declared token.
        others: counts the known ends at the other side.
        declared: a subscriber, publisher or queryable; it is undeclared after the token when the end is closed.
    """

    def __init__(self, token: Any, others: Callable[[], int], declared: Any = None) -> None:
        self._token = token
        self._others = others
        self._closed = False
        self._declared = declared

    @property
    def peers(self) -> int:
        """Number of known ends of others."""
        return 0 if self._closed else self._others()

    async def ready(self) -> None:
        """Return at once: ends are declared before they are announced."""

    def close(self) -> None:
        """Undeclare it."""
        if not self._closed:
            self._closed = True
            self._token.undeclare()
            if self._declared is not None:
                self._declared.undeclare()


class _Sender:
    """Numbers the messages of an end."""

    def __init__(self, key: str) -> None:
        self.identity = hashlib.blake2b(key.encode(), digest_size=_GID).digest()
        self._number = 0

    def attachment(self) -> bytes:
        """Return the attachment of the next message, with the wall-clock time, as in ROS 2."""
        self._number += 1
        return Attachment(self._number, time.time_ns(), self.identity).write()


class ZenohWriter(End):
    """A publisher; `key` distinguishes it from those of other sessions."""

    def __init__(self, token: Any, others: Callable[[], int], publisher: Any, key: str) -> None:
        super().__init__(token, others, publisher)
        self._publisher = publisher
        self._sender = _Sender(key)

    @property
    def confirmed(self) -> bool:
        """Whether messages arrived: Zenoh does not report it."""
        return False

    def write(self, content: bytes) -> None:
        """Send a message; RobotError KG803 if the session is closed."""
        try:
            self._publisher.put(content, attachment=self._sender.attachment())
        except zenoh.ZError as error:
            raise RobotError("KG803", f"a message was not sent: {error}") from None


class ZenohCaller(End):
    """A client of a service, whose key `key` returns."""

    def __init__(self, token: Any, others: Callable[[], int], session: Session, key: Callable[[], str]) -> None:
        super().__init__(token, others)
        self._session = session
        self._key = key
        self._sender = _Sender(str(id(self)))
        self._waiting: set[asyncio.Future[bytes]] = set()

    async def call(self, content: bytes) -> bytes:
        """Return the first response; RobotError KG807 if no server received the request, KG808 if it failed."""
        loop = asyncio.get_running_loop()
        answered: asyncio.Future[bytes] = loop.create_future()
        self._waiting.add(answered)
        cancellation = zenoh.CancellationToken()
        forward = partial(call_in, loop, _answer, answered)
        self._session.get(
            self._key(),
            zenoh.handlers.Callback(forward, lambda: forward(None)),
            target=QueryTarget.ALL_COMPLETE,
            consolidation=ConsolidationMode.NONE,
            timeout=_EVER,
            congestion_control=CongestionControl.BLOCK,
            payload=content,
            attachment=self._sender.attachment(),
            cancellation_token=cancellation,
        )
        try:
            return await answered
        except asyncio.CancelledError:
            cancellation.cancel()  # type: ignore[no-untyped-call]  # untyped in the library
            raise
        finally:
            self._waiting.discard(answered)

    def close(self) -> None:
        """Close the client; waiting calls get an error."""
        for answered in self._waiting:
            if not answered.done():
                answered.set_exception(RobotError("KG803", "the connection was closed before the service answered"))
        super().close()


def _answer(answered: asyncio.Future[bytes], reply: Reply | None) -> None:
    """Complete a call with its first reply; None is the end of all replies."""
    if answered.done():
        return
    if reply is None:
        answered.set_exception(RobotError("KG803", "the server left without an answer"))
    elif reply.ok is not None:
        answered.set_result(reply.ok.payload.to_bytes())
    elif reply.err is not None:
        message = reply.err.payload.to_bytes().decode("utf-8", "replace")
        answered.set_exception(RobotError("KG808", f"the service failed: {message[:500]}"))


class ZenohServer(End):
    """A service server; failures are sent to the client as errors of Zenoh."""

    def __init__(
        self,
        session: Session,
        key: str,
        answer: Callable[[bytes], Awaitable[bytes]],
        declare: Callable[[], tuple[Any, Callable[[], int]]],
    ) -> None:
        """Start to serve, then announce it, which gives the token and the counter of clients."""
        self._key = key
        self._answer = answer
        self._sender = _Sender(key)
        self._running = Tasks()
        forward = partial(call_in, asyncio.get_running_loop(), self._take)
        answering = session.declare_queryable(key, forward, complete=True)
        super().__init__(*declare(), answering)

    def _take(self, query: Query) -> None:
        self._running.spawn(self._respond(query), f"answering {self._key}")

    async def _respond(self, query: Query) -> None:
        with query:
            content = query.payload.to_bytes() if query.payload is not None else b""
            response = await outcome(self._answer(content))
            if isinstance(response, RobotError):
                query.reply_err(response.message)
            elif isinstance(response, BaseException):
                query.reply_err(str(response))
            else:
                query.reply(self._key, response, attachment=self._attached(query))

    def _attached(self, query: Query) -> bytes:
        """Return the attachment of a response: number and sender of the request, with the current time."""
        try:
            request = Attachment.read(query.attachment.to_bytes() if query.attachment is not None else b"")
        except ValueError:
            return self._sender.attachment()
        return request._replace(time=time.time_ns()).write()

    def close(self) -> None:
        """Stop serving."""
        self._running.cancel()
        super().close()
