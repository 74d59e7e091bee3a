"""Running programs: each program in cases/run with its expected events, and behaviour beyond the cases."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast
from uuid import uuid4

import pytest
from patience import patient
from robot.programs.trolley import CAPABILITIES, Trolley, trolley

from kg.robot.capability import Capabilities, Capability, Parameter, Way
from kg.robot.driving import Driver
from kg.robot.memory import Bus, MemoryConnection
from kg.robot.programs.parse import parse
from kg.robot.programs.runner import Runner

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.connection import Received, Subscription
    from kg.robot.programs.events import Ended

CASES = Path(__file__).parent / "cases" / "run"
TOLD = {"enter", "log", "set", "event", "error", "done", "stopped", "failed", "cancelled"}


def line(event: dict[str, Any]) -> str:
    """Return an event in the notation of the cases."""
    told = [event[key] for key in ("path", "message", "variable", "shown", "code") if event.get(key)]
    return " ".join([event["event"], *told])


async def carried_out(
    text: str, meanwhile: Callable[[Runner, Trolley], Awaitable[None]] | None = None
) -> tuple[Ended, list[dict[str, Any]], Trolley]:
    """Run a program on a trolley, with a concurrent action."""
    events: list[dict[str, Any]] = []
    async with trolley() as (robot, driver), asyncio.timeout(patient(15)):
        runner = Runner(driver, parse(text), events.append)
        beside = asyncio.ensure_future(meanwhile(runner, robot)) if meanwhile else None
        ended = await runner.run()
        if beside is not None:
            await beside
        while robot.speed:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
    return ended, events, robot


@pytest.mark.parametrize("case", sorted(CASES.glob("*.kgp")), ids=lambda path: path.stem)
def test_a_program_is_carried_out(case: Path) -> None:
    """Statements are entered in order, with the expected values, log and result."""
    _, events, _ = asyncio.run(carried_out(case.read_text(encoding="utf-8")))
    told = [line(event) for event in events if event["event"] in TOLD]
    assert told == case.with_suffix(".events").read_text(encoding="utf-8").splitlines()


def test_why_the_robot_is_lost_is_told() -> None:
    """A program whose robot is lost fails with the reason given by the connection."""

    async def scene() -> Ended:
        with Bus(uuid4().hex) as bus:
            async with Driver(bus.join("/face"), Capabilities(of="nothing")) as driver, asyncio.timeout(patient(15)):
                running = asyncio.ensure_future(Runner(driver, parse("wait 60 s")).run())
                await asyncio.sleep(0.05)
                bus.cut("/face", "the cable broke")
                return await running

    ended = asyncio.run(scene())
    assert ended.problem is not None
    assert ended.problem.code == "KG803"
    assert ended.problem.message.endswith(" is lost: the cable broke")


@pytest.mark.parametrize("dry_run", [True, False])
def test_the_log_of_the_robot_has_messages_and_errors(
    monkeypatch: pytest.MonkeyPatch,
    dry_run: bool,  # noqa: FBT001 - a case
) -> None:
    """What a program logs, and why it fails, is in the log of the robot; a dry run writes nothing there."""
    lines: list[tuple[str, str]] = []
    monkeypatch.setattr(MemoryConnection, "log", lambda _, level, message: lines.append((level, message)))

    async def scene() -> None:
        async with trolley() as (_, own), Driver(own.connection, CAPABILITIES, dry_run=dry_run) as driver:
            await Runner(driver, parse('log "before"\ngo to a pose  x: 9 m')).run()

    asyncio.run(scene())
    assert [level for level, _ in lines] == ([] if dry_run else ["info", "error"])
    assert dry_run or (lines[0][1], lines[1][1][:7]) == ("before", "[KG809]")


def test_a_pause_stops_what_moves() -> None:
    """A paused movement stops, and is continued for the rest of its time."""

    async def pause(runner: Runner, robot: Trolley) -> None:
        while robot.place < 0.4:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        runner.pause()
        while robot.speed:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        place = robot.place
        await asyncio.sleep(0.05)
        assert robot.place == place
        runner.resume()

    ended, events, robot = asyncio.run(carried_out("move at a velocity  forward: 1 m/s for 1 s", pause))
    assert ended.ended == "done"
    assert [one["event"] for one in events if one["event"] in {"paused", "resumed"}] == ["paused", "resumed"]
    assert 0.7 < robot.place < 1.4


def test_a_goal_is_given_again_after_a_pause() -> None:
    """A goal is cancelled when the program is paused, and sent again when it resumes."""

    async def pause(runner: Runner, robot: Trolley) -> None:
        while robot.place < 0.3:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        runner.pause()
        while not robot.cancelled:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        runner.resume()

    ended, _, robot = asyncio.run(carried_out("go to a pose  x: 1 m", pause))
    assert (ended.ended, robot.goals) == ("done", [1.0, 1.0])


def test_waiting_stands_still_in_a_pause() -> None:
    """A pause does not count for the time of a wait, or of the program."""

    async def pause(runner: Runner, robot: Trolley) -> None:
        await asyncio.sleep(0.01)
        runner.pause()
        begun = robot.clock.now()
        while robot.clock.now() < begun + 3:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        runner.resume()

    ended, _, _ = asyncio.run(carried_out('program "p" within 3 s\nwait 2 s', pause))
    assert ended.ended == "done"
    assert ended.seconds > 4


def test_a_program_can_be_cancelled() -> None:
    """`cancel` ends a program anywhere; the robot is stopped."""

    async def cancel(runner: Runner, robot: Trolley) -> None:
        while robot.place < 0.3:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.005)
        runner.cancel()

    ended, events, _ = asyncio.run(carried_out("move at a velocity  forward: 1 m/s for 1 min", cancel))
    assert (ended.ended, events[-1]["event"]) == ("cancelled", "cancelled")


def test_who_is_cancelled_stops_the_robot() -> None:
    """When the task that runs a program is cancelled, the robot is stopped before it ends."""

    async def work() -> float:
        async with trolley() as (robot, driver):
            task = asyncio.ensure_future(Runner(driver, parse("move at a velocity  forward: 1 m/s for 1 min")).run())
            while robot.place < 0.3:  # noqa: ASYNC110 - the test looks from outside
                await asyncio.sleep(0.005)
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            while robot.speed:  # noqa: ASYNC110 - the test looks from outside
                await asyncio.sleep(0.005)
            return robot.speed

    assert asyncio.run(asyncio.wait_for(work(), patient(15))) == 0.0


def test_who_is_cancelled_twice_stops_the_robot_before_it_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """A second cancellation, while the robot is being stopped, does not interrupt that."""

    async def work() -> list[str]:
        stopping, go = asyncio.Event(), asyncio.Event()
        stop, told = Driver.stop, []

        async def slowly(self: Driver) -> None:
            stopping.set()
            await go.wait()
            await stop(self)
            told.append("stopped")

        async with trolley() as (robot, driver):
            monkeypatch.setattr(Driver, "stop", slowly)
            program = parse("move at a velocity  forward: 1 m/s for 1 min")
            task = asyncio.ensure_future(Runner(driver, program, lambda event: told.append(event["event"])).run())
            while robot.place < 0.3:  # noqa: ASYNC110 - the test looks from outside
                await asyncio.sleep(0.005)
            task.cancel()
            await stopping.wait()
            task.cancel()
            await asyncio.sleep(0)
            go.set()
            await asyncio.gather(task, return_exceptions=True)
            monkeypatch.undo()
        return told[-2:]

    assert asyncio.run(asyncio.wait_for(work(), patient(15))) == ["stopped", "cancelled"]


def test_events_name_blocks() -> None:
    """Every event of a statement has its id."""
    ended, events, _ = asyncio.run(carried_out('log 1 / 0 @"block 7"'))
    assert ended.problem is not None
    assert ended.problem.id == "block 7"
    assert {event["id"] for event in events if event["event"] in {"enter", "error", "leave"}} == {"block 7"}


class _Late:
    """Subscribes; among subscriptions to only the newest message, all but the first wait for a gate."""

    def __init__(self, subscribe: Callable[..., Awaitable[Subscription]]) -> None:
        self.go = asyncio.Event()
        self.heard = asyncio.Event()
        self._subscribe = subscribe

    async def subscribe(self, topic: str, kind: str, *, queue: int) -> Subscription:
        subscription = await self._subscribe(topic, kind, queue=queue)
        return cast("Subscription", _Held(self, subscription)) if queue == 1 else subscription


class _Held:
    def __init__(self, late: _Late, subscription: Subscription) -> None:
        self._late = late
        self._subscription = subscription

    async def __aiter__(self) -> AsyncIterator[Received]:
        async for received in self._subscription:
            yield received
            self._late.heard.set()
            await self._late.go.wait()

    async def aclose(self) -> None:
        await self._subscription.aclose()


def test_a_condition_is_looked_at_with_what_has_come() -> None:
    """A value published once makes a condition true, however late the cache of newest values receives it."""
    feeling = Capability(
        iri="#feeling",
        name="feeling",
        label="feel",
        kinds=("sensing",),
        modality="read",
        parameters=(Parameter(name="pressed", label="pressed", type="boolean"),),
        ways=(Way(kind="topic", name="/bumper", type="std_msgs/Bool", node="/base", fields={"pressed": "data"}),),
    )

    async def feel() -> Ended:
        with Bus(uuid4().hex) as bus:
            bumper = await bus.join("/base").advertise("/bumper", "std_msgs/Bool", latch=True)
            await bumper.publish({"data": False})
            face = bus.join("/face")
            late = _Late(face.subscribe)
            face.subscribe = late.subscribe  # type: ignore[method-assign,assignment]  # the test is in between
            async with Driver(face, Capabilities(of="", capabilities=(feeling,))) as driver:
                running = asyncio.ensure_future(Runner(driver, parse("wait until pressed of feeling = true")).run())
                await late.heard.wait()
                for _ in range(50):
                    await asyncio.sleep(0)
                await bumper.publish({"data": True})
                for _ in range(50):
                    await asyncio.sleep(0)
                late.go.set()
                return await running

    assert asyncio.run(asyncio.wait_for(feel(), patient(5))).ended == "done"


def test_a_service_is_asked_again_while_it_is_waited_for() -> None:
    """A condition on a service's value becomes true when the service returns another value."""
    asking = Capability(
        iri="#asking",
        name="asking",
        label="ask",
        kinds=("sensing",),
        modality="read",
        parameters=(Parameter(name="words", label="words", type="text"),),
        ways=(Way(kind="service", name="/ask", type="std_srvs/Trigger", node="/oracle", fields={"words": "message"}),),
    )
    answers = iter(["no", "no", "no", "no", "no"])

    async def answer(_: dict[str, Any]) -> dict[str, Any]:
        return {"success": True, "message": next(answers, "yes")}

    async def ask() -> Ended:
        with Bus(uuid4().hex) as bus:
            await bus.join("/oracle").serve("/ask", "std_srvs/Trigger", answer)
            async with Driver(bus.join("/face"), Capabilities(of="", capabilities=(asking,))) as driver:
                program = parse('wait until words of asking = "yes" within 60 s')
                return await asyncio.wait_for(Runner(driver, program).run(), patient(15))

    assert asyncio.run(ask()).ended == "done"


def test_steps_without_end_are_an_error() -> None:
    """A loop whose number of steps is not a number fails at its statement: KG838."""
    ended, _, _ = asyncio.run(carried_out("for x from 0 to 5 step 1e-320\n  break\nend"))
    assert ended.problem is not None
    assert (ended.problem.code, ended.problem.path) == ("KG838", "/body/0")


def test_a_short_movement_is_begun() -> None:
    """A movement for a hundredth of a second is sent, although too short to be resumed after a pause."""
    _, _, robot = asyncio.run(carried_out("move at a velocity  forward: 1 m/s for 0.01 s"))
    assert robot.fastest == 1.0
