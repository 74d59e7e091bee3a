"""The commands with Debian's ROS 1: its master, and nodes written for rospy."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from cli.program import Program
from patience import patient
from robot.ros1.debian import needs, needs_debian, rosmaster, rospy

from kg.errors import Exit

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

pytestmark = [pytest.mark.ros, needs_debian, needs("/usr/lib/python3/dist-packages/nav_msgs")]

_BASE = """
import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
rospy.init_node("base")
odometry = rospy.Publisher("/odom", Odometry, queue_size=1)
commands = rospy.Subscriber("/cmd_vel", Twist, lambda message: None)
"""
_LASER = """
import rospy
from sensor_msgs.msg import LaserScan
rospy.init_node("laser")
scan = rospy.Publisher("/scan", LaserScan, queue_size=1)
"""


@pytest.fixture
def master() -> Iterator[int]:
    """Yield the port of a master with one node."""
    with rosmaster() as port, rospy(port, _BASE):
        yield port


def test_a_real_robot_is_asked_what_it_can_do(master: int, tmp_path: Path) -> None:
    """Without a store, capabilities come from the graph of a real master, each explained down to the peer."""
    kg = Program(tmp_path)
    address = f"ros1://127.0.0.1:{master}"
    run = kg("robot", "capabilities", "--robot", address, "--json")
    assert run.code == Exit.OK, run.err
    found = {one["name"]: one for one in map(json.loads, run.out.splitlines())}
    assert found["drivingAtVelocity"]["ways"][0]["node"] == "/base"
    assert found["sensingPose"]["ways"][0]["name"] == "/odom"
    why = kg("robot", "capabilities", "--robot", address, "--why", "sensingPose")
    assert "/base at http://127.0.0.1:" in why.out
    assert "seen since 20" in why.out


def test_a_real_robot_is_kept_in_step(master: int, tmp_path: Path) -> None:
    """A joining and leaving node is reported with its capabilities; Ctrl-C leaves the graph, marked as ended."""
    command = [sys.executable, "-m", "kg", "robot", "watch", "--name", "debian", "--json"]
    surroundings = {**os.environ, "KG_ROBOT": f"ros1://127.0.0.1:{master}"}
    with subprocess.Popen(command, cwd=tmp_path, env=surroundings, stdout=subprocess.PIPE, text=True) as watching:
        try:
            _wait(watching, "kept", None)
            with rospy(master, _LASER):
                _wait(watching, "capability", ("came", "laserScanning"))
            _wait(watching, "capability", ("went", "laserScanning"))
        finally:
            watching.send_signal(signal.SIGINT)
        assert watching.wait(patient(20)) == Exit.INTERRUPTED
    kg = Program(tmp_path)
    assert "/base" in kg("instances", "robot/debian").out
    query = kg("query", "ASK { ?s a rnkg:RunningSystem ; rnkg:seenUntil ?t }")
    assert "true" in query.out


def _wait(watching: subprocess.Popen[str], event: str, what: tuple[str, str] | None) -> None:
    """Read the output until an event."""
    assert watching.stdout is not None
    for line in watching.stdout:
        told = json.loads(line)
        if told["event"] == event and what in {None, (told.get("change"), told.get("name"))}:
            return
    raise AssertionError(f"{event} {what}")
