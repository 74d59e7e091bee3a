"""Services over DDS as rmw_cyclonedds_cpp has them: two topics, and a header before each message.

The header is the identity of the client and the number of its request; the client picks its responses by it.
"""

from __future__ import annotations

import asyncio
import struct
from contextlib import suppress
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.errors import RobotError
from kg.robot.tasks import Tasks, outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.dds.entities import DdsReader, DdsWriter

__all__ = ["DdsCaller", "DdsServer", "Request", "headed", "unheaded"]

_HEADER: Final = struct.Struct("<Qq")
_ENCAPSULATION: Final = 4
_CLIENT_IS_READY: Final = 1.0
"""Seconds that a response waits for the reader of its client to be found."""


class Request(NamedTuple):
    """A message with the header of a service taken off."""

    client: int
    number: int
    content: bytes


def headed(client: int, number: int, content: bytes) -> bytes:
    """Return a message with the header of a service behind its encapsulation.

    The header is 16 bytes long, so that everything behind it is aligned as before.
    """
    return content[:_ENCAPSULATION] + _HEADER.pack(client, number) + content[_ENCAPSULATION:]


def unheaded(content: bytes) -> Request:
    """Return the header and the message; RobotError KG816 for one that is too short."""
    end = _ENCAPSULATION + _HEADER.size
    if len(content) < end:
        raise RobotError("KG816", f"a message of a service has {len(content)} bytes, too few for its header")
    client, number = _HEADER.unpack(content[_ENCAPSULATION:end])
    return Request(client, number, content[:_ENCAPSULATION] + content[end:])


class DdsCaller:
    """A client of a service."""

    def __init__(self, identity: int) -> None:
        self._identity = identity
        self._number = 0
        self._waiting: dict[int, asyncio.Future[bytes]] = {}
        self._requests: DdsWriter
        self._responses: DdsReader

    def connect(self, requests: DdsWriter, responses: DdsReader) -> None:
        """Take the two ends that it works with."""
        self._requests, self._responses = requests, responses

    @property
    def peers(self) -> int:
        """How many servers there are."""
        return self._requests.peers

    async def ready(self) -> None:
        """Return when requests and responses are both connected."""
        await self._requests.ready()
        await self._responses.ready()

    async def call(self, content: bytes) -> bytes:
        """Return the response to a request."""
        await self.ready()
        self._number += 1
        number = self._number
        self._waiting[number] = asyncio.get_running_loop().create_future()
        try:
            self._requests.write(headed(self._identity, number, content))
            return await self._waiting[number]
        finally:
            del self._waiting[number]

    def take(self, content: bytes, _: int) -> None:
        """Take a response; those to other clients are left."""
        try:
            response = unheaded(content)
        except RobotError:
            return  # nobody knows to whom it was
        waiting = self._waiting.get(response.number) if response.client == self._identity else None
        if waiting is not None and not waiting.done():
            waiting.set_result(response.content)

    def close(self) -> None:
        """Stop being a client; who waits learns that it is lost."""
        self._requests.close()
        self._responses.close()
        for waiting in self._waiting.values():
            if not waiting.done():
                waiting.set_exception(RobotError("KG803", "the connection was closed before the service answered"))


class DdsServer:
    """A service that is answered; a request that fails has no response, since ROS 2 has none for it."""

    def __init__(self, answer: Callable[[bytes], Awaitable[bytes]]) -> None:
        self._answer = answer
        self._running = Tasks()
        self._requests: DdsReader
        self._responses: DdsWriter

    def connect(self, requests: DdsReader, responses: DdsWriter) -> None:
        """Take the two ends that it works with."""
        self._requests, self._responses = requests, responses

    @property
    def peers(self) -> int:
        """How many clients there are."""
        return self._requests.peers

    async def ready(self) -> None:
        """Return when there is a client."""
        await self._requests.ready()

    def take(self, content: bytes, writer: int) -> None:
        """Take a request, and answer it when there is an answer."""
        self._running.spawn(self._respond(content, writer), "answering a request")

    async def _respond(self, content: bytes, writer: int) -> None:
        try:
            request = unheaded(content)
        except RobotError:
            return  # nobody knows whose it is
        response = await outcome(self._answer(request.content))
        if isinstance(response, BaseException):
            return  # it was reported where it failed
        client = self._requests.origin(writer)
        if client is not None:
            with suppress(TimeoutError):
                await asyncio.wait_for(self._responses.until(lambda: self._responses.reaches(client)), _CLIENT_IS_READY)
        self._responses.write(headed(request.client, request.number, response))

    def close(self) -> None:
        """Stop answering."""
        self._running.cancel()
        self._requests.close()
        self._responses.close()
