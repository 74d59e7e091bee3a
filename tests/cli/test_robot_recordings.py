"""`kg robot topics`, `read`, `do`, `watch` and `record` with recordings as input and output."""

from __future__ import annotations

import asyncio
import json
import signal
import subprocess
import sys
import time
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from patience import patient
from robot.bag.bags import FORMS, Sent, odometry, write

from kg.errors import Exit
from kg.robot.connecting import connect

if TYPE_CHECKING:
    from pathlib import Path

TALKER = """
import asyncio
from kg.robot.connecting import connect
from kg.robot.ros1 import Master

async def main():
    async with Master() as master:
        node = await connect(master.address, name="/talker")
        texts = await node.advertise("/text", "std_msgs/String", latch=True)
        await texts.publish({"data": "hello"})
        print(master.address, flush=True)
        await node.wait_lost()

asyncio.run(main())
"""


@pytest.fixture
def here(tmp_path: Path) -> Program:
    """The program in a folder without a store."""
    return Program(tmp_path)


@pytest.mark.parametrize("form", FORMS)
def test_topics_of_a_recording_have_counts_and_rates(here: Program, form: str) -> None:
    """Each topic has its type, its publishers, its number of messages and its rate."""
    run = here("robot", "topics", "--robot", write(here.folder, form, odometry(21, every=0.1)))
    node = "/base" if form == "bag" else "/_recorded"
    assert run.out.splitlines()[1:] == [f"/odom\tnav_msgs/Odometry\t{node}\t\t21\t10.5"]


def test_topics_as_json(here: Program) -> None:
    """Each topic is an object with all keys."""
    run = here("robot", "topics", "--json", "--robot", write(here.folder, "bag", odometry(3, every=1.0)))
    assert [json.loads(line) for line in run.out.splitlines()] == [
        {
            "name": "/odom",
            "type": "nav_msgs/Odometry",
            "publishers": ["/base"],
            "subscribers": [],
            "messages": 3,
            "rate": 1.5,
        }
    ]


@pytest.mark.parametrize("form", FORMS)
def test_a_capability_is_read_from_a_recording(here: Program, form: str) -> None:
    """All values are printed, and the command succeeds at the end of the recording."""
    address = write(here.folder, form, odometry(3))
    run = here("robot", "read", "sensingPose", "--robot", address)
    assert run.code == Exit.OK
    assert [json.loads(line)["x"] for line in run.out.splitlines()] == [0.0, 1.0, 2.0]


def test_a_topic_is_read_from_a_recording(here: Program) -> None:
    """Messages of a topic are lines of JSON; a path may contain spaces."""
    folder = here.folder / "my drives"
    folder.mkdir()
    address = write(folder, "bag", [Sent("/text", "std_msgs/String", 0, {"data": "one"})])
    run = here("robot", "read", "/text", "--robot", address)
    assert (run.code, run.out) == (Exit.OK, '{"data": "one"}\n')


def test_a_topic_without_a_message_is_told(here: Program) -> None:
    """A topic without a message before the end is an error."""
    address = write(here.folder, "bag", odometry(2))
    run = here("robot", "read", "/odom", "--robot", f"{address}?start=5")
    assert run.code == Exit.FOUND
    assert "[KG825]" in run.err


def test_a_recording_is_not_driven(here: Program) -> None:
    """Driving a recording is rejected with its code and the reason, whatever its capabilities."""
    run = here("robot", "do", "drivingAtVelocity", "--for", "1", "--robot", write(here.folder, "bag", odometry(1)))
    assert run.code == Exit.FOUND
    assert "[KG851]" in run.err
    assert "is a recording: it can be read, not commanded" in run.err


def test_a_program_longer_than_its_recording_fails(here: Program) -> None:
    """The error has the recording and how to go on, and nothing about a robot that might be moving."""
    (here.folder / "long.kgp").write_text("log x of sensingPose\nwait 1 min\n", "utf-8")
    run = here("robot", "run", "long.kgp", "--robot", write(here.folder, "bag", odometry(3)))
    assert run.code == Exit.FOUND
    assert "drive.bag: the recording has ended" in run.err
    assert "help: Run the command again" in run.err


def test_the_wiring_of_a_recording_is_checked(here: Program) -> None:
    """A recording is stored like a running robot, and `kg lint` finds the near miss in it."""
    other = Sent("/odmo", "nav_msgs/Odometry", 0, node="/other")
    address = write(here.folder, "bag", [*odometry(2), other])
    assert here("robot", "watch", "--once", "--robot", address).code == Exit.OK
    instances = here("instances", "robot/bag/drive.bag")
    assert [line.split("\t")[0] for line in instances.out.splitlines()[1:]] == ["/base", "/other"]
    assert here("lint", "--launch", "robot/bag/drive.bag").code in {Exit.OK, Exit.FOUND}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_a_recording_with_a_complete_file(tmp_path: Path, number: signal.Signals) -> None:
    """Ctrl-C and SIGTERM leave a readable file."""
    with subprocess.Popen([sys.executable, "-c", TALKER], stdout=subprocess.PIPE, text=True) as talker:
        assert talker.stdout is not None
        address = talker.stdout.readline().strip()
        command = [sys.executable, "-m", "kg", "robot", "record", "drive.bag", "/text", "--robot", address]
        with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as recorder:
            assert recorder.stderr is not None
            assert recorder.stderr.readline() == "note: recording /text (std_msgs/String)\n"
            _until_written(tmp_path / "drive.bag")
            recorder.send_signal(number)
            said = recorder.stderr.read()
            assert recorder.wait(patient(10)) == Exit.INTERRUPTED
        talker.kill()
    assert "note: 1 message in 0.0 s: drive.bag" in said
    assert asyncio.run(_values(f"bag://{tmp_path}/drive.bag")) == [{"data": "hello"}]


def test_a_recording_ends_after_its_time(here: Program) -> None:
    """--for ends the recording; its content is listed, and can be read."""
    with subprocess.Popen([sys.executable, "-c", TALKER], stdout=subprocess.PIPE, text=True) as talker:
        assert talker.stdout is not None
        address = talker.stdout.readline().strip()
        run = here("robot", "record", "drive.bag", "/text", "--for", "1", "--json", "--robot", address)
        talker.kill()
    assert run.code == Exit.OK
    assert json.loads(run.out) == {"topic": "/text", "type": "std_msgs/String", "messages": 1, "dropped": 0}
    assert here("robot", "read", "/text", "--robot", "bag://drive.bag").out == '{"data": "hello"}\n'


def test_a_recording_of_nothing_is_an_error(here: Program) -> None:
    """Without messages no file is written, and the error gives the reason."""
    address = write(here.folder, "bag", odometry(1))
    run = here("robot", "record", "none.bag", "/nobody", "--robot", address, "--for", "0.1")
    assert run.code == Exit.FOUND
    assert "[KG825]" in run.err
    assert not (here.folder / "none.bag").exists()


def _until_written(path: Path) -> None:
    until = time.monotonic() + patient(10)
    while not path.exists():
        assert time.monotonic() < until
        time.sleep(0.01)


async def _values(address: str) -> list[dict[str, object]]:
    connection = await connect(address, name="/reader")
    try:
        return [one.value async for one in await connection.subscribe("/text")]
    finally:
        await connection.aclose()
