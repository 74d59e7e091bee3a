"""Code converted from programs, run by Debian's rospy on the simulated robots."""

from __future__ import annotations

import asyncio
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.ros1.debian import environment, needs, needs_debian, rosmaster

from kg.evaluate.exercises import Robot, exercises, missed, program_of
from kg.robot.connecting import connect
from kg.robot.live import infer
from kg.robot.programs.converting import convert
from kg.robot.simulation.running import Choice, opened, running
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.evaluate.exercises import Variant

pytest.importorskip("pybullet", reason="worlds need pybullet")
pytest.importorskip("cv2", reason="tags need OpenCV")

PACKAGES = "/usr/lib/python3/dist-packages"
needs_messages = needs(f"{PACKAGES}/move_base_msgs", f"{PACKAGES}/actionlib", f"{PACKAGES}/nav_msgs")


async def code_for(variant: Variant, address: str) -> str:
    """Return the code of a program for the robot at an address."""
    face = await connect(address, name="/kg")
    try:
        capabilities = infer(await face.graph(), Settings(), address=address)
    finally:
        await face.aclose()
    return convert(program_of(variant), capabilities, to="rospy")


async def run(code: str, port: int, home: str) -> int | None:
    """Run code with Debian's Python; return its exit code."""
    path = Path(home) / "program.py"
    path.write_text(code, encoding="utf-8")
    process = await asyncio.create_subprocess_exec(
        "/usr/bin/python3", str(path), env=environment(port, home), stdout=sys.stderr.fileno()
    )
    try:
        await asyncio.wait_for(process.wait(), patient(60))
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()
    return process.returncode


@pytest.mark.ros
@needs_debian
@needs_messages
@pytest.mark.parametrize(("number", "robot"), [(1, "office")])
def test_the_code_reaches_the_goal_of_the_program(number: int, robot: Robot) -> None:
    """A rospy node written by kg makes the robot do the same as the program."""
    variant = exercises()[number - 1].of(robot)

    async def carried_out(port: int, home: str) -> list[str]:
        choice = Choice(robot, f"ros1://127.0.0.1:{port}", speed=4.0)
        async with opened(choice) as (simulation, address), running(simulation):
            code = await code_for(variant, address)
            assert await run(code, port, home) == 0
            return missed(variant, simulation.world)

    with rosmaster() as port, tempfile.TemporaryDirectory() as home:
        assert asyncio.run(carried_out(port, home)) == []
