"""ROS 2 over DDS: a participant of Cyclone DDS, compatible with rmw_cyclonedds_cpp."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING, Any, Final

from cyclonedds.builtin import (
    BuiltinDataReader,
    BuiltinTopicDcpsParticipant,
    BuiltinTopicDcpsPublication,
    BuiltinTopicDcpsSubscription,
)
from cyclonedds.core import DDSStatus, InstanceState
from cyclonedds.core import Qos as DdsQos
from cyclonedds.qos import Policy
from cyclonedds.topic import Topic

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connection import GraphProblem
from kg.robot.dds.discovery import INFO, LONG, SHORT, Discovery, Endpoint, decode_info, encode_info
from kg.robot.dds.domains import join, leave
from kg.robot.dds.entities import Bell, DdsCaller, DdsReader, DdsServer, DdsWriter
from kg.robot.dds.qos import from_dds, policies_at, to_dds, user_data, written
from kg.robot.dds.types import Classes, learned
from kg.robot.ros2.middleware import ANSWERS, Deliver, Neighbourhood
from kg.robot.ros2.names import dds_topic, is_name, replies, ros_end
from kg.robot.ros2.types import type_hash

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.messages import Types
    from kg.robot.ros2.graph import Watch

_TOPIC: Final = "ros_discovery_info"
_OWN_QOS: Final = Qos("reliable", "transient_local", "keep_last", 1)
_PEER_QOS: Final = Qos("reliable", "transient_local", "keep_all")
_SAMPLES: Final = 1000
_ALIVE: Final = InstanceState.Alive
_CYCLONE: Final = b"\x01\x10"  # the first bytes of an identifier are those of its vendor (DDSI-RTPS 2.5, 9.3.1.5)
_OURS: Final = "kg"  # user data of kg's own participants, which read identifiers of any length


class DdsMiddleware:
    """Our participant of a domain, with one node.

    It announces its node with identifiers of the length that others use: the longer one with `humble`, or while another
    participant does. `ask_types` lets it request unknown types from peers.
    """

    def __init__(self, domain: int, name: str, types: Types, *, humble: bool = False, ask_types: bool = False) -> None:
        self.types = types
        self._name = name
        self._domain = domain
        self._humble = humble
        self._length = LONG if humble else SHORT
        self._classes = Classes(types)
        self._topics: dict[tuple[str, str, bool], Any] = {}
        self._readers: set[bytes] = set()
        self._writers: set[bytes] = set()
        self._closed = False
        data = DdsQos(Policy.Userdata(written({"enclave": "/", _OURS: "1"})))
        self._participant = join(domain, data, by_name=not ask_types)
        self._gid: bytes = self._participant.guid.bytes
        self._discovery = Discovery(self._gid)

    def begin(self, watch: Watch) -> None:
        """Watch the domain, and announce our node."""
        self._watch = watch
        self._bell = Bell(self._participant)
        takes: list[tuple[Any, Callable[[], None]]] = [
            (BuiltinTopicDcpsParticipant, self._participants),
            (BuiltinTopicDcpsPublication, lambda: self._endpoints(1, writer=True)),
            (BuiltinTopicDcpsSubscription, lambda: self._endpoints(2, writer=False)),
        ]
        self._builtin = [self._watching(topic, take) for topic, take in takes]
        topic = self._topic(_TOPIC, INFO)
        self._info = DdsWriter(self._bell, topic, to_dds(_OWN_QOS, {}), watch.changed)
        self._announcements = DdsReader(self._bell, topic, to_dds(_PEER_QOS, {}), self._hear, watch.changed)
        self._announce()
        for _, take in takes:
            take()

    def _watching(self, topic: Any, take: Callable[[], None]) -> BuiltinDataReader:
        reader = BuiltinDataReader(self._participant, topic)
        reader._cqos_conv = policies_at  # noqa: SLF001 - the library's own takes 0.7 ms for each end, ours a third of that
        self._bell.add(reader, DDSStatus.DataAvailable, take)
        return reader

    def _taken(self, index: int) -> list[Any]:
        samples: list[Any] = [] if self._closed else self._builtin[index].take(N=_SAMPLES)
        for sample in samples:
            if sample.sample_info.instance_state != _ALIVE:
                self._discovery.gone(sample.key.bytes)
        if samples:
            self._watch.changed()
        if len(samples) == _SAMPLES:
            samples += self._taken(index)
        return [sample for sample in samples if sample.sample_info.instance_state == _ALIVE]

    def _participants(self) -> None:
        for sample in self._taken(0):
            properties = {one.key: one.value for one in sample.qos if isinstance(one, Policy.Property)}
            host = properties.get("__Hostname") or sample.key.hex
            process = f" process {properties['__Pid']}" if "__Pid" in properties else ""
            self._discovery.participant(sample.key.bytes, host + process, ours=_OURS in user_data(sample.qos))
        self._adapt_length()

    def _endpoints(self, index: int, *, writer: bool) -> None:
        for sample in self._taken(index):
            end, problem = ros_end(sample.topic_name, sample.type_name, writer=writer), None
            if end is not None and not is_name(end[1]):
                problem = GraphProblem("KG816", sample.topic_name[:80], f"`{end[1][:80]}` is not a ROS 2 name")
            endpoint = Endpoint(
                sample.participant_key.bytes,
                sample.topic_name,
                None if problem else end,
                from_dds(sample.qos, writer=writer, cyclone=sample.key.bytes.startswith(_CYCLONE)),
                sample.sample_info.instance_handle,
                sample.type_id,
                problem,
                user_data(sample.qos).get("typehash"),
            )
            self._discovery.end(sample.key.bytes, endpoint)

    def _hear(self, content: bytes, _: int) -> None:
        try:
            value, length = decode_info(self.types, content)
        except RobotError as error:
            self._watch.report(
                GraphProblem("KG816", _TOPIC, f"a participant sent invalid discovery data: {error.message}")
            )
            return
        self._discovery.announce(value, length)
        self._adapt_length()
        self._watch.changed()

    def _announce(self) -> None:
        node = (self._name, sorted(self._readers), sorted(self._writers))
        self._info.write(encode_info(self.types, self._gid, [node], self._length))

    def _adapt_length(self) -> None:
        """Announce our node again when others use another length of identifiers than before."""
        length = LONG if self._humble or LONG in self._discovery.lengths() else SHORT
        if length != self._length:
            self._length = length
            self._announce()

    def _topic(self, name: str, kind: str, *, header: bool = False) -> Any:
        if (name, kind, header) not in self._topics:
            sort = self._classes.of(kind, header=header)
            self._topics[name, kind, header] = Topic(self._participant, name, sort)
        return self._topics[name, kind, header]

    def _reader(
        self, topic: str, kind: str, qos: Qos, deliver: Callable[[bytes, int], None], mark: dict[str, str] | None = None
    ) -> DdsReader:
        of_kind = self._topic(topic, kind, header=mark is not None)
        reader = DdsReader(self._bell, of_kind, self._policies(kind, qos, mark), deliver, self._watch.changed)
        self._opened(reader, self._readers)
        return reader

    def _writer(self, topic: str, kind: str, qos: Qos, mark: dict[str, str] | None = None) -> DdsWriter:
        of_kind = self._topic(topic, kind, header=mark is not None)
        writer = DdsWriter(self._bell, of_kind, self._policies(kind, qos, mark), self._watch.changed)
        self._opened(writer, self._writers)
        return writer

    def _policies(self, kind: str, qos: Qos, mark: dict[str, str] | None) -> DdsQos:
        return to_dds(qos, {**(mark or {}), "typehash": type_hash(self.types, kind)})

    def _opened(self, end: DdsReader | DdsWriter, side: set[bytes]) -> None:
        def closed() -> None:
            side.discard(end.identity)
            if not self._closed:
                self._announce()

        side.add(end.identity)
        end.on_close = closed
        self._announce()

    def neighbourhood(self) -> Neighbourhood:
        """Return the nodes and ends of other participants."""
        return self._discovery.neighbourhood()

    def reader(self, topic: str, kind: str, qos: Qos, deliver: Deliver) -> DdsReader:
        """Open a reader of a topic."""

        def take(content: bytes, writer: int) -> None:
            deliver(content, self._discovery.node(writer))

        return self._reader(dds_topic(topic, Role.SUBSCRIBES), kind, qos, take)

    def writer(self, topic: str, kind: str, qos: Qos) -> DdsWriter:
        """Open a writer of a topic."""
        return self._writer(dds_topic(topic, Role.PUBLISHES), kind, qos)

    def caller(self, service: str, kind: str) -> DdsCaller:
        """Open a client of a service."""
        identity = random.getrandbits(63)
        caller, mark = DdsCaller(identity), {"clientid": _spelt(identity)}
        responses = self._reader(replies(service), f"{kind}_Response", ANSWERS, caller.take, mark)
        caller.connect(self._writer(f"rq{service}Request", f"{kind}_Request", ANSWERS, mark), responses)
        return caller

    def server(self, service: str, kind: str, answer: Callable[[bytes], Awaitable[bytes]]) -> DdsServer:
        """Serve a service."""
        server, mark = DdsServer(answer), {"serviceid": _spelt(random.getrandbits(63))}
        responses = self._writer(replies(service), f"{kind}_Response", ANSWERS, mark)
        server.connect(self._reader(f"rq{service}Request", f"{kind}_Request", ANSWERS, server.take, mark), responses)
        return server

    def hashes(self, name: str) -> list[tuple[str, str]]:
        """Return the nodes with an end of a topic or service, each with the hash of its type."""
        return list(self._discovery.hashes(name))

    async def learn(self, kind: str, name: str) -> bool:
        """Request the types of an end from its participants (DDS XTypes); return whether any was learned.

        A service has two, of the request and of the response. Only participants that send type information can answer,
        such as Cyclone DDS for Python, but not ROS 2 before Kilted. Without `ask_types` no request is sent.
        """
        learned_any = False
        for end in list(self._discovery.endpoints(name)):
            if self.types.has(kind):
                break
            if end.type_id is not None:
                learned_any |= await learned(self._participant, end.type_id, self.types)
        return learned_any

    def close(self) -> None:
        """Leave the domain."""
        self._closed = True
        self._bell.close()
        leave(self._domain, self._participant)


def _spelt(identity: int) -> str:
    return ".".join(f"{one:x}" for one in identity.to_bytes(8, "little"))
