from __future__ import annotations

import asyncio
import math
from typing import Any

import pytest
from patience import patient
from robot.driving.rover import rover, until

from kg.errors import RobotError
from kg.robot.clock import SimulatedClock

SCAN = {"ranges": [2.0, 0.5, math.nan], "angle_increment": math.pi / 2, "range_max": 10.0}


def odometry(x: float) -> dict[str, Any]:
    """Return the odometry of the rover."""
    return {"pose": {"pose": {"position": {"x": x}, "orientation": {"w": 1.0}}}}


def test_values_come_by_parameter() -> None:
    """Values are the parameters of the capability, of each message in order."""

    async def scene() -> None:
        async with rover() as robot:
            values = robot.driver.read("sensingPose")
            first = asyncio.ensure_future(anext(values))
            await robot.tell("/odom", "nav_msgs/Odometry", odometry(0.5))
            await until(lambda: robot.publications["/odom"].peers)
            await robot.tell("/odom", "nav_msgs/Odometry", odometry(1.5))
            assert await first == {"x": 1.5, "heading": 0.0}
            await robot.tell("/odom", "nav_msgs/Odometry", odometry(2.5))
            assert await anext(values) == {"x": 2.5, "heading": 0.0}
            await values.aclose()
            await until(lambda: not robot.publications["/odom"].peers)

    asyncio.run(scene())


def test_what_a_message_does_not_say_is_none() -> None:
    """NaN is None, a free reading is infinite, invalid readings are skipped."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.tell("/scan", "sensor_msgs/LaserScan", {})
            newest = asyncio.ensure_future(robot.driver.latest("laserScanning"))
            await until(lambda: robot.publications["/scan"].peers)
            await robot.tell("/scan", "sensor_msgs/LaserScan", SCAN)
            assert await newest == {"nearest": 0.5, "ahead": 2.0}
            for ranges, ahead in (([math.nan], None), ([math.inf], math.inf), ([], None)):
                await robot.tell("/scan", "sensor_msgs/LaserScan", {**SCAN, "ranges": ranges})
                async with asyncio.timeout(patient(5)):
                    while (await robot.driver.latest("laserScanning"))["ahead"] != ahead:  # noqa: ASYNC110 - no event
                        await asyncio.sleep(0.01)

    asyncio.run(scene())


def test_the_newest_value_is_kept() -> None:
    """`latest` waits for the first message, then returns the newest at once, with one subscription for all callers."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.tell("/odom", "nav_msgs/Odometry", odometry(0))
            both = asyncio.gather(robot.driver.latest("sensingPose"), robot.driver.latest("sensing where it is"))
            await until(lambda: robot.publications["/odom"].peers)
            for x in range(5):
                await robot.tell("/odom", "nav_msgs/Odometry", odometry(x))
            await both
            assert (await robot.driver.latest("sensingPose"))["x"] == 4
            assert robot.publications["/odom"].peers == 1

    asyncio.run(scene())


def test_nothing_comes() -> None:
    """A reading without a value in time is KG825."""

    async def scene() -> None:
        async with rover() as robot:
            with pytest.raises(RobotError) as late:
                await robot.driver.latest("sensingPose", seconds=0.05)
            assert late.value.code == "KG825"

    asyncio.run(scene())


def test_no_more_than_asked_for() -> None:
    """With a rate, values too soon after the last one are skipped, by the robot's clock."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock) as robot:

            async def read() -> list[float]:
                return [value["x"] async for value in robot.driver.read("sensingPose", rate=10)]

            reading = asyncio.ensure_future(read())
            await robot.tell("/odom", "nav_msgs/Odometry", odometry(0))
            await until(lambda: robot.publications["/odom"].peers)
            for tick in range(101):
                clock.set_time(tick / 100)
                await robot.tell("/odom", "nav_msgs/Odometry", odometry(tick))
            await robot.driver._close()
            found = await reading
            assert found[0] == 0
            assert len(found) == 11

    asyncio.run(scene())


def test_a_service_is_read() -> None:
    """A value available only by service is requested once, or at the rate."""

    async def scene() -> None:
        async with rover() as robot:
            assert [one async for one in robot.driver.read("measuring")] == [{"remark": "twice"}]
            assert await robot.driver.latest("measuring") == {"remark": "twice"}
            several = robot.driver.read("measuring", rate=1000)
            assert [await anext(several) for _ in range(3)] == 3 * [{"remark": "twice"}]
            await several.aclose()

    asyncio.run(scene())


def test_a_lost_robot_is_told() -> None:
    """When the robot is lost, readers get KG803 with the reason, and so do later callers."""

    async def scene() -> None:
        async with rover() as robot:
            values = robot.driver.read("sensingPose")
            first = asyncio.ensure_future(anext(values))
            newest = asyncio.ensure_future(robot.driver.latest("sensingPose"))
            await asyncio.sleep(0.01)
            robot.bus.cut("/face", "the cable was pulled")
            for waiting in (first, newest, robot.driver.latest("sensingPose")):
                with pytest.raises(RobotError) as lost:
                    await waiting
                assert lost.value.code == "KG803"
                assert "cable" in lost.value.message

    asyncio.run(scene())


def test_reading_ends_with_the_driver() -> None:
    """Leaving the driver's block ends readings, without an error."""

    async def scene() -> None:
        async with rover() as robot:
            values = robot.driver.read("sensingPose")
            first = asyncio.ensure_future(anext(values))
            await asyncio.sleep(0.01)
            newest = asyncio.ensure_future(robot.driver.latest("sensingPose"))
            await asyncio.sleep(0.01)
            await robot.driver._close()
            with pytest.raises(StopAsyncIteration):
                await first
            with pytest.raises(RobotError):
                await newest

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("name", "code"),
    [("nonsense", "KG821"), ("drivingAtVelocity", "KG822"), ("flying", "KG822")],
)
def test_what_cannot_be_read(name: str, code: str) -> None:
    """A missing, write-only or unreachable capability is reported as such."""

    async def scene() -> None:
        async with rover() as robot:
            with pytest.raises(RobotError) as refused:
                await robot.driver.latest(name)
            assert refused.value.code == code
            assert refused.value.hint or "reached" in refused.value.message

    asyncio.run(scene())
