"""The clock of a simulation and waits for its first time."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from patience import patient

from kg.errors import RobotError
from kg.robot import clock as clocks
from kg.robot.clock import SimulatedClock, WallClock, within
from kg.robot.connecting import connect
from kg.robot.memory import Bus
from kg.robot.ros1 import Master

if TYPE_CHECKING:
    from kg.robot.connection import Value


def test_first_time() -> None:
    """Waiting for a clock to start ends with its first time, or at once if it has one."""

    async def scene() -> None:
        clock = SimulatedClock()
        waiting = asyncio.ensure_future(clock.begun(60))
        await asyncio.sleep(0)
        clock.set_time(42.0)
        await waiting
        await clock.begun(60)

    asyncio.run(scene())


def test_no_time() -> None:
    """Waiting for a clock without time ends at the time limit."""
    clock = SimulatedClock()
    asyncio.run(clock.begun(0.01))
    assert clock.now() == 0


def test_connected_with_time() -> None:
    """A connection to a simulation has its time from the start, so no movement ends prematurely."""

    async def scene() -> None:
        async with Master() as master:
            teller = await connect(master.address, name="/simulator")
            await teller.set_parameter("/use_sim_time", True)  # type: ignore[attr-defined]  # what ROS 1 has
            clock = await teller.advertise("/clock", "rosgraph_msgs/Clock", latch=True)
            await clock.publish({"clock": {"sec": 7, "nanosec": 0}})
            robot = await connect(master.address)
            try:
                assert robot.clock.now() == 7
            finally:
                await robot.aclose()
                await teller.aclose()

    asyncio.run(scene())


def test_no_answer_while_time_stands_still(monkeypatch: pytest.MonkeyPatch) -> None:
    """A service without a response is KG803, even if the time of the simulation is paused."""
    monkeypatch.setattr(clocks, "_STALLED", 0.05)

    async def scene() -> None:
        async def silent(_: Value) -> Value:
            await asyncio.Event().wait()
            return {}

        with Bus("still", clock=SimulatedClock()) as bus:
            await bus.join("/server").serve("/quiet", "std_srvs/Empty", silent)
            with pytest.raises(RobotError) as late:
                async with asyncio.timeout(patient(10)):
                    await bus.join("/client").call("/quiet", "std_srvs/Empty", {}, seconds=5)
            assert late.value.code == "KG803"

    asyncio.run(scene())


def test_what_pauses_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Work that pauses with the simulation may outlast the pause, and ends at its simulated time limit."""
    monkeypatch.setattr(clocks, "_STALLED", 0.01)

    async def scene() -> None:
        clock = SimulatedClock()
        waiting = asyncio.ensure_future(within(clock, 5, asyncio.Event().wait(), pauses=True))
        await asyncio.sleep(0.1)
        assert not waiting.done()
        clock.set_time(6)
        with pytest.raises(TimeoutError):
            await waiting

    asyncio.run(scene())


def test_late_work_has_ended() -> None:
    """At the time limit or after cancellation, the work has cleaned up."""
    cleaned: list[str] = []

    async def work(name: str) -> None:
        try:
            await asyncio.Event().wait()
        finally:
            await asyncio.sleep(0.05)
            cleaned.append(name)

    async def scene() -> None:
        with pytest.raises(TimeoutError):
            await within(WallClock(), 0.01, work("late"))
        assert cleaned == ["late"]
        waiting = asyncio.ensure_future(within(WallClock(), 60, work("given up")))
        await asyncio.sleep(0.01)
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        assert cleaned == ["late", "given up"]

    asyncio.run(scene())
