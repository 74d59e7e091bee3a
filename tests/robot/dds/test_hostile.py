"""Participants with invalid data are reported, and break nothing."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from cyclonedds import _clayer
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from robot.dds.peer import RELIABLE, TOLD, Gid, Info, NodeInfo, String

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from kg.robot.connection import ComputationGraph, Connection


class _Stranger:
    """A participant that announces and writes arbitrary data."""

    def __init__(self, number: int) -> None:
        self.participant = DomainParticipant(number)
        self.gid = self.participant.guid.bytes
        self._info = self.writer("ros_discovery_info", Info, TOLD)

    def writer(self, topic: str, kind: Any, qos: Any = RELIABLE) -> Any:
        """Return a writer to any topic of DDS."""
        return DataWriter(self.participant, Topic(self.participant, topic, kind), qos=qos)

    def tell(self, *nodes: tuple[str, str, list[bytes]], gid: bytes = b"") -> None:
        """Announce nodes, and their writers."""
        told = [NodeInfo(where, name, [], [Gid(list(one)) for one in gids]) for where, name, gids in nodes]
        self._info.write(Info(Gid(list(gid or self.gid)), told))


@asynccontextmanager
async def _beside() -> AsyncIterator[tuple[Connection, _Stranger]]:
    with domain() as number:
        stranger = _Stranger(number)
        connection = await connect(f"dds://{number}?settle=1", name="/kg")
        try:
            yield connection, stranger
        finally:
            await connection.aclose()


async def _seen(connection: Connection, true: Callable[[ComputationGraph], bool]) -> ComputationGraph:
    async def wait() -> ComputationGraph:
        async for graph in connection.changes():
            if true(graph):
                return graph
        raise AssertionError

    return await asyncio.wait_for(wait(), patient(10))


def test_topics_whose_names_are_none() -> None:
    """A topic with an invalid ROS 2 name is reported; one outside ROS 2 is silently ignored."""

    async def scene() -> None:
        async with _beside() as (connection, stranger):
            kept = [stranger.writer(name, String) for name in ("rt/a__b", "rt/", "rq/Request", "plain", "rt/good")]
            stranger.tell(("/", "strange", [kept[-1].guid.bytes]))
            graph = await _seen(connection, lambda graph: len(graph.problems) > 2 and bool(graph.ends))
            assert {problem.code for problem in graph.problems} == {"KG816"}
            assert [(end.node, end.name, end.type) for end in graph.ends] == [("/strange", "/good", "std_msgs/String")]

    asyncio.run(scene())


def test_nodes_that_are_none() -> None:
    """Invalid names, duplicate nodes, foreign ends and absent participants break nothing."""

    async def scene() -> None:
        async with _beside() as (connection, stranger):
            publication = await connection.advertise("/ours", "std_msgs/String")
            nobody = bytes(range(16))
            stranger.tell(("/", "ghost", []), gid=nobody)
            stranger.tell(("", "", []), ("/", "twice", [nobody]), ("/", "twice", []), ("/a//b", "x" * 256, []))
            graph = await _seen(connection, lambda graph: len(graph.problems) > 1)
            assert [node.name for node in graph.nodes] == ["/twice"]
            assert {problem.code for problem in graph.problems} == {"KG816"}
            assert publication.peers == 0

    asyncio.run(scene())


def test_a_message_that_does_not_decode() -> None:
    """A text that is not UTF-8 is reported (KG816), and the next message is read."""

    async def scene() -> None:
        async with _beside() as (connection, stranger):
            writer = stranger.writer("rt/chatter", String)
            subscription = await connection.subscribe("/chatter", "std_msgs/String")
            reading = asyncio.ensure_future(anext(aiter(subscription)))
            reported = asyncio.ensure_future(_seen(connection, lambda graph: bool(graph.problems)))
            while not reported.done():  # the reader may not have matched the writer yet
                _clayer.ddspy_write(writer._ref, b"\x00\x01\x00\x00\x03\x00\x00\x00\xff\xfe\x00\x00")
                await asyncio.sleep(0.01)
            assert {problem.code for problem in reported.result().problems} == {"KG816"}
            writer.write(String("fine"))
            assert (await asyncio.wait_for(reading, patient(10))).value == {"data": "fine"}

    asyncio.run(scene())


def test_types_that_differ() -> None:
    """A topic with another type is KG806, and so are ends of a topic with different types."""

    async def scene() -> None:
        async with _beside() as (connection, stranger):
            kept = stranger.writer("rt/chatter", String)
            await _seen(connection, lambda graph: any(end.role is Role.PUBLISHES for end in graph.ends))
            with pytest.raises(RobotError) as differs:
                await connection.subscribe("/chatter", "geometry_msgs/Twist")
            assert differs.value.code == "KG806"
            assert kept.get_matched_subscriptions() == []

    asyncio.run(scene())


@pytest.mark.parametrize(
    "address", ["dds://x", "dds://233", "dds://0?colour=red", "dds://0?types=all", "dds://1.5", "dds://[::"]
)
def test_an_address_that_is_none(address: str) -> None:
    """An address of another form is KG801."""
    with pytest.raises(RobotError) as refused:
        asyncio.run(connect(address))
    assert refused.value.code == "KG801"


def test_a_domain_that_cannot_be_joined(monkeypatch: pytest.MonkeyPatch) -> None:
    """If Cyclone DDS finds no network it is KG817."""
    interfaces = "<Interfaces><NetworkInterface name='none'/></Interfaces>"
    settings = f"<CycloneDDS><Domain><General>{interfaces}</General></Domain></CycloneDDS>"
    monkeypatch.setenv("CYCLONEDDS_URI", settings)
    with pytest.raises(RobotError) as refused:
        asyncio.run(connect("dds://231"))
    assert refused.value.code == "KG817"
