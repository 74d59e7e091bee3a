from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.driving.rover import CAPABILITIES, rover, until

from kg.errors import RobotError
from kg.robot.clock import SimulatedClock
from kg.robot.driving import Driver, Outcome, Watchdog

if TYPE_CHECKING:
    from collections.abc import Awaitable

    from robot.driving.rover import Rover


async def _told(clock: SimulatedClock, work: Awaitable[Outcome], step: float = 0.01) -> Outcome:
    """Advance the time until a task is done."""
    task = asyncio.ensure_future(work)
    while not task.done():
        for _ in range(20):
            await asyncio.sleep(0)
        clock.set_time(clock.now() + step)
    return task.result()


def test_a_movement_is_renewed_and_ends() -> None:
    """It is renewed at the way's rate for its time, followed by a zero command."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock) as robot:
            outcome = await _told(clock, robot.driver.do("driving", {"forward": "20 cm/s"}, seconds=2))
            assert outcome.ended == "done"
            assert outcome.sent == 40
            assert clock.now() == pytest.approx(2, abs=0.03)
            await until(lambda: len(robot.speeds()) == 41)
            assert robot.speeds() == [*40 * [0.2], 0.0]
        assert robot.speeds()[-1] == 0.0

    asyncio.run(scene())


def test_a_clock_that_is_set_back_ends_a_movement() -> None:
    """When a simulation restarts, earlier movements are stopped."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock) as robot:
            clock.set_time(100)
            moving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.2}, seconds=50))
            await until(robot.speeds)
            clock.set_time(0)
            assert (await moving).ended == "done"
            await until(lambda: robot.speeds()[-1] == 0)

    asyncio.run(scene())


def test_a_message_is_sent_once() -> None:
    """A command without renewal is sent once, and nothing after it."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.listen("/say", "std_msgs/String")
            outcome = await robot.driver.do("saying", {"words": "hello"}, seconds=5)
            assert (outcome.ended, outcome.sent, outcome.plan.seconds) == ("done", 1, None)
        await until(lambda: robot.told.get("/say") == [{"data": "hello"}])

    asyncio.run(scene())


def test_a_service_is_called() -> None:
    """Its response is read by parameter or as a whole; its failure is KG808."""

    async def scene() -> None:
        async with rover() as robot:
            outcome = await robot.driver.do("doubling", {"value": "150cm"})
            assert outcome.values == {"value": 3.0, "remark": "twice"}
            with pytest.raises(RobotError) as failed:
                await robot.driver.do("doubling", {"value": -1})
            assert failed.value.code == "KG808"

    asyncio.run(scene())


def test_a_goal_is_reached() -> None:
    """Feedback arrives during the goal; the result at its end."""

    async def scene() -> None:
        async with rover() as robot:
            told: list[object] = []
            outcome = await robot.driver.do("counting", {"until": 3}, seconds=patient(5), on_feedback=told.append)
            assert told == [{"now": 1}, {"now": 2}, {"now": 3}]
            assert outcome.values == {"reached": 3}
            assert robot.goals == [{"until": 3}]

    asyncio.run(scene())


def test_a_goal_that_takes_too_long() -> None:
    """A goal not reached in time is cancelled, and KG825."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock) as robot:
            with pytest.raises(RobotError) as late:
                await _told(clock, robot.driver.do("counting", {"until": 10**6}, seconds=0.1))
            assert late.value.code == "KG825"
            await until(lambda: robot.cancelled == 1)

    asyncio.run(scene())


@pytest.mark.parametrize("how", ["cancel", "stop", "leave", "fail"])
def test_whatever_ends_a_goal_cancels_it(how: str) -> None:
    """A goal is cancelled when its waiter is cancelled, on `stop`, at the end, and when feedback fails."""

    async def scene() -> None:
        def feedback(value: object) -> None:
            if how == "fail":
                raise ValueError(value)

        async with rover() as robot:
            doing = asyncio.ensure_future(robot.driver.do("counting", {"until": 10**6}, on_feedback=feedback))
            await until(lambda: robot.goals)
            if how == "cancel":
                doing.cancel()
            elif how == "stop":
                await robot.driver.stop()
            elif how == "leave":
                await robot.driver._close()
            ended = (await asyncio.gather(doing, return_exceptions=True))[0]
            expected: dict[str, type[object]] = {"cancel": asyncio.CancelledError, "fail": ValueError}
            assert isinstance(ended, expected.get(how, Outcome))
            assert isinstance(ended, BaseException) or ended.ended == "stopped"
            await until(lambda: robot.cancelled == 1)

    asyncio.run(scene())


async def _move(robot: Rover, seconds: float | None = None) -> asyncio.Task[Outcome]:
    moving = asyncio.ensure_future(robot.driver.do("driving", {"forward": 0.5}, seconds=seconds))
    await until(lambda: robot.speeds()[-1:] == [0.5])
    return moving


@pytest.mark.parametrize("how", ["cancel", "stop", "leave", "twice"])
def test_whatever_ends_a_movement_stops_it(how: str) -> None:
    """A movement without an end gets a zero command when it is cancelled, even twice, on `stop`, and at the end."""

    async def scene() -> None:
        async with rover() as robot:
            moving = await _move(robot)
            if how in {"cancel", "twice"}:
                moving.cancel()
            if how == "twice":
                await asyncio.sleep(0)
                moving.cancel()
            if how == "stop":
                await robot.driver.stop()
            if how == "leave":
                await robot.driver._close()
            ended = (await asyncio.gather(moving, return_exceptions=True))[0]
            assert isinstance(ended, asyncio.CancelledError if how in {"cancel", "twice"} else Outcome)
            assert isinstance(ended, BaseException) or ended.ended == "stopped"
            await until(lambda: robot.speeds()[-1] == 0)
            count = len(robot.speeds())
            await asyncio.sleep(0.15)
            assert robot.speeds()[count:] == []

    asyncio.run(scene())


def test_an_exception_in_the_block_stops_the_robot() -> None:
    """An error in the block of the driver leaves it with the robot stopped."""

    async def scene() -> None:
        robots: list[Rover] = []

        async def broken() -> None:
            async with rover() as robot:
                robots.append(robot)
                await _move(robot)
                raise ValueError("broken")

        with pytest.raises(ValueError, match="broken"):
            await broken()
        assert robots[0].speeds()[-1] == 0

    asyncio.run(scene())


def test_stopping_tells_all_that_was_ever_moved() -> None:
    """`stop` sends a zero command also to topics that have stopped, in case another publisher moved them since."""

    async def scene() -> None:
        async with rover() as robot:
            await robot.driver.do("driving", {"forward": 0.5}, seconds=0.05)
            await until(lambda: robot.speeds()[-1] == 0)
            zeros = robot.speeds().count(0)
            await robot.driver.stop()
            await until(lambda: robot.speeds().count(0) == zeros + 1)

    asyncio.run(scene())


def test_a_lost_connection_ends_what_is_done() -> None:
    """Movements and goals end with KG803 and the reason; later calls fail."""

    async def scene() -> None:
        async with rover() as robot:
            moving = await _move(robot)
            counting = asyncio.ensure_future(robot.driver.do("counting", {"until": 10**6}))
            await until(lambda: robot.goals)
            robot.bus.cut("/face", "the cable was pulled")
            for doing in (moving, counting, robot.driver.do("driving", {"forward": 0.5}, seconds=1)):
                with pytest.raises(RobotError) as lost:
                    await doing
                assert lost.value.code == "KG803"

    asyncio.run(scene())


def test_zero_is_sent_again_to_a_robot_that_comes_back() -> None:
    """A robot that was cut off when a movement ended might have missed its zero, and gets it when it is back."""

    async def scene() -> None:
        async with rover() as robot:
            moving = await _move(robot)
            robot.bus.cut("/rover", "its network was cut")
            with pytest.raises(RobotError):
                await moving
            robot.node = robot.bus.join("/rover")
            robot.told.clear()
            received = await robot.node.subscribe("/cmd_vel", "geometry_msgs/Twist")
            zeros = aiter(received)
            kept, again = [(await anext(zeros)).value["linear"]["x"] for _ in range(2)]
            assert kept == again == 0

    asyncio.run(scene())


def test_the_zero_of_a_movement_that_just_ended_is_owed() -> None:
    """If the robot is lost soon after a movement, the watchdog gets its topic: the zero might not have arrived."""
    owed: list[str] = []

    class Recording(Watchdog):
        async def owe(self, topic: str, peers: int) -> None:
            del peers
            owed.append(topic)

    async def scene() -> None:
        async with rover(watchdog=Recording("memory://")) as robot:
            await robot.driver.do("driving", {"forward": 0.5}, seconds=0.1)
            robot.bus.cut("/face", "the cable was pulled")

    asyncio.run(scene())
    assert owed == ["/cmd_vel"]


def test_a_movement_that_nobody_hears_any_more_ends() -> None:
    """When the last subscriber leaves it is KG824, and one that returns gets the zero command."""

    async def scene() -> None:
        async with rover() as robot:
            moving = await _move(robot)
            robot.bus.cut("/rover", "it crashed")
            with pytest.raises(RobotError) as alone:
                await moving
            assert alone.value.code == "KG824"
            robot.node = robot.bus.join("/rover")
            robot.told.clear()
            await robot.listen("/cmd_vel", "geometry_msgs/Twist")
            await until(lambda: robot.speeds() == [0.0])

    asyncio.run(scene())


def test_nobody_listens() -> None:
    """A command for a topic without a subscriber is KG824 after a moment, and is not sent."""

    async def scene() -> None:
        async with rover() as robot:
            with pytest.raises(RobotError) as alone:
                await robot.driver.do("saying", {"words": "hello"})
            assert alone.value.code == "KG824"
        async with rover(listen=patient(5)) as robot:
            later = asyncio.ensure_future(robot.driver.do("saying", {"words": "hello"}))
            await asyncio.sleep(0.05)
            await robot.listen("/say", "std_msgs/String")
            assert (await later).ended == "done"

    asyncio.run(scene())


def test_the_later_command_takes_over() -> None:
    """Of two movements on one topic, and two goals of one action, the later replaces the first, which is notified."""

    async def scene() -> None:
        async with rover() as robot:
            first = await _move(robot)
            second = asyncio.ensure_future(robot.driver.do("driving", {"forward": -0.5}, seconds=0.2))
            assert (await first).ended == "taken over"
            assert (await second).ended == "done"
            await until(lambda: robot.speeds()[-1] == 0)
            assert robot.speeds() == [*sorted(robot.speeds()[:-1], reverse=True), 0.0]
            count = asyncio.ensure_future(robot.driver.do("counting", {"until": 10**6}))
            await until(lambda: robot.goals)
            assert (await robot.driver.do("counting", {"until": 2})).values == {"reached": 2}
            assert (await count).ended == "taken over"

    asyncio.run(scene())


def test_a_stop_ends_what_is_only_being_prepared() -> None:
    """A command still waiting for a subscriber is also ended by `stop`, and never sent."""

    async def scene() -> None:
        async with rover() as robot:
            waiting = asyncio.ensure_future(robot.driver.do("saying", {"words": "hello"}))
            await asyncio.sleep(0)
            await robot.driver.stop()
            assert (await waiting).ended == "stopped"
            await robot.listen("/say", "std_msgs/String")
            await asyncio.sleep(0.05)
            assert "/say" not in robot.told

    asyncio.run(scene())


def test_stopping_within_feedback() -> None:
    """`stop` may be called from the feedback of a goal."""

    async def scene() -> None:
        async with rover() as robot:
            stops: list[asyncio.Task[None]] = []

            def feedback(_: object) -> None:
                stops.append(asyncio.ensure_future(robot.driver.stop()))

            outcome = await robot.driver.do("counting", {"until": 10**6}, on_feedback=feedback)
            assert outcome.ended == "stopped"
            await asyncio.gather(*stops)
            await until(lambda: robot.cancelled == 1)

    asyncio.run(scene())


def test_topics_are_not_flooded() -> None:
    """No topic gets more messages a second than the driver's limit, from all senders together."""

    async def scene() -> None:
        clock = SimulatedClock()
        async with rover(clock) as robot, Driver(robot.face, CAPABILITIES, limit=10) as driver:
            await robot.listen("/say", "std_msgs/String")
            for _ in range(11):
                await _told(clock, driver.do("saying", {"words": "hello"}))
            assert 1.0 <= clock.now() < 1.5
            outcome = await _told(clock, driver.do("driving", {"forward": 0.1}, seconds=1))
            assert outcome.sent <= 11

    asyncio.run(scene())


def test_a_dry_run_says_what_would_be_sent() -> None:
    """A dry run shows the whole message, its target, its rate and its end; nothing is sent."""

    async def scene() -> None:
        async with rover() as robot, Driver(robot.face, CAPABILITIES, dry_run=True) as driver:
            outcome = await driver.do("driving", {"turn": "90deg/s"}, seconds=2)
            plan = outcome.plan
            assert (outcome.ended, outcome.sent) == ("planned", 0)
            assert (plan.kind, plan.name, plan.type, plan.node) == (
                "topic",
                "/cmd_vel",
                "geometry_msgs/Twist",
                "/rover",
            )
            assert plan.message["angular"]["z"] == pytest.approx(1.5708, abs=1e-4)
            assert (plan.rate, plan.seconds) == (20, 2)
            assert plan.afterwards == {"linear": dict.fromkeys("xyz", 0.0), "angular": dict.fromkeys("xyz", 0.0)}
            goal = await driver.plan("counting", {"until": 5}, seconds=9)
            assert (goal.message, goal.afterwards, goal.seconds) == ({"until": 5}, None, 9)
            assert robot.told == {}
            assert "/cmd_vel" not in {one.name for one in robot.bus.graph(without="/rover").ends}

    asyncio.run(scene())


def test_constants_and_the_time_are_sent() -> None:
    """A message has its constant fields, and the robot's time in its header."""

    async def scene() -> None:
        clock = SimulatedClock()
        clock.set_time(12.5)
        async with rover(clock) as robot:
            await robot.listen("/stamped", "geometry_msgs/TwistStamped")
            plan = await robot.driver.plan("driving", {"up": 0.5})
            assert plan.name == "/stamped"
            assert plan.message["header"] == {"seq": 0, "stamp": {"sec": 12, "nanosec": 500000000}, "frame_id": "base"}
            await _told(clock, robot.driver.do("driving", {"up": 0.5}, seconds=1), step=0.05)
            stamps = [one["header"]["stamp"]["sec"] for one in robot.told["/stamped"]]
            assert (stamps[0], stamps[-1]) == (12, 13)

    asyncio.run(scene())


@pytest.mark.parametrize(
    ("name", "arguments", "way", "code"),
    [
        ("nonsense", {}, None, "KG821"),
        ("laserScanning", {}, None, "KG822"),
        ("driving", {}, "/nowhere", "KG822"),
        ("driving", {"forward": 2}, None, "KG823"),
        ("driving", {"up": 0.5}, "/cmd_vel", "KG823"),
        ("driving", {"sideways": 0.5}, None, "KG823"),
        ("counting", {}, None, "KG823"),
        ("saying", {"words": "nonsense"}, None, "KG823"),
    ],
)
def test_what_is_refused_is_not_sent(name: str, arguments: dict[str, float], way: str | None, code: str) -> None:
    """An invalid call is rejected before anything is sent or advertised."""

    async def scene() -> None:
        async with rover() as robot:
            with pytest.raises(RobotError) as refused:
                await robot.driver.do(name, arguments, way=way)
            assert refused.value.code == code
            await asyncio.sleep(0.02)
            assert robot.told == {}
            assert robot.goals == []

    asyncio.run(scene())
