"""Command line tools in launch files: the types given by their arguments, and the table of arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from wiring.systems_of import configuration, started

from kg.facts import InstanceInterface, NodeReference, Role
from kg.launch.wiring.instances import Tool
from kg.launch.wiring.plugin_table import load_rows
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Mapping


def ends(row: Mapping[str, Any], ros: int) -> tuple[InstanceInterface, ...]:
    """Return the ends of the only node of a configuration."""
    return wire(configuration([started({"name": "one", **row})], ros), NodeTypes([])).instances[0].interfaces


def test_a_type_on_the_command_line_is_that_of_the_topic() -> None:
    """It is written with or without `msg`; the line of the node is the evidence."""
    row = {"package": "ros2topic", "executable": "ros2", "arguments": ["pub --once /goal geometry_msgs/msg/Pose {}"]}
    (end,) = ends(row, 2)
    assert (end.declared.type, end.declared.location.line) == ("geometry_msgs/Pose", 1)
    assert end.owner == NodeReference("local/here", "ros2topic", "ros2")
    row = {"package": "rostopic", "executable": "rostopic", "arguments": ["pub goal geometry_msgs/Pose"]}
    (end,) = ends(row, 1)
    assert end.declared.type == "geometry_msgs/Pose"


def test_a_type_that_the_command_line_does_not_give_is_not_known() -> None:
    """The two ends of a relay have the type of the incoming message."""
    row = {"package": "topic_tools", "executable": "relay", "arguments": ["/a /b"]}
    assert {end.declared.type for end in ends(row, 1)} == {None}


@pytest.mark.parametrize("ros", [1, 2])
def test_a_command_of_the_other_version_is_not_read(ros: int) -> None:
    """`rostopic` is of ROS 1, `ros2 topic` of ROS 2."""
    package, executable = ("ros2topic", "ros2") if ros == 1 else ("rostopic", "rostopic")
    assert ends({"package": package, "executable": executable, "arguments": ["echo /a"]}, ros) == ()


def test_each_row_names_roles_and_its_own_operands() -> None:
    """A misspelt operand would silently drop its end."""
    for row in load_rows(folder("ontology") / "tools.toml", "tool", Tool):
        for text in row.ends:
            role, kind, name = text.split(" ", 2)
            assert Role(role)
            for operand in ("{" + part.partition("}")[0].partition("=")[0] for part in (kind + name).split("{")[1:]):
                assert operand.strip("{") in (*row.operands, "each")
