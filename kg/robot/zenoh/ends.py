"""Ends of topics and services over Zenoh, and what is attached to their messages.

What the library's threads tell is passed on to the event loop. Attachments have the number of a message, the time and
who sent it. Two forms are read: that since version 0.2.4 of rmw_zenoh_cpp, and the one before, which names each part.
The numbers are little endian; lists and texts have their length before them (`zenoh-ext`).
"""

from __future__ import annotations

import asyncio
import hashlib
import struct
import time
from collections.abc import Awaitable, Callable
from typing import Any, Final, NamedTuple

import zenoh
from zenoh import CongestionControl, ConsolidationMode, Query, QueryTarget, Reply, Session

from kg.errors import RobotError
from kg.robot.tasks import Tasks, outcome

_GID: Final = 16
_FORM: Final = struct.Struct("<qqB16s")
_LABELS: Final = (b"sequence_number", b"source_timestamp", b"source_gid")


class Attachment(NamedTuple):
    """The number of a message, nanoseconds since 1970, and the identity of its sender."""

    number: int
    time: int
    sender: bytes

    def write(self) -> bytes:
        """Return it as it is attached."""
        return _FORM.pack(self.number, self.time, _GID, self.sender)

    @classmethod
    def read(cls, content: bytes) -> Attachment:
        """Return what is attached; ValueError when it is of neither form."""
        plain = content
        for label in _LABELS:
            plain = plain.replace(bytes([len(label)]) + label, b"", 1)
        if len(plain) != _FORM.size or plain[16] != _GID:
            raise ValueError(f"{len(content)} bytes are not an attachment of ROS 2")
        number, time, _, sender = _FORM.unpack(plain)
        return cls(number, time, sender)


_EVER: Final = 30 * 24 * 3600.0
"""Seconds that a request may take: the caller has a deadline of its own, and the result of an action takes its time."""


def passing(loop: asyncio.AbstractEventLoop, call: Callable[[Any], None]) -> Callable[[Any], None]:
    """Return a callback for a thread of the library that has `call` called in the loop."""

    def told(what: object) -> None:
        try:
            loop.call_soon_threadsafe(call, what)
        except RuntimeError:
            return  # the loop was closed without closing the connection

    return told


class End:
    """What all ends have: a token that tells others of it, and who is at the other side.

    Args:
        token: the token that was declared; it is taken back when the end is closed.
        others: counts the ends at the other side that are known now.
    """

    def __init__(self, token: Any, others: Callable[[], int]) -> None:
        self._token = token
        self._others = others
        self._closed = False
        self._declared: list[Any] = []

    @property
    def peers(self) -> int:
        """How many ends of others are known."""
        return 0 if self._closed else self._others()

    async def ready(self) -> None:
        """Return at once: who tells of an end has declared it before."""

    def close(self) -> None:
        """Undeclare it."""
        if not self._closed:
            self._closed = True
            self._token.undeclare()
            for one in self._declared:
                one.undeclare()


class _Sender:
    """Numbers what an end sends."""

    def __init__(self, key: str) -> None:
        self.identity = hashlib.blake2b(key.encode(), digest_size=_GID).digest()
        self._number = 0

    def attachment(self) -> bytes:
        """Return the attachment of the next message; the time is that of the wall, as ROS 2 has it there."""
        self._number += 1
        return Attachment(self._number, time.time_ns(), self.identity).write()


class ZenohReader(End):
    """A subscriber."""

    def attach(self, subscriber: Any) -> None:
        """Take the subscriber that it is."""
        self._declared.append(subscriber)


class ZenohWriter(End):
    """A publisher."""

    def attach(self, publisher: Any, key: str) -> None:
        """Take the publisher that it is."""
        self._publisher = publisher
        self._sender = _Sender(key)
        self._declared.append(publisher)

    def write(self, content: bytes) -> None:
        """Send a message; RobotError KG803 when the session is closed."""
        try:
            self._publisher.put(content, attachment=self._sender.attachment())
        except zenoh.ZError as error:
            raise RobotError("KG803", f"a message was not sent: {error}") from None


class ZenohCaller(End):
    """A client of a service."""

    def attach(self, session: Session, key: Callable[[], str]) -> None:
        """Take the session, and what tells the key of the service."""
        self._session = session
        self._key = key
        self._sender = _Sender(str(id(self)))
        self._waiting: set[asyncio.Future[bytes]] = set()

    async def call(self, content: bytes) -> bytes:
        """Return the first response; RobotError KG807 when no server has the request, KG808 when it failed."""
        loop = asyncio.get_running_loop()
        answered: asyncio.Future[bytes] = loop.create_future()
        self._waiting.add(answered)
        cancellation = zenoh.CancellationToken()
        self._session.get(
            self._key(),
            zenoh.handlers.Callback(
                passing(loop, lambda reply: _answer(answered, reply)),
                lambda: passing(loop, lambda _: _unanswered(answered))(None),
            ),
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
        """Stop being a client; who waits learns that it is lost."""
        for answered in self._waiting:
            if not answered.done():
                answered.set_exception(RobotError("KG803", "the connection was closed before the service answered"))
        super().close()


def _answer(answered: asyncio.Future[bytes], reply: Reply) -> None:
    if answered.done():
        return
    if reply.ok is not None:
        answered.set_result(reply.ok.payload.to_bytes())
    elif reply.err is not None:
        message = reply.err.payload.to_bytes().decode("utf-8", "replace")
        answered.set_exception(RobotError("KG808", f"the service failed: {message[:500]}"))


def _unanswered(answered: asyncio.Future[bytes]) -> None:
    if not answered.done():
        answered.set_exception(RobotError("KG803", "the server left without an answer"))


class ZenohServer(End):
    """A service that is answered; a failure is told to the client as an error of Zenoh."""

    def __init__(
        self,
        session: Session,
        key: str,
        answer: Callable[[bytes], Awaitable[bytes]],
        tell: Callable[[], tuple[Any, Callable[[], int]]],
    ) -> None:
        """Begin to answer, and then tell of it, which gives the token and what counts the others."""
        self._key = key
        self._answer = answer
        self._sender = _Sender(key)
        self._running = Tasks()
        told = passing(asyncio.get_running_loop(), self._take)
        answering = session.declare_queryable(key, told, complete=True)
        super().__init__(*tell())
        self._declared.append(answering)

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
        """Return the number and the sender of the request, with the time of now."""
        try:
            request = Attachment.read(query.attachment.to_bytes() if query.attachment is not None else b"")
        except ValueError:
            return self._sender.attachment()
        return request._replace(time=time.time_ns()).write()

    def close(self) -> None:
        """Stop answering."""
        self._running.cancel()
        super().close()
