from __future__ import annotations

import asyncio
import os
import re
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from contextlib import suppress
from typing import TYPE_CHECKING, cast

import pytest
from forks import start
from patience import patient
from robot.dds.domain import domain
from robot.ros1.debian import needs_debian, rosmaster

from kg.cli.commands.robot_simulate import chosen
from kg.errors import Exit, RobotError, UsageError
from kg.evaluate.exercises import Robot, Variant, carry_out, exercises, missed, program_of
from kg.robot.connecting import connect
from kg.robot.ros1 import Master
from kg.robot.simulation.drone import State
from kg.robot.simulation.running import Choice, opened, running, simulate
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kg.robot.simulation.running import Simulation

pytest.importorskip("pybullet", reason="worlds need pybullet")
pytest.importorskip("cv2", reason="tags need OpenCV")


@pytest.fixture(scope="module")
def master() -> Iterator[int]:
    """Yield the port of Debian's rosmaster."""
    with rosmaster() as port:
        yield port


async def wrong_of(variant: Variant, simulation: Simulation, address: str) -> list[str]:
    """Run a variant of an exercise; return its failures."""
    wrong = await carry_out(program_of(variant), address, Settings())
    # The program ends when the drone is near the ground, a moment before its rotors are off.
    async with asyncio.timeout(patient(10)):
        while getattr(simulation.world.robot, "state", None) is State.LANDING:  # noqa: ASYNC110 - no event tells of it
            await asyncio.sleep(0.02)
    return wrong + missed(variant, simulation.world)


@pytest.mark.ros
@needs_debian
@pytest.mark.parametrize("robot", ["office", "drone"])
def test_an_exercise_on_a_real_master(master: int, robot: Robot) -> None:
    """Nodes, messages and actions use ROS 1, with the time of the simulation, three times as fast."""
    variant = exercises()[1].of(robot)

    async def carried_out() -> list[str]:
        choice = Choice(robot, f"ros1://127.0.0.1:{master}", speed=3.0, start=variant.start)
        async with opened(choice) as (simulation, address), running(simulation):
            return await wrong_of(variant, simulation, address)

    assert asyncio.run(carried_out()) == []


def test_an_exercise_over_dds() -> None:
    """The drone speaks ROS 2 on a real wire, in the time of the simulation."""
    pytest.importorskip("cyclonedds", reason="DDS needs cyclonedds")
    variant = exercises()[1].of("drone")

    async def carried_out(number: int) -> list[str]:
        choice = Choice("drone", f"dds://{number}", speed=4.0, start=variant.start)
        async with opened(choice) as (simulation, address), running(simulation):
            return await wrong_of(variant, simulation, address)

    with domain() as number:
        assert asyncio.run(carried_out(number)) == []


def test_a_simulation_that_fails_at_the_end_of_what_uses_it() -> None:
    """If the simulation fails at the moment its user finishes, that is an error, and cancels no task."""

    class Failing:
        def __init__(self) -> None:
            self.done: asyncio.Future[None] = asyncio.get_running_loop().create_future()

        async def run(self) -> None:
            self.done.set_result(None)
            raise ValueError("no such wheel")

    async def use() -> None:
        simulation = Failing()
        with pytest.raises(ValueError, match="no such wheel"):
            async with running(cast("Simulation", simulation)):
                await simulation.done
        await asyncio.sleep(0)

    asyncio.run(use())


def test_a_master_of_our_own_ends_with_the_simulation() -> None:
    """A connection in between finds the robot; afterwards the port is closed, and simulated seconds are reported."""

    async def look() -> None:
        begun: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        simulating = asyncio.create_task(simulate(Choice("drone", seconds=3600, speed=2.0), begun.set_result))
        address = await begun
        face = await connect(address, name="/kg")
        nodes = {one.name for one in (await face.graph()).nodes}
        await face.clock.sleep(0.5)
        assert 0 < face.clock.now() < 3600
        await face.aclose()
        simulating.cancel()
        await asyncio.gather(simulating, return_exceptions=True)
        assert {"/ardrone_driver", "/ar_track_alvar", "/simulator"} <= nodes
        with pytest.raises(RobotError) as gone:
            await connect(address, name="/kg")
        assert gone.value.code == "KG802"

    asyncio.run(look())


def test_the_time_of_a_master_is_given_back() -> None:
    """An existing master uses real time again when the simulation has ended."""

    async def look() -> None:
        async with Master() as master:
            await simulate(Choice("drone", master.address, seconds=0.2, speed=None), lambda _: None)
            assert "use_sim_time" not in " ".join(master.parameters.names())

    asyncio.run(look())


def test_a_master_that_is_not_there() -> None:
    """The missing master is reported, and nothing is simulated."""
    with pytest.raises(RobotError) as nobody:
        asyncio.run(simulate(Choice("drone", "ros1://127.0.0.1:9", speed=1.0), lambda _: None))
    assert nobody.value.code == "KG802"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_a_kill_end_it_quietly(number: signal.Signals) -> None:
    """The address and the next command are printed; Ctrl-C and SIGTERM exit with 130 without error messages."""
    process = start("-m", "kg", "robot", "simulate", "drone")
    assert process.stderr is not None
    said = [process.stderr.readline() for _ in range(6)]
    assert re.search(r"drone at ros1://127\.0\.0\.1:\d+, 1 times real time; Ctrl-C ends it", said[0])
    assert "kg robot capabilities --live --robot ros1://" in said[1]
    assert "kg serve --robot ros1://" in said[5]
    process.send_signal(number)
    out, err = process.communicate(timeout=patient(20))
    assert process.returncode == Exit.INTERRUPTED
    assert out == ""
    assert "error" not in err


def test_without_pybullet_the_extra_is_named() -> None:
    """KG840 names the extra to install."""
    hidden = "import sys; sys.modules['pybullet'] = None; from kg.cli.main import run; run()"
    command = [sys.executable, "-c", hidden, "robot", "simulate", "office"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | {"KG_COLOR": "never"})
    assert ended.returncode == Exit.FOUND
    assert "KG840" in ended.stderr
    assert "kg-ros[simulate]" in ended.stderr


def chosen_with(world: str = "office", **given: str | bool | None) -> Choice:
    """Return the result of options."""
    options = {"master": None, "port": "0", "ros2": False, "speed": "1", "seconds": None, "seed": "0"} | given
    return chosen(world, **options)  # type: ignore[arg-type] # texts and truth values as typer gives them


@pytest.mark.parametrize("master", ["http://localhost:11311/", "robot:11311", "robot"])
def test_a_master_is_written_as_a_robot_is(master: str) -> None:
    """Values rejected by --robot are rejected by --master, too, with the right syntax."""
    assert chosen_with(master="ros1://robot:11311").address == "ros1://robot:11311"
    assert chosen_with(master="dds://3").address == "dds://3"
    with pytest.raises(RobotError) as refused:
        chosen_with(master=master)
    assert (refused.value.code, refused.value.exit_code) == ("KG801", Exit.USAGE)


@pytest.mark.parametrize("speed", ["0", "abc", "inf", "-1"])
def test_a_speed_is_a_factor(speed: str) -> None:
    """An invalid speed is reported as a factor, not as a time."""
    with pytest.raises(UsageError, match=f"`--speed {speed}` is not a factor"):
        chosen_with(speed=speed)


def test_the_robot_begins_where_an_exercise_does() -> None:
    """The drone of the third exercise starts hovering; an unknown number is rejected."""
    assert chosen_with().start is None
    assert chosen_with("office", exercise="1").start is None
    start = chosen_with("drone", exercise="3").start
    assert start is not None
    assert start.up == 2.0
    with pytest.raises(UsageError, match="--exercise 5"):
        chosen_with(exercise="5")


def test_the_arm_has_no_exercise() -> None:
    """An exercise of a world without exercises is rejected, with the worlds that have some."""
    with pytest.raises(UsageError, match="--exercise does not go with the world `arm`") as refused:
        chosen_with("arm", exercise="1")
    assert refused.value.hint == "Exercises are of office and drone."


def test_the_port_is_of_our_own_master() -> None:
    """Without a master of our own, a requested port is rejected instead of ignored."""
    assert chosen_with(port="3").port == 3
    assert chosen_with(port="0", ros2=True).port == 0
    for other in ({"ros2": True}, {"master": "dds://3"}):
        with pytest.raises(UsageError, match="--port 3 does not go with"):
            chosen_with(port="3", **other)


def test_options_that_cannot_be_meant() -> None:
    """An unknown world, an invalid speed, and --ros2 with a master of ROS 1 are rejected."""
    for options in (
        {"world": "ofice"},
        {"speed": "fast"},
        {"seconds": "-1"},
        {"ros2": True, "master": "ros1://robot:11311"},
    ):
        with pytest.raises(UsageError):
            chosen_with(**options)
    assert chosen_with(speed="max").speed is None


def seen(address: str) -> str:
    """Return the response of an address, once it responds."""
    until = time.monotonic() + patient(20)
    while True:
        try:
            with urllib.request.urlopen(address, timeout=patient(5)) as answer:  # noqa: S310 - it is of http
                return str(answer.read().decode())
        except urllib.error.HTTPError:
            if time.monotonic() > until:
                raise
            time.sleep(0.2)


def test_a_page_shows_the_robot(tmp_path: Path) -> None:
    """With --page and no store, `kg serve` shows the world from above, and ends with the simulation."""
    command = [sys.executable, "-m", "kg", "robot", "simulate", "drone", "--page"]
    clean = {name: value for name, value in os.environ.items() if not name.startswith("KG_")}
    process = subprocess.Popen(
        command, stderr=subprocess.PIPE, text=True, cwd=tmp_path, env=clean, start_new_session=True
    )
    assert process.stderr is not None
    try:
        told = (re.search(r"(http://\S+robot)\b", line) for line in process.stderr)
        address = next(found.group(1) for found in told if found)
        assert "The drone from above" in seen(f"{address}/view")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=patient(20))
        with pytest.raises(urllib.error.URLError):
            urllib.request.urlopen(address, timeout=patient(10))  # noqa: S310 - it is of http
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
    assert process.returncode == Exit.INTERRUPTED
    assert list(tmp_path.iterdir()) == []
