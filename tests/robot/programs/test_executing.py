"""A program on the robot at an address: preparation before it starts."""

from __future__ import annotations

import asyncio
import threading
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from patience import patient

from kg.robot.capability import Capabilities
from kg.robot.connecting import connect
from kg.robot.memory import Bus
from kg.robot.programs import runner
from kg.robot.programs.parse import parse
from kg.settings import Settings

if TYPE_CHECKING:
    import pytest

    from kg.robot.programs.events import Ended


def test_a_capability_that_is_gone_ends_the_program_at_its_block() -> None:
    """Unrelated nodes come and go; when the moved one is gone, the program fails at its movement."""

    async def scene() -> tuple[list[str], Ended | None]:
        with Bus(uuid4().hex) as bus:
            base, events = bus.join("/base"), list[str]()
            moves = await base.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=10)
            program = parse("move at a velocity forward: 0.1 m/s")
            running = asyncio.ensure_future(
                runner.execute(
                    program, bus.address, Settings(), on_event=lambda event: events.append(event["event"]),
                    on_problems=lambda _: None,
                )
            )  # fmt: skip
            await anext(aiter(moves))
            laser = bus.join("/laser")
            await laser.advertise("/scan", "sensor_msgs/LaserScan")
            await asyncio.sleep(1)
            await laser.aclose()
            assert not running.done()
            await moves.aclose()
            return events, await asyncio.wait_for(running, patient(20))

    events, done = asyncio.run(scene())
    assert events == ["enter", "error", "leave", "failed"]
    assert done is not None
    assert done.problem is not None
    assert (done.problem.path, done.problem.code in {"KG822", "KG824"}) == ("/body/0", True)


def test_time_goes_on_while_it_is_inferred_what_a_robot_can_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages, such as the time of a simulation, are received during inference; no movement ends prematurely."""

    async def scene() -> None:
        loop = asyncio.get_running_loop()

        def inferred(*_: Any, **__: Any) -> Capabilities:
            taken = threading.Event()
            loop.call_soon_threadsafe(taken.set)
            assert taken.wait(20)
            return Capabilities(of="a robot")

        monkeypatch.setattr(runner, "infer", inferred)
        with Bus(uuid4().hex) as bus:
            base = await connect(f"memory://{bus.name}", name="/base")
            program = parse('log "x"')
            done = await runner.execute(
                program, f"memory://{bus.name}", Settings(), on_event=lambda _: None, on_problems=lambda _: None
            )
            await base.aclose()
        assert done is not None

    asyncio.run(scene())
