"""Reading and driving an independent node: rospy, on Debian's rosmaster."""

from __future__ import annotations

import asyncio
from contextlib import ExitStack, asynccontextmanager
from threading import Timer
from typing import TYPE_CHECKING

import pytest
from msgspec.structs import replace
from patience import patient
from robot.driving.rover import CAPABILITIES, DRIVING
from robot.ros1.debian import needs_debian, rosmaster, rospy

from kg.errors import RobotError
from kg.robot.capability import Capability, Parameter, Way
from kg.robot.connecting import connect
from kg.robot.driving import Driver

if TYPE_CHECKING:
    import subprocess
    from collections.abc import AsyncIterator, Callable, Iterator

pytestmark = [pytest.mark.ros, needs_debian]

ROVER = """
import actionlib, os, rospy, sys
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseAction
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserScan
rospy.init_node("rover", disable_signals=True)
def drive(twist):
    print("%.2f" % twist.linear.x)
    sys.stdout.flush()
    if twist.angular.z > 1.5:
        os._exit(0)
odometry = rospy.Publisher("/odom", Odometry, queue_size=10)
scans = rospy.Publisher("/scan", LaserScan, queue_size=10)
where, scan = Odometry(), LaserScan(angle_increment=1.5708, range_max=10, ranges=[2, float("nan"), 0.5])
where.pose.pose.orientation.w = 1
def tell(_):
    where.pose.pose.position.x += 0.5
    odometry.publish(where)
    scans.publish(scan)
rospy.Timer(rospy.Duration(0.02), tell)
rospy.Subscriber("/cmd_vel", Twist, drive, queue_size=1000)
def move(goal):
    print("goal")
    while not server.is_preempt_requested():
        rospy.sleep(0.02)
    server.set_preempted()
server = actionlib.SimpleActionServer("/move_base", MoveBaseAction, move, auto_start=False)
server.start()
"""
GOING = Capability(
    iri="#goingToPose",
    name="goingToPose",
    label="Going to a pose",
    modality="write",
    parameters=(Parameter(name="x", label="x", unit="m"),),
    ways=(
        Way(
            kind="action",
            name="/move_base",
            type="move_base_msgs/MoveBase",
            node="/rover",
            fields={"x": "target_pose.pose.position.x"},
        ),
    ),
    moves="base",
)
KNOWN = replace(CAPABILITIES, capabilities=(replace(DRIVING, moves="base"), *CAPABILITIES.capabilities[1:], GOING))


@pytest.fixture(scope="module")
def port() -> Iterator[int]:
    """Yield the port of a master."""
    with rosmaster() as listening:
        yield listening


@pytest.fixture
def rover(port: int) -> Iterator[subprocess.Popen[str]]:
    """Yield a rover that writes down the speeds it receives."""
    with rospy(port, ROVER) as process:
        yield process


@asynccontextmanager
async def driving(port: int) -> AsyncIterator[Driver]:
    """Yield a driver of the rover."""
    connection = await connect(f"ros1://127.0.0.1:{port}", name="/face")
    try:
        async with Driver(connection, KNOWN, listen=patient(3)) as driver:
            yield driver
    finally:
        await connection.aclose()


def speeds(rover: subprocess.Popen[str]) -> list[float]:
    """Return the speeds that a rover received up to zero; if it never gets zero, it is killed."""
    assert rover.stdout is not None
    found: list[float] = []
    patience = Timer(patient(10), rover.kill)
    patience.start()
    while not found or found[-1] != 0:
        line = rover.stdout.readline()
        assert line, f"it was told {found[-3:]} last, and never to stand still"
        found.append(float(line))
    patience.cancel()
    return found


def test_a_rospy_node_is_read(port: int, rover: subprocess.Popen[str]) -> None:
    """Values of its topics arrive by parameter, in order, and the newest is cached."""

    async def scene() -> None:
        async with asyncio.timeout(patient(10)), driving(port) as driver:
            values = driver.read("sensingPose")
            places = [(await anext(values))["x"] for _ in range(5)]
            await values.aclose()
            assert places == sorted(set(places))  # a slow reader loses some
            assert await driver.latest("laserScanning", seconds=patient(5)) == {"nearest": 0.5, "ahead": 2.0}
            assert (await driver.latest("sensingPose", seconds=patient(5)))["x"] > places[-1]

    asyncio.run(scene())
    assert rover.poll() is None


def test_a_rospy_node_is_driven(port: int, rover: subprocess.Popen[str]) -> None:
    """It gets the renewed command, and a zero command at the end of the time."""

    async def scene() -> None:
        async with asyncio.timeout(patient(10)), driving(port) as driver:
            outcome = await driver.do("driving", {"forward": "25cm/s"}, seconds=1)
            assert outcome.ended == "done"
            assert outcome.sent >= 2
            told = await asyncio.to_thread(speeds, rover)
            assert told == [*outcome.sent * [0.25], 0.0]

    asyncio.run(scene())


@pytest.mark.parametrize("how", ["leave", "raise", "cancel"])
def test_a_rospy_node_stands_still_afterwards(port: int, rover: subprocess.Popen[str], how: str) -> None:
    """However the driver's block is left, and even if the connection is closed at once, the last command is zero."""

    async def block(moving: asyncio.Event) -> None:
        async with driving(port) as driver:
            doing = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}))
            await asyncio.to_thread(rover.stdout.readline)  # type: ignore[union-attr]  # it has one
            moving.set()
            if how == "raise":
                raise ValueError
            if how == "cancel":
                await doing

    async def scene() -> None:
        moving = asyncio.Event()
        task = asyncio.ensure_future(block(moving))
        await moving.wait()
        if how == "cancel":
            task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    asyncio.run(scene())
    assert set(speeds(rover)) <= {0.5, 0.0}


def test_one_thing_moves_a_rospy_node(port: int, rover: subprocess.Popen[str]) -> None:
    """A goal and a velocity exclude each other until the first one has ended."""

    async def scene() -> None:
        async with asyncio.timeout(patient(20)), driving(port) as driver:
            going = asyncio.ensure_future(driver.do("goingToPose", {"x": 1}))
            assert await asyncio.to_thread(rover.stdout.readline) == "goal\n"  # type: ignore[union-attr]  # it has one
            with pytest.raises(RobotError) as beside:
                await driver.do("driving", {"forward": 0.1}, seconds=0.2)
            assert beside.value.code == "KG827"
            await driver.stop()
            assert (await going).ended == "stopped"
            moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}))
            await asyncio.to_thread(rover.stdout.readline)  # type: ignore[union-attr]  # it has one
            with pytest.raises(RobotError) as other:
                await driver.do("goingToPose", {"x": 1})
            assert other.value.code == "KG827"
            await driver.stop()
            assert (await moving).ended == "stopped"

    asyncio.run(scene())
    assert set(speeds(rover)) <= {0.5, 0.0}


def test_a_rospy_node_that_goes_away(port: int, rover: subprocess.Popen[str]) -> None:
    """When the driven node exits, the movement ends with KG824."""

    async def scene() -> None:
        async with asyncio.timeout(patient(10)), driving(port) as driver:
            with pytest.raises(RobotError) as alone:
                await driver.do("driving", {"forward": 0.5, "turn": 1.6})
            assert alone.value.code == "KG824"

    asyncio.run(scene())
    assert rover.wait(patient(5)) is not None


def test_a_master_that_goes_away() -> None:
    """When the master dies during a movement, it ends with KG803, and the robot gets its zero command."""

    async def scene(port: int, rover: subprocess.Popen[str], end_master: Callable[[], object]) -> None:
        async with driving(port) as driver:
            doing = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}))
            await asyncio.to_thread(rover.stdout.readline)  # type: ignore[union-attr]  # it has one
            await asyncio.to_thread(end_master)
            with pytest.raises(RobotError) as lost:
                await asyncio.wait_for(doing, patient(15))
            assert lost.value.code == "KG803"

    with ExitStack() as master:
        port = master.enter_context(rosmaster())
        with rospy(port, ROVER) as rover:
            asyncio.run(scene(port, rover, master.close))
            assert set(speeds(rover)) <= {0.5, 0.0}
