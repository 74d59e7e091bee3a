from __future__ import annotations

import asyncio
import math
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import pytest
from repository import ROOT

from kg.errors import RobotError
from kg.evaluate.exercises import carry_out
from kg.robot.connecting import connect, look
from kg.robot.driving import Driver
from kg.robot.live import infer
from kg.robot.programs.files import load
from kg.robot.programs.places import placed, places_of
from kg.robot.programs.tree import Written
from kg.robot.simulation.arm import Arm
from kg.robot.simulation.plan import read_plan
from kg.robot.simulation.running import hosted_in_memory
from kg.robot.simulation.world import World
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

pytest.importorskip("pybullet", reason="worlds need pybullet")
pytest.importorskip("cv2", reason="cameras need OpenCV")

PROGRAM = ROOT / "examples" / "programs" / "arm-1-pick-and-place.kgp"
both = pytest.mark.parametrize("ros", [1, 2])


@asynccontextmanager
async def driven(ros: int = 1) -> AsyncIterator[tuple[World, Arm, Driver]]:
    """Run the arm in memory, and drive it."""
    async with hosted_in_memory("arm", ros=ros) as (simulation, address):
        connection = await connect(address, name="/kg")
        capabilities = infer(await connection.graph(), Settings(), address=address)
        async with Driver(connection, capabilities) as driver:
            assert isinstance(simulation.world.robot, Arm)
            yield simulation.world, simulation.world.robot, driver
        await connection.aclose()


def moved_to(x: float, y: float, z: float) -> Arm:
    """Return the arm of a fresh world six seconds after its hand got a target."""
    with World("arm") as world:
        arm = world.robot
        assert isinstance(arm, Arm)
        arm.reach((x, y, z), (0.0, 0.0, 0.0, 0.0))
        for _ in range(600):
            world.advance()
        return arm


@both
def test_its_interfaces_show_what_it_can_do(ros: int) -> None:
    """Hand, joints, gripper and camera are recognised; no pose of the hand is taken for that of the robot."""

    async def see() -> set[str]:
        async with hosted_in_memory("arm", ros=ros) as (_, address):
            return {one.name for one in infer(await look(address), Settings(), address=address).capabilities}

    names = asyncio.run(see())
    assert {"movingHand", "movingJoints", "gripping", "sensingHand", "sensingJoints", "seeing"} <= names
    assert not {"goingToPose", "sensingPose", "drivingAtVelocity"} & names


@both
def test_the_program_puts_the_cube_into_the_tray(ros: int) -> None:
    """The red cube ends in the left tray, the green one stays in place, and the gripper is open."""

    async def run() -> None:
        async with hosted_in_memory("arm", ros=ros) as (simulation, address):
            world = simulation.world
            program = placed(load(str(PROGRAM)).program, places_of(world.plan.places()))
            assert await carry_out(program, address, Settings()) == []
            assert world.plan.room_at(*world.thing_at("red cube")[:2]) == "left tray"
            assert world.plan.room_at(*world.thing_at("green cube")[:2]) == "green spot"
            assert world.thing_at("red cube")[2] == pytest.approx(0.025, abs=0.005)

    asyncio.run(run())


def test_a_place_of_the_arm_is_above_the_table() -> None:
    """A place has all values of a hand target, so a page can send the hand there."""
    places = places_of(read_plan("arm").places())
    assert [one.z for one in places.values()] == [Written(value=0.2, unit="m")] * 4


def test_joints_follow_a_trajectory() -> None:
    """The named joints reach their positions, the others stay."""

    async def run() -> None:
        async with driven() as (world, arm, driver):
            before = arm.positions
            names = ["panda_joint2", "panda_joint1"]
            await driver.do("movingJoints", {"names": names, "positions": [0.1, 0.5], "seconds": 2}, seconds=30)
            assert world.time >= 2
            assert arm.positions[:2] == pytest.approx((0.5, 0.1), abs=0.02)
            assert arm.positions[2:] == pytest.approx(before[2:], abs=0.02)

    asyncio.run(run())


@pytest.mark.parametrize(
    ("names", "positions", "why"),
    [
        (["panda_joint9"], [1.0], "unknown joint panda_joint9"),
        (["panda_joint1"], [1.0, 2.0], "2 positions for 1 joints"),
        (["panda_joint1"], [math.inf], "not a number"),
        ([], [], "no joints"),
        (["panda_joint4"], [2.0], "rad away from its position"),
    ],
)
def test_a_trajectory_that_is_impossible_is_aborted(names: list[str], positions: list[float], why: str) -> None:
    """An unknown joint, a wrong number of positions, and a position beyond a joint's limit abort the goal."""

    async def run() -> None:
        async with driven() as (_, _arm, driver):
            with pytest.raises(RobotError, match=why) as aborted:
                await driver.do("movingJoints", {"names": names, "positions": positions}, seconds=30)
            assert aborted.value.code == "KG809"

    asyncio.run(run())


def test_a_stopped_trajectory_holds_the_joints() -> None:
    """After Stop the arm stays in place, far from the end of the trajectory."""

    async def run() -> None:
        async with driven() as (_, arm, driver):
            arguments = {"names": ["panda_joint1"], "positions": [2.0], "seconds": 20}
            moving = asyncio.create_task(driver.do("movingJoints", arguments, seconds=60))
            while arm.positions[0] < 0.2:
                await driver.connection.clock.sleep(0.1)
            await driver.stop()
            await asyncio.gather(moving, return_exceptions=True)
            held = arm.positions[0]
            await driver.connection.clock.sleep(3)
            assert arm.positions[0] == pytest.approx(held, abs=0.05)
            assert held < 1.0

    asyncio.run(run())


def test_a_grip_on_a_thing_stalls() -> None:
    """The gripper reports stalling on the cube, and opens again."""

    async def run() -> None:
        async with driven() as (world, arm, driver):
            x, y, _ = world.thing_at("green cube")
            await driver.do("movingHand", {"x": x, "y": y, "z": 0.02})
            while arm.pose.z > 0.025:
                await driver.connection.clock.sleep(0.1)
            gripped = (await driver.do("gripping", {"opening": 0.0}, seconds=10)).values
            assert (gripped["stalled"], gripped["reached_goal"]) == (True, False)
            assert gripped["position"] == pytest.approx(0.045, abs=0.01)
            opened = (await driver.do("gripping", {"opening": 0.08}, seconds=10)).values
            assert opened["reached_goal"] is True

    asyncio.run(run())


@pytest.mark.parametrize(("x", "y", "z"), [(0.6, 0.8, 0.3), (0.5, 0.35, 0.1)])
def test_the_hand_gets_where_it_is_sent(x: float, y: float, z: float) -> None:
    """The hand is within a centimetre of its target, and points down."""
    arm = moved_to(x, y, z)
    assert (arm.pose.x, arm.pose.y, arm.pose.z) == pytest.approx((x, y, z), abs=0.01)
    assert abs(arm.turned[0]) > 0.99


@pytest.mark.parametrize(("x", "y", "z"), [(9.0, 9.0, 9.0), (0.7, 0.6, -3.0), (-4.0, 0.6, 0.2)])
def test_a_target_out_of_reach_is_approached(x: float, y: float, z: float) -> None:
    """Beyond its reach or below the table, the hand goes as far as it can, and not through the table."""
    arm = moved_to(x, y, z)
    assert math.dist((arm.pose.x, arm.pose.y, arm.pose.z), (arm.base.x, arm.base.y, 0.333)) < 0.9
    assert arm.pose.z > 0
    assert all(math.isfinite(one) for one in arm.positions)


def test_a_target_that_is_not_a_number_is_ignored() -> None:
    """The hand stays in place."""
    arm = moved_to(math.nan, 0.5, 0.3)
    assert arm.pose.z == pytest.approx(0.437, abs=0.01)
