"""Converted programs stop the robot however they end: signals, errors, the end of the program, `rosnode kill`.

Those for rospy run in Debian's ROS 1, those for rclpy on a stand-in that aborts in the same cases as rclpy.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xmlrpc.client import ServerProxy

import pytest
from msgspec.structs import replace
from patience import patient
from robot.programs.debian import SYSTEM, has_ros, ros
from robot.programs.trolley import CAPABILITIES

from kg.robot.capability import Capability, Way
from kg.robot.programs.converting import convert
from kg.robot.programs.parse import parse

if TYPE_CHECKING:
    from collections.abc import Iterator

TESTS = Path(__file__).parents[2]
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]
needs_ros = pytest.mark.skipif(not has_ros(), reason="Debian's ROS 1 (rospy, rosmaster, move_base_msgs) is missing")

MOVING = "move at a velocity  forward: 1 m/s"
TOGETHER = 'at the same time\n  move at a velocity  forward: 1 m/s\nalso\n  wait 100 s\n  log "late"\nend'
GOING = "go to a pose  x: 9 m"
WAITING = Capability(
    iri="#waiting",
    name="waiting",
    label="have it wait",
    modality="write",
    ways=(Way(kind="service", name="/wait", type="std_srvs/Trigger", node="/trolley"),),
)


AS_IN_A_TERMINAL = "--default-signal=INT,TERM,HUP"
"""Programs get signals even if the tests ignore them."""


@contextmanager
def started(command: list[str], environment: dict[str, str]) -> Iterator[subprocess.Popen[str]]:
    """Run a program, and kill it if it does not exit."""
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, env=environment, text=True, stdout=pipe, stderr=pipe)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


# --- rospy


@pytest.fixture(scope="module")
def trolley(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[dict[str, str], Path]]:
    """A trolley in ROS 1: the environment of further nodes, and the file of its received commands."""
    with ros(tmp_path_factory.mktemp("ros")) as running:
        yield running


def told(said: Path, since: int, line: str) -> list[str]:
    """Wait until the trolley has received a command; return the commands so far."""
    end = time.monotonic() + patient(15)
    while line not in (lines := said.read_text(encoding="utf-8").splitlines()[since:]):
        assert time.monotonic() < end, lines
        time.sleep(0.02)
    return lines


@contextmanager
def rospy_program(
    text: str, trolley: tuple[dict[str, str], Path], folder: Path
) -> Iterator[tuple[subprocess.Popen[str], Path, int]]:
    """Run a program; yield its process, and the commands of the trolley so far."""
    environment, said = trolley
    known = replace(CAPABILITIES, capabilities=(*CAPABILITIES.capabilities, WAITING))
    file = folder / "program.py"
    file.write_text(convert(parse(f'program "ending"\n{text}'), known, to="rospy"), encoding="utf-8")
    since = len(said.read_text(encoding="utf-8").splitlines())
    with started(["/usr/bin/env", AS_IN_A_TERMINAL, SYSTEM, str(file)], environment) as process:
        yield process, said, since


@pytest.mark.ros
@needs_ros
@pytest.mark.parametrize("text", [MOVING, TOGETHER])
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_stops_the_robot_in_ros_1(
    number: signal.Signals, text: str, trolley: tuple[dict[str, str], Path], tmp_path: Path
) -> None:
    """The last command of the robot is zero; the exit code is the signal's, without a traceback."""
    with rospy_program(text, trolley, tmp_path) as (process, said, since):
        told(said, since, "speed 1")
        process.send_signal(number)
        output, errors = process.communicate(timeout=patient(10))
        assert told(said, since, "speed 0")[-1] == "speed 0"
    assert "Traceback" not in output + errors
    assert process.returncode == 128 + number


@pytest.mark.ros
@needs_ros
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_cancels_the_goal_in_ros_1(
    number: signal.Signals, trolley: tuple[dict[str, str], Path], tmp_path: Path
) -> None:
    """A running goal is cancelled."""
    with rospy_program(GOING, trolley, tmp_path) as (process, said, since):
        told(said, since, "going")
        process.send_signal(number)
        output, errors = process.communicate(timeout=patient(10))
        told(said, since, "cancelled")
    assert "Traceback" not in output + errors
    assert process.returncode == 128 + number


@pytest.mark.ros
@needs_ros
def test_a_signal_ends_the_wait_for_a_service(trolley: tuple[dict[str, str], Path], tmp_path: Path) -> None:
    """A program waiting for an unresponsive service can be interrupted."""
    with rospy_program("have it wait", trolley, tmp_path) as (process, said, since):
        told(said, since, "called")
        process.send_signal(signal.SIGTERM)
        output, errors = process.communicate(timeout=patient(10))
    assert "Traceback" not in output + errors
    assert process.returncode == 128 + signal.SIGTERM


@pytest.mark.ros
@needs_ros
def test_a_node_that_is_killed_stops_the_robot(trolley: tuple[dict[str, str], Path], tmp_path: Path) -> None:
    """`rosnode kill` ends the program with a zero, before its topics are closed."""
    with rospy_program(MOVING, trolley, tmp_path) as (process, said, since):
        told(said, since, "speed 1")
        master = ServerProxy(trolley[0]["ROS_MASTER_URI"])
        node: Any = master.lookupNode("/test", "/ending")
        with suppress(OSError):  # it may be gone before it answers
            ServerProxy(node[2]).shutdown("/test", "as rosnode kill does")
        output, errors = process.communicate(timeout=patient(10))
        assert told(said, since, "speed 0")[-1] == "speed 0"
    assert "Traceback" not in output + errors


# --- rclpy


def action(name: str) -> Capability:
    """Return a capability to go to a pose by an action of this name."""
    going = next(one for one in CAPABILITIES.capabilities if one.name == "goingToPose")
    fields = {"x": "pose.pose.position.x"}
    way = Way(kind="action", name=name, type="nav2_msgs/NavigateToPose", node="/nav", fields=fields)
    return replace(going, ways=(way,))


@contextmanager
def rclpy_program(
    text: str, folder: Path, name: str = "/go", signals: str = AS_IN_A_TERMINAL
) -> Iterator[subprocess.Popen[str]]:
    """Run a program on the stand-in."""
    file = folder / "program.py"
    others = tuple(one for one in CAPABILITIES.capabilities if one.name != "goingToPose")
    known = replace(CAPABILITIES, capabilities=(*others, action(name)))
    file.write_text(convert(parse(f'program "ending"\n{text}'), known, to="rclpy"), encoding="utf-8")
    messages = ["geometry_msgs/Twist", "nav2_msgs/action/NavigateToPose"]
    command = ["/usr/bin/env", signals, sys.executable, "-m", "robot.programs.rclpy_standin", str(file), *messages]
    with started(command, {**os.environ, "PYTHONPATH": str(TESTS)}) as process:
        yield process


def until(process: subprocess.Popen[str], begin: str) -> None:
    """Wait until a program prints a line with one of these beginnings."""
    assert process.stdout is not None
    assert process.stderr is not None
    for line in process.stdout:
        if line.startswith(begin):
            return
    raise AssertionError(process.stderr.read())


def speeds(output: str) -> list[float]:
    """Return the speeds received by the robot."""
    lines = (line.partition(" ") for line in output.splitlines())
    return [json.loads(value)["linear"]["x"] for topic, _, value in lines if topic == "/cmd_vel"]


@pytest.mark.parametrize("text", [MOVING, TOGETHER])
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_stops_the_robot_in_ros_2(number: signal.Signals, text: str, tmp_path: Path) -> None:
    """The last command of the robot is zero; the exit code is the signal's: rclpy does not abort."""
    with rclpy_program(text, tmp_path) as process:
        until(process, "/cmd_vel")
        process.send_signal(number)
        output, errors = process.communicate(timeout=patient(10))
    assert speeds(output)[-1] == 0
    assert errors == ""
    assert process.returncode == 128 + number


@pytest.mark.parametrize(("name", "seen"), [("/go", "accepted"), ("/late", "goal")])
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_cancels_the_goal_in_ros_2(number: signal.Signals, name: str, seen: str, tmp_path: Path) -> None:
    """A running goal is cancelled, and so is one that the server accepts after the program has given it up."""
    with rclpy_program(GOING, tmp_path, name) as process:
        until(process, seen)
        process.send_signal(number)
        output, errors = process.communicate(timeout=patient(10))
    assert "cancel" in output.splitlines()
    assert errors == ""
    assert process.returncode == 128 + number


def test_the_end_of_a_program_is_no_abort(tmp_path: Path) -> None:
    """A program that finishes exits with 0."""
    with rclpy_program(f"{MOVING} for 100 ms", tmp_path) as process:
        output, errors = process.communicate(timeout=patient(10))
    assert speeds(output)[-1] == 0
    assert errors == ""
    assert process.returncode == 0


def test_an_error_is_no_abort(tmp_path: Path) -> None:
    """A program that fails reports the error, stops the robot, and exits with 1."""
    with rclpy_program(f"{MOVING} for 100 ms\n{GOING} within 100 ms", tmp_path) as process:
        output, errors = process.communicate(timeout=patient(10))
    assert speeds(output)[-1] == 0
    assert "TimeoutError" in errors
    assert process.returncode == 1


def test_a_signal_that_the_caller_ignores_is_ignored(tmp_path: Path) -> None:
    """Under `nohup` a program continues when the terminal is closed."""
    with rclpy_program(f"{MOVING} for 300 ms", tmp_path, signals="--ignore-signal=HUP") as process:
        until(process, "/cmd_vel")
        process.send_signal(signal.SIGHUP)
        process.communicate(timeout=patient(10))
    assert process.returncode == 0
