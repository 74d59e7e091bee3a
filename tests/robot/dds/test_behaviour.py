"""A connection over DDS passes the suite of every connection."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.connections import Behaviour, System, types_for_tests
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.robot.connection import Value


class TestDds(Behaviour):
    """The suite of every connection."""

    @pytest.fixture
    def system(self) -> Iterator[System]:
        """Yield a domain of our own."""
        with domain() as number:
            address = f"dds://{number}?settle=1"
            yield System(2, lambda name: connect(address, name=name, types=types_for_tests(2)), seconds=5)

    def test_a_service_answers(self, system: System) -> None:
        """A call returns the response; a failure is a timeout, because ROS 2 has no message for it; KG807 unserved."""

        async def scene() -> None:
            async with system.pair() as (_, two):
                three = await system.join("/three")
                await three.serve("/double", "kg_test/Double", _double)
                await system.seen(two, lambda graph: any(end.name == "/double" for end in graph.ends))
                call = two.call("/double", "kg_test/Double", {"value": 2.0}, seconds=patient(system.seconds))
                assert await call == {"value": 4.0, "remark": "twice"}
                assert (await two.call("/double", None, {"value": 3.0}, seconds=patient(2)))["value"] == 6.0
                with pytest.raises(RobotError) as failed:
                    await two.call("/double", "kg_test/Double", {"value": -1.0}, seconds=0.5)
                assert failed.value.code == "KG803"
                graph = await system.seen(three, lambda graph: bool(graph.problems))
                assert [problem.code for problem in graph.problems] == ["KG808"]
                await three.aclose()
                await system.seen(two, lambda graph: not [end for end in graph.ends if end.role is Role.SERVICES])
                with pytest.raises(RobotError) as nobody:
                    await two.call("/double", "kg_test/Double", {"value": 1.0}, seconds=1.0)
                assert nobody.value.code == "KG807"

        asyncio.run(scene())


async def _double(request: Value) -> Value:
    if request["value"] < 0:
        raise ValueError("negative")
    return {"value": 2 * request["value"], "remark": "twice"}
