"""Types learned from peers."""

from __future__ import annotations

import asyncio

import pytest
from patience import patient
from robot.connections import types_for_tests
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.messages import Types


async def _double(request: dict[str, float]) -> dict[str, object]:
    return {"value": 2 * request["value"], "remark": "twice"}


def test_the_type_of_a_service_is_told_by_who_serves_it() -> None:
    """Request and response are learned without their header on the wire, and the service is called."""

    async def scene(number: int) -> object:
        server = await connect(f"dds://{number}?settle=1&types=peers", name="/server", types=types_for_tests(2))
        client = await connect(f"dds://{number}?settle=1&types=peers", name="/client", types=Types(2))
        try:
            await server.serve("/double", "kg_test/Double", _double)
            async with asyncio.timeout(patient(10)):
                async for graph in client.changes():
                    if any(end.name == "/double" for end in graph.ends):
                        break
            assert not client.types.has("kg_test/Double_Request")
            answer = await client.call("/double", None, {"value": 2.0}, seconds=patient(10))
            assert [one.name for one in client.types.fields("kg_test/Double_Request")] == ["value"]
            with pytest.raises(RobotError) as other:
                await client.call("/double", None, {"guid": 1}, seconds=patient(10))
            assert other.value.code == "KG805"
            return answer
        finally:
            await client.aclose()
            await server.aclose()

    with domain() as number:
        assert asyncio.run(scene(number)) == {"value": 4.0, "remark": "twice"}
