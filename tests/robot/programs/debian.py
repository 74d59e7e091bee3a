"""A trolley in Debian's ROS 1: a master of its own, and cases/trolley_node.py."""

from __future__ import annotations

import shutil
import socket
import subprocess
import time
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from patience import patient
from ports import own_port

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["SYSTEM", "has_ros", "ros"]

HERE = Path(__file__).parent
SYSTEM = "/usr/bin/python3"


@cache
def has_ros() -> bool:
    """Whether Debian's ROS 1 is installed."""
    modules = "import rospy, actionlib, move_base_msgs.msg, nav_msgs.msg, std_srvs.srv"
    found = Path(SYSTEM).exists() and shutil.which("rosmaster", path="/usr/bin:/bin") is not None
    return found and subprocess.run([SYSTEM, "-c", modules], capture_output=True, check=False).returncode == 0


@contextmanager
def ros(folder: Path) -> Iterator[tuple[dict[str, str], Path]]:
    """Run a master and the trolley; once it is ready, yield the environment of further nodes and its output file."""
    with own_port() as port:
        yield from _running(port, folder)


def _running(port: int, folder: Path) -> Iterator[tuple[dict[str, str], Path]]:
    names = {"ROS_IP": "127.0.0.1", "ROS_MASTER_URI": f"http://127.0.0.1:{port}", "HOME": str(folder)}
    environment = {"PATH": "/usr/bin:/bin", "LC_ALL": "C.UTF-8", "PYTHONUNBUFFERED": "1", **names}
    said = folder / "said.txt"
    with (folder / "master.txt").open("w") as told, said.open("w") as output:
        running = [subprocess.Popen(["/usr/bin/rosmaster", "--core", "-p", str(port)], env=environment, stdout=told)]
        try:
            _listening(port)
            node = [SYSTEM, str(HERE / "cases" / "trolley_node.py")]
            running.append(subprocess.Popen(node, env=environment, stdout=output))
            _ready(said)
            yield environment, said
        finally:
            for process in reversed(running):
                process.terminate()
            for process in running:
                process.wait(patient(20))


def _listening(port: int) -> None:
    end = time.monotonic() + patient(10)
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), 1).close()
        except OSError:
            assert time.monotonic() < end
            time.sleep(0.1)
        else:
            return


def _ready(said: Path) -> None:
    """Wait until the trolley has registered all its topics: an earlier observer would see only some."""
    end = time.monotonic() + patient(20)
    while "ready" not in said.read_text(encoding="utf-8"):
        assert time.monotonic() < end, "the trolley does not start"
        time.sleep(0.05)
