"""The session of a server with its robot: manual driving, programs, and above all reliable stopping."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING, Any, cast
from uuid import uuid4

import pytest
from patience import patient
from rover import PICTURE, Rover

from kg.errors import RobotError
from kg.robot import live
from kg.robot.connection import GraphProblem
from kg.robot.driving import Driver
from kg.robot.programs.parse import parse
from kg.robot.simulation.running import VIEW
from kg.server.robot import link, work
from kg.server.robot import session as ending
from kg.server.robot.judging import judged
from kg.server.robot.link import TOPIC, Picture
from kg.server.robot.session import Session
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from kg.robot.connection import Connection
    from kg.server.robot.listeners import Listener

DRIVE = {"forward": 0.5}


async def until(holds: Callable[[], bool], seconds: float = 10) -> None:
    """Wait until a condition holds."""
    async with asyncio.timeout(patient(seconds)):
        while not holds():  # noqa: ASYNC110 - what is waited for is told by nobody
            await asyncio.sleep(0.02)


def still(rover: Rover) -> bool:
    """Whether the last command was zero."""
    return bool(rover.commands) and rover.commands[-1] == (0.0, 0.0)


@asynccontextmanager
async def met() -> AsyncIterator[tuple[Session, Rover]]:
    """Yield a connected session, and its robot."""
    name = uuid4().hex
    try:
        async with Session(f"rover://{name}", load({}, environment={})) as session:
            await until(lambda: session.capabilities is not None, 30)
            yield session, Rover.known[name]
    finally:
        await Rover.known[name].stop()


async def drive(session: Session, rover: Rover, seconds: float = 30) -> Listener:
    """Start manual driving, as an open page; return the page when the robot moves."""
    page = session.listen()
    session.do(page.identity, "drivingAtVelocity", DRIVE, seconds)
    await until(lambda: (0.5, 0.0) in rover.commands)
    return page


def waiting(page: Listener) -> list[dict[str, Any]]:
    """Return the pending events of a page."""
    found = []
    while not page.waiting.empty():
        found.append(page.waiting.get_nowait() or {})
    return found


def told(page: Listener, kind: str) -> list[dict[str, Any]]:
    """Return the pending events of a kind."""
    return [event for event in waiting(page) if event.get("event") == kind]


async def hears(page: Listener, holds: Callable[[list[dict[str, Any]]], bool]) -> list[dict[str, Any]]:
    """Return the events received by a page until a condition on them holds; their number is unspecified."""
    found: list[dict[str, Any]] = []
    async with asyncio.timeout(patient(10)):
        while not holds(found):
            found.append(await page.waiting.get() or {})
    return found


def states(events: list[dict[str, Any]], kind: str) -> list[str]:
    """Return the states in events of a kind."""
    return [event["state"] for event in events if event.get("event") == kind]


class Broken:
    """A reading with a defect."""

    def __aiter__(self) -> Broken:
        return self

    async def __anext__(self) -> Any:
        raise ValueError("no such eye")


def test_the_robot_is_told_with_reasons() -> None:
    """The capabilities of a connected robot are grouped, each with the responsible part of the robot."""

    async def ask() -> dict[str, Any]:
        async with met() as (session, _):
            return session.status()

    found = asyncio.run(ask())
    assert (found["state"], found["problem"], found["view"]) == ("connected", None, "/robot/view")
    driving = next(one for one in found["capabilities"] if one["name"] == "drivingAtVelocity")
    assert "movement" in [kind.lower() for kind in driving["kinds"]]
    assert driving["because"] == ["Its node `/base` subscribes to `/cmd_vel` (`geometry_msgs/Twist`)."]


def leaves(proof: dict[str, Any]) -> list[str]:
    """Return the places of the facts at the end of a proof."""
    below = [place for one in proof.get("premises", ()) for place in leaves(one)]
    return below + ([proof["evidence"]["path"]] if proof.get("evidence") else [])


def test_why_it_can_is_proven_down_to_the_node_that_was_seen() -> None:
    """A proof ends at the observed node, with place and time, and at the ontology; KG818, KG846."""

    async def ask() -> tuple[dict[str, Any], dict[str, Any], list[str]]:
        codes = []
        async with met() as (session, rover):
            before = await session.why("drivingAtVelocity")
            capabilities = session.capabilities
            await rover.bus.join("/laser").advertise("/scan", "sensor_msgs/LaserScan")
            await until(lambda: session.capabilities != capabilities, 30)
            after = await session.why("laserScanning"), await session.why("move at a velocity")
            with pytest.raises(RobotError) as error:
                await session.why("brewing")
            codes.append(error.value.code)
            rover.bus.cut("/kg_page", "the cable broke")
            await until(lambda: session.status()["state"] == "lost")
            with pytest.raises(RobotError) as error:
                await session.why("drivingAtVelocity")
            assert leaves(after[1]["proofs"][0]) == leaves(before["proofs"][0]), "the base was seen as long as before"
            return before, after[0], [*codes, error.value.code]

    driving, laser, codes = asyncio.run(ask())
    assert codes == ["KG818", "KG846"]
    assert driving["capability"] == "drivingAtVelocity"
    assert driving["proofs"][0]["text"] == "/base rnkg:hasCapability move at a velocity"
    places = leaves(driving["proofs"][0])
    assert any(one.startswith("/base at ") and ", seen since " in one for one in places)
    assert "ontology/capability.ttl" in places
    assert any(one.startswith("/laser at ") for one in leaves(laser["proofs"][0]))


def test_what_is_done_by_hand_ends_by_itself() -> None:
    """A manual movement runs for its time, then the robot stops; the page receives both events."""

    async def do() -> list[str]:
        async with met() as (session, rover):
            page = await drive(session, rover, 0.5)
            await until(lambda: still(rover))
            return states(await hears(page, lambda found: len(states(found, "hand")) > 1), "hand")

    assert asyncio.run(do()) == ["doing", "done"]


def test_what_ends_before_it_is_done_is_told_as_that() -> None:
    """A manual movement replaced by another, or stopped by the driver, is not reported as done."""

    async def do() -> list[str]:
        async with met() as (session, rover):
            page = await drive(session, rover)
            session.do(page.identity, "drivingAtVelocity", {"forward": 0.25}, 30)
            await until(lambda: (0.25, 0.0) in rover.commands)
            driver = session._link.driver
            assert driver is not None
            await driver.stop()
            return states(await hears(page, lambda found: "stopped" in states(found, "hand")), "hand")

    assert asyncio.run(do()) == ["doing", "doing", "taken over", "stopped"]


def test_a_page_that_vanishes_stops_what_it_drives() -> None:
    """The robot stops when the page that drives it is closed, but not for any other page (C38)."""

    async def vanish() -> tuple[bool, bool]:
        async with met() as (session, rover):
            other, page = session.listen(), await drive(session, rover)
            await session.gone(other)
            goes_on = not still(rover)
            await session.gone(page)
            await until(lambda: still(rover))
            return goes_on, still(rover)

    assert asyncio.run(vanish()) == (True, True)


def test_a_page_that_falls_silent_stops_what_it_drives(monkeypatch: pytest.MonkeyPatch) -> None:
    """The robot stops when the driving page is silent for a while, as after closing a laptop (C38)."""
    silence = patient(0.6)
    monkeypatch.setattr(work, "SILENT", silence)

    async def fall_silent() -> tuple[int, bool]:
        async with met() as (session, rover):
            page = await drive(session, rover, 60)
            for _ in range(30):
                session.here(page.identity)
                await asyncio.sleep(0.05 * silence)
            spoke = rover.commands.count((0.0, 0.0))
            await until(lambda: still(rover), 10 + silence)
            return spoke, still(rover)

    assert asyncio.run(fall_silent()) == (0, True)


def test_a_program_goes_on_without_pages_until_it_is_stopped() -> None:
    """A program continues without pages; any client can stop it (C38)."""

    async def run() -> tuple[bool, str, bool]:
        async with met() as (session, rover):
            page = session.listen()
            await session.run(parse("move at a velocity forward: 0.5 for 60 s"))
            await until(lambda: (0.5, 0.0) in rover.commands)
            await session.gone(page)
            await asyncio.sleep(0.5)
            goes_on = not still(rover)
            await session.stop()
            await until(lambda: still(rover))
            return goes_on, session.status()["program"]["state"], still(rover)

    assert asyncio.run(run()) == (True, "stopped", True)


def test_the_end_of_the_server_stops_the_robot() -> None:
    """When the session ends, the robot is stopped and streams have ended, for manual driving and programs (C39)."""

    async def leave(program: str | None) -> tuple[bool, bool]:
        async with met() as (session, rover):
            if program:
                page = session.listen()
                await session.run(parse(program))
                await until(lambda: (0.5, 0.0) in rover.commands)
            else:
                page = await drive(session, rover)
            await session.leave()
            await until(lambda: still(rover))
            events = [event async for event in page.events()]
            return still(rover), bool(events)

    assert asyncio.run(leave(None)) == (True, True)
    assert asyncio.run(leave("move at a velocity forward: 0.5 for 60 s")) == (True, True)


def test_the_robot_stops_although_leaving_it_is_cut_short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cancelling the end of the server a second time does not interrupt stopping the robot."""

    async def end() -> bool:
        async with met() as (session, rover):
            await drive(session, rover)
            leaving = asyncio.Event()

            async def hang() -> None:
                leaving.set()
                await asyncio.Event().wait()

            monkeypatch.setattr(session._link, "_leave", hang)
            keeping = session._tasks[0]
            keeping.cancel()
            await asyncio.wait_for(leaving.wait(), patient(10))
            keeping.cancel()
            await asyncio.wait({keeping}, timeout=patient(10))
            return still(rover)

    assert asyncio.run(end())


def test_an_idle_page_publishes_no_velocities(monkeypatch: pytest.MonkeyPatch) -> None:
    """After a program, another client can drive exclusively; a program that waits keeps its topics. Stop sends zero."""
    monkeypatch.setattr(ending, "_LOOK", 0.02)
    monkeypatch.setattr(ending, "_UNUSED", 0.05)

    def publishes(rover: Rover) -> bool:
        return any((one.node, one.name) == ("/kg_page", "/cmd_vel") for one in rover.bus.graph().ends)

    async def idle() -> tuple[bool, bool]:
        async with met() as (session, rover):
            await session.run(parse("move at a velocity  forward: 0.5 m/s for 0.1 s\nwait for 60 s"))
            await until(lambda: still(rover))
            await asyncio.sleep(0.5)
            kept = publishes(rover)
            await session.stop()
            await until(lambda: not publishes(rover))
            before = len(rover.commands)
            await session.stop()
            await until(lambda: len(rover.commands) > before)
            await until(lambda: not publishes(rover))
            await drive(session, rover, 0.1)
            await until(lambda: still(rover))
            return kept, rover.commands[before] == (0.0, 0.0)

    assert asyncio.run(idle()) == (True, True)


def test_one_thing_moves_the_robot_at_a_time() -> None:
    """While a program runs, manual movements and other programs are KG847."""

    async def both() -> list[str]:
        codes = []
        async with met() as (session, rover):
            page = session.listen()
            await session.run(parse("wait for 60 s"))
            with pytest.raises(RobotError) as error:
                session.do(page.identity, "drivingAtVelocity", DRIVE, 1)
            codes.append(error.value.code)
            with pytest.raises(RobotError) as error:
                await session.run(parse("wait for 1 s"))
            codes.append(error.value.code)
            await session.stop()
            await drive(session, rover)
            with pytest.raises(RobotError) as error:
                await session.run(parse("wait for 1 s"))
            return [*codes, error.value.code]

    assert asyncio.run(both()) == ["KG847"] * 3


def test_what_cannot_be_done_by_hand() -> None:
    """Missing capabilities, unlimited times and closed pages are rejected with their codes."""

    async def ask() -> list[str]:
        codes = []
        async with met() as (session, _):
            page = session.listen().identity
            for identity, name, seconds in (
                (page, "flying", 1.0),
                (page, "sensingPose", 1.0),
                (page, "drivingAtVelocity", 3600.0),
                ("nobody", "drivingAtVelocity", 1.0),
            ):
                with pytest.raises(RobotError) as error:
                    session.do(identity, name, DRIVE, seconds)
                codes.append(error.value.code)
        return codes

    assert asyncio.run(ask()) == ["KG821", "KG822", "KG848", "KG849"]


def test_values_are_told_to_who_follows_them() -> None:
    """A follower of a capability receives its values at a readable rate; other pages receive none."""
    many = 6

    def enough(found: list[dict[str, Any]]) -> bool:
        return [one["event"] for one in found].count("value") == many

    async def follow() -> tuple[list[dict[str, Any]], float, list[dict[str, Any]]]:
        async with met() as (session, _):
            page, other = session.listen(), session.listen()
            began = asyncio.get_running_loop().time()
            session.follow(page.identity, ["sensingPose"])
            events = await hears(page, enough)
            took = asyncio.get_running_loop().time() - began
            session.follow(page.identity, [])
            return [one for one in events if one.get("event") == "value"], took, told(other, "value")

    values, took, none = asyncio.run(follow())
    assert none == []
    assert took > 0.09 * (many - 1)
    assert set(values[0]["value"]) >= {"x", "y", "heading"}


async def laser(session: Session, rover: Rover) -> None:
    """Start another node, and wait for the additional capability."""
    before = session.capabilities
    await rover.bus.join("/laser").advertise("/scan", "sensor_msgs/LaserScan")
    await until(lambda: session.capabilities != before, 30)


def test_what_goes_on_when_the_robot_can_do_more() -> None:
    """A program and followed values continue when an unrelated node joins and leaves; no zero command is sent."""

    async def go_on() -> tuple[str, set[tuple[float, float]]]:
        async with met() as (session, rover):
            page = session.listen()
            session.follow(page.identity, ["sensingPose"])
            await session.run(parse("move at a velocity forward: 0.5 for 60 s"))
            await until(lambda: bool(rover.commands))
            await laser(session, rover)
            more = session.capabilities
            rover.bus.cut("/laser", "it was switched off")
            await until(lambda: session.capabilities != more, 30)
            told(page, "value")
            await until(lambda: bool(told(page, "value")))
            return session.status()["program"]["state"], set(rover.commands)

    assert asyncio.run(go_on()) == ("running", {(0.5, 0.0)})


def test_a_program_whose_capability_is_gone_is_told_so() -> None:
    """The program fails at its block and the robot stops; followers are notified of the loss and of the return."""

    def unread(event: dict[str, Any]) -> bool:
        return event.get("event") == "value" and "problem" in event

    async def lose() -> tuple[dict[str, Any], list[str]]:
        async with met() as (session, rover):
            await laser(session, rover)
            page = session.listen()
            session.follow(page.identity, ["laserScanning"])
            await session.run(
                parse("as soon as nearest of laserScanning < 1 m @w stop during drivingAtVelocity forward: 0.5 end")
            )
            await until(lambda: bool(rover.commands))
            with_laser = session.capabilities
            rover.bus.cut("/laser", "it was switched off")
            await until(lambda: session.capabilities != with_laser, 30)
            await until(lambda: session.status()["program"]["state"] == "failed")
            await until(lambda: still(rover))
            events = await hears(page, lambda found: "failed" in states(found, "program") and any(map(unread, found)))
            await laser(session, rover)
            problems = [one["problem"]["code"] for one in events if unread(one)]
            (end,) = [one for one in events if one["event"] == "program" and one["state"] == "failed"]
            told(page, "value")
            before = session.capabilities
            rover.bus.cut("/laser", "it was switched off")
            await until(lambda: session.capabilities != before, 30)
            await hears(page, lambda found: any(map(unread, found)))
            return end["problem"], problems

    problem, problems = asyncio.run(lose())
    assert (problem["id"], problem["code"] in {"KG821", "KG822"}) == ("w", True)
    assert "laserScanning" in problem["message"]
    assert problems
    assert set(problems) <= {"KG821", "KG822"}


def test_nodes_that_are_dead_are_told_at_the_block() -> None:
    """A node that dies silently is a warning at the block that needs it, and pages are notified."""

    async def die() -> tuple[list[dict[str, Any]], list[str]]:
        async with met() as (session, rover):
            page = session.listen()
            rover.bus.problems.append(GraphProblem("KG811", "/base", "nothing listens at http://127.0.0.1:1/"))
            rover.bus.changes.notify()
            await until(lambda: bool(told(page, "robot")), 30)
            asked = judged(None, "drivingAtVelocity forward: 0.1 for 1 s @w", session.robot)
            return asked["problems"], session.status()["doubts"]

    (problem,), doubted = asyncio.run(die())
    assert (problem["id"], problem["severity"], problem["code"]) == ("w", "warning", "KG811")
    assert "does not answer" in problem["message"]
    assert doubted == ["/base: nothing listens at http://127.0.0.1:1/"]


def test_a_defect_reaches_the_page(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    """A defect during driving, a program or followed values is reported to the page as KG900, and logged."""

    async def broken(*_: Any, **__: Any) -> Any:
        raise ValueError("no such wheel")

    async def meet() -> list[str]:
        async with met() as (session, _):
            page = session.listen()
            monkeypatch.setattr(Driver, "do", broken)
            session.do(page.identity, "drivingAtVelocity", DRIVE, 1)
            await until(lambda: not session._hands.busy)
            await session.run(parse("drivingAtVelocity forward: 0.1 for 1 s"))
            await until(lambda: session.status()["program"]["state"] == "failed")
            monkeypatch.setattr(Driver, "read", lambda *_: Broken())
            session.follow(page.identity, ["sensingPose"])
            events = await hears(page, lambda found: any(one.get("event") == "value" for one in found))
            return [one["problem"]["code"] for one in events if "problem" in one]

    assert asyncio.run(meet()) == ["KG900", "KG900", "KG900"]
    for what in ("driving by hand", "running a program", "reading sensingPose"):
        assert f"{what} failed: no such" in caplog.text


def test_a_robot_that_does_not_stop_in_time_keeps_no_server(monkeypatch: pytest.MonkeyPatch) -> None:
    """A session ends with no work left, even if stopping exceeds the time limit of the server."""
    monkeypatch.setattr(ending, "_LAST", 0.05)
    stop = Driver.stop

    async def slowly(driver: Driver, **_: bool) -> None:
        await asyncio.sleep(0.3)
        await stop(driver)

    async def leave() -> tuple[bool, int]:
        async with met() as (session, rover):
            await drive(session, rover)
            monkeypatch.setattr(Driver, "stop", slowly)
        return still(rover), len(asyncio.all_tasks())

    assert asyncio.run(leave()) == (True, 1)


def test_steps_and_values_of_a_program_are_told() -> None:
    """Running statements, read values, printed text and the end are sent to all pages."""

    async def run() -> tuple[list[dict[str, Any]], str]:
        async with met() as (session, _):
            page = session.listen()
            await session.run(parse('if x of sense its pose < 5 m then\n  log "near"\n  wait for 0.3 s\nend'))
            await until(lambda: session.status()["program"]["state"] == "done")
            events = []
            while not page.waiting.empty():
                events.append(page.waiting.get_nowait())
            return [event for event in events if event], session.status()["program"]["state"]

    events, state = asyncio.run(run())
    assert state == "done"
    assert [event["state"] for event in events if event["event"] == "program"] == ["running", "done"]
    assert "near" in [event.get("log") for event in events]
    assert any(event["event"] == "value" and "x" in event["value"] for event in events)


def test_what_is_stopped_before_it_began_does_not_go_on_for_pages() -> None:
    """A program or manual movement stopped at once is not reported as running."""

    async def hurry() -> tuple[str, list[str], list[str]]:
        async with met() as (session, _):
            page = session.listen()
            await session.run(parse("wait for 60 s"))
            await session.stop()
            state = session.status()["program"]["state"]
            programs = [event["state"] for event in told(page, "program")]
            session.do(page.identity, "drivingAtVelocity", DRIVE, 60)
            await session.stop()
            return state, programs, [event["state"] for event in told(page, "hand")]

    state, programs, hand = asyncio.run(hurry())
    assert (state, programs) == ("stopped", ["running", "stopped"])
    assert hand in ([], ["doing", "stopped"])


def test_a_robot_that_comes_later_is_met() -> None:
    """Connecting to a missing robot is retried; until then the reason is KG846."""

    async def wait() -> tuple[str, str, str]:
        name = uuid4().hex
        async with Session(f"memory://{name}", load({}, environment={})) as session:
            await until(lambda: session.status()["problem"] is not None)
            before = session.status()["state"]
            with pytest.raises(RobotError) as error:
                await session.run(parse("wait for 1 s"))
            rover = Rover(name)
            await rover.start()
            try:
                await until(lambda: session.status()["state"] == "connected", 30)
                met_at_last = session.status()["state"]
                rover.bus.cut("/kg_page", "the cable broke")
                await until(lambda: session.status()["state"] == "lost")
            finally:
                await rover.stop()
            return before, error.value.code, met_at_last

    assert asyncio.run(wait()) == ("connecting", "KG846", "connected")


def test_a_defect_does_not_freeze_the_page(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    """A defect while the robot is observed is reported as KG900 and logged, and the connection succeeds."""
    infer = live.infer
    broken: list[str] = []

    def defective(*given: Any, **named: Any) -> Any:
        if not broken:
            broken.append("once")
            raise ValueError("no such world")
        return infer(*given, **named)

    async def meet() -> str:
        name = uuid4().hex
        try:
            async with Session(f"rover://{name}", load({}, environment={})) as session:
                await until(lambda: session.status()["problem"] is not None, 30)
                code = session.status()["problem"]["code"]
                await until(lambda: session.status()["state"] == "connected", 30)
                return str(code)
        finally:
            await Rover.known[name].stop()

    monkeypatch.setattr(link, "infer", defective)
    assert asyncio.run(meet()) == "KG900"
    assert "following the robot failed: no such world" in caplog.text


def test_why_there_is_no_picture() -> None:
    """If the picture cannot be subscribed to, the reason is reported at once."""

    class Closed:
        async def subscribe(self, *_: Any, **__: Any) -> Any:
            raise RobotError("KG806", "another type")

    async def look() -> str:
        with pytest.raises(RobotError) as error:
            await Picture(cast("Connection", Closed())).newest()
        return f"{error.value.code} {error.value.message}"

    assert asyncio.run(look()) == "KG803 the simulation shows no picture: another type"


def test_the_picture_of_a_simulation_is_shown() -> None:
    """A simulation with a picture is shown from above; the topic is the one simulations publish to."""

    async def look() -> str:
        async with met() as (session, _):
            return await session.view()

    assert asyncio.run(look()) == PICTURE
    assert TOPIC == VIEW
