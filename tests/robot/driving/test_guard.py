"""The process that stops a robot when the one that moves it is killed."""

from __future__ import annotations

import asyncio
import json
import sys
from asyncio.subprocess import PIPE
from typing import TYPE_CHECKING

import pytest
from patience import patient

from kg.robot.connecting import connect
from kg.robot.driving import Guard
from kg.robot.ros1 import Master

if TYPE_CHECKING:
    from kg.robot.connection import Subscription

ZERO = {"header": {"frame_id": "base"}, "twist": {"linear": {"x": 0.0}}}
TOPIC, KIND = "/cmd_vel", "geometry_msgs/TwistStamped"


MOVED = f"{json.dumps([TOPIC, KIND, ZERO])}\n"
LEFT = f'["{TOPIC}", "", null]\n'


@pytest.mark.parametrize(
    ("orders", "expected"),
    [
        (MOVED, 5),
        (MOVED + "null\n", 0),
        (MOVED + LEFT, 0),
        (MOVED + LEFT + MOVED, 5),
        (f'["/arm", "own_msgs/Nobody", {{}}]\n{MOVED}', 5),
        (f'{MOVED}["/arm", "geome', 5),
    ],
)
def test_a_broken_pipe_sends_zero(orders: str, expected: int) -> None:
    """What moves when the pipe ends gets zero commands of now; what stands still, or was said farewell to, none."""
    stamps: list[int] = []

    async def follow(heard: Subscription) -> None:
        async for one in heard:
            header = one.value["header"]
            stamps.append(header["stamp"]["sec"])

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            following = asyncio.ensure_future(follow(await base.subscribe(TOPIC, KIND, queue=100)))
            command = (sys.executable, "-c", "from kg.robot.driving.guard import main; main()", master.address)
            process = await asyncio.create_subprocess_exec(*command, stdin=PIPE)
            await process.communicate(orders.encode())
            assert process.returncode == 0
            assert not (await base.graph()).nodes
            while len(stamps) < expected:  # noqa: ASYNC110 - the test looks from outside
                await asyncio.sleep(0.01)
            await base.aclose()
            await following

    asyncio.run(scene())
    assert len(stamps) == expected
    assert all(stamps)


def test_a_guard_that_is_only_beginning_is_not_waited_for() -> None:
    """A command that is over before its guard has begun ends it at once: it does not even ask for the master."""
    asked = []

    async def scene() -> None:
        async with asyncio.timeout(patient(20)):
            master = await asyncio.start_server(lambda _, writer: asked.append(writer), "127.0.0.1", 0)
            guard = Guard(f"ros1://127.0.0.1:{master.sockets[0].getsockname()[1]}")
            beginning = f"import time; time.sleep(3600); {guard._command[3]}"
            guard._command = (*guard._command[:3], beginning, guard._command[4])
            await guard.watch(TOPIC, KIND, ZERO)
            await guard.release()
            master.close()

    asyncio.run(scene())
    assert not asked


def test_a_guard_ends_with_its_driver() -> None:
    """It is there from the first movement until it is released, as a node of its own; a robot in memory has none."""

    async def scene() -> None:
        async with Master() as master, asyncio.timeout(patient(20)):
            base = await connect(master.address, name="/base")
            heard = await base.subscribe(TOPIC, KIND, queue=100)
            guard = Guard(master.address)
            await guard.release()
            await guard.watch(TOPIC, KIND, ZERO)
            async for graph in base.changes():
                if any(end.name == TOPIC for end in graph.ends):
                    break
            await guard.release()
            assert not (await base.graph()).nodes
            assert heard.dropped == 0
            in_memory = Guard("memory://office")
            await in_memory.watch(TOPIC, KIND, ZERO)
            await in_memory.release()

    asyncio.run(scene())
