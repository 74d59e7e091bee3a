"""The log and the parameters of our own nodes, over DDS, and what is read of those of others."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

import pytest
from patience import patient
from robot.connections import types_for_tests
from robot.dds.domain import domain

pytest.importorskip("cyclonedds", reason="the extra `dds` is not installed")

from kg.errors import RobotError
from kg.facts import Qos, Role
from kg.robot.connecting import connect
from kg.robot.connection import GraphProblem
from kg.robot.dds.qos import from_dds, to_dds
from kg.robot.parameters import find, parsed, read, write

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import Accepted, Connection, Value


@asynccontextmanager
async def pair() -> AsyncIterator[tuple[Connection, Connection]]:
    """Yield two nodes of a domain, `/deep/one` and `/two`."""
    with domain() as number:
        address = f"dds://{number}?settle=2"
        one = await connect(address, name="/deep/one", types=types_for_tests(2))
        two = await connect(address, name="/two", types=types_for_tests(2))
        try:
            async with asyncio.timeout(patient(20)):
                yield one, two
        finally:
            await one.aclose()
            await two.aclose()


async def serves(node: Connection, service: str) -> None:
    """Return when a node sees a service."""
    async for graph in node.changes():
        if any((one.name, one.role) == (service, Role.SERVICES) for one in graph.ends):
            return


def test_our_node_has_parameters() -> None:
    """`use_sim_time` is listed, described and read; it cannot be set, since the address determines the clock."""

    async def scene() -> None:
        async with pair() as (_, two):
            await serves(two, "/deep/one/set_parameters_atomically")
            found, problems = await read(two, "/deep/one")
            assert not problems
            assert [(one.name, one.type, one.value, one.read_only) for one in found] == [
                ("use_sim_time", "boolean", False, True)
            ]
            with pytest.raises(RobotError):
                await write(two, parameter := await find(two, "/deep/one", "use_sim_time"), parsed(parameter, "true"))

    asyncio.run(scene())


def _refused(name: str, why: str) -> Value:
    return {"successful": False, "reason": f"parameter '{name}' cannot be set because it is {why}"}


@pytest.mark.parametrize(
    ("service", "question", "response"),
    [
        ("ListParameters", {"prefixes": ["other"]}, {"result": {"names": [], "prefixes": []}}),
        ("GetParameterTypes", {"names": ["use_sim_time"]}, {"types": b"\x01"}),
        ("GetParameterTypes", {"names": ["use_sim_time", "other"]}, {"types": b""}),
        (
            "SetParameters",
            {"parameters": [{"name": "other"}]},
            {
                "results": [
                    {"successful": False, "reason": "parameter 'other' cannot be set because it is not declared"}
                ]
            },
        ),
        (
            "SetParametersAtomically",
            {"parameters": [{"name": "use_sim_time"}]},
            {
                "result": {
                    "successful": False,
                    "reason": "parameter 'use_sim_time' cannot be set because it is read-only",
                }
            },
        ),
        ("SetParametersAtomically", {}, {"result": {"successful": True, "reason": ""}}),
    ],
)
def test_requests_about_parameters(service: str, question: Value, response: Value) -> None:
    """Responses are those of rclpy, as for names that are not declared."""

    async def scene() -> Value:
        async with pair() as (_, two):
            name = "".join(f"_{one.lower()}" if one.isupper() else one for one in service).removeprefix("_")
            await serves(two, f"/deep/one/{name}")
            return await two.call(f"/deep/one/{name}", f"rcl_interfaces/{service}", question, seconds=patient(5))

    assert asyncio.run(scene()) == response


def test_our_log_is_on_rosout() -> None:
    """Lines, and what our node reports about itself, arrive with level, name and time, also at a late subscriber."""

    async def scene() -> list[Value]:
        async with pair() as (one, two):
            one.log("info", "it begins")

            async def fail(_: Value) -> Value:
                raise ValueError("no tea")

            await one.serve("/brew", "std_srvs/Trigger", fail)
            await serves(two, "/brew")
            with pytest.raises(RobotError):
                await two.call("/brew", "std_srvs/Trigger", {}, seconds=0.5)
            lines = []
            async for received in await two.subscribe("/rosout", "rcl_interfaces/Log"):
                if received.value["name"] == "deep.one":
                    lines.append(received.value)
                if len(lines) == 2:
                    break
            (log,) = {end.qos for end in (await two.graph()).ends if end.name == "/rosout" and end.node == "/deep/one"}
            assert log == Qos("reliable", "transient_local", "keep_last", 1000, lifespan=10.0, liveliness="automatic")
            return lines

    lines = asyncio.run(scene())
    assert [(one["level"], one["msg"]) for one in lines] == [
        (20, "it begins"),
        (30, "[KG808] /brew: our own answer failed: no tea"),
    ]
    assert all(one["stamp"]["sec"] for one in lines)


def test_a_closed_connection_logs_nothing() -> None:
    """A line after the end of a connection is dropped."""

    async def scene() -> None:
        async with pair() as (one, _):
            await one.aclose()
            one.log("error", "too late")
            one.watch.report(GraphProblem("KG808", "/brew", "too late"))  # type: ignore[attr-defined]  # of ROS 2

    asyncio.run(scene())


@pytest.mark.parametrize("qos", [Qos("reliable", history="keep_last", depth=7), Qos("reliable", history="keep_all")])
def test_only_cyclone_tells_history(qos: Qos) -> None:
    """History and depth of an end are those that Cyclone DDS sends; for other vendors they are unknown."""
    told = from_dds(to_dds(qos, {}), writer=True, cyclone=True)
    assert (told.history, told.depth) == (qos.history, qos.depth)
    unknown = from_dds(to_dds(qos, {}), writer=True, cyclone=False)
    assert (unknown.history, unknown.depth) == (None, None)


def test_status_and_feedback_of_actions_are_topics() -> None:
    """Both are read without a type; the last status is kept for late subscribers."""

    async def count(accepted: Accepted) -> Value:
        while not accepted.cancelled:
            await accepted.feedback({"now": 1})
            await asyncio.sleep(0.05)
        return {"reached": 1}

    async def scene() -> list[Value]:
        async with pair() as (one, two):
            await one.serve_action("/count", "kg_test/Count", count)
            goal = await two.send_goal("/count", "kg_test/Count", {"until": 9}, seconds=patient(5))
            await anext(aiter(goal.feedback()))
            found = []
            for topic in ("/count/_action/status", "/count/_action/feedback"):
                subscription = await two.subscribe(topic)
                found.append((await anext(aiter(subscription))).value)
                await subscription.aclose()
            await goal.cancel()
            with pytest.raises(RobotError):
                await goal.result()
            return found

    status, feedback = asyncio.run(scene())
    assert [one["status"] for one in status["status_list"]] == [2]
    assert feedback["feedback"] == {"now": 1}
    assert feedback["goal_id"] == status["status_list"][0]["goal_info"]["goal_id"]
