"""A managed node in another process: its states, its parameters, and the types that it describes."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.driving import Driver
from kg.robot.live import infer
from kg.robot.parameters import find, parsed, read, write
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

    from kg.robot.connection import ComputationGraph, Connection

_PEER = Path(__file__).parent / "managed.py"
_INACTIVE, _ACTIVE = 2, 3


class Robot:
    """The process of the node, and the address of its domain."""

    def __init__(self, process: subprocess.Popen[str], address: str) -> None:
        self._process = process
        self.address = address

    def become(self, state: int) -> None:
        """Put the node into a state."""
        assert self._process.stdin is not None
        print(state, file=self._process.stdin, flush=True)


@pytest.fixture(scope="module")
def robot() -> Iterator[Robot]:
    """Yield a robot with one managed node, which is inactive; tests that activate it restore that."""
    paths = os.pathsep.join(sys.path)
    with domain() as number, subprocess.Popen(
        [sys.executable, str(_PEER), str(number)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": paths},
    ) as process:  # fmt: skip
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        try:
            yield Robot(process, f"dds://{number}?settle=1")
        finally:
            process.kill()


@asynccontextmanager
async def _joined(robot: Robot) -> AsyncIterator[Connection]:
    connection = await connect(robot.address, name="/kg")
    try:
        async with asyncio.timeout(patient(20)):
            await _until(connection, "inactive")
            yield connection
    finally:
        await connection.aclose()


async def _until(connection: Connection, state: str) -> ComputationGraph:
    """Return the first graph that has the node in a state."""
    async for graph in connection.changes():
        if [(node.name, node.state) for node in graph.nodes] == [("/base", state)]:
            return graph
    raise AssertionError


def test_states_are_told_and_followed(robot: Robot) -> None:
    """A graph has the state of a managed node, and each change is another graph."""

    async def scene() -> None:
        async with _joined(robot) as connection:
            assert [node.state for node in (await connection.graph()).nodes] == ["inactive"]
            robot.become(_ACTIVE)
            await _until(connection, "active")
            robot.become(_INACTIVE)
            await _until(connection, "inactive")

    asyncio.run(scene())


def test_what_needs_an_inactive_node_waits_for_it(robot: Robot) -> None:
    """A capability has the reason why it is unavailable; using it is KG819 until the node is active."""

    async def scene() -> None:
        settings = load({}, environment={})
        async with _joined(robot) as connection:
            graph = await connection.graph()
            known = await asyncio.to_thread(infer, graph, settings, address=robot.address)
            why = {one.name: one.unavailable for one in known.capabilities}
            assert why["drivingAtVelocity"] == "/base is inactive"
            async with Driver(connection, known, graph=graph) as driver:
                with pytest.raises(RobotError, match="not available now: /base is inactive") as idle:
                    await driver.do("drivingAtVelocity", {"forward": 0.1}, seconds=0.1)
                assert idle.value.code == "KG819"
            robot.become(_ACTIVE)
            graph = await _until(connection, "active")
            known = await asyncio.to_thread(infer, graph, settings, address=robot.address)
            assert not any(one.unavailable for one in known.capabilities)
            async with Driver(connection, known, graph=graph) as driver:
                outcome = await driver.do("drivingAtVelocity", {"forward": 0.1}, seconds=0.1)
            assert outcome.ended == "done"
            robot.become(_INACTIVE)
            await _until(connection, "inactive")

    asyncio.run(scene())


def test_parameters_are_read_with_what_is_told_of_them(robot: Robot) -> None:
    """Types, values, limits and descriptions come from the node, even if one of its parameters is not set."""

    async def scene() -> None:
        async with _joined(robot) as connection:
            found, problems = await read(connection)
            assert not problems
            named = {one.name: one for one in found}
            speed = named["speed"]
            assert (speed.node, speed.type, speed.value) == ("/base", "double", 0.5)
            assert (speed.minimum, speed.maximum, speed.description) == (0.0, 2.0, "how fast, in m/s")
            assert named["serial"].read_only
            assert (named["gains"].type, named["gains"].value) == ("double array", [1.0, 0.5])
            assert (named["unset"].type, named["unset"].value) == ("integer", None)

    asyncio.run(scene())


def test_parameters_are_set_and_refusals_have_their_reason(robot: Robot) -> None:
    """A value is set with the type described by the node; a rejection has the node's reason."""

    async def scene() -> None:
        async with _joined(robot) as connection:
            mode = await find(connection, "/base", "mode")
            assert (await write(connection, mode, parsed(mode, "fast"))).value == "fast"
            assert (await find(connection, "base", "mode")).value == "fast"
            with pytest.raises(RobotError, match="only slow and fast") as refused:
                await write(connection, mode, parsed(mode, "odd"))
            assert refused.value.code == "KG843"
            with pytest.raises(RobotError, match="no parameter `mood`") as unknown:
                await find(connection, "/base", "mood")
            assert unknown.value.hint == "Did you mean `mode`?"

    asyncio.run(scene())


def test_a_type_is_described_by_who_uses_it(robot: Robot) -> None:
    """A topic of an unknown type is read: its node describes the type, and the nested one, by the hash of the topic."""

    async def scene() -> None:
        async with _joined(robot) as connection:
            subscription = await connection.subscribe("/reading")
            came = await anext(aiter(subscription))
            assert came.value == {"spots": [{"x": 0.5, "label": "here"}], "three": [1, 2, 3], "fine": True}

    asyncio.run(scene())


def test_why_a_type_is_not_described_is_told(robot: Robot) -> None:
    """A type that its node does not describe remains unknown (KG804), with the node's reason."""

    async def scene() -> None:
        async with _joined(robot) as connection:
            with pytest.raises(RobotError, match="`/base` does not describe it: Type not currently in use") as unknown:
                await connection.subscribe("/riddle")
            assert unknown.value.code == "KG804"

    asyncio.run(scene())
