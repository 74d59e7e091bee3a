"""After any sequence of commands, cancellations, stops and losses, the last message of a moved topic is zero."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from robot.driving.rover import CAPABILITIES, ONE_PART, rover, until

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import SimulatedClock
from kg.robot.driving import Driver, Watchdog

if TYPE_CHECKING:
    from robot.driving.rover import Rover

    from kg.robot.capability import Capabilities
    from kg.robot.connection import Value
    from kg.robot.driving import Outcome

TOPICS = {"/cmd_vel": "geometry_msgs/Twist", "/stamped": "geometry_msgs/TwistStamped"}

moves = st.tuples(
    st.just("do"),
    st.sampled_from(sorted(TOPICS)),
    st.sampled_from([-1.0, -0.3, 0.5, 1.0]),
    st.sampled_from([None, 0.01, 0.1, 0.3]),
)
steps = st.one_of(
    moves,
    st.tuples(st.just("cancel"), st.integers(0, 5)),
    st.tuples(st.just("stop")),
    st.tuples(st.just("release")),
    st.tuples(st.just("stop all")),
    st.tuples(st.just("pass"), st.sampled_from([0.0, 0.01, 0.05, 0.2])),
    st.tuples(st.just("reset")),
    st.tuples(st.just("count")),
    st.tuples(st.just("wrong")),
)


async def _settle() -> None:
    for _ in range(30):
        await asyncio.sleep(0)


class _Play:
    """A sequence played on a rover."""

    def __init__(self, robot: Rover, clock: SimulatedClock) -> None:
        self.robot = robot
        self.clock = clock
        self.tasks: list[asyncio.Task[Outcome]] = []

    async def step(self, kind: str, *values: object) -> None:
        """Perform one step, and wait for its effects."""
        driver = self.robot.driver
        if kind == "do":
            topic, forward, seconds = values
            work = driver.do("driving", {"forward": forward}, seconds=seconds, way=str(topic))  # type: ignore[arg-type]  # as drawn
            self.tasks.append(asyncio.ensure_future(work))
        elif kind == "cancel" and self.tasks:
            self.tasks[int(str(values[0])) % len(self.tasks)].cancel()
        elif kind == "stop":
            await driver.stop()
        elif kind == "release":
            await driver.release(0)
        elif kind == "stop all":
            await driver.stop(released=True)
        elif kind == "pass":
            self.clock.set_time(self.clock.now() + float(str(values[0])))
        elif kind == "reset":
            self.clock.set_time(0.0)
        elif kind == "count":
            self.tasks.append(asyncio.ensure_future(driver.do("counting", {"until": 10**6})))
        elif kind == "wrong":
            self.tasks.append(asyncio.ensure_future(driver.do("driving", {"forward": 99})))
        if len(values) != 1:
            await _settle()


def _fast(robot: Rover) -> dict[str, list[float]]:
    return {topic: robot.speeds(topic) for topic in TOPICS if robot.speeds(topic)}


class _Told(Watchdog):
    """A watchdog that only records its registrations."""

    def __init__(self) -> None:
        super().__init__("memory://", silence=3600)
        self.moved: set[str] = set()

    async def watch_topic(self, topic: str, kind: str, zero: Value) -> None:
        """Record a moved topic."""
        assert (kind, zero.get("twist", zero)["linear"]["x"]) == (TOPICS[topic], 0)
        self.moved.add(topic)

    async def watch_goal(self, action: str, identity: str) -> None:
        """Record a goal."""
        assert action == "/count"
        self.moved.add(identity)

    async def forget(self, key: str) -> None:
        """Remove a record."""
        self.moved.discard(key)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(steps, max_size=14),
    st.sampled_from(["leave", "raise", "cancel"]),
    st.sampled_from([CAPABILITIES, ONE_PART]),
)
def test_the_last_thing_is_zero(sequence: list[tuple[object, ...]], end: str, known: Capabilities) -> None:
    """After any sequence and any exit of the block, each moved topic got a zero command last.

    The watchdog has a record of each while it moves.
    """

    async def scene() -> None:
        clock, watchdog = SimulatedClock(), _Told()
        robots: list[Rover] = []

        async def block() -> None:
            async with rover(clock, capabilities=known, watchdog=watchdog) as robot:
                await robot.listen("/stamped", TOPICS["/stamped"])
                robots.append(robot)
                play = _Play(robot, clock)
                for kind, *values in sequence:
                    await play.step(str(kind), *values)
                    assert {topic for topic, speeds in _fast(robot).items() if speeds[-1]} <= watchdog.moved
                if end == "raise":
                    raise ValueError
                if end == "cancel":
                    await asyncio.Event().wait()
            await asyncio.gather(*play.tasks, return_exceptions=True)

        task = asyncio.ensure_future(block())
        if end == "cancel":
            await asyncio.sleep(0.01)
            await _settle()
            task.cancel()
        (left,) = await asyncio.gather(task, return_exceptions=True)
        assert isinstance(left, {"leave": type(None), "raise": ValueError, "cancel": asyncio.CancelledError}[end]), left
        await _settle()
        assert [speeds[-1] for speeds in _fast(robots[0]).values()] == [0.0] * len(_fast(robots[0]))
        assert robots[0].cancelled == len(robots[0].goals)
        assert not watchdog.moved

    asyncio.run(scene())


@settings(deadline=None, max_examples=30)
@given(st.lists(steps, max_size=8), st.booleans(), st.sampled_from([CAPABILITIES, ONE_PART]))
def test_a_loss_ends_everything(
    sequence: list[tuple[object, ...]],
    later: bool,  # noqa: FBT001 - as drawn
    known: Capabilities,
) -> None:
    """When the connection is lost during a sequence, all work ends, and nothing moves afterwards."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock, capabilities=known) as robot:
            play = _Play(robot, clock)
            for kind, *values in sequence:
                await play.step(str(kind), *values)
            robot.bus.cut("/face", "the cable was pulled")
            await _settle()
            moved = _fast(robot)
            if later:
                await play.step("do", "/cmd_vel", 0.5, None)
            clock.set_time(clock.now() + 1)
            await _settle()
            assert all(task.done() for task in play.tasks)
            assert _fast(robot) == moved
            await asyncio.gather(*play.tasks, return_exceptions=True)

    asyncio.run(scene())


def test_impatience_does_not_cut_stopping_short() -> None:
    """Repeated cancellation leaves a driver with the robot stopped and no topic advertised."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.listen("/cmd_vel", "geometry_msgs/Twist")

            async def drive() -> None:
                async with Driver(robot.face, CAPABILITIES) as driver:
                    await driver.do("driving", {"forward": 0.5})

            driving = asyncio.ensure_future(drive())
            await until(robot.speeds)
            while not driving.done():
                driving.cancel()
                await asyncio.sleep(0)
            assert robot.told["/cmd_vel"][-1]["linear"]["x"] == 0.0
            assert (Role.PUBLISHES, "/cmd_vel") not in {(one.role, one.name) for one in robot.bus.graph().ends}

    asyncio.run(scene())


KIND = "geometry_msgs/Twist"


def _publishes(robot: Rover) -> bool:
    return ("/face", Role.PUBLISHES, "/cmd_vel") in {(one.node, one.role, one.name) for one in robot.bus.graph().ends}


def test_a_topic_that_stopped_is_released() -> None:
    """A topic is published until every subscriber has the zero command; the next command publishes it again."""

    async def scene() -> None:
        async with rover() as robot:
            moving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}))
            await until(robot.speeds)
            await robot.driver.release(0)
            assert _publishes(robot)
            await robot.driver.stop()
            await moving
            await robot.driver.release(3600)
            assert _publishes(robot)
            await robot.driver.release(0)
            assert not _publishes(robot)
            await robot.driver.do("driving", {"forward": 0.3}, seconds=0.05)
            await until(lambda: robot.speeds()[-2:] == [0.3, 0.0])

    asyncio.run(scene())


def test_a_topic_that_nobody_listened_to_is_released() -> None:
    """A command that found no subscriber leaves nothing for later ones, so its topic is released."""

    async def scene() -> None:
        async with rover(listen=0.01) as robot:
            with pytest.raises(RobotError, match="no node listens"):
                await robot.driver.do("driving", {"forward": 0.5}, way="/stamped", seconds=1)
            assert "/stamped" in robot.bus.topics
            await robot.driver.release(0)
            assert not [one for one in robot.bus.graph().ends if one.name == "/stamped"]

    asyncio.run(scene())


@pytest.mark.parametrize("confirmed", [True, False])
def test_a_topic_is_kept_for_a_subscriber_that_may_have_missed_zero(
    monkeypatch: pytest.MonkeyPatch,
    confirmed: bool,  # noqa: FBT001 - a case
) -> None:
    """If a subscriber left or does not confirm, the topic keeps its zero command for a robot that comes back."""
    monkeypatch.setattr("kg.robot.memory.MemoryPublication.confirmed", confirmed)

    async def scene() -> None:
        async with rover() as robot:
            base = await robot.listen("/cmd_vel", KIND)
            moving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}))
            await until(robot.speeds)
            if confirmed:
                await base.aclose()
            await robot.driver.stop()
            await moving
            await robot.driver.release(0)
            assert _publishes(robot)
            back = await robot.node.subscribe("/cmd_vel", KIND)
            async for one in back:
                assert one.value["linear"]["x"] == 0
                break

    asyncio.run(scene())


@pytest.mark.parametrize(("released", "zeros"), [(True, 2), (False, 1)])
def test_a_person_stops_topics_that_were_released(released: bool, zeros: int) -> None:  # noqa: FBT001 - a case
    """A stop for all sends zero to them again; others leave them to the client that drives by now."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.driver.do("driving", {"forward": 0.5}, seconds=0.05)
            await robot.driver.release(0)
            await robot.driver.stop(released=released)
            await _settle()
            assert robot.speeds().count(0.0) == zeros
            assert _publishes(robot) == released

    asyncio.run(scene())


def test_a_stop_for_all_leaves_a_later_command_alone() -> None:
    """A command that begins while the stop waits for subscribers keeps its topic, and ends with zero itself."""

    async def scene() -> None:
        async with rover() as robot:
            base = await robot.listen("/stamped", TOPICS["/stamped"])
            await robot.driver.do("driving", {"forward": 0.5}, way="/stamped", seconds=0.05)
            await robot.driver.release(0)
            await base.aclose()
            stopping = asyncio.ensure_future(robot.driver.stop(released=True))
            await _settle()
            work = robot.driver.do("driving", {"forward": 0.3}, way="/stamped", seconds=0.3)
            moving = asyncio.ensure_future(work)
            await _settle()
            await robot.listen("/stamped", TOPICS["/stamped"])
            await stopping
            assert (await moving).ended == "done"
            await _settle()
            assert robot.speeds("/stamped")[-2:] == [0.3, 0.0]

    asyncio.run(scene())
