"""Parameters of running nodes: conversion of texts, and the parameter server of ROS 1."""

from __future__ import annotations

import asyncio
import math
from contextlib import suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import RobotError
from kg.robot.connecting import connect
from kg.robot.memory import Bus
from kg.robot.parameters import NodeParameter, find, parsed, read, write
from kg.robot.ros1 import Master


def _of(kind: str, **more: Any) -> NodeParameter:
    return NodeParameter(node="/base", name="speed", type=kind, **more)


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("boolean", "True", True),
        ("integer", "0x10", 16),
        ("double", "2", 2.0),
        ("double", "-.inf", -math.inf),
        ("string", "5", "5"),
        ("string", "[a", "[a"),
        ("byte array", "[1, 255]", [1, 255]),
        ("boolean array", "[true, false]", [True, False]),
        ("integer array", "[]", []),
        ("double array", "[1, .5]", [1.0, 0.5]),
        ("string array", "[no, 5]", ["no", "5"]),
        ("not set", "[1.5, 2.5]", [1.5, 2.5]),
    ],
)
def test_a_text_is_a_value_of_the_type_of_the_parameter(kind: str, text: str, value: object) -> None:
    """The type described by the node decides how a text is parsed."""
    found = parsed(_of(kind), text)
    assert (found, type(found)) == (value, type(value))


@pytest.mark.parametrize(
    ("parameter", "text", "why"),
    [
        (_of("boolean"), "1", "neither true nor false"),
        (_of("integer"), "1.5", "not a whole number"),
        (_of("double"), "fast", "not a number"),
        (_of("byte array"), "[256]", "not a byte"),
        (_of("double array"), "1, 2", "not a list"),
        (_of("double array"), "[[1]]", "not a list"),
        (_of("double", minimum=0.0, maximum=2.0), "2.5", "above its maximum, 2"),
        (_of("double", minimum=0.0, maximum=2.0), ".nan", "below its minimum, 0"),
        (_of("integer", minimum=1.0, maximum=2.0), "0", "below its minimum, 1"),
        (_of("string", read_only=True), "x", "read-only"),
        (_of("not set"), "null", "not a value of a parameter"),
        (_of("integer", dynamic=True), "{a: 1}", "not a value of a parameter"),
    ],
)
def test_what_is_no_value_is_refused(parameter: NodeParameter, text: str, why: str) -> None:
    """A value of another type, or out of the limits, is KG843 before anything is sent."""
    with pytest.raises(RobotError, match=why) as refused:
        parsed(parameter, text)
    assert refused.value.code == "KG843"


def test_a_parameter_that_cannot_change_names_the_way_out() -> None:
    """The advice for a read-only parameter is not about its value."""
    with pytest.raises(RobotError) as refused:
        parsed(_of("string", read_only=True), "x")
    assert refused.value.hint == "Start the node with another value."


@given(st.sampled_from(["boolean", "integer", "double", "string", "string array", "not set"]), st.text(max_size=20))
def test_any_text_is_a_value_or_refused(kind: str, text: str) -> None:
    """Any text is a value or KG843."""
    with suppress(RobotError):
        parsed(_of(kind), text)


def test_the_parameters_of_a_master() -> None:
    """In ROS 1 parameters belong to the node above them; new ones can be added, and keep their type."""

    async def scene() -> None:
        async with Master() as master:
            robot = await connect(master.address, name="/base")
            face = await connect(master.address, name="/face")
            try:
                await robot.set_parameter("/base/gains/p", 0.5)  # type: ignore[attr-defined]  # what ROS 1 has
                await robot.set_parameter("/use_sim_time", False)  # type: ignore[attr-defined]  # the same
                found, _ = await read(face)
                assert [(one.node, one.name, one.type, one.value) for one in found] == [
                    ("/", "use_sim_time", "boolean", False),
                    ("/base", "gains/p", "double", 0.5),
                ]
                gain = await find(face, "base", "gains/p")
                assert (await write(face, gain, parsed(gain, "2"))).value == 2.0
                assert [one.name for one in (await read(face, "/base/gains"))[0]] == ["p"]
                label = await find(face, "/base", "label", new=True)
                await write(face, label, parsed(label, "big"))
                assert (await find(face, "/base", "label")).value == "big"
                with pytest.raises(RobotError, match="no node and no parameter is called `/bse`"):
                    await read(face, "/bse")
            finally:
                await face.aclose()
                await robot.aclose()

    asyncio.run(scene())


def test_a_node_that_does_not_answer_is_a_problem() -> None:
    """A dead node among many is a problem; requested alone it is an error."""

    async def broken(_: dict[str, Any]) -> dict[str, Any]:
        raise ValueError("no")

    async def scene() -> None:
        with Bus("parameters", ros=2) as bus:
            robot, face = bus.join("/base"), bus.join("/face")
            await robot.serve("/base/list_parameters", "rcl_interfaces/ListParameters", broken)
            found, (problem,) = await read(face)
            assert (found, problem.code, problem.subject) == ([], "KG808", "/base")
            with pytest.raises(RobotError, match="/base") as alone:
                await read(face, "/base")
            assert alone.value.code == "KG808"

    asyncio.run(scene())
