"""DDS readers and writers of bytes, services built from them, and the thread that waits for them.

Callbacks of the library into Python are avoided: its threads would wait for the interpreter lock while they hold locks
of the library, which deadlocks with our calls.

Services are those of rmw_cyclonedds_cpp: two topics, and a header before each message. The header is the identity of
the client and the number of its request, by which the client selects its responses.
"""

from __future__ import annotations

import asyncio
import struct
import threading
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from cyclonedds import _clayer
from cyclonedds.core import (
    DDSException,
    DDSStatus,
    Entity,
    GuardCondition,
    InstanceState,
    Policy,
    SampleState,
    ViewState,
    WaitSet,
)
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.util import duration

from kg.errors import RobotError
from kg.robot.tasks import Tasks, outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from cyclonedds.domain import DomainParticipant

_EVER: Final = duration(infinite=True)


def delete(entity: Entity) -> None:
    """Delete a DDS entity now, instead of at garbage collection."""
    entity.__del__()


class Bell:
    """Notifies the event loop of status changes of entities."""

    def __init__(self, participant: DomainParticipant) -> None:
        self.participant = participant
        self._loop = asyncio.get_running_loop()
        self._set = WaitSet(participant)
        self._stop = GuardCondition(participant)
        self._set.attach(self._stop)
        self._calls: dict[int, tuple[Entity, int, Callable[[], None]]] = {}
        self._handled = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._wait, name="kg-dds", daemon=True)
        self._thread.start()

    def add(self, entity: Entity, mask: int, call: Callable[[], None]) -> None:
        """Call `call` in the event loop when a status of the mask changes."""
        entity.set_status_mask(mask)
        self._calls[id(entity)] = (entity, mask, call)
        self._set.attach(entity)

    def remove(self, entity: Entity) -> None:
        """Remove an entity."""
        if not self._closed and self._calls.pop(id(entity), None) is not None:
            self._set.detach(entity)

    def _wait(self) -> None:
        """Wait, notify the event loop, and wait until it is done: a status stays set until it is taken."""
        while not self._closed:
            self._set.wait(_EVER)
            self._handled.clear()
            try:
                self._loop.call_soon_threadsafe(self._ring)
            except RuntimeError:
                return  # the event loop was closed without closing the connection
            self._handled.wait()

    def _ring(self) -> None:
        try:
            for entity, mask, call in list(self._calls.values()):
                if not self._closed and id(entity) in self._calls and entity.take_status(mask):
                    call()
        finally:
            self._handled.set()

    def close(self) -> None:
        """End the thread."""
        self._closed = True
        self._stop.set(True)
        while self._thread.is_alive():
            self._handled.set()
            self._thread.join(0.01)
        delete(self._set)


PREFIX: Final = 12
"""The first 12 of the 16 bytes of an identifier are those of the participant (DDSI-RTPS 2.5, 9.3.1)."""
_ANY: Final = SampleState.Any | ViewState.Any | InstanceState.Any
_BATCH: Final = 100
_ALIGNMENT: Final = 4


def _matched(handles: Callable[[], list[int]]) -> list[int]:
    """Return the handles of peers; the library counts before it fetches, and fails if one is added in between."""
    while True:
        try:
            return handles()
        except IndexError:
            continue


class _End:
    """Base of readers and writers: their matched peers, until it is closed."""

    def __init__(self, bell: Bell, on_change: Callable[[], None]) -> None:
        self.on_close: Callable[[], None] = lambda: None
        self._news = asyncio.Event()
        self._bell = bell
        self._on_change = on_change
        self._closed = False
        self._entity: Any = None

    @property
    def peers(self) -> int:
        """Number of matched ends of others."""
        raise NotImplementedError

    def _match(self) -> None:
        self._news.set()
        self._on_change()

    async def until(self, true: Callable[[], bool]) -> None:
        """Return when a condition on the matched peers holds; KG803 if it is closed first."""
        while not true():
            if self._closed:
                raise RobotError("KG803", "the connection was closed before anybody was there")
            self._news.clear()
            await self._news.wait()

    async def ready(self) -> None:
        """Return when an end of another node is matched."""
        await self.until(lambda: self.peers > 0)

    def close(self) -> None:
        """Delete it; may be repeated."""
        if not self._closed:
            self._closed = True
            self._news.set()
            self._bell.remove(self._entity)
            delete(self._entity)
            self.on_close()


class DdsReader(_End):
    """A reader that passes on each message, with the handle and identifier of its writer."""

    def __init__(
        self,
        bell: Bell,
        topic: Any,
        qos: Any,
        deliver: Callable[[bytes, int], None],
        on_change: Callable[[], None],
    ) -> None:
        super().__init__(bell, on_change)
        self._deliver = deliver
        self._entity = DataReader(bell.participant, topic, qos=qos)
        self.identity: bytes = self._entity.guid.bytes
        bell.add(self._entity, DDSStatus.DataAvailable | DDSStatus.SubscriptionMatched, self._happened)
        self._happened()  # for what came before the bell was attached

    @property
    def peers(self) -> int:
        """Number of matched writers."""
        return 0 if self._closed else len(_matched(self._entity.get_matched_publications))

    def _happened(self) -> None:
        self._match()
        self._drain()

    def origin(self, handle: int) -> bytes | None:
        """Return the participant whose writer has a handle, None if it is gone."""
        publication = None if self._closed else self._entity.get_matched_publication_data(handle)
        return publication.key.bytes[:PREFIX] if publication else None

    def _drain(self) -> None:
        """Take all messages; later ones trigger another notification."""
        while not self._closed:
            messages = _clayer.ddspy_take(self._entity._ref, _ANY, _BATCH)  # noqa: SLF001 - the library has no public way to bytes
            if isinstance(messages, int):
                return
            for content, info in messages:
                if info.valid_data:
                    self._deliver(content, info.publication_handle)
            if len(messages) < _BATCH:
                return


class DdsWriter(_End):
    """A writer of messages in CDR."""

    def __init__(self, bell: Bell, topic: Any, qos: Any, on_change: Callable[[], None]) -> None:
        super().__init__(bell, on_change)
        self._name = topic.get_name()
        self._entity = DataWriter(bell.participant, topic, qos=qos)
        self.identity: bytes = self._entity.guid.bytes
        bell.add(self._entity, DDSStatus.PublicationMatched, self._match)

    @property
    def peers(self) -> int:
        """Number of matched readers."""
        return 0 if self._closed else len(_matched(self._entity.get_matched_subscriptions))

    def reaches(self, participant: bytes) -> bool:
        """Return whether a reader of a participant is matched."""
        handles = [] if self._closed else _matched(self._entity.get_matched_subscriptions)
        subscriptions = (self._entity.get_matched_subscription_data(handle) for handle in handles)
        return any(one.key.bytes[:PREFIX] == participant for one in subscriptions if one)

    @property
    def confirmed(self) -> bool:
        """Whether all matched readers are reliable and have confirmed all messages."""
        handles = [] if self._closed else _matched(self._entity.get_matched_subscriptions)
        readers = [self._entity.get_matched_subscription_data(handle) for handle in handles]
        reliable = all(one and one.qos[Policy.Reliability] != Policy.Reliability.BestEffort for one in readers)
        with suppress(AttributeError):  # of the library, where it should report that the time is over
            return reliable and not self._closed and self._entity.wait_for_acks(0)
        return False

    def write(self, content: bytes) -> None:
        """Send a message with its encapsulation; RobotError KG803 if the library refuses it."""
        # The library takes whole words of four bytes; readers ignore what follows the last field.
        padded = content.ljust(-(-len(content) // _ALIGNMENT) * _ALIGNMENT, b"\0")
        code = DDSException.DDS_RETCODE_ALREADY_DELETED
        if not self._closed:
            code = _clayer.ddspy_write(self._entity._ref, padded)  # noqa: SLF001 - the library has no public way to bytes
        if code < 0:
            raise RobotError("KG803", f"a message to `{self._name}` was not sent: {DDSException(code, 'writing').msg}")


_HEADER: Final = struct.Struct("<Qq")
_ENCAPSULATION: Final = 4
_CLIENT_IS_READY: Final = 1.0  # seconds that a response waits for the discovery of its client's reader


class Request(NamedTuple):
    """A message without its service header."""

    client: int
    number: int
    content: bytes


def headed(client: int, number: int, content: bytes) -> bytes:
    """Return a message with a service header after its encapsulation.

    The header has 16 bytes, which keeps the alignment.
    """
    return content[:_ENCAPSULATION] + _HEADER.pack(client, number) + content[_ENCAPSULATION:]


def unheaded(content: bytes) -> Request:
    """Return the header and the message; RobotError KG816 if it is too short."""
    end = _ENCAPSULATION + _HEADER.size
    if len(content) < end:
        raise RobotError("KG816", f"a message of a service has {len(content)} bytes, too few for its header")
    client, number = _HEADER.unpack(content[_ENCAPSULATION:end])
    return Request(client, number, content[:_ENCAPSULATION] + content[end:])


class _ServiceEnd:
    """A client or server of a service, which works with two ends."""

    _requests: _End
    _responses: _End

    def connect(self, requests: _End, responses: _End) -> None:
        """Take the two ends."""
        self._requests, self._responses = requests, responses

    def close(self) -> None:
        """Close both ends."""
        self._requests.close()
        self._responses.close()


class DdsCaller(_ServiceEnd):
    """A client of a service."""

    _requests: DdsWriter

    def __init__(self, identity: int) -> None:
        self._identity = identity
        self._number = 0
        self._waiting: dict[int, asyncio.Future[bytes]] = {}

    async def call(self, content: bytes) -> bytes:
        """Return the response to a request, once requests and responses are both connected."""
        await self._requests.ready()
        await self._responses.ready()
        self._number += 1
        number = self._number
        self._waiting[number] = asyncio.get_running_loop().create_future()
        try:
            self._requests.write(headed(self._identity, number, content))
            return await self._waiting[number]
        finally:
            del self._waiting[number]

    def take(self, content: bytes, _: int) -> None:
        """Take a response; those to other clients are ignored."""
        try:
            response = unheaded(content)
        except RobotError:
            return  # its client is unknown
        waiting = self._waiting.get(response.number) if response.client == self._identity else None
        if waiting is not None and not waiting.done():
            waiting.set_result(response.content)

    def close(self) -> None:
        """Close the client; waiting calls get an error."""
        super().close()
        for waiting in self._waiting.values():
            if not waiting.done():
                waiting.set_exception(RobotError("KG803", "the connection was closed before the service answered"))


class DdsServer(_ServiceEnd):
    """A service server; a failed request has no response, since ROS 2 cannot report failures."""

    _requests: DdsReader
    _responses: DdsWriter

    def __init__(self, answer: Callable[[bytes], Awaitable[bytes]]) -> None:
        self._answer = answer
        self._running = Tasks()

    def take(self, content: bytes, writer: int) -> None:
        """Take a request, and respond when the response is ready."""
        self._running.spawn(self._respond(content, writer), "answering a request")

    async def _respond(self, content: bytes, writer: int) -> None:
        try:
            request = unheaded(content)
        except RobotError:
            return  # its client is unknown
        response = await outcome(self._answer(request.content))
        if isinstance(response, BaseException):
            return  # it was reported where it failed
        client = self._requests.origin(writer)
        if client is not None:
            with suppress(TimeoutError):
                await asyncio.wait_for(self._responses.until(lambda: self._responses.reaches(client)), _CLIENT_IS_READY)
        self._responses.write(headed(request.client, request.number, response))

    def close(self) -> None:
        """Stop serving."""
        self._running.cancel()
        super().close()
