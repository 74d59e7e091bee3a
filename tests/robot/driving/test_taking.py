"""When the capabilities of a robot change, a driver continues all work except that on removed ones."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import msgspec
import pytest
from patience import patient
from robot.driving.rover import CAPABILITIES, COUNTING, DRIVING, WHERE, rover, until

from kg.errors import RobotError
from kg.robot.capability import Capabilities

if TYPE_CHECKING:
    from kg.robot.connection import ComputationGraph, Subscription

MORE = Capabilities(of="the rover", capabilities=(*CAPABILITIES.capabilities, msgspec.structs.replace(WHERE, iri="#w")))


def without(*names: str) -> Capabilities:
    """Return the capabilities of the rover without some of them."""
    return Capabilities(
        of="the rover", capabilities=tuple(one for one in CAPABILITIES.capabilities if one.name not in names)
    )


def where(x: float) -> dict[str, object]:
    """Return the odometry of the rover."""
    return {"pose": {"pose": {"position": {"x": x}, "orientation": {"w": 1.0}}}}


def test_what_is_there_still_goes_on() -> None:
    """A movement, a goal and a reading continue when other capabilities come and go, without a zero command."""

    async def scene() -> None:
        async with rover() as robot:
            driver = robot.driver
            moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}))
            counting = asyncio.ensure_future(driver.do("counting", {"until": 30}))
            values = driver.read("sensingPose")
            reading = asyncio.ensure_future(anext(values))
            await robot.tell("/odom", "nav_msgs/Odometry", where(0.5))
            await until(lambda: robot.speeds() and robot.goals and robot.publications["/odom"].peers)
            for capabilities in (MORE, without("saying", "doubling", "laserScanning")):
                await driver.take(capabilities)
            await robot.tell("/odom", "nav_msgs/Odometry", where(1.5))
            assert (await reading)["x"] == 1.5
            assert (await counting).ended == "done"
            assert not moving.done()
            assert set(robot.speeds()) == {0.5}
            await driver.stop()
            assert (await moving).ended == "stopped"
            await values.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize("gone", [DRIVING, COUNTING])
def test_what_is_there_no_more_ends(gone: object) -> None:
    """A movement gets its zero command and a goal is cancelled before KG822 reports the removed capability."""
    name = getattr(gone, "name", "")

    async def scene() -> None:
        async with rover() as robot:
            moving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}))
            counting = asyncio.ensure_future(robot.driver.do("counting", {"until": 10**6}))
            await until(lambda: robot.speeds() and robot.goals)
            await robot.driver.take(without(name))
            ended, other = (moving, counting) if gone is DRIVING else (counting, moving)
            with pytest.raises(RobotError) as error:
                await ended
            assert (error.value.code, other.done()) == ("KG822", False)
            assert f"no node of the robot provides `{name}`" in error.value.message
            if gone is DRIVING:
                await until(lambda: robot.speeds()[-1] == 0)
            else:
                await until(lambda: robot.cancelled)
            with pytest.raises(RobotError) as error:
                await robot.driver.do(name)
            assert error.value.code == "KG821"
            await robot.driver.stop()
            await other

    asyncio.run(scene())


def test_what_is_read_no_more_ends_and_is_not_old_when_it_is_back() -> None:
    """A reading ends with KG822, even if it waits for its first value; after its return, old values are discarded."""

    async def scene() -> None:
        async with rover() as robot:
            driver = robot.driver
            values = driver.read("sensingPose")
            reading = asyncio.ensure_future(anext(values))
            waiting = asyncio.ensure_future(driver.latest("laserScanning"))
            first = asyncio.ensure_future(driver.latest("sensingPose"))
            await until(lambda: "/odom" in robot.bus.topics and len(robot.bus.topics["/odom"].subscriptions) == 2)
            await robot.tell("/odom", "nav_msgs/Odometry", where(0.5))
            assert [(await one)["x"] for one in (reading, first)] == [0.5, 0.5]
            again = asyncio.ensure_future(anext(values))
            await driver.take(without("sensingPose", "laserScanning"))
            for task in (again, waiting):
                with pytest.raises(RobotError) as error:
                    await task
                assert (error.value.code, "reports" in error.value.message) == ("KG822", True)
            await driver.take(CAPABILITIES)
            with pytest.raises(RobotError) as error:
                await driver.latest("sensingPose", seconds=0.05)
            assert error.value.code == "KG825"

    asyncio.run(scene())


def test_what_is_begun_while_others_are_taken_is_not_there_either() -> None:
    """Work started at the moment of the removal gets the same error, and nothing is sent."""

    async def scene() -> None:
        async with rover() as robot:
            driver, going = robot.driver, asyncio.Event()
            graph, subscribe = driver.connection.graph, driver.connection.subscribe

            async def late_graph() -> ComputationGraph:
                await going.wait()
                return await graph()

            async def late_subscribe(*asked: Any, **options: Any) -> Subscription:
                await going.wait()
                return await subscribe(*asked, **options)

            with pytest.MonkeyPatch.context() as patched:
                patched.setattr(driver.connection, "graph", late_graph)
                patched.setattr(driver.connection, "subscribe", late_subscribe)
                moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}))
                reading = asyncio.ensure_future(anext(driver.read("sensingPose")))
                await asyncio.sleep(0)
                await driver.take(without(DRIVING.name, WHERE.name))
                going.set()
                found = await asyncio.wait_for(asyncio.gather(moving, reading, return_exceptions=True), patient(5))
            assert [getattr(one, "code", one) for one in found] == ["KG821", "KG822"]
            assert not robot.speeds()

    asyncio.run(scene())
