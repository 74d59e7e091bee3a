"""The behaviour of every `Connection`: a suite run by the tests of each middleware.

Create a subclass of `Behaviour` in your test module with a fixture `system` that returns a `System`:

    class TestMyConnection(Behaviour):
        @pytest.fixture
        def system(self) -> System:
            return System(ros=1, join=lambda name: connect(f"ros1://127.0.0.1:{port}", name, types_for_tests(1)))

`join` creates another node of the same system each time that it is awaited. `seconds` is the time limit for the graph,
or a message, to arrive; `confirms` is whether publications report that subscribers confirmed their messages. For
unsupported features, override the test with the reason.
"""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any
from uuid import uuid4

import pytest
from patience import patient

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.messages import Types

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.connection import Accepted, ComputationGraph, Connection, Publication, Received, Subscription, Value

__all__ = ["Behaviour", "System", "types_for_tests"]

_DEFINITIONS = {
    "kg_test/Double_Request": "float64 value",
    "kg_test/Double_Response": "float64 value\nstring remark",
    "kg_test/Count_Goal": "int32 until",
    "kg_test/Count_Result": "int32 reached",
    "kg_test/Count_Feedback": "int32 now",
}


def types_for_tests(ros: int) -> Types:
    """Return types with the service `kg_test/Double` and the action `kg_test/Count`."""
    types = Types(ros)
    for name, text in _DEFINITIONS.items():
        types.define(name, text)
    return types


@dataclass
class System:
    """A system under test: how to join it as a node, its time limit, and whether subscribers confirm messages."""

    ros: int
    join: Callable[[str], Awaitable[Connection]]
    seconds: float = 2.0
    confirms: bool = True

    async def soon(self, what: Awaitable[Any]) -> Any:
        """Return the awaited result, or fail at the time limit."""
        return await asyncio.wait_for(what, patient(self.seconds))

    async def until(self, true: Callable[[], bool]) -> None:
        """Return when a condition holds."""

        async def wait() -> None:
            while not true():  # noqa: ASYNC110 - a middleware tells nobody how many peers it has
                await asyncio.sleep(0.01)

        await self.soon(wait())

    @asynccontextmanager
    async def pair(self) -> AsyncIterator[tuple[Connection, Connection]]:
        """Yield two nodes, `/one` and `/two`."""
        one, two = await self.join("/one"), await self.join("/two")
        try:
            yield one, two
        finally:
            await one.aclose()
            await two.aclose()

    async def topic(self, one: Connection, two: Connection, kind: str) -> tuple[Publication, Subscription]:
        """Return a topic from one node to the other, connected."""
        publication = await one.advertise("/topic", kind)
        subscription = await two.subscribe("/topic", kind)
        await self.until(lambda: publication.peers > 0)
        return publication, subscription

    async def seen(self, watcher: Connection, true: Callable[[ComputationGraph], bool]) -> ComputationGraph:
        """Return the first graph that satisfies a condition."""

        async def wait() -> ComputationGraph:
            async for graph in watcher.changes():
                if true(graph):
                    return graph
            raise AssertionError

        found: ComputationGraph = await self.soon(wait())
        return found


def _ends(graph: ComputationGraph, name: str) -> list[tuple[str, Role, str | None]]:
    return [(one.node, one.role, one.type) for one in graph.ends if one.name == name]


async def _first(subscription: Subscription, number: int) -> list[Received]:
    found = []
    async for one in subscription:
        found.append(one)
        if len(found) == number:
            break
    return found


class Behaviour:
    """The behaviour of any connection; see the docstring of the module."""

    @pytest.fixture
    def system(self) -> System:
        """Return the system under test; each middleware has its own."""
        raise NotImplementedError

    def test_it_says_who_and_where_it_is(self, system: System) -> None:
        """A connection has its node's absolute name, its address, the version of ROS and the time."""

        async def scene() -> None:
            async with system.pair() as (one, _):
                assert one.name == "/one"
                assert "://" in one.address
                assert one.ros == system.ros == one.types.ros
                before = one.clock.now()
                assert one.clock.now() >= before

        asyncio.run(scene())

    def test_messages_arrive_in_order(self, system: System) -> None:
        """Published messages arrive complete, in order, with the time and the sender or None."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication, subscription = await system.topic(one, two, "geometry_msgs/Twist")
                for speed in range(5):
                    await publication.publish({"linear": {"x": float(speed)}})
                came = await system.soon(_first(subscription, 5))
                assert [each.value["linear"]["x"] for each in came] == [0.0, 1.0, 2.0, 3.0, 4.0]
                assert came[0].value["angular"] == {"x": 0.0, "y": 0.0, "z": 0.0}
                assert {each.node for each in came} <= {"/one", None}
                assert [each.at for each in came] == sorted(each.at for each in came)

        asyncio.run(scene())

    def test_bytes_and_nested_lists_arrive(self, system: System) -> None:
        """Arrays of bytes are bytes; lists of messages are lists of dicts."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication, subscription = await system.topic(one, two, "sensor_msgs/PointCloud2")
                value = {"data": b"\x00\x01\xff", "fields": [{"name": "x"}, {"name": "y"}], "width": 3}
                await publication.publish(value)
                (came,) = await system.soon(_first(subscription, 1))
                assert came.value["data"] == b"\x00\x01\xff"
                assert [each["name"] for each in came.value["fields"]] == ["x", "y"]
                assert came.value["width"] == 3

        asyncio.run(scene())

    def test_a_misfit_is_refused_before_it_is_sent(self, system: System) -> None:
        """A value of the wrong type, or an unknown field, is KG805."""

        async def scene() -> None:
            async with system.pair() as (one, _):
                publication = await one.advertise("/topic", "geometry_msgs/Twist")
                for value in ({"linear": {"x": "fast"}}, {"speed": 1.0}, {"linear": 3}):
                    with pytest.raises(RobotError) as refused:
                        await publication.publish(value)
                    assert refused.value.code == "KG805"

        asyncio.run(scene())

    def test_the_oldest_are_dropped_and_counted(self, system: System) -> None:
        """When the queue is full, the oldest messages are dropped and counted."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication = await one.advertise("/topic", "std_msgs/Int32")
                subscription = await two.subscribe("/topic", "std_msgs/Int32", queue=3)
                await system.until(lambda: publication.peers > 0)
                for number in range(8):
                    await publication.publish({"data": number})
                await system.until(lambda: subscription.dropped == 5)
                came = await system.soon(_first(subscription, 3))
                assert [each.value["data"] for each in came] == [5, 6, 7]

        asyncio.run(scene())

    def test_the_type_of_a_topic_is_asked_for(self, system: System) -> None:
        """A subscription without a type takes that of the topic; without one it is KG804."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication = await one.advertise("/topic", "std_msgs/String")
                await system.seen(two, lambda graph: bool(_ends(graph, "/topic")))
                subscription = await two.subscribe("/topic")
                await system.until(lambda: publication.peers > 0)
                await publication.publish({"data": "hello"})
                (came,) = await system.soon(_first(subscription, 1))
                assert came.value == {"data": "hello"}
                with pytest.raises(RobotError) as unknown:
                    await system.soon(two.subscribe("/nobody"))
                assert unknown.value.code == "KG804"

        asyncio.run(scene())

    def test_received_messages_are_confirmed(self, system: System) -> None:
        """A connection that can tell reports when all subscribers have confirmed all messages; others never do."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication, subscription = await system.topic(one, two, "std_msgs/String")
                await publication.publish({"data": "stop"})
                assert len(await system.soon(_first(subscription, 1))) == 1
                if system.confirms:
                    await system.until(lambda: publication.confirmed)
                else:
                    assert not publication.confirmed

        asyncio.run(scene())

    def test_a_latched_message_is_kept(self, system: System) -> None:
        """A late subscriber receives the last latched message, and only that one."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication = await one.advertise("/topic", "std_msgs/String", latch=True)
                await publication.publish({"data": "old"})
                await publication.publish({"data": "map"})
                subscription = await two.subscribe("/topic", "std_msgs/String")
                (came,) = await system.soon(_first(subscription, 1))
                assert came.value == {"data": "map"}

        asyncio.run(scene())

    def test_a_closed_subscription_ends(self, system: System) -> None:
        """The iteration over a subscription ends when it is closed, and the publisher has one peer less."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                publication, subscription = await system.topic(one, two, "std_msgs/Empty")
                reading = asyncio.ensure_future(_first(subscription, 100))
                await asyncio.sleep(0.05)
                await subscription.aclose()
                assert await system.soon(reading) == []
                await system.until(lambda: publication.peers == 0)

        asyncio.run(scene())

    def test_the_graph_shows_others_ends(self, system: System) -> None:
        """The graph has the topics, services and actions of other nodes, with types, and not our own node."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.advertise("/speed", "geometry_msgs/Twist")
                await one.subscribe("/scan", "sensor_msgs/LaserScan")
                await one.serve("/double", "kg_test/Double", _double)
                await one.serve_action("/count", "kg_test/Count", _count)
                names = {"/speed", "/scan", "/double", "/count"}
                graph = await system.seen(two, lambda graph: names <= {each.name for each in graph.ends})
                assert "/one" in {each.name for each in graph.nodes}
                assert "/two" not in {each.name for each in graph.nodes}
                assert ("/one", Role.PUBLISHES, "geometry_msgs/Twist") in _ends(graph, "/speed")
                assert ("/one", Role.SUBSCRIBES, "sensor_msgs/LaserScan") in _ends(graph, "/scan")
                assert ("/one", Role.SERVICES, "kg_test/Double") in _ends(graph, "/double")
                assert ("/one", Role.ACTION_SERVERS, "kg_test/Count") in _ends(graph, "/count")
                assert not [each for each in graph.ends if each.name.startswith("/count/")]
                assert (await two.graph()).ros == system.ros

        asyncio.run(scene())

    def test_changes_follow_the_graph(self, system: System) -> None:
        """Watchers see nodes join and leave."""

        async def scene() -> None:
            async with system.pair() as (one, _):
                three = await system.join("/three")
                await system.seen(one, lambda graph: "/three" in {each.name for each in graph.nodes})
                await three.aclose()
                await system.seen(one, lambda graph: "/three" not in {each.name for each in graph.nodes})

        asyncio.run(scene())

    def test_a_service_answers(self, system: System) -> None:
        """A call returns the response; a failure is KG808 with its message; without a server it is KG807."""

        async def scene() -> None:
            async with system.pair() as (_, two):
                three = await system.join("/three")
                await three.serve("/double", "kg_test/Double", _double)
                await system.seen(two, lambda graph: bool(_ends(graph, "/double")))
                call = two.call("/double", "kg_test/Double", {"value": 2.0}, seconds=patient(system.seconds))
                assert await call == {"value": 4.0, "remark": "twice"}
                with pytest.raises(RobotError) as failed:
                    await two.call("/double", "kg_test/Double", {"value": -1.0}, seconds=patient(system.seconds))
                assert failed.value.code == "KG808"
                assert "negative" in failed.value.message
                await three.aclose()
                await system.seen(two, lambda graph: not _ends(graph, "/double"))
                with pytest.raises(RobotError) as nobody:
                    await two.call("/double", "kg_test/Double", {"value": 1.0}, seconds=patient(system.seconds))
                assert nobody.value.code == "KG807"

        asyncio.run(scene())

    def test_a_slow_service_is_not_waited_for(self, system: System) -> None:
        """A call that exceeds its time limit is KG803."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve("/double", "kg_test/Double", _never)
                await system.seen(two, lambda graph: bool(_ends(graph, "/double")))
                with pytest.raises(RobotError) as late:
                    await system.soon(two.call("/double", "kg_test/Double", {}, seconds=0.3))
                assert late.value.code == "KG803"

        asyncio.run(scene())

    def test_a_goal_is_carried_out(self, system: System) -> None:
        """A goal gives feedback during its execution, and a result."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve_action("/count", "kg_test/Count", _count)
                goal = await two.send_goal("/count", "kg_test/Count", {"until": 3}, seconds=patient(system.seconds))
                told = await system.soon(_all(goal.feedback()))
                assert told == [{"now": 1}, {"now": 2}, {"now": 3}]
                assert await system.soon(goal.result()) == {"reached": 3}

        asyncio.run(scene())

    def test_a_goal_is_cancelled(self, system: System) -> None:
        """A cancelled goal ends with KG809, and the server receives the cancellation."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve_action("/count", "kg_test/Count", _count)
                goal = await two.send_goal("/count", "kg_test/Count", {"until": 10**6}, seconds=patient(system.seconds))
                await system.soon(anext(aiter(goal.feedback())))
                await goal.cancel()
                with pytest.raises(RobotError) as ended:
                    await system.soon(goal.result())
                assert ended.value.code == "KG809"

        asyncio.run(scene())

    def test_another_node_cancels_a_goal(self, system: System) -> None:
        """Another node cancels a goal by its identity; a goal of another identity continues."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                other = await system.join("/other")
                await one.serve_action("/count", "kg_test/Count", _count)
                identity = uuid4().hex
                goal = await two.send_goal(
                    "/count", "kg_test/Count", {"until": 10**6}, seconds=patient(system.seconds), identity=identity
                )
                cancel = await other.canceller("/count")
                await system.soon(cancel(uuid4().hex))
                await system.soon(anext(aiter(goal.feedback())))
                await system.soon(cancel(identity))
                with pytest.raises(RobotError) as ended:
                    await system.soon(goal.result())
                assert ended.value.code == "KG809"
                await other.aclose()

        asyncio.run(scene())

    def test_a_newer_goal_takes_over(self, system: System) -> None:
        """A second goal cancels the first; both clients receive their results."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve_action("/count", "kg_test/Count", _count)
                first = await two.send_goal("/count", "kg_test/Count", {"until": 10**6}, seconds=patient(2))
                await system.soon(anext(aiter(first.feedback())))
                second = await two.send_goal("/count", "kg_test/Count", {"until": 2}, seconds=patient(2))
                with pytest.raises(RobotError) as ended:
                    await system.soon(first.result())
                assert ended.value.code == "KG809"
                assert await system.soon(second.result()) == {"reached": 2}

        asyncio.run(scene())

    def test_a_goal_that_cannot_be_reached_is_aborted(self, system: System) -> None:
        """A goal aborted by the server is KG809."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve_action("/count", "kg_test/Count", _count)
                goal = await two.send_goal("/count", "kg_test/Count", {"until": -1}, seconds=patient(system.seconds))
                with pytest.raises(RobotError) as ended:
                    await system.soon(goal.result())
                assert ended.value.code == "KG809"

        asyncio.run(scene())

    def test_a_goal_is_lost_with_its_server(self, system: System) -> None:
        """A goal whose server leaves before the result is KG803."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.serve_action("/count", "kg_test/Count", _count)
                goal = await two.send_goal("/count", "kg_test/Count", {"until": 10**6}, seconds=patient(system.seconds))
                await system.soon(anext(aiter(goal.feedback())))
                await one.aclose()
                with pytest.raises(RobotError) as lost:
                    await asyncio.wait_for(goal.result(), patient(15))
                assert lost.value.code == "KG803"

        asyncio.run(scene())

    def test_nobody_carries_out_a_goal(self, system: System) -> None:
        """A goal for an action without a server is KG807 after its time limit."""

        async def scene() -> None:
            async with system.pair() as (_, two):
                with pytest.raises(RobotError) as nobody:
                    await system.soon(two.send_goal("/nobody", "kg_test/Count", {"until": 1}, seconds=0.3))
                assert nobody.value.code == "KG807"

        asyncio.run(scene())

    def test_closing_leaves_nothing(self, system: System) -> None:
        """After closing, the node is gone from the graph, its subscriptions have ended, and closing again is fine."""

        async def scene() -> None:
            async with system.pair() as (one, two):
                await one.advertise("/speed", "geometry_msgs/Twist")
                subscription = await one.subscribe("/scan", "sensor_msgs/LaserScan")
                reading = asyncio.ensure_future(_first(subscription, 1))
                await system.seen(two, lambda graph: bool(_ends(graph, "/speed")))
                await one.aclose()
                assert await system.soon(reading) == []
                await system.seen(two, lambda graph: not _ends(graph, "/speed") and not _ends(graph, "/scan"))
                await one.aclose()

        asyncio.run(scene())


async def _double(request: Value) -> Value:
    if request["value"] < 0:
        raise ValueError("negative")
    return {"value": 2 * request["value"], "remark": "twice"}


async def _never(request: Value) -> Value:
    await asyncio.Event().wait()
    return request


async def _count(accepted: Accepted) -> Value:
    now = 0
    if accepted.goal["until"] < 0:
        accepted.abort("it is below zero")
    while now < accepted.goal["until"] and not accepted.cancelled:
        now += 1
        await accepted.feedback({"now": now})
        await asyncio.sleep(0.01)
    return {"reached": now}


async def _all(values: AsyncIterator[Value]) -> list[Value]:
    return [one async for one in values]
