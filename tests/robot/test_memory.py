from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING
from uuid import uuid4

import pytest
from robot.connections import Behaviour, System, types_for_tests

from kg.errors import RobotError
from kg.robot.clock import SimulatedClock, within
from kg.robot.connecting import connect
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.connection import Connection


@pytest.fixture
def bus() -> Iterator[Bus]:
    """Yield a bus with a unique name."""
    with Bus(uuid4().hex, types=types_for_tests(1)) as made:
        yield made


@pytest.mark.parametrize("ros", [1, 2])
class TestMemory(Behaviour):
    """A connection in memory passes the suite of every connection."""

    @pytest.fixture
    def system(self, ros: int) -> Iterator[System]:
        """Yield a bus of one version of ROS."""
        with Bus(uuid4().hex, ros=ros, types=types_for_tests(ros)) as made:

            async def join(name: str) -> Connection:
                return await connect(made.address, name=name)

            yield System(ros, join)


def test_no_robot_of_that_name() -> None:
    """An address without a bus in this process is KG802."""
    with pytest.raises(RobotError) as nobody:
        asyncio.run(connect("memory://nowhere"))
    assert nobody.value.code == "KG802"


def test_a_name_is_taken_once(bus: Bus) -> None:
    """A second bus of the same name is rejected; closing the first releases the name."""
    with pytest.raises(RobotError) as taken:
        Bus(bus.name)
    assert taken.value.code == "KG801"
    bus.close()
    Bus(bus.name).close()


def test_a_node_of_the_same_name_throws_the_first_out(bus: Bus) -> None:
    """As in ROS 1, the first node is disconnected."""

    async def scene() -> None:
        first = bus.join("/one")
        bus.join("one")
        assert "same name" in await first.wait_lost()

    asyncio.run(scene())


def test_a_lost_node_knows_it(bus: Bus) -> None:
    """The open ends of a lost node end; its calls are KG803 (the graph KG802); others see it leave."""

    async def scene() -> None:
        one, two = bus.join("/one"), bus.join("/two")
        publication = await one.advertise("/topic", "std_msgs/Empty")
        subscription = await one.subscribe("/other", "std_msgs/Empty")
        lost = asyncio.ensure_future(one.wait_lost())
        await asyncio.sleep(0)
        bus.cut("/one", "the cable was pulled")
        assert await lost == await one.wait_lost() == "the cable was pulled"
        assert [each async for each in subscription] == []
        assert [each async for each in one.changes()] == []
        for sent in (
            publication.publish({}),
            one.call("/x", None, {}, seconds=1),
            one.advertise("/a", "std_msgs/Int8"),
        ):
            with pytest.raises(RobotError) as failed:
                await sent
            assert failed.value.code == "KG803"
        with pytest.raises(RobotError) as failed:
            await one.graph()
        assert failed.value.code == "KG802"
        assert (await two.graph()).nodes == ()

    asyncio.run(scene())


def test_who_waits_for_a_lost_server_learns_it(bus: Bus) -> None:
    """Calls and goals end with KG803 when the answering node is lost."""

    async def scene() -> None:
        one, two = bus.join("/one"), bus.join("/two")

        async def forever(_: object) -> dict[str, object]:
            await asyncio.Event().wait()
            return {}

        await one.serve("/double", "kg_test/Double", forever)
        await one.serve_action("/count", "kg_test/Count", forever)
        call = asyncio.ensure_future(two.call("/double", None, {}, seconds=60))
        goal = await two.send_goal("/count", "kg_test/Count", {}, seconds=60)
        await asyncio.sleep(0.01)
        bus.cut("/one", "it crashed")
        for waiting in (call, goal.result()):
            with pytest.raises(RobotError) as failed:
                await waiting
            assert failed.value.code == "KG803"
        assert "the robot may still be moving" in failed.value.message
        assert [each async for each in goal.feedback()] == []

    asyncio.run(scene())


def test_types_that_differ_are_refused(bus: Bus) -> None:
    """A topic, service or action has one type; another is KG806."""

    async def scene() -> None:
        one = bus.join("/one")
        await one.advertise("/topic", "std_msgs/Empty")
        with pytest.raises(RobotError) as differ:
            await one.subscribe("/topic", "std_msgs/String")
        assert differ.value.code == "KG806"

    asyncio.run(scene())


def test_types_are_learned_from_the_publisher(bus: Bus) -> None:
    """A node with its own types learns an unknown one from its publisher."""

    async def scene() -> None:
        bus.types.define("kg_test/Odd", "float32 oddity")
        one, two = bus.join("/one"), bus.join("/two", types_for_tests(1))
        publication = await one.advertise("/topic", "kg_test/Odd")
        subscription = await two.subscribe("/topic")
        await publication.publish({"oddity": 0.5})
        assert (await anext(aiter(subscription))).value == {"oddity": 0.5}
        with pytest.raises(RobotError) as unknown:
            await two.advertise("/other", "kg_test/Even")
        assert unknown.value.code == "KG804"

    asyncio.run(scene())


def test_receivers_do_not_share_a_value(bus: Bus) -> None:
    """A change by one subscriber to a value is invisible to others."""

    async def scene() -> None:
        one = bus.join("/one")
        first, second = [await one.subscribe("/topic", "geometry_msgs/Twist") for _ in range(2)]
        await (await one.advertise("/topic", "geometry_msgs/Twist")).publish({})
        (await anext(aiter(first))).value["linear"]["x"] = 9
        assert (await anext(aiter(second))).value["linear"]["x"] == 0

    asyncio.run(scene())


def test_all_share_the_clock() -> None:
    """Time is set by the simulation: deadlines and receive times follow it."""

    async def scene() -> None:
        clock = SimulatedClock()
        with Bus(uuid4().hex, clock=clock) as bus:
            one = bus.join("/one")
            subscription = await one.subscribe("/topic", "std_msgs/Empty")
            clock.set_time(7.5)
            await (await one.advertise("/topic", "std_msgs/Empty")).publish({})
            assert (await anext(aiter(subscription))).at == 7.5
            waiting = asyncio.ensure_future(within(one.clock, 100, asyncio.Event().wait()))
            await asyncio.sleep(0.01)
            assert not waiting.done()
            clock.set_time(108)
            with pytest.raises(TimeoutError):
                await waiting

    asyncio.run(scene())
