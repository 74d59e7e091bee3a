"""A robot that is out of reach while it moves is stopped when it is back, over DDS between two hosts."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from threading import Timer
from typing import TYPE_CHECKING, Final

import pytest

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from patience import patient
from robot import hosts
from robot.dds.domain import domain
from robot.driving import drivable

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.driving.doing import Channel, Command
from kg.robot.ros2 import Ros2Connection
from kg.robot.ros2.middleware import OFFERED

if TYPE_CHECKING:
    from collections.abc import Iterator

TOPIC, KIND = "/cmd_vel", "geometry_msgs/Twist"
ZERO = {"linear": {"x": 0.0}}
ROBOT: Final = "dds://0"
LEASE: Final = "<CycloneDDS><Domain><Discovery><LeaseDuration>{}s</LeaseDuration></Discovery></Domain></CycloneDDS>"


@contextmanager
def process(host: str, lease: int, *arguments: str, errors: int) -> Iterator[subprocess.Popen[str]]:
    """Run Python on a host until it has ended, or for a minute at most; `errors` takes its standard error."""
    paths = os.pathsep.join(map(str, Path(__file__).parents[2:4]))
    environment = {**drivable.clean(), "PYTHONPATH": paths, "CYCLONEDDS_URI": LEASE.format(lease), "KG_WATCHDOG": "60"}
    command = [*hosts.on(host), sys.executable, *arguments]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, env=environment, stdin=pipe, stdout=pipe, stderr=errors, text=True) as started:
        patience = Timer(patient(60), started.kill)
        patience.start()
        try:
            yield started
        finally:
            patience.cancel()
            started.kill()


@pytest.fixture
def cabled() -> Iterator[tuple[str, str]]:
    """Make two hosts with a cable between them."""
    if (why := hosts.missing()) is not None:
        pytest.skip(why)
    with hosts.host("robot") as one, hosts.host("kg") as other, hosts.cable(one, other):
        yield one, other


@pytest.mark.parametrize(("lease", "seconds", "code"), [(4, 600, 1), (60, 3, 0)])
def test_a_robot_gets_zero_when_its_network_is_back(
    cabled: tuple[str, str], lease: int, seconds: int, code: int
) -> None:
    """A robot gets zero if it was lost, or its command has ended, while its cable was pulled."""
    command = ("drivingAtVelocity", "forward=0.5", "--for", str(seconds), "--robot", ROBOT)
    with process(cabled[0], lease, str(drivable.__file__), ROBOT, errors=subprocess.DEVNULL) as started:
        robot = drivable.Drivable(started)
        with process(cabled[1], lease, "-m", "kg", "robot", "do", *command, errors=subprocess.PIPE) as driver:
            robot.until("settled")
            robot.until("speed 0.5")
            hosts.plug(cabled[0], "down")
            _, told = driver.communicate()
            assert driver.returncode == code
            assert f"the robot was lost while it moved; for 60 s, kg tries to send zero to `{TOPIC}`" in told
        hosts.plug(cabled[0], "up")
        robot.until("speed 0")


@pytest.mark.parametrize(
    ("reliability", "message"),
    [("reliable", "no node listens to `/cmd_vel` any more"), ("best_effort", "out of reach")],
)
def test_a_subscriber_that_leaves_is_not_out_of_reach(reliability: str, message: str) -> None:
    """A reliable subscriber has confirmed messages until it left; of another one, nobody can know."""

    async def keep_sending(channel: Channel, command: Command) -> None:
        while True:
            await channel.send(ZERO, command)

    async def scene(address: str) -> None:
        async with asyncio.timeout(patient(20)):
            robot, driver = [await connect(address, name=name) for name in ("/robot", "/driver")]
            assert isinstance(robot, Ros2Connection)
            heard = robot.wire.reader(TOPIC, KIND, replace(OFFERED, reliability=reliability), lambda *_: None)
            channel = Channel(TOPIC, KIND, await driver.advertise(TOPIC, KIND), driver.clock, 200)
            channel.discovered = True
            channel.zero = lambda: ZERO
            command = Command()
            await channel.wait_subscriber(patient(3))
            await channel.send(ZERO, command)
            heard.close()
            with pytest.raises(RobotError, match=message) as error:
                await keep_sending(channel, command)
            assert error.value.code == "KG824"
            await robot.aclose()
            await driver.aclose()

    with domain() as number:
        asyncio.run(scene(f"dds://{number}?settle=1"))
