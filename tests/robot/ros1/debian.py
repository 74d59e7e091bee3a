"""Debian's ROS 1: its master, nodes written for rospy, and programs, each in a process of its own."""

from __future__ import annotations

import signal
import socket
import subprocess
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from ports import own_port

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["environment", "needs", "needs_debian", "process", "rosmaster", "rospy"]

_PACKAGES = Path("/usr/lib/python3/dist-packages")

_END = """
print("ready")
import os, sys
sys.stdin.read()
rospy.signal_shutdown("the test is over")
os._exit(0)
"""


def needs(*paths: str) -> pytest.MarkDecorator:
    """Skip if a file of Debian's packages is missing."""
    missing = [path for path in paths if not Path(path).exists()]
    return pytest.mark.skipif(bool(missing), reason=f"Debian's ROS 1 is not installed: {', '.join(missing)}")


needs_debian = needs(
    *(f"/usr/bin/{tool}" for tool in ("rosmaster", "rostopic", "rosservice", "rosparam", "rosnode")),
    *(str(_PACKAGES / package) for package in ("rospy", "actionlib", "std_srvs", "geometry_msgs", "move_base_msgs")),
)


def environment(port: int, home: str) -> dict[str, str]:
    """Return the environment of a program of ROS whose master listens on a port."""
    return {
        "PATH": "/usr/bin:/bin",
        "ROS_IP": "127.0.0.1",
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "HOME": home,
        "ROS_HOME": home,
        "LC_ALL": "C.UTF-8",
        "PYTHONDONTWRITEBYTECODE": "1",
        "PYTHONUNBUFFERED": "1",
    }


@contextmanager
def process(port: int, *command: str, stop: int = signal.SIGINT) -> Iterator[subprocess.Popen[str]]:
    """Run a program of ROS, and end it by a signal."""
    with tempfile.TemporaryDirectory() as home:
        started = subprocess.Popen(
            command, env=environment(port, home), text=True, stdin=subprocess.PIPE, stdout=subprocess.PIPE
        )
        try:
            yield started
        finally:
            if stop:
                started.send_signal(stop)
            try:
                started.communicate(timeout=patient(2))
            except subprocess.TimeoutExpired:
                started.kill()
                started.communicate()


@contextmanager
def rospy(port: int, code: str) -> Iterator[subprocess.Popen[str]]:
    """Run a node of rospy until its input is closed on exit; it has to print `ready`."""
    with process(port, "/usr/bin/python3", "-c", code + _END, stop=0) as started:
        assert started.stdout is not None
        assert started.stdout.readline().strip() == "ready"
        yield started


@contextmanager
def rosmaster() -> Iterator[int]:
    """Run a master, and yield its port."""
    with own_port() as port, process(port, "/usr/bin/rosmaster", "--core", "-p", str(port)) as started:
        until = time.monotonic() + patient(5)
        while time.monotonic() < until and started.poll() is None:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", port)) == 0:
                    break
            time.sleep(0.05)
        assert started.poll() is None
        yield port
