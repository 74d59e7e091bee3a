"""`kg serve --robot` suspended or blocked while a program runs: the robot stops and stays stopped."""

from __future__ import annotations

import signal
import time
from threading import Thread
from typing import TYPE_CHECKING

import httpx
import pytest
from patience import patient
from robot.driving.drivable import BLOCKABLE, drivable
from serving import TOKEN, robot_told, served

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Iterator
    from pathlib import Path

    from robot.driving.drivable import Drivable

PROGRAM = "repeat 9 times\n  move at a velocity forward: 0.5 m/s for 10 min\nend\n"


@pytest.fixture(params=[1, 2], ids=["ros1", "dds"])
def robot(request: pytest.FixtureRequest) -> Iterator[Drivable]:
    """A robot over ROS 1 or DDS."""
    if request.param == 2:
        pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")
    with drivable(request.param, patient(30)) as found:
        yield found


def _resume(process: subprocess.Popen[str], number: signal.Signals) -> None:
    """Resume a process, repeatedly if needed: Ctrl-Z suspends it some time after the robot stops."""
    while process.poll() is None:
        process.send_signal(number)
        time.sleep(0.2)


@pytest.mark.parametrize(
    ("robot", "pause", "resume"),
    [
        (1, signal.SIGSTOP, signal.SIGCONT),
        (2, signal.SIGTSTP, signal.SIGCONT),
        (1, signal.SIGUSR1, signal.SIGUSR2),
    ],
    indirect=["robot"],
    ids=["ros1-stop", "dds-ctrl-z", "ros1-block"],
)
def test_a_silent_server_stops_the_robot(
    robot: Drivable, store: Path, pause: signal.Signals, resume: signal.Signals
) -> None:
    """The robot gets zero; when the server resumes its program has failed, and nothing moves."""
    with served(store, before=BLOCKABLE, log="off", token=TOKEN, robot=robot.address) as server:
        headers = {"Authorization": f"Bearer {TOKEN}"}
        with httpx.Client(base_url=server.address, headers=headers, timeout=patient(20)) as client:
            robot_told(client, "connected", "robot")
            assert client.post("/robot/run", json={"text": PROGRAM}).is_success
            robot.until("settled")
            robot.until("speed 0.5")
            server.process.send_signal(pause)
            robot.until("speed 0")
            resuming = Thread(target=_resume, args=(server.process, resume), daemon=True)
            resuming.start()
            robot_told(client, "failed")
        server.process.kill()
    assert robot.stands_still()
