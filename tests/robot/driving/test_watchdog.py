"""The watchdog process that stops a robot when its controller dies or is silent."""

from __future__ import annotations

import asyncio
import json
import sys
from asyncio.subprocess import PIPE
from typing import TYPE_CHECKING

import pytest
from patience import patient

from kg.robot.connecting import connect
from kg.robot.driving import Watchdog
from kg.robot.driving.watchdog import NODES
from kg.robot.ros1 import Master

if TYPE_CHECKING:
    from asyncio.subprocess import Process

    from kg.errors import RobotError
    from kg.robot.connection import Subscription

ZERO = {"header": {"frame_id": "base"}, "twist": {"linear": {"x": 0.0}}}
TOPIC, KIND = "/cmd_vel", "geometry_msgs/TwistStamped"


MOVED = f"{json.dumps(['topic', TOPIC, KIND, ZERO])}\n"
LEFT = f'["forget", "{TOPIC}"]\n'
WITHDRAWN = f'["withdraw", "{TOPIC}"]\n'
BEAT = '["beat"]\n'
NEVER = 3600.0


@pytest.mark.parametrize(
    ("orders", "expected"),
    [
        (MOVED, 5),
        (MOVED + BEAT, 5),
        (MOVED + '["end"]\n', 0),
        (MOVED + LEFT, 0),
        (MOVED + LEFT + MOVED, 5),
        (MOVED + WITHDRAWN, 5),
        (MOVED + LEFT + WITHDRAWN, 0),
        (MOVED + LEFT + WITHDRAWN + MOVED, 5),
        (f'["topic", "/arm", "own_msgs/Nobody", {{}}]\n{MOVED}', 5),
        (f'["topic", "/arm", "geometry_msgs/Twist", {{}}]\n{MOVED}', 5),
        (f'{MOVED}["topic", "/arm", "geome', 5),
    ],
)
def test_a_broken_pipe_sends_zero(orders: str, expected: int) -> None:
    """When the pipe closes, moving topics get zero commands with the current time; stopped and released ones do not."""
    stamps: list[int] = []

    async def follow(heard: Subscription) -> None:
        async for one in heard:
            header = one.value["header"]
            stamps.append(header["stamp"]["sec"])

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            following = asyncio.ensure_future(follow(await base.subscribe(TOPIC, KIND, queue=100)))
            process = await _process(master.address, NEVER)
            _, said = await process.communicate(orders.encode())
            assert process.returncode == 0
            assert (b"warning[KG828]" in said) == bool(expected)
            assert not (await base.graph()).nodes
            while len(stamps) < expected:  # noqa: ASYNC110 - the test looks from outside
                await asyncio.sleep(0.01)
            await base.aclose()
            await following

    asyncio.run(scene())
    assert len(stamps) == expected
    assert all(stamps)


@pytest.mark.parametrize("before", ["", LEFT])
def test_a_robot_that_was_lost_is_stopped_when_it_is_back(before: str) -> None:
    """A process that outlives the watchdog sends zero once the robot responds again, and then exits.

    This also applies to a movement that had just ended: its zero might have been lost with the connection.
    """

    async def scene() -> None:
        async with asyncio.timeout(patient(20)):
            async with Master() as master:
                process = await _process(master.address, NEVER)
                assert process.stdin is not None
                process.stdin.write(MOVED.encode())
                base = await connect(master.address, name="/base")
                async for graph in base.changes():
                    if any(end.name == TOPIC for end in graph.ends):
                        break
                await base.aclose()
            _, said = await process.communicate(f'{before}["owe", "{TOPIC}", 1]\n["end"]\n'.encode())
            assert b"was lost while it moved" in said
            async with Master(port=int(master.address.rpartition(":")[2])) as master:
                base = await connect(master.address, name="/base")
                received = aiter(await base.subscribe(TOPIC, KIND, queue=100))
                for _ in range(5):
                    assert (await anext(received)).value["twist"]["linear"]["x"] == 0
                async for graph in base.changes():
                    if not graph.nodes:
                        break
                await base.aclose()

    asyncio.run(scene())


def test_all_subscribers_that_were_lost_are_waited_for() -> None:
    """Zero is sent once a topic has as many subscribers as before: the lost one need not be the first to be back."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            monitor = await connect(master.address, name="/monitor")
            seen = aiter(await monitor.subscribe(TOPIC, KIND, queue=100))
            process = await _process(master.address, NEVER)
            await process.communicate(f'{MOVED}["owe", "{TOPIC}", 2]\n["end"]\n'.encode())
            async for graph in monitor.changes():
                if any(end.name == TOPIC and end.node.startswith(NODES) for end in graph.ends):
                    break
            base = await connect(master.address, name="/base")
            received = aiter(await base.subscribe(TOPIC, KIND, queue=100))
            for messages in (received, seen):
                for _ in range(5):
                    await anext(messages)
            async for graph in base.changes():
                if not any(node.name.startswith(NODES) for node in graph.nodes):
                    break
            await base.aclose()
            await monitor.aclose()
            assert [one async for one in seen] == []

    asyncio.run(scene())


async def _process(address: str, silence: float) -> Process:
    command = (sys.executable, "-c", "from kg.robot.driving.watchdog import main; main()", address, str(silence))
    return await asyncio.create_subprocess_exec(*command, stdin=PIPE, stdout=PIPE, stderr=PIPE)


def test_a_topic_that_stopped_is_withdrawn() -> None:
    """After the controller has released a topic, its watchdog does not publish it either."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            process = await _process(master.address, NEVER)
            assert process.stdin is not None
            process.stdin.write(MOVED.encode())
            graphs = base.changes()
            while not any(end.name == TOPIC for end in (await anext(graphs)).ends):
                pass
            process.stdin.write((LEFT + WITHDRAWN).encode())
            while any(end.name == TOPIC for end in (await anext(graphs)).ends):
                pass
            _, said = await process.communicate(b'["end"]\n')
            assert not said
            await base.aclose()

    asyncio.run(scene())


def test_silence_sends_zero_and_is_reported_once() -> None:
    """An open pipe without heartbeats stops movements; a topic is watched again when it moves again."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            received = aiter(await base.subscribe(TOPIC, KIND, queue=100))
            process = await _process(master.address, 0.2)
            assert process.stdin is not None
            assert process.stdout is not None
            for _ in range(2):
                process.stdin.write(MOVED.encode())
                assert float(await process.stdout.readline()) > 0.2
                for _ in range(5):
                    assert (await anext(received)).value["twist"]["linear"]["x"] == 0
            out, said = await process.communicate(b"")
            assert out == b""
            assert said.count(b"warning[KG828]") == 2
            await base.aclose()

    asyncio.run(scene())


def test_the_log_of_the_robot_says_why_it_was_stopped() -> None:
    """What the watchdog did is on `/rosout`, for people who do not see the controller's terminal."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            await base.subscribe(TOPIC, KIND, queue=100)
            lines = aiter(await base.subscribe("/rosout", "rosgraph_msgs/Log"))
            process = await _process(master.address, 0.2)
            assert process.stdin is not None
            process.stdin.write(MOVED.encode())
            line = (await anext(lines)).value
            assert (line["level"], line["name"]) == (8, f"/kg_watchdog_{process.pid}")
            assert "zero velocity was sent to `/cmd_vel`" in line["msg"]
            await process.communicate(b"")
            await base.aclose()

    asyncio.run(scene())


def test_heartbeats_keep_a_movement_up() -> None:
    """While the loop of the controller runs nothing is sent, however long the movement takes."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            received = aiter(await base.subscribe(TOPIC, KIND, queue=100))
            silences: list[RobotError] = []
            watchdog = Watchdog(master.address, patient(0.5))
            watchdog.open(silences.append)
            await watchdog.watch_topic(TOPIC, KIND, ZERO)
            listening = asyncio.ensure_future(anext(received))
            with pytest.raises(TimeoutError):
                await asyncio.wait_for(asyncio.shield(listening), 3 * watchdog.silence)
            assert not silences
            watchdog._tasks[0].cancel()  # the heart
            assert (await listening).value["twist"]["linear"]["x"] == 0
            await watchdog.release()
            assert [one.code for one in silences] == ["KG828"]
            await base.aclose()

    asyncio.run(scene())


@pytest.mark.parametrize(("moves", "pause", "ends"), [(True, 0.3, True), (True, 0.0, False), (False, 0.3, False)])
def test_a_controller_notices_its_own_pause(
    monkeypatch: pytest.MonkeyPatch, *, moves: bool, pause: float, ends: bool
) -> None:
    """After its loop was blocked during a movement, a controller ends it before another velocity is sent."""
    now = 100.0
    monkeypatch.setattr("kg.robot.driving.watchdog.time.clock_gettime", lambda _: now)

    async def scene() -> list[str]:
        nonlocal now
        silences: list[RobotError] = []
        watchdog = Watchdog("memory://office", 0.2)
        watchdog.open(silences.append)
        await asyncio.sleep(0)
        if moves:
            await watchdog.watch_topic(TOPIC, KIND, ZERO)
        now += pause
        assert (watchdog.late() is not None) == ends
        while ends and not silences:  # noqa: ASYNC110 - the test looks from outside
            await asyncio.sleep(0.01)
        assert watchdog.late() is None
        await watchdog.release()
        return [one.code for one in silences]

    assert asyncio.run(scene()) == ["KG828"] * ends


def test_a_watchdog_that_is_only_starting_is_not_waited_for() -> None:
    """A command that is over before its watchdog has started ends it at once, before it contacts the master."""
    asked = []

    async def scene() -> None:
        async with asyncio.timeout(patient(20)):
            master = await asyncio.start_server(lambda _, writer: asked.append(writer), "127.0.0.1", 0)
            watchdog = Watchdog(f"ros1://127.0.0.1:{master.sockets[0].getsockname()[1]}")
            beginning = f"import time; time.sleep(3600); {watchdog._command[3]}"
            watchdog._command = (*watchdog._command[:3], beginning, *watchdog._command[4:])
            await watchdog.watch_topic(TOPIC, KIND, ZERO)
            await watchdog.release()
            master.close()

    asyncio.run(scene())
    assert not asked


def test_a_watchdog_ends_with_its_driver() -> None:
    """It runs from the first movement until its release, as a separate node; a robot in memory has none."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            heard = await base.subscribe(TOPIC, KIND, queue=100)
            watchdog = Watchdog(master.address, NEVER)
            await watchdog.release()
            await watchdog.watch_topic(TOPIC, KIND, ZERO)
            async for graph in base.changes():
                if any(end.name == TOPIC for end in graph.ends):
                    break
            await watchdog.release()
            assert not (await base.graph()).nodes
            assert heard.dropped == 0
            in_memory = Watchdog("memory://office")
            await in_memory.watch_topic(TOPIC, KIND, ZERO)
            await in_memory.release()

    asyncio.run(scene())
