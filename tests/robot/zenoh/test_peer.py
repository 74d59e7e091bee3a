"""Our node with a plain session of Zenoh, with handwritten tokens, keys and CDR."""

from __future__ import annotations

import asyncio
import struct
import time
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from ports import own_port
from robot.connections import types_for_tests

pytest.importorskip("zenoh", reason="the extra `zenoh` is not installed")

import zenoh
from robot.zenoh.hub import hub

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect
from kg.robot.messages import Types
from kg.robot.ros2.names import dds_type
from kg.robot.ros2.types import type_hash

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.connection import ComputationGraph, Connection, Value

STRING = "std_msgs::msg::dds_::String_/RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
ADD = (
    "example_interfaces::srv::dds_::AddTwoInts_/RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
)
HELLO = b"\x00\x01\x00\x00\x06\x00\x00\x00hello\x00"
GID = bytes(range(16))
ATTACHED = struct.pack("<qqB16s", 1, 1_700_000_000_000_000_000, 16, GID)


class _Peer:
    """A session with the node `/robot/base`, written by hand."""

    def __init__(self, session: Any) -> None:
        self.session = session
        self._tokens = [session.liveliness().declare_token(self._token("0/0/NN"))]

    def _token(self, middle: str, rest: str = "") -> str:
        return f"@ros2_lv/0/{self.session.zid()}/{middle}/%/%robot/base{rest}"

    async def publisher(self, key: str) -> Any:
        """Declare a publisher and wait until a subscriber matches it."""
        publisher = self.session.declare_publisher(key)
        await _until(lambda: publisher.matching_status.matching)
        return publisher

    def end(self, number: int, sort: str, topic: str, kind: str, qos: str = "::,10:,:,:,,") -> None:
        """Announce an end of the node."""
        rest = f"/%{topic}/{kind}/{qos}"
        self._tokens.append(self.session.liveliness().declare_token(self._token(f"0/{number}/{sort}", rest)))

    def leave(self) -> None:
        """Withdraw all tokens."""
        for token in self._tokens:
            token.undeclare()


@asynccontextmanager
async def _beside(*, options: str = "settle=1") -> AsyncIterator[tuple[Connection, _Peer]]:
    with hub() as (place, session):
        peer = _Peer(session)
        types = types_for_tests(2)
        types.define("example_interfaces/AddTwoInts", "int64 a\nint64 b\n---\nint64 sum\n", "srv")
        connection = await connect(f"zenoh://{place}?{options}", name="/kg", types=types)
        try:
            yield connection, peer
        finally:
            await connection.aclose()


async def _soon(what: Awaitable[Any]) -> Any:
    return await asyncio.wait_for(what, patient(10))


async def _until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(patient(10)):
        while not true():  # noqa: ASYNC110 - the other thread tells nobody
            await asyncio.sleep(0.01)


async def _seen(connection: Connection, true: Callable[[ComputationGraph], bool]) -> ComputationGraph:
    async for graph in connection.changes():
        if true(graph):
            return graph
    raise AssertionError


def test_the_graph_is_what_tokens_tell() -> None:
    """Nodes, ends with types and quality of service, folded actions; a broken token is reported."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            peer.end(1, "MP", "robot%chatter", STRING, "2:1:,7:,:,:,,")
            peer.end(2, "MS", "robot%chatter", STRING, "1:2:1,7:0,500000000:,:1,9223372036,854775807")
            peer.end(3, "SS", "add_two_ints", ADD)
            peer.end(4, "SS", "fib%_action%send_goal", "demo::action::dds_::Fib_SendGoal_/RIHS01_00")
            peer.end(5, "SS", "fib%_action%get_result", "demo::action::dds_::Fib_GetResult_/RIHS01_00")
            peer.end(6, "MP", "other", STRING[:-1] + "9")
            peer.end(7, "MP", "no name", STRING)
            peer.end(8, "MP", "nonsense", STRING, "what")
            await _soon(_seen(connection, lambda graph: len(graph.problems) > 3 and len(graph.ends) > 4))
            graph = await _soon(connection.graph())
            assert [node.name for node in graph.nodes] == ["/robot/base"]
            assert {(end.role, end.name, end.type) for end in graph.ends} == {
                (Role.PUBLISHES, "/robot/chatter", "std_msgs/String"),
                (Role.SUBSCRIBES, "/robot/chatter", "std_msgs/String"),
                (Role.PUBLISHES, "/other", "std_msgs/String"),
                (Role.SERVICES, "/add_two_ints", "example_interfaces/AddTwoInts"),
                (Role.ACTION_SERVERS, "/fib", "demo/Fib"),
            }
            (qos,) = [end.qos for end in graph.ends if end.role is Role.SUBSCRIBES]
            assert qos is not None
            assert (qos.reliability, qos.durability, qos.depth, qos.deadline) == ("reliable", "volatile", 7, 0.5)
            assert sorted(problem.code for problem in graph.problems) == ["KG806", "KG815", "KG816", "KG816"]

    asyncio.run(scene())


def test_messages_go_both_ways() -> None:
    """The peer reads our messages under ROS 2's key with an attachment, and our node reads its messages."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            came: list[Any] = []
            kept = peer.session.declare_subscriber(f"0/robot/told/{STRING}", came.append)
            publication = await connection.advertise("/robot/told", "std_msgs/String")
            peer.end(1, "MS", "robot%told", STRING)
            await _soon(_seen(connection, lambda _: publication.peers > 0))
            await publication.publish({"data": "hello"})
            await _until(lambda: bool(came))
            assert came[0].payload.to_bytes() == HELLO
            number, _, length, _ = struct.unpack("<qqB16s", came[0].attachment.to_bytes())
            assert (number, length) == (1, 16)
            kept.undeclare()
            peer.end(2, "MP", "chatter", STRING)
            subscription = await connection.subscribe("/chatter", queue=1)
            publisher = await peer.publisher(f"0/chatter/{STRING}")
            publisher.put(HELLO, attachment=ATTACHED)
            publisher.put(HELLO, attachment=ATTACHED)
            await _until(lambda: subscription.dropped == 1)
            received = await _soon(anext(aiter(subscription)))
            assert received.value == {"data": "hello"}

    asyncio.run(scene())


def test_services_go_both_ways() -> None:
    """Our node and the peer call each other's services, as queries with a number repeated in the response."""

    async def add(request: Value) -> Value:
        return {"sum": request["a"] + request["b"]}

    def answer(query: Any) -> None:
        content = query.payload.to_bytes()
        first, second = struct.unpack_from("<qq", content, 4)
        query.reply(query.key_expr, content[:4] + struct.pack("<q", first * second), attachment=query.attachment)

    async def scene() -> None:
        async with _beside() as (connection, peer):
            kept = peer.session.declare_queryable(f"0/multiply/{ADD}", answer, complete=True)
            peer.end(1, "SS", "multiply", ADD)
            response = await connection.call("/multiply", None, {"a": 6, "b": 7}, seconds=patient(5))
            assert response == {"sum": 42}
            kept.undeclare()
            await connection.serve("/add_two_ints", "example_interfaces/AddTwoInts", add)
            payload = b"\x00\x01\x00\x00" + struct.pack("<qq", 2, 40)
            reply = await asyncio.to_thread(_asked, peer.session, payload)
            assert reply.payload.to_bytes() == b"\x00\x01\x00\x00" + struct.pack("<q", 42)
            number, _, _, sender = struct.unpack("<qqB16s", reply.attachment.to_bytes())
            assert (number, sender) == (1, GID)

    asyncio.run(scene())


def test_a_type_is_described_by_its_node() -> None:
    """A topic of an unknown type is read: its node describes the type by the hash in the topic's token."""
    described = Types(2)
    described.define("newer_msgs/Reading", "float64 x\nuint8[<=4] few\n")
    digest, service = type_hash(described, "newer_msgs/Reading"), "type_description_interfaces/GetTypeDescription"
    kinds = {"x": {"type_id": 11}, "few": {"type_id": 99, "capacity": 4}}
    fields = [{"name": name, "type": kind} for name, kind in kinds.items()]
    whole = {"type_description": {"type_name": "newer_msgs/msg/Reading", "fields": fields}}

    def answer(query: Any) -> None:
        asked = described.decode(f"{service}_Request", query.payload.to_bytes())
        right = (asked["type_name"], asked["type_hash"]) == ("newer_msgs/msg/Reading", digest)
        content = described.encode(f"{service}_Response", {"successful": right, "type_description": whole})
        query.reply(query.key_expr, content, attachment=query.attachment)

    async def scene() -> None:
        async with _beside() as (connection, peer):
            key = f"{dds_type(service, service=True)}/{type_hash(described, service, service=True)}"
            name = "robot/base/get_type_description"
            kept = peer.session.declare_queryable(f"0/{name}/{key}", answer, complete=True)
            peer.end(1, "SS", name.replace("/", "%"), key)
            topic = f"{dds_type('newer_msgs/Reading')}/{digest}"
            peer.end(2, "MP", "reading", topic)
            subscription = await _soon(connection.subscribe("/reading"))
            publisher = await peer.publisher(f"0/reading/{topic}")
            publisher.put(described.encode("newer_msgs/Reading", {"x": 0.5, "few": b"\x01"}), attachment=ATTACHED)
            received = await _soon(anext(aiter(subscription)))
            assert received.value == {"x": 0.5, "few": b"\x01"}
            kept.undeclare()

    asyncio.run(scene())


def _asked(session: Any, payload: bytes) -> Any:
    target = zenoh.QueryTarget.ALL_COMPLETE
    end = time.monotonic() + patient(10)
    while time.monotonic() < end:
        for reply in session.get(f"0/add_two_ints/{ADD}", payload=payload, attachment=ATTACHED, target=target):
            if reply.ok is not None:
                return reply.ok
        time.sleep(0.05)  # it is not known yet, or answers late
    raise AssertionError


def test_a_payload_that_does_not_decode_is_reported() -> None:
    """Invalid bytes are skipped and reported (KG816), and the next message is read."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            peer.end(1, "MP", "chatter", STRING)
            subscription = await connection.subscribe("/chatter")
            publisher = await peer.publisher(f"0/chatter/{STRING}")
            publisher.put(b"\x00\x01\x00\x00\xff\xff\xff\xffno")
            publisher.put(HELLO)
            received = await _soon(anext(aiter(subscription)))
            assert received.value == {"data": "hello"}
            graph = await _soon(_seen(connection, lambda graph: bool(graph.problems)))
            assert {problem.code for problem in graph.problems} == {"KG816"}

    asyncio.run(scene())


def test_the_clock_of_a_simulation_is_followed() -> None:
    """With `clock=simulated` the time is that of `/clock`, and waits follow it."""
    digest = type_hash(Types(2), "rosgraph_msgs/Clock")

    async def scene() -> None:
        async with _beside(options="settle=0&clock=simulated") as (connection, peer):
            waiting = asyncio.ensure_future(connection.clock.sleep(20))
            publisher = await peer.publisher(f"0/clock/rosgraph_msgs::msg::dds_::Clock_/{digest}")
            publisher.put(b"\x00\x01\x00\x00" + struct.pack("<iI", 19, 500_000_000))
            await _until(lambda: connection.clock.now() == 19.5)
            assert not waiting.done()
            publisher.put(b"\x00\x01\x00\x00" + struct.pack("<iI", 20, 500_000_000))
            await _soon(waiting)
            assert connection.clock.now() == 20.5

    asyncio.run(scene())


def test_a_robot_that_goes_is_noticed() -> None:
    """When all nodes have left the robot is lost."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            await _soon(_seen(connection, lambda graph: bool(graph.nodes)))
            peer.leave()
            assert "left" in await _soon(connection.wait_lost())

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("address", "code"),
    [
        ("zenoh://127.0.0.1:{free}", "KG802"),
        ("zenoh://localhost?color=red", "KG801"),
        ("zenoh://localhost?clock=cuckoo", "KG801"),
        ("zenoh://localhost?domain=233", "KG801"),
        ("zenoh://localhost:port", "KG801"),
        ("zenoh://[::", "KG801"),
    ],
)
def test_a_place_where_nobody_is(address: str, code: str) -> None:
    """An invalid address is KG801, and one without a listener is KG802."""
    with own_port() as free, pytest.raises(RobotError) as refused:
        asyncio.run(connect(address.replace("{free}", str(free))))
    assert refused.value.code == code
