"""Only one command moves a part of a robot at a time."""

from __future__ import annotations

import asyncio

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from robot.driving.rover import COUNTING, DRIVING, ONE_PART, Rover, rover, until

from kg.errors import RobotError
from kg.robot.capability import Capabilities, Way
from kg.robot.driving.doing import robots_of

LONG = 10**6


def _of(*names: str, node: str) -> Capabilities:
    """Return capabilities with driving ways of these names, each of a node `NAME/node`."""
    way = DRIVING.ways[0]
    ways = tuple(replace(way, name=f"/{name}/cmd_vel", node=f"/{name}/{node}") for name in names)
    return Capabilities(of="several", capabilities=(replace(DRIVING, moves="base", ways=ways),))


async def _refused(robot: Rover, name: str, arguments: dict[str, float], way: str | None = None) -> RobotError:
    with pytest.raises(RobotError) as caught:
        await robot.driver.do(name, arguments, seconds=0.05, way=way)
    assert caught.value.code == "KG827"
    return caught.value


def test_a_movement_beside_a_goal_is_refused() -> None:
    """Driving during a goal is rejected with the current command; nothing is sent, the goal continues."""

    async def scene() -> None:
        async with rover(capabilities=ONE_PART) as robot:
            going = asyncio.ensure_future(robot.driver.do("counting", {"until": LONG}))
            await until(lambda: robot.goals)
            error = await _refused(robot, "driving", {"forward": 0.5}, "/cmd_vel")
            assert "`counting` moves (by the action /count)" in error.message
            assert error.hint is not None
            assert error.hint.startswith("Stop `counting` first")
            assert robot.speeds() == []
            assert not going.done()
            await robot.driver.stop()
            assert (await going).ended == "stopped"
            assert (await robot.driver.do("driving", {"forward": 0.5}, seconds=0.05, way="/cmd_vel")).ended == "done"
            assert robot.speeds()[-1] == 0

    asyncio.run(scene())


def test_a_goal_beside_a_movement_is_refused() -> None:
    """A goal during driving is rejected, and so is driving by another topic; the first command continues."""

    async def scene() -> None:
        async with rover(capabilities=ONE_PART) as robot:
            await robot.listen("/stamped", "geometry_msgs/TwistStamped")
            driving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}, way="/cmd_vel"))
            await until(robot.speeds)
            await _refused(robot, "counting", {"until": 3})
            await _refused(robot, "driving", {"forward": 0.1}, "/stamped")
            assert (robot.goals, robot.speeds("/stamped"), driving.done()) == ([], [], False)
            assert (await robot.driver.do("doubling", {"value": 2})).values["value"] == 4
            later = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.2}, way="/cmd_vel"))
            assert (await driving).ended == "taken over"
            await _refused(robot, "counting", {"until": 3})
            later.cancel()
            await asyncio.gather(later, return_exceptions=True)
            assert (await robot.driver.do("counting", {"until": 3})).ended == "done"

    asyncio.run(scene())


def test_two_robots_are_driven_at_a_time() -> None:
    """Nodes of the same name in two namespaces are two robots; two topics of one node belong to one."""

    async def together(capabilities: Capabilities) -> list[str]:
        async with rover(capabilities=capabilities) as robot:
            names = [way.name for way in capabilities.capabilities[0].ways]
            for name in names:
                await robot.listen(name, "geometry_msgs/Twist")
            work = (robot.driver.do("driving", {"forward": 0.5}, seconds=0.1, way=name) for name in names)
            found = await asyncio.gather(*work, return_exceptions=True)
            return [one.code if isinstance(one, RobotError) else getattr(one, "ended", "?") for one in found]

    assert asyncio.run(together(_of("one", "two", node="base"))) == ["done", "done"]
    mux = _of("joy", "keys", node="mux")
    (driving,) = mux.capabilities
    into_one = replace(driving, ways=tuple(replace(way, node="/mux") for way in driving.ways))
    assert asyncio.run(together(replace(mux, capabilities=(into_one,)))) == ["done", "KG827"]


@given(st.lists(st.from_regex(r"(/[ab]){0,2}/[cd]", fullmatch=True)))
def test_robots_are_told_by_their_nodes(nodes: list[str]) -> None:
    """A namespace is a robot if, and only if, it has a node whose name occurs in another namespace too."""
    within = {tuple(node[1:].split("/", 1)) for node in nodes if node.count("/") > 1}
    expected = {
        space for space, name in within if any(other != space and (other, name) in within for other, _ in within)
    }
    assert robots_of(nodes) == expected


def test_what_moves_nothing_is_never_refused() -> None:
    """A capability that moves no part according to the ontology is never excluded."""
    beside = replace(COUNTING, moves=None, ways=(*COUNTING.ways, Way(kind="topic", name="/x", type="t/T", node="/n")))

    async def scene() -> str:
        capabilities = replace(ONE_PART, capabilities=(ONE_PART.capabilities[0], beside))
        async with rover(capabilities=capabilities) as robot:
            driving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}, way="/cmd_vel"))
            await until(robot.speeds)
            found = await robot.driver.do("counting", {"until": 2}, way="/count")
            driving.cancel()
            await asyncio.gather(driving, return_exceptions=True)
            return found.ended

    assert asyncio.run(scene()) == "done"
