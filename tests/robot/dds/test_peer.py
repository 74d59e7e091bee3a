"""Our node with a peer of plain Cyclone DDS in another process, with handwritten names and classes."""

from __future__ import annotations

import asyncio
import signal
import subprocess
import sys
from contextlib import asynccontextmanager, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from robot.connections import types_for_tests
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect
from kg.robot.ros2.middleware import OFFERED

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Iterator

    from kg.robot.connection import ComputationGraph, Connection, Publication, Value

_PEER = Path(__file__).parent / "peer.py"
_ENDS = 10
"""Number of ends of the peer, with actions folded."""


@contextmanager
def _running(number: int) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, str(_PEER), str(number)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as peer:
        assert peer.stdout is not None
        assert peer.stdout.readline() == "ready\n"
        try:
            yield peer
        finally:
            peer.kill()


@asynccontextmanager
async def _beside(options: str = "") -> AsyncIterator[tuple[Connection, subprocess.Popen[str]]]:
    """Yield a connection of ours to a domain with the peer."""
    with domain() as number, _running(number) as peer:
        types = types_for_tests(2)
        types.define("example_interfaces/AddTwoInts", "int64 a\nint64 b\n---\nint64 sum\n", "srv")
        connection = await connect(f"dds://{number}?settle=2{options}", name="/kg", types=types)
        try:
            await _soon(_whole(connection))
            yield connection, peer
        finally:
            await connection.aclose()


async def _soon(what: Awaitable[Any]) -> Any:
    return await asyncio.wait_for(what, patient(10))


async def _whole(connection: Connection) -> None:
    """Return when all of the peer is discovered with its nodes, which takes time on a busy machine."""
    async for graph in connection.changes():
        named = all(node.problem is None for node in graph.nodes)
        if named and len(graph.ends) >= _ENDS:
            return
    raise AssertionError


async def _next(connection: Connection, topic: str, kind: str | None = None) -> Value:
    subscription = await connection.subscribe(topic, kind)
    async for one in subscription:
        await subscription.aclose()
        return one.value
    raise AssertionError


async def _matched(publication: Publication) -> None:
    while not publication.peers:  # noqa: ASYNC110 - a middleware tells nobody how many peers it has
        await asyncio.sleep(0.01)


async def _seen(connection: Connection, text: str) -> ComputationGraph:
    async for graph in connection.changes():
        if text in str(graph):
            return graph
    raise AssertionError


def test_a_message_that_a_peer_has_not_received_is_not_confirmed() -> None:
    """A suspended peer confirms nothing; when it continues, it confirms what it has missed."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            publication = await connection.advertise("/cmd_vel", "geometry_msgs/Twist")
            await _soon(_matched(publication))
            peer.send_signal(signal.SIGSTOP)
            try:
                await publication.publish({"linear": {"x": 0.5}})
                assert not publication.confirmed
            finally:
                peer.send_signal(signal.SIGCONT)
            async with asyncio.timeout(patient(10)):
                while not publication.confirmed:  # noqa: ASYNC110 - a middleware does not report it
                    await asyncio.sleep(0.01)

    asyncio.run(scene())


def test_the_graph_is_that_of_the_peer() -> None:
    """Nodes, topics, services and actions have names and types; actions are folded; QoS mismatches are reported."""

    async def scene() -> None:
        async with _beside() as (connection, _):
            graph = await _soon(connection.graph())
            assert graph.complete
            assert [node.name for node in graph.nodes] == ["/robot/base", "/tester"]
            ends = {(end.node, end.role, end.name, end.type) for end in graph.ends}
            assert ends == {
                ("/robot/base", Role.PUBLISHES, "/chatter", "std_msgs/String"),
                ("/robot/base", Role.PUBLISHES, "/echo", "geometry_msgs/Twist"),
                ("/robot/base", Role.PUBLISHES, "/scan", "geometry_msgs/Vector3"),
                ("/robot/base", Role.PUBLISHES, "/unheard", "unheard_msgs/Whole"),
                ("/robot/base", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
                ("/robot/base", Role.SERVICES, "/add_two_ints", "example_interfaces/AddTwoInts"),
                ("/robot/base", Role.ACTION_SERVERS, "/count", "kg_test/Count"),
                ("/tester", Role.SUBSCRIBES, "/scan", "geometry_msgs/Vector3"),
                ("/tester", Role.CLIENTS, "/double", "kg_test/Double"),
                ("/tester", Role.PUBLISHES, "/told", "std_msgs/String"),
            }
            qos = {(end.role, end.name): end.qos.reliability for end in graph.ends if end.qos}
            assert qos[Role.PUBLISHES, "/scan"] == "best_effort"
            assert qos[Role.SUBSCRIBES, "/scan"] == "reliable"
            (problem,) = graph.problems
            assert (problem.code, problem.subject) == ("KG815", "/scan")

    asyncio.run(scene())


def test_messages_go_both_ways() -> None:
    """The peer and our node read each other's messages, even if the peer offers only best effort."""

    async def scene() -> None:
        async with _beside() as (connection, _):
            assert await _soon(_next(connection, "/chatter")) == {"data": "hello"}
            assert await _soon(_next(connection, "/scan")) == {"x": 1.0, "y": 2.0, "z": 3.0}
            answers = await connection.subscribe("/echo", "geometry_msgs/Twist")
            commands = await connection.advertise("/cmd_vel", "geometry_msgs/Twist")
            await _soon(_matched(commands))
            sent = {"linear": {"x": 0.5, "y": 0.0, "z": -1.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.25}}
            await commands.publish(sent)
            came = await _soon(anext(aiter(answers)))
            assert came.value == sent
            assert came.node == "/robot/base"

    asyncio.run(scene())


def test_services_go_both_ways() -> None:
    """Our node and the peer call each other's services, with the header of rmw_cyclonedds_cpp."""

    async def double(request: Value) -> Value:
        return {"value": 2 * request["value"], "remark": "twice"}

    async def scene() -> None:
        async with _beside() as (connection, _):
            request = {"a": 2, "b": 40}
            assert await connection.call("/add_two_ints", None, request, seconds=patient(5)) == {"sum": 42}
            await connection.serve("/double", "kg_test/Double", double)
            assert await _soon(_next(connection, "/told")) == {"data": "77 5 42.0 twice"}

    asyncio.run(scene())


def test_an_action_of_the_peer_is_carried_out() -> None:
    """The peer accepts a goal, sends feedback, and gives the result; or it rejects the goal (KG809)."""

    async def scene() -> None:
        async with _beside() as (connection, _):
            goal = await connection.send_goal("/count", "kg_test/Count", {"until": 3}, seconds=patient(5))
            assert await _soon(goal.result()) == {"reached": 3}
            assert [told async for told in goal.feedback()] == [{"now": 1}, {"now": 2}, {"now": 3}]
            with pytest.raises(RobotError) as rejected:
                await connection.send_goal("/count", "kg_test/Count", {"until": -1}, seconds=patient(5))
            assert rejected.value.code == "KG809"

    asyncio.run(scene())


def test_a_type_that_is_not_known_is_asked_for() -> None:
    """With `types=peers`, an unknown type is fetched from a peer that provides type information."""

    async def scene() -> None:
        async with _beside("&types=peers") as (connection, _):
            came = await _soon(_next(connection, "/unheard"))
            assert came == {"parts": [{"x": 0.5, "name": "half"}], "three": [1, 2, 3], "fine": True}
            with pytest.raises(RobotError) as unknown:
                await connection.subscribe("/nobody", "nowhere_msgs/Thing")
            assert unknown.value.code == "KG804"
            assert unknown.value.hint is not None
            assert "workspace that has the package `nowhere_msgs`" in unknown.value.hint

    asyncio.run(scene())


def test_types_are_compared_by_their_names() -> None:
    """A publisher with the same type name matches, whatever its fields; no description is requested.

    Cyclone DDS before 11 crashes when it receives the response, even for a request of another participant.
    """

    async def scene() -> None:
        async with _beside() as (connection, _):
            wire: Any = connection.wire  # type: ignore[attr-defined]  # by DDS
            assert not await wire.learn("unheard_msgs/Whole", "/unheard")
            connection.types.define("unheard_msgs/Whole", "int32 other\n")
            await _soon(wire.reader("/unheard", "unheard_msgs/Whole", OFFERED, lambda *_: None).ready())

    asyncio.run(scene())


def test_a_name_that_is_none_is_reported() -> None:
    """An invalidly named node is ignored and reported; its ends then belong to an unnamed participant."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            await _soon(connection.graph())
            assert peer.stdin is not None
            print("/robot ba//se", file=peer.stdin, flush=True)
            graph = await _soon(_seen(connection, "KG816"))
            assert "/robot/base" not in {node.name for node in graph.nodes}
            nameless = [node for node in graph.nodes if node.problem]
            assert nameless
            assert nameless[0].name.startswith("/_participant_")

    asyncio.run(scene())


def test_a_robot_that_goes_is_noticed() -> None:
    """A participant that leaves takes its nodes with it; after the last one the robot is lost."""

    async def scene() -> None:
        async with _beside() as (connection, peer):
            await _soon(connection.graph())
            assert peer.stdin is not None
            peer.stdin.close()
            assert "left" in await asyncio.wait_for(connection.wait_lost(), patient(30))
            assert (await connection.graph()).nodes == ()

    asyncio.run(scene())
