"""The robot of a server over DDS: nodes with ROS 2 wire names, in a process of their own."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import aclosing
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from repository import ROOT

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from robot.dds.domain import domain

from kg.robot.connecting import connect
from kg.robot.programs.parse import parse
from kg.server.robot.session import Session
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator

    from kg.robot.connection import Connection

PEER = ROOT / "tests/robot/dds/peer.py"
MANAGED = PEER.with_name("managed.py")
PROGRAM = "move at a velocity forward: 0.25 m/s for 60 s"


async def heard(connection: Connection) -> AsyncGenerator[float, None]:
    """Yield the forward speeds received by the peer."""
    subscription = await connection.subscribe("/echo", "geometry_msgs/Twist")
    async for one in subscription:
        yield one.value["linear"]["x"]


async def scene(number: int) -> dict[str, Any]:
    """Run a program on the robot, and stop it; return the reported states."""
    async with Session(f"dds://{number}?settle=2", load({}, environment={})) as session:
        while session.capabilities is None or not session.capabilities.capabilities:  # noqa: ASYNC110 - nothing tells it
            await asyncio.sleep(0.05)
        tester = await connect(f"dds://{number}?settle=1", name="/listener")
        try:
            async with aclosing(heard(tester)) as speeds:
                await session.run(parse(PROGRAM))
                assert await anext(speeds) == 0.25
                await session.stop()
                async for speed in speeds:
                    if speed == 0:
                        break
        finally:
            await tester.aclose()
        return session.status()


def test_programs_run_and_stop_over_dds() -> None:
    """Capabilities are inferred, a program moves the robot, stopping ends it; QoS mismatches are reported."""
    with domain() as number, subprocess.Popen(
        [sys.executable, str(PEER), str(number)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as peer:  # fmt: skip
        assert peer.stdout is not None
        assert peer.stdout.readline() == "ready\n"
        try:
            robot = asyncio.run(asyncio.wait_for(scene(number), patient(60)))
        finally:
            peer.kill()
    assert "drivingAtVelocity" in {one["name"] for one in robot["capabilities"]}
    assert robot["program"]["state"] == "stopped"
    assert [one.partition(":")[0] for one in robot["doubts"]] == ["/scan"]


def test_what_an_inactive_node_would_do_is_told_as_not_available() -> None:
    """A page shows why a capability is unavailable, and its availability once the node is active."""

    async def scene(number: int, node: subprocess.Popen[str]) -> list[str | None]:
        async with Session(f"dds://{number}?settle=1", load({}, environment={})) as session:

            def why() -> list[str | None]:
                known = session.status()["capabilities"]
                return [one.get("unavailable") for one in known if one["name"] == "drivingAtVelocity"]

            while why() != ["/base is inactive"]:  # noqa: ASYNC110 - nothing tells it
                await asyncio.sleep(0.05)
            assert node.stdin is not None
            print(3, file=node.stdin, flush=True)
            while why() != [None]:  # noqa: ASYNC110 - the same
                await asyncio.sleep(0.05)
            return why()

    with domain() as number, subprocess.Popen(
        [sys.executable, str(MANAGED), str(number)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    ) as node:  # fmt: skip
        assert node.stdout is not None
        assert node.stdout.readline() == "ready\n"
        try:
            assert asyncio.run(asyncio.wait_for(scene(number, node), patient(60))) == [None]
        finally:
            node.kill()
