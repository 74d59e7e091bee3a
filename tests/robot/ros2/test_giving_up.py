"""ROS 2 goals that are given up before the first response of the server."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.connections import types_for_tests

pytest.importorskip("zenoh", reason="the extra `zenoh` is not installed")

from robot.zenoh.hub import hub

from kg.errors import RobotError
from kg.robot.clock import SimulatedClock
from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Value


async def _until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(patient(10)):
        while not true():  # noqa: ASYNC110 - a list tells nobody that it grows
            await asyncio.sleep(0.01)


def test_a_goal_that_nobody_waits_for_is_cancelled() -> None:
    """A goal without a response of the server is cancelled at its time limit, and when its client gives up."""

    async def scene(address: str) -> tuple[list[bytes], list[bytes]]:
        one = await connect(address, name="/one", types=types_for_tests(2))
        two = await connect(address, name="/two", types=types_for_tests(2))
        sent: list[bytes] = []
        told: list[bytes] = []

        async def silent(request: Value) -> Value:
            sent.append(bytes(request["goal_id"]["uuid"]))
            never: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
            return await never

        async def cancel(request: Value) -> Value:
            told.append(bytes(request["goal_info"]["goal_id"]["uuid"]))
            return {}

        await two.serve("/count/_action/get_result", "kg_test/Count_GetResult", silent)
        await two.serve("/count/_action/cancel_goal", "action_msgs/CancelGoal", cancel)
        await two.serve("/count/_action/send_goal", "kg_test/Count_SendGoal", silent)
        one.clock = clock = SimulatedClock()  # type: ignore[misc]  # so that nothing is late because the machine is busy
        late = asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": 1}, seconds=2))
        await _until(lambda: len(sent) == len(("late",)))
        clock.set_time(3.0)
        with pytest.raises(RobotError) as error:
            await late
        assert error.value.code == "KG803"
        given = asyncio.ensure_future(one.send_goal("/count", "kg_test/Count", {"until": 2}, seconds=60))
        await _until(lambda: len(sent) == len(("late", "given up")))
        given.cancel()
        await asyncio.gather(given, return_exceptions=True)
        await one.aclose()
        await two.aclose()
        return sent, told

    with hub() as (place, _):
        sent, told = asyncio.run(scene(f"zenoh://{place}?settle=1"))
    assert sent == told


def test_who_waits_for_a_server_learns_that_the_connection_is_closed() -> None:
    """A goal that waits for a server of its action ends with KG803 when the connection is closed."""

    async def scene(address: str) -> str:
        one = await connect(address, name="/one", types=types_for_tests(2))
        waiting = asyncio.ensure_future(one.send_goal("/nobody", "kg_test/Count", {"until": 1}, seconds=3600))
        await asyncio.sleep(0.01)
        await one.aclose()
        with pytest.raises(RobotError) as closed:
            await asyncio.wait_for(waiting, patient(10))
        return closed.value.code

    with hub() as (place, _):
        assert asyncio.run(scene(f"zenoh://{place}?settle=1")) == "KG803"
