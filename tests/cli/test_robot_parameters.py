"""`kg robot nodes` and `kg robot params`."""

from __future__ import annotations

import asyncio
import json
from typing import TYPE_CHECKING, Any

import pytest

from kg.cli.commands import robot_topics
from kg.cli.commands.robot import show_capabilities
from kg.cli.commands.robot_topics import set_parameter, show_parameters
from kg.errors import RobotError
from kg.facts import Role
from kg.robot.capability import Capabilities, Capability, Way
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.memory import Bus
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Callable

VALUES: dict[str, Any] = {}
_RUN = asyncio.run


async def _answer_list(_: dict[str, Any]) -> dict[str, Any]:
    return {"result": {"names": [*VALUES]}}


async def _answer_get(request: dict[str, Any]) -> dict[str, Any]:
    return {"values": [VALUES[name] for name in request["names"]]}


async def _answer_describe(request: dict[str, Any]) -> dict[str, Any]:
    limits = {"floating_point_range": [{"from_value": 0.0, "to_value": 2.0}]}
    return {"descriptors": [{"name": name, "type": 3, **limits} for name in request["names"]]}


async def _answer_set(request: dict[str, Any]) -> dict[str, Any]:
    VALUES.update({one["name"]: one["value"] for one in request["parameters"]})
    return {"results": [{"successful": True}] * len(request["parameters"])}


_ANSWERS: dict[str, tuple[str, Callable[..., Any]]] = {
    "list_parameters": ("ListParameters", _answer_list),
    "get_parameters": ("GetParameters", _answer_get),
    "describe_parameters": ("DescribeParameters", _answer_describe),
    "set_parameters": ("SetParameters", _answer_set),
}


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[], None]], None]:
    """Return a function that runs a command with a robot in memory, whose node `/base` has the parameter `speed`."""
    VALUES.clear()
    VALUES["speed"] = {"type": 3, "double_value": 0.5}

    def run(command: Callable[[], None]) -> None:
        async def scene(work: Any) -> Any:
            with Bus("parameters", ros=2) as bus:
                base = bus.join("/base")
                for name, (kind, answer) in _ANSWERS.items():
                    await base.serve(f"/base/{name}", f"rcl_interfaces/{kind}", answer)
                return await work

        monkeypatch.setattr(robot_topics, "address_of", lambda _: "memory://parameters")
        monkeypatch.setattr(asyncio, "run", lambda work: _RUN(scene(work)))
        command()

    return run


def test_parameters_are_shown_with_their_limits(
    robot: Callable[[Callable[[], None]], None], capsys: pytest.CaptureFixture[str]
) -> None:
    """A line has node, name, type, value and limits."""
    robot(lambda: show_parameters(Settings(), None, None, json=False))
    lines = [line.split("\t") for line in capsys.readouterr().out.splitlines()]
    assert lines == [
        ["node", "parameter", "type", "value", "limits", "description"],
        ["/base", "speed", "double", "0.5", "0 to 2", ""],
    ]


def test_a_parameter_is_set(robot: Callable[[Callable[[], None]], None], capsys: pytest.CaptureFixture[str]) -> None:
    """The line has the old and the new value; with --dry-run nothing is set."""
    robot(lambda: set_parameter(Settings(), "/base", "speed", "1", dry_run=True, json=True))
    told = json.loads(capsys.readouterr().out)
    assert (told["before"], told["value"], told["set"], VALUES["speed"]["double_value"]) == (0.5, 1.0, False, 0.5)
    robot(lambda: set_parameter(Settings(), "base", "speed", "1.5", dry_run=False, json=True))
    told = json.loads(capsys.readouterr().out)
    assert (told["before"], told["value"], told["set"], VALUES["speed"]["double_value"]) == (0.5, 1.5, True, 1.5)


def test_a_value_out_of_the_limits_is_not_sent(robot: Callable[[Callable[[], None]], None]) -> None:
    """The value is rejected with KG843, and the parameter is unchanged."""
    with pytest.raises(RobotError, match="above its maximum") as refused:
        robot(lambda: set_parameter(Settings(), "/base", "speed", "9", dry_run=False, json=True))
    assert (refused.value.code, VALUES["speed"]["double_value"]) == ("KG843", 0.5)


def test_a_recording_has_no_parameters_to_set() -> None:
    """Setting a parameter of a recording is KG851."""
    with pytest.raises(RobotError) as refused:
        set_parameter(Settings(robot="bag://drive.mcap"), "/base", "speed", "1", dry_run=False, json=True)
    assert refused.value.code == "KG851"


def test_nodes_are_listed_with_their_states(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line has the state of a managed node, and the number of its topics, services and actions."""

    async def look(_: str) -> ComputationGraph:
        nodes = (LiveNode("/base", "host", None, "inactive"), LiveNode("/laser"))
        ends = (
            LiveEnd("/base", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
            LiveEnd("/base", Role.SERVICES, "/base/get_parameters", "rcl_interfaces/GetParameters"),
        )
        return ComputationGraph(2, nodes, ends)

    monkeypatch.setattr(robot_topics, "look", look)
    robot_topics.nodes(settings=Settings(robot="dds://0"), json=True)
    base, laser = map(json.loads, capsys.readouterr().out.splitlines())
    assert base == {
        "name": "/base", "state": "inactive", "publishes": 0, "subscribes": 1, "services": 0, "actions": 0,
        "address": "host", "problem": None,
    }  # fmt: skip
    assert laser["state"] is None


def test_capabilities_say_why_they_are_not_available(capsys: pytest.CaptureFixture[str]) -> None:
    """The table has an additional column if a node is not active, and none otherwise."""
    way = Way(kind="topic", name="/cmd_vel", type="geometry_msgs/Twist", node="/base")
    idle = Capability(
        iri="#driving", name="driving", label="drive", modality="write", ways=(way,), unavailable="/base is inactive"
    )
    show_capabilities(Capabilities(of="robot", capabilities=(idle,)), every=False, json=False)
    heading, line = (each.split("\t") for each in capsys.readouterr().out.splitlines())
    assert (heading[-1], line[-1]) == ("unavailable", "/base is inactive")
    show_capabilities(Capabilities(of="robot", capabilities=()), every=False, json=False)
    assert "unavailable" not in capsys.readouterr().out
