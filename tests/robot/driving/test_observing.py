"""Effects of a movement: a robot that does not move, and competing controllers."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any

import pytest
from msgspec.structs import replace
from robot.driving.rover import CAPABILITIES, rover, until

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.capability import Capability, Parameter, Way
from kg.robot.clock import SimulatedClock
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.driving import Driver
from kg.robot.driving.observing import other_controllers
from kg.robot.memory import MemoryConnection

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from robot.driving.rover import Rover

KIND = "geometry_msgs/Twist"


def _measuring(name: str, **fields: str) -> Capability:
    way = Way(kind="topic", name="/odom", type="nav_msgs/Odometry", node="/rover", fields=fields)
    parameters = tuple(Parameter(name=one, label=one, unit="m") for one in fields)
    return Capability(iri=f"#{name}", name=name, label=name, modality="read", parameters=parameters, ways=(way,))


VELOCITY = _measuring("sensingVelocity", forward="twist.twist.linear.x", turn="twist.twist.angular.z")
POSE = _measuring("sensingPose", x="pose.pose.position.x")
MEASURING = replace(
    CAPABILITIES,
    capabilities=(*(one for one in CAPABILITIES.capabilities if one.name != "sensingPose"), VELOCITY, POSE),
)


def _speed(forward: float) -> dict[str, Any]:
    return {"twist": {"twist": {"linear": {"x": forward}}}}


def _place(x: float) -> dict[str, Any]:
    return {"pose": {"pose": {"position": {"x": x}}}}


@pytest.mark.parametrize(
    ("arguments", "told", "moved"),
    [
        ({"forward": 0.5}, [_speed(0.0)], False),
        ({"forward": 0.5}, [_speed(0.4)], True),
        ({"forward": 0.5}, [_speed(-0.4), _speed(0.0)], True),
        ({"forward": 0.5}, [_speed(0.001)], False),
        ({"forward": 0.5}, [_place(0.0), _place(0.5)], True),
        ({"forward": 0.5}, [_place(0.0), _place(0.02)], False),
        ({"turn": 0.5}, [_speed(0.4)], False),
        ({"forward": 0.5}, [], None),
        ({"forward": 0.0}, [_speed(0.0)], None),
    ],
)
def test_a_robot_that_does_not_move(
    arguments: dict[str, float],
    told: list[dict[str, Any]],
    moved: bool | None,  # noqa: FBT001 - a case
) -> None:
    """A robot that measures zero speed during a movement did not move; without measurements that is unknown."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock, capabilities=MEASURING) as robot:
            await robot.tell("/odom", "nav_msgs/Odometry", _speed(0.0))
            doing = asyncio.ensure_future(robot.driver.do("driving", arguments, seconds=2, way="/cmd_vel"))
            await until(lambda: robot.publications["/odom"].peers)
            while not doing.done():
                clock.set_time(clock.now() + 0.05)
                for one in [*told, None]:
                    if one is not None:
                        await robot.tell("/odom", "nav_msgs/Odometry", one)
                    for _ in range(10):
                        await asyncio.sleep(0)
            outcome = await doing
            assert outcome.ended == "done"
            assert outcome.moved is moved
            assert (outcome.problem.code if outcome.problem else None) == ("KG820" if moved is False else None)

    asyncio.run(scene())


@asynccontextmanager
async def _contested(*, exclusive: bool) -> AsyncIterator[tuple[Rover, Driver, list[GraphProblem]]]:
    """Yield a rover, a driver that follows the graph, and the reports of the driver."""
    async with rover() as robot:
        problems: list[GraphProblem] = []
        second = robot.bus.join("/second")
        async with Driver(second, CAPABILITIES, exclusive=exclusive, on_problem=problems.append) as driver:

            async def follow() -> None:
                async for graph in second.changes():
                    driver.saw(graph)

            following = asyncio.ensure_future(follow())
            yield robot, driver, problems
            following.cancel()


def test_another_controller_is_reported_at_the_start_and_when_it_appears() -> None:
    """Each appearance is reported once; the movement continues."""

    async def scene() -> None:
        async with _contested(exclusive=False) as (robot, driver, problems):
            joystick = robot.bus.join("/joystick")
            publication = await joystick.advertise("/cmd_vel", KIND)
            moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}, way="/cmd_vel"))
            await until(lambda: len(problems) == 1)
            await publication.aclose()
            await until(lambda: len(robot.speeds()) > 2)
            await joystick.advertise("/cmd_vel", KIND)
            await until(lambda: len(problems) == 2)
            assert not moving.done()
            await driver.stop()
            assert (await moving).ended == "stopped"
            assert {(one.code, one.subject) for one in problems} == {("KG829", "/joystick")}

    asyncio.run(scene())


def test_another_controller_is_in_the_log_of_the_robot(monkeypatch: pytest.MonkeyPatch) -> None:
    """The warning about it is also written to the robot's log."""
    lines: list[tuple[str, str]] = []
    monkeypatch.setattr(MemoryConnection, "log", lambda _, level, message: lines.append((level, message)))

    async def scene() -> None:
        async with _contested(exclusive=False) as (robot, driver, problems):
            await robot.bus.join("/joystick").advertise("/cmd_vel", KIND)
            moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}, way="/cmd_vel"))
            await until(lambda: bool(problems))
            await driver.stop()
            await moving

    asyncio.run(scene())
    assert lines == [("warning", "[KG829] /joystick: it publishes to `/cmd_vel`, too")]


@pytest.mark.parametrize("first", [True, False])
def test_an_exclusive_movement_is_refused_or_ended(first: bool) -> None:  # noqa: FBT001 - a case
    """With another controller present it is KG829 and nothing is sent; when one appears it ends with zero."""

    async def scene() -> None:
        async with _contested(exclusive=True) as (robot, driver, problems):
            joystick = robot.bus.join("/joystick")
            if first:
                await joystick.advertise("/cmd_vel", KIND)
            moving = asyncio.ensure_future(driver.do("driving", {"forward": 0.5}, way="/cmd_vel"))
            if not first:
                await until(robot.speeds)
                await joystick.advertise("/cmd_vel", KIND)
            with pytest.raises(RobotError, match="`/joystick` publishes to `/cmd_vel`") as refused:
                await moving
            assert refused.value.code == "KG829"
            await until(lambda: first or robot.speeds()[-1] == 0.0)
            assert bool(robot.speeds()) != first
            assert not problems

    asyncio.run(scene())


def test_who_is_no_other_controller() -> None:
    """A watchdog of kg, a dead node, navigation, and unnamed DDS nodes do not count; a second kg does."""
    names = ("/kg_7", "/kg_watchdog_7", "/dead", "/move_base", "/_participant_0a1b")
    nodes = tuple(LiveNode(name, problem="it does not answer" if name == "/dead" else None) for name in names)
    ends = (
        *(LiveEnd(name, Role.PUBLISHES, "/cmd_vel", KIND) for name in names),
        LiveEnd("/move_base", Role.ACTION_SERVERS, "/move_base"),
        LiveEnd("/base", Role.SUBSCRIBES, "/cmd_vel", KIND),
        LiveEnd("/camera", Role.PUBLISHES, "/image"),
    )
    found = other_controllers("/cmd_vel", ComputationGraph(1, nodes, ends))
    assert [(one.code, one.subject) for one in found] == [("KG829", "/kg_7")]
