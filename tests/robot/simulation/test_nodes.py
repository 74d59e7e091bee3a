from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

import pytest
from patience import patient

from kg.errors import RobotError
from kg.robot.connecting import connect, of_robot
from kg.robot.driving import Driver
from kg.robot.live import infer
from kg.robot.simulation.drone import Drone, State
from kg.robot.simulation.plan import PLANS
from kg.robot.simulation.running import VIEW, hosted_in_memory
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import Connection
    from kg.robot.simulation.running import Simulation

pytest.importorskip("pybullet", reason="worlds need pybullet")
pytest.importorskip("cv2", reason="tags need OpenCV")

ACTION = {1: ("/move_base", "move_base_msgs/MoveBase"), 2: ("/navigate_to_pose", "nav2_msgs/NavigateToPose")}


@asynccontextmanager
async def simulated(world: str, ros: int = 1) -> AsyncIterator[tuple[Simulation, Connection]]:
    """Run a world in memory at maximum speed, with a node that observes it."""
    async with hosted_in_memory(world, ros=ros) as (simulation, address):
        yield simulation, await connect(address, name="/kg")


async def first(face: Connection, topic: str) -> Any:
    """Return the next message of a topic."""
    subscription = await face.subscribe(topic)
    async for received in subscription:
        await subscription.aclose()
        return received.value
    raise AssertionError(topic)


def goal(ros: int, x: float, y: float) -> dict[str, Any]:
    """Return a goal on the map."""
    pose = {"position": {"x": x, "y": y}, "orientation": {"w": 1.0}}
    return {{1: "target_pose", 2: "pose"}[ros]: {"header": {"frame_id": "map"}, "pose": pose}}


@pytest.mark.parametrize("ros", [1, 2])
def test_a_goal_is_reached(ros: int) -> None:
    """The action drives the robot into the kitchen, sends feedback, and succeeds."""

    async def drive() -> None:
        async with simulated("office", ros) as (simulation, face):
            sent = await face.send_goal(*ACTION[ros], goal(ros, 2.0, 6.8), seconds=5)
            told = [value async for value in sent.feedback()]
            await sent.result()
            assert simulation.world.robot.pose.distance(2.0, 6.8) < 0.2
            assert len(told) > 10

    asyncio.run(drive())


@pytest.mark.parametrize(("x", "y"), [(11.3, 0.7), (-5.0, 2.0), (4.0, 1.0), (float("nan"), 1.0)])
def test_a_goal_that_cannot_be_reached_is_aborted(x: float, y: float) -> None:
    """A room without a door, a place outside, one within a wall and one that is not a number are rejected."""

    async def drive() -> None:
        async with simulated("office") as (simulation, face):
            sent = await face.send_goal(*ACTION[1], goal(1, x, y), seconds=5)
            with pytest.raises(RobotError) as aborted:
                await sent.result()
            assert aborted.value.code == "KG809"
            assert simulation.world.robot.pose.distance(1.0, 4.5) < 0.1

    asyncio.run(drive())


def test_a_goal_that_is_cancelled_stops_the_robot() -> None:
    """After the cancellation the robot stops."""

    async def drive() -> None:
        async with simulated("office") as (simulation, face):
            sent = await face.send_goal(*ACTION[1], goal(1, 10.0, 6.8), seconds=5)
            await face.clock.sleep(3)
            await sent.cancel()
            with pytest.raises(RobotError):
                await sent.result()
            await face.clock.sleep(1.5)
            stood = simulation.world.robot.pose
            await face.clock.sleep(1)
            assert 1.5 < stood.x < 9
            assert simulation.world.robot.pose.distance(stood.x, stood.y) < 1e-6

    asyncio.run(drive())


def test_a_simple_goal_is_driven_to() -> None:
    """A message on the topic for simple goals is a goal."""

    async def drive() -> None:
        async with simulated("office") as (simulation, face):
            goals = await face.advertise("/move_base_simple/goal", "geometry_msgs/PoseStamped")
            await goals.publish(goal(1, 2.0, 4.5)["target_pose"])
            await face.clock.sleep(6)
            assert simulation.world.robot.pose.distance(2.0, 4.5) < 0.2

    asyncio.run(drive())


@pytest.mark.parametrize("ros", [1, 2])
def test_the_office_tells_what_it_senses(ros: int) -> None:
    """Scan, odometry, pose, battery, map and camera have the values of the world."""

    async def look() -> None:
        async with simulated("office", ros) as (_, face):
            scan = await first(face, "/scan")
            assert min(scan["ranges"]) == pytest.approx(0.85, abs=0.05)
            assert (await first(face, "/odom"))["child_frame_id"] == "base_link"
            assert (await first(face, "/amcl_pose"))["pose"]["pose"]["position"]["x"] == pytest.approx(1, abs=0.1)
            assert (await first(face, "/battery_state"))["percentage"] == pytest.approx(1, abs=0.01)
            grid = await first(face, "/map")
            assert len(grid["data"]) == grid["info"]["width"] * grid["info"]["height"]
            answer = await face.call("/static_map", "nav_msgs/GetMap", {}, seconds=5)
            assert answer["map"]["data"] == grid["data"]
            picture = await first(face, "/camera/rgb/image_raw")
            assert len(picture["data"]) == picture["step"] * picture["height"]

    asyncio.run(look())


def test_tags_are_found_in_the_frame_of_the_robot() -> None:
    """Tag 7 at the end of the corridor is ahead, at the right distance."""

    async def look() -> None:
        async with simulated("office") as (simulation, face):
            sent = await face.send_goal(*ACTION[1], goal(1, 9.5, 4.5), seconds=5)
            await sent.result()
            tags = await face.subscribe("/ar_pose_marker")
            async for received in tags:
                if received.value["markers"]:
                    break
            (marker,) = received.value["markers"]
            at = marker["pose"]["pose"]["position"]
            assert marker["id"] == 7
            assert at["x"] == pytest.approx(11.93 - simulation.world.robot.pose.x, abs=0.25)
            assert abs(at["y"]) < 0.3

    asyncio.run(look())


@pytest.mark.parametrize("ros", [1, 2])
def test_the_drone_flies_and_lands(ros: int) -> None:
    """Topics make it take off, fly and land, and it publishes its altitude and the tag below."""

    async def fly() -> None:
        async with simulated("drone", ros) as (simulation, face):
            drone = simulation.world.robot
            assert isinstance(drone, Drone)
            await (await face.advertise("/ardrone/takeoff", "std_msgs/Empty")).publish({})
            await face.clock.sleep(4)
            state = await first(face, "/ardrone/navdata" if ros == 1 else "/flight_data")
            assert (state["altd"] / 1000 if ros == 1 else state["h"] / 100) == pytest.approx(1.2, abs=0.15)
            (marker,) = (await first(face, "/ar_pose_marker"))["markers"]
            assert marker["id"] == 10
            velocity = await face.advertise("/cmd_vel", "geometry_msgs/Twist")
            for _ in range(20):
                await velocity.publish({"linear": {"x": 1.0}})
                await face.clock.sleep(0.1)
            await (await face.advertise("/ardrone/land", "std_msgs/Empty")).publish({})
            await face.clock.sleep(6)
            assert drone.state is State.LANDED
            assert drone.pose.x > 3

    asyncio.run(fly())


@pytest.mark.parametrize("ros", [1, 2])
def test_a_landed_drone_does_not_move(ros: int) -> None:
    """A velocity ignored by a drone on the ground is reported as KG820; in the air it flies."""

    async def fly() -> None:
        async with simulated("drone", ros) as (_, face):
            capabilities = infer(of_robot(await face.graph()), Settings(), address=face.address)
            async with Driver(face, capabilities) as driver:
                landed = await driver.do("drivingAtVelocity", {"forward": 0.5}, seconds=2)
                await driver.do("takingOff")
                await face.clock.sleep(4)
                flying = await driver.do("drivingAtVelocity", {"forward": 0.5}, seconds=2)
            assert landed.problem is not None
            assert landed.problem.code == "KG820"
            assert (landed.moved, flying.moved) == (False, True)

    asyncio.run(fly())


@pytest.mark.parametrize("world", PLANS)
def test_the_world_is_shown_from_above(world: str) -> None:
    """The view is well-formed SVG that names every room and every tag."""

    async def look() -> None:
        async with simulated(world) as (simulation, face):
            await face.clock.sleep(0.5)
            picture = (await first(face, VIEW))["data"]
            drawing = ET.fromstring(picture)  # noqa: S314 - our own picture
            shown = {text.text for text in drawing.iter("{http://www.w3.org/2000/svg}text")}
            assert {room.name for room in simulation.world.plan.rooms} <= shown
            assert {str(tag.id) for tag in simulation.world.plan.tags} <= shown

    asyncio.run(look())


def test_a_message_that_fails_does_not_deafen(caplog: pytest.LogCaptureFixture) -> None:
    """After failing on a message, which is reported, a node still receives the next ones."""

    async def scene() -> list[str]:
        heard: list[str] = []

        def hear(value: Any) -> None:
            heard.append(value["data"])
            if value["data"] == "bad":
                raise ValueError("not that")

        async with simulated("office") as (simulation, face):
            node = await simulation.stage.node("/listener")
            await node.hear("/said", "std_msgs/String", hear)
            said = await face.advertise("/said", "std_msgs/String")
            for word in ("bad", "good"):
                await said.publish({"data": word})
            async with asyncio.timeout(patient(5)):
                while len(heard) < len(("bad", "good")):  # noqa: ASYNC110 - a list tells nobody that it grows
                    await asyncio.sleep(0.01)
        return heard

    assert asyncio.run(scene()) == ["bad", "good"]
    assert "hearing /said failed: not that" in caplog.text


def test_a_simulation_that_fails_ends_who_waits_for_it() -> None:
    """If the simulation fails, a wait for its time raises that error."""

    async def wait() -> None:
        async with hosted_in_memory("office") as (simulation, address):
            face = await connect(address, name="/kg")
            await face.clock.sleep(0.1)
            simulation.world.close()
            await face.clock.sleep(60)

    with pytest.raises(Exception, match=r"[Pp]hysics"):
        asyncio.run(wait())
