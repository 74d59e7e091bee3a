"""`kg robot read` and `kg robot do`."""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
from contextlib import ExitStack
from threading import Timer
from typing import TYPE_CHECKING, Any

import pytest
from forks import start
from patience import patient
from robot.driving.drivable import MODULES
from robot.driving.rover import CAPABILITIES, rover, until
from robot.programs import trolley

from kg.cli.commands import robot_driving
from kg.cli.commands.robot_driving import Doing, Reading, write_feedback
from kg.cli.interruptible import interruptible
from kg.errors import KgError, RobotError, UsageError
from kg.robot.driving import find
from kg.robot.programs.places import TOPIC
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from robot.driving.rover import Rover

ONCE: dict[str, Any] = {"once": False, "count": None, "seconds": None, "rate": None, "way": None, "json": True}
EARNEST: dict[str, Any] = {
    "keep": None,
    "timeout": None,
    "way": None,
    "dry_run": False,
    "exclusive": False,
    "json": True,
}
ROBOT = (subprocess.DEVNULL, subprocess.PIPE, None)
"""Streams of a robot, whose output is read."""
ROVER = """
import asyncio, sys
from kg.robot.connecting import connect
from kg.robot.ros1 import Master

async def main():
    async with Master() as master:
        node = await connect(master.address, name="/rover")
        speeds = await node.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=1000)
        print(master.address, flush=True)
        async for one in speeds:
            print(one.value["linear"]["x"], flush=True)

asyncio.run(main())
"""
NODE = """
import asyncio, sys
from kg.robot.connecting import connect

async def main():
    node = await connect(sys.argv[1], name="/rover")
    speeds = await node.subscribe("/cmd_vel", "geometry_msgs/Twist", queue=1000)
    print("ready", flush=True)
    async for one in speeds:
        print(one.value["linear"]["x"], flush=True)

asyncio.run(main())
"""
MASTER = """
import asyncio
from kg.robot.ros1 import Master

async def main():
    async with Master() as master:
        print(master.address, flush=True)
        await asyncio.Event().wait()

asyncio.run(main())
"""


def _play(monkeypatch: pytest.MonkeyPatch, scene: Callable[[Rover], Awaitable[None]]) -> None:
    """Play a scene with a rover in memory, which the commands connect to."""

    async def play() -> None:
        async with rover() as robot:
            monkeypatch.setattr(robot_driving, "address_of", lambda _: robot.bus.address)
            monkeypatch.setattr(robot_driving, "infer", lambda *_, **__: CAPABILITIES)
            await scene(robot)

    asyncio.run(play())


async def _read(name: str, **options: Any) -> None:
    await robot_driving._read(Settings(), name, Reading.of(**{**ONCE, **options}))


async def _do(name: str, *values: str, **options: Any) -> None:
    await robot_driving._do(Settings(), name, Doing.of(values, **{**EARNEST, **options}))


def test_values_are_lines_of_json(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Each value is a line; missing and non-finite numbers are null."""

    async def scene(robot: Rover) -> None:
        reading = asyncio.ensure_future(_read("laserScanning", count="2"))
        await robot.tell("/scan", "sensor_msgs/LaserScan", {})
        await until(lambda: robot.publications["/scan"].peers)
        for nearest in (0.5, float("inf")):
            value = {"ranges": [nearest], "angle_increment": 1.0, "range_max": 9.0}
            await robot.tell("/scan", "sensor_msgs/LaserScan", value)
        await reading

    _play(monkeypatch, scene)
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines == [{"nearest": 0.5, "ahead": 0.5}, {"nearest": None, "ahead": None}]


def test_bytes_of_a_message(capsys: pytest.CaptureFixture[str]) -> None:
    """An identity is written in hexadecimal, an image as its length."""
    robot_driving.write_message({"uuid": bytes(range(16)), "data": bytes(17)})
    assert json.loads(capsys.readouterr().out) == {"uuid": "000102030405060708090a0b0c0d0e0f", "data": "17 bytes"}


def test_values_are_words_on_a_terminal(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A terminal shows names, rounded numbers and units."""

    async def scene(robot: Rover) -> None:
        monkeypatch.setattr("kg.cli.commands.robot_driving.terminal", lambda: True)
        reading = asyncio.ensure_future(_read("sensing where it is", once=True, json=False))
        await robot.tell("/odom", "nav_msgs/Odometry", {})
        await until(lambda: robot.publications["/odom"].peers)
        await robot.tell("/odom", "nav_msgs/Odometry", {"pose": {"pose": {"position": {"x": 1 / 3}}}})
        await reading

    _play(monkeypatch, scene)
    assert capsys.readouterr().out == "x    0.333 m   heading    0.000 rad\n"


def test_reading_ends_after_its_time(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """After --seconds, reading succeeds if a value was received; otherwise it is KG825."""

    async def scene(_: Rover) -> None:
        await _read("measuring", rate="100", seconds="0.2")
        monkeypatch.setattr(robot_driving, "_FIRST", 0.1)
        with pytest.raises(RobotError) as nothing:
            await _read("sensingPose", seconds="0.1")
        assert nothing.value.code == "KG825"

    _play(monkeypatch, scene)
    assert capsys.readouterr().out.splitlines()[0] == '{"remark": "twice"}'


def test_something_is_done(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A movement, a service and a goal: feedback during the work, and the result at the end."""

    async def scene(robot: Rover) -> None:
        await _do("driving", "forward=20cm/s", keep="0.1")
        await until(lambda: robot.speeds()[-1:] == [0.0])
        assert robot.speeds()[0] == 0.2
        await _do("doubling", "value = 2")
        await _do("counting", "until=1", timeout="60")

    _play(monkeypatch, scene)
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert lines[0]["ended"] == "done"
    assert lines[1]["values"] == {"value": 4.0, "remark": "twice"}
    assert lines[2:] == [{"feedback": {"now": 1}}, {"ended": "done", "sent": 1, "values": {"reached": 1}}]


def test_what_was_done_in_words(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """A terminal shows in words what was sent, or would be."""

    async def scene(_: Rover) -> None:
        monkeypatch.setattr("kg.cli.commands.robot_driving.terminal", lambda: True)
        await _do("driving", "forward=0.2", keep="2", dry_run=True, json=False)
        await _do("driving", keep="0.01", json=False)
        await _do("counting", "until=1", json=False)

    _play(monkeypatch, scene)
    said = capsys.readouterr()
    assert "geometry_msgs/Twist:\n  linear:\n    x: 0.200\n" in said.out
    assert "would send to the topic /cmd_vel of /rover 20 times a second for 2 s" in said.err
    assert "sent 1 message to /cmd_vel, then a zero command" in said.err
    assert "/count is done" in said.err
    assert "now        1" in said.err
    assert "now" not in said.out


def test_a_goal_by_the_name_of_a_place(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """A place of a file or of the robot stands for its coordinates; the file takes precedence."""
    (tmp_path / "own.toml").write_text("kitchen = { x = 3, y = 1 }", encoding="utf-8")
    settings = Settings(places=str(tmp_path / "own.toml"))

    async def scene(robot: Rover) -> None:
        monkeypatch.setattr(robot_driving, "infer", lambda *_, **__: trolley.CAPABILITIES)
        publication = await robot.node.advertise(TOPIC, "std_msgs/String", latch=True)
        await publication.publish({"data": "kitchen = { x = 8, y = 8 }\nlab = { x = 5, y = 2 }"})
        for place in ("kitchen", "lab"):
            await robot_driving._do(settings, "goingToPose", Doing.of([f"at={place}"], **{**EARNEST, "dry_run": True}))

    _play(monkeypatch, scene)
    plans = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    found = [plan["message"]["target_pose"]["pose"]["position"] for plan in plans]
    assert [(one["x"], one["y"]) for one in found] == [(3.0, 1.0), (5.0, 2.0)]


def test_only_who_names_a_place_needs_the_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A missing file of places does not affect commands without places."""
    settings = Settings(places=str(tmp_path / "gone.toml"))

    async def scene(robot: Rover) -> None:
        await robot_driving._do(settings, "driving", Doing.of(["forward=0.2"], **{**EARNEST, "keep": "0.1"}))
        await until(lambda: robot.speeds()[-1:] == [0.0])
        with pytest.raises(UsageError, match=r"gone\.toml` cannot be read"):
            await robot_driving._do(settings, "driving", Doing.of(["at=kitchen"], **{**EARNEST, "keep": "0.1"}))

    _play(monkeypatch, scene)


@pytest.mark.parametrize(
    ("values", "options", "code"),
    [
        (["driving", "forward=0.2"], {}, "KG003"),
        (["doubling", "value=1"], {"keep": "2"}, "KG003"),
        (["driving", "forward=20"], {"keep": "2"}, "KG823"),
        (["drivign"], {"keep": "2"}, "KG821"),
    ],
)
def test_what_is_refused(
    monkeypatch: pytest.MonkeyPatch, values: list[str], options: dict[str, str], code: str
) -> None:
    """Unbounded movements, bounds for finite actions, and refusals by the driver: nothing is sent."""

    async def scene(robot: Rover) -> None:
        with pytest.raises(KgError) as refused:
            await _do(*values, **options)
        assert refused.value.code == code
        assert refused.value.hint
        assert robot.told == {}

    _play(monkeypatch, scene)


@pytest.mark.parametrize("options", [{"once": True, "count": "2"}, {"count": "0"}, {"rate": "-1"}, {"seconds": "x"}])
def test_options_that_make_no_sense(options: dict[str, Any]) -> None:
    """Contradictory or non-numeric options are KG003."""
    with pytest.raises(UsageError):
        Reading.of(**{**ONCE, **options})


@pytest.mark.parametrize("value", ["forward", "=2", " = 2"])
def test_arguments_have_a_name_and_a_value(value: str) -> None:
    """An argument has the form NAME=VALUE."""
    with pytest.raises(UsageError):
        Doing.of([value], **EARNEST)


@pytest.mark.parametrize(
    ("command", "number"),
    [
        (("do", "drivingAtVelocity", "forward=0.5", "--for", "600"), signal.SIGINT),
        (("do", "drivingAtVelocity", "forward=0.5", "--for", "600"), signal.SIGTERM),
        (("run", "endless.kgp"), signal.SIGINT),
        (("run", "endless.kgp"), signal.SIGTERM),
        (("run", "endless.kgp"), signal.SIGHUP),
    ],
)
def test_the_robot_stops_on_a_signal(tmp_path: Path, command: tuple[str, ...], number: signal.Signals) -> None:
    """Ctrl-C, SIGTERM and a closed terminal stop the robot; the exit code is 130."""
    program = "move at a velocity  forward: 0.5 m/s for 10 min\n"
    (tmp_path / "endless.kgp").write_text(program, encoding="utf-8")
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("KG_", "ROS_"))}
    with start("-c", ROVER, streams=ROBOT, environment=clean, folder=tmp_path, modules=MODULES[1]) as robot:
        patience = Timer(patient(20), robot.kill)
        patience.start()
        try:
            assert robot.stdout is not None
            address = robot.stdout.readline().strip()
            called = ("-m", "kg", "robot", *command, "--robot", address)
            started = start(*called, environment=clean, folder=tmp_path)
            assert float(robot.stdout.readline()) == 0.5
            started.send_signal(number)
            out, err = started.communicate(timeout=patient(20))
            assert (started.returncode, "cancelled" in out) == (130, command[0] == "run")
            assert err.strip() == "interrupted"
            while float(robot.stdout.readline()):
                pass
        finally:
            patience.cancel()
            robot.kill()


@pytest.mark.parametrize(
    "command", [("do", "drivingAtVelocity", "forward=0.5", "--for", "600"), ("run", "endless.kgp")]
)
def test_the_robot_stops_when_its_driver_is_killed(tmp_path: Path, command: tuple[str, ...]) -> None:
    """If the process is killed, its watchdog stops the robot and prints nothing afterwards."""
    (tmp_path / "endless.kgp").write_text("move at a velocity  forward: 0.5 m/s for 10 min\n", encoding="utf-8")
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("KG_", "ROS_"))}
    with start("-c", ROVER, streams=ROBOT, environment=clean, folder=tmp_path, modules=MODULES[1]) as robot:
        patience = Timer(patient(20), robot.kill)
        patience.start()
        try:
            assert robot.stdout is not None
            called = ("-m", "kg", "robot", *command, "--robot", robot.stdout.readline().strip())
            with start(*called, environment=clean, folder=tmp_path) as started:
                assert float(robot.stdout.readline()) == 0.5
                started.kill()
            while float(robot.stdout.readline()):
                pass
        finally:
            patience.cancel()
            robot.kill()


def test_a_dead_node_is_told_once(tmp_path: Path) -> None:
    """A killed but still registered node is reported on standard error, with instructions, and in JSON."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("KG_", "ROS_"))}
    with ExitStack() as stack:
        master = start("-c", MASTER, streams=ROBOT, environment=clean, modules=MODULES[1])
        stack.enter_context(master)
        stack.callback(master.kill)
        assert master.stdout is not None
        address = master.stdout.readline().strip()
        robot = start("-c", NODE, address, streams=ROBOT, environment=clean, modules=MODULES[1])
        stack.enter_context(robot)
        assert robot.stdout is not None
        robot.stdout.readline()
        robot.kill()
        robot.wait()
        called = ("-m", "kg", "robot", "do", "drivingAtVelocity", "--for", "1", "--json", "--robot", address)
        with start(*called, environment=clean, folder=tmp_path) as driver:
            out, err = driver.communicate(timeout=patient(20))
        (told,) = map(json.loads, out.splitlines())
        assert (told["event"], told["code"], told["name"]) == ("warning", "KG811", "/rover")
        assert err.count("warning[KG811]: /rover: it listens to `/cmd_vel`") == 1
        assert "rosnode cleanup" in err
        assert "error[KG824]" in err


def test_what_outlives_its_terminal_goes_on(capsys: pytest.CaptureFixture[str]) -> None:
    """If SIGHUP is ignored, as with nohup, it does not stop the command."""

    async def work() -> None:
        os.kill(os.getpid(), signal.SIGHUP)
        await asyncio.sleep(0.05)
        sys.stdout.write("done\n")

    earlier = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        interruptible(work())
    finally:
        signal.signal(signal.SIGHUP, earlier)
    assert capsys.readouterr().out == "done\n"


def test_feedback_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    """A field without a parameter is named by its shortest unique path suffix; headers and quaternions are left out."""
    turned = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    pose = {"position": {"x": 1.0, "y": None}, "reach": {"w": float("inf")}, "orientation": turned}
    feedback = {"base": {"header": {"seq": 1}, "pose": pose}}
    write_feedback(feedback, CAPABILITIES.capabilities[0], json=False)
    assert capsys.readouterr() == ("", "x    1.000   y        -   w     free\n")
    times = {"navigation_time": {"sec": 2}, "time_remaining": {"sec": 9}}
    going = find(trolley.CAPABILITIES, "goingToPose", "write")
    write_feedback({"current_pose": {"pose": pose}, **times}, going, json=False)
    words = "x    1.000 m   y        -   w     free   navigation_time.sec        2   time_remaining.sec        9\n"
    assert capsys.readouterr() == ("", words)
    write_feedback({f"field{number}": 1.0 for number in range(20)}, CAPABILITIES.capabilities[0], json=False)
    line = capsys.readouterr().err
    assert (line.count("\n"), len(line) <= 101, line.endswith("...\n")) == (1, True, True)
    write_feedback(feedback, CAPABILITIES.capabilities[0], json=True)
    assert json.loads(capsys.readouterr().out)["feedback"]["base"]["pose"]["orientation"] == turned


def test_feedback_is_all_there_only_as_data(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A terminal or log gets at most one line of feedback a second; with --json each message is one line."""

    async def scene(_: Rover) -> None:
        monkeypatch.setattr(robot_driving, "monotonic", lambda: 5.0)
        await _do("counting", "until=3", timeout="60", json=False)
        assert capsys.readouterr().err.count("now ") == 1
        await _do("counting", "until=3", timeout="60")

    _play(monkeypatch, scene)
    assert capsys.readouterr().out.count('"feedback"') == 3
