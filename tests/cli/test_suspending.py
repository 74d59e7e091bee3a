"""`kg robot do` and `run` in a suspended, blocked or killed process: the robot stops, and no work resumes."""

from __future__ import annotations

import signal
import subprocess
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import pytest
from forks import start
from patience import patient
from robot.driving.drivable import BLOCKABLE, clean, drivable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from forks import Forked
    from robot.driving.drivable import Drivable

PIPE = subprocess.PIPE
DO = ("do", "drivingAtVelocity", "forward=0.5", "--for", "600")
GO = ("do", "goingToPose", "x=1", "y=2", "heading=0")
RUN = ("run", "endless.kgp")
PROGRAM = "repeat 9 times\n  move at a velocity  forward: 0.5 m/s for 10 min\nend\n"
TELL = """
import asyncio, os, sys
def tell(*_):
    for task in asyncio.all_tasks():
        task.print_stack()
    sys.stderr.flush()
    os._exit(1)
signal.signal(signal.SIGQUIT, tell)
"""
"""Code run before a process that makes SIGQUIT print where its tasks wait, and end it."""
KG = BLOCKABLE + TELL + "import runpy, sys; sys.argv[0] = 'kg'; runpy.run_module('kg', run_name='__main__')"


@pytest.fixture(params=[1, 2], ids=["ros1", "dds"])
def robot(request: pytest.FixtureRequest) -> Iterator[Drivable]:
    """A robot over ROS 1 or DDS."""
    if request.param == 2:
        pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")
    with drivable(request.param, patient(60)) as found:
        yield found


@contextmanager
def kg(robot: Drivable, folder: Path, *command: str) -> Iterator[Forked | subprocess.Popen[str]]:
    """Run a command that drives the robot; on a busy machine, its own pauses do not count as silence.

    If the robot does not do what a test waits for, the error has the output of the command and where it waits.
    """
    (folder / "endless.kgp").write_text(PROGRAM, encoding="utf-8")
    silence = () if "--watchdog" in command else ("--watchdog", str(patient(0.5)))
    called = ("-c", KG, "robot", *command, *silence, "--robot", robot.address)
    with start(*called, environment=clean(), folder=folder) as process:
        try:
            yield process
        except AssertionError as error:
            process.send_signal(signal.SIGQUIT)
            with suppress(subprocess.TimeoutExpired):  # it is suspended or blocked
                error.add_note("\n".join(process.communicate(timeout=patient(5))))
            raise
        finally:
            process.kill()


@pytest.mark.parametrize(
    ("robot", "command", "pause", "resume"),
    [
        (1, DO, signal.SIGSTOP, signal.SIGCONT),
        (1, RUN, signal.SIGUSR1, signal.SIGUSR2),
        (2, DO, signal.SIGUSR1, signal.SIGUSR2),
        (2, RUN, signal.SIGSTOP, signal.SIGCONT),
    ],
    indirect=["robot"],
    ids=["ros1-do-stop", "ros1-run-block", "dds-do-block", "dds-run-stop"],  # each pair of robot, command and pause
)
def test_a_silent_controller_stops_and_does_not_go_on(
    robot: Drivable, tmp_path: Path, command: tuple[str, ...], pause: signal.Signals, resume: signal.Signals
) -> None:
    """The watchdog sends zero for a suspended process or a blocked loop, which exits with KG828 when it resumes."""
    with kg(robot, tmp_path, *command) as process:
        robot.until("settled")
        robot.until("speed 0.5")
        process.send_signal(pause)
        robot.until("speed 0")
        process.send_signal(resume)
        _, err = process.communicate(timeout=patient(20))
    assert process.returncode == 1
    assert "warning[KG828]: the process that drives the robot was silent for" in err
    assert "zero velocity was sent to `/cmd_vel`" in err
    assert "error[KG828]" in err
    assert robot.stands_still()


@pytest.mark.parametrize(("robot", "command"), [(1, DO), (2, RUN)], indirect=["robot"], ids=["ros1-do", "dds-run"])
def test_ctrl_z_stops_at_once(robot: Drivable, tmp_path: Path, command: tuple[str, ...]) -> None:
    """SIGTSTP ends the command like Ctrl-C, with KG828; no watchdog is needed."""
    with kg(robot, tmp_path, *command, "--watchdog", "3600") as process:
        robot.until("settled")
        robot.until("speed 0.5")
        process.send_signal(signal.SIGTSTP)
        _, err = process.communicate(timeout=patient(20))
    assert process.returncode == 1
    assert "error[KG828]: Ctrl-Z ended the command" in err
    assert "warning" not in err
    robot.until("speed 0")
    assert robot.stands_still()


@pytest.mark.parametrize(
    ("robot", "number"),
    [(1, signal.SIGSTOP), (1, signal.SIGTSTP), (2, signal.SIGKILL), (2, signal.SIGUSR1)],
    indirect=["robot"],
    ids=["ros1-stop", "ros1-ctrl-z", "dds-kill", "dds-block"],
)
def test_a_goal_is_cancelled(robot: Drivable, tmp_path: Path, number: signal.Signals) -> None:
    """The goal of a process that is suspended, killed, blocked, or ended by Ctrl-Z is cancelled."""
    with kg(robot, tmp_path, *GO) as process:
        robot.until("goal")
        process.send_signal(number)
        robot.until("cancelled")
