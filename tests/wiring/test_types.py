from __future__ import annotations

from dataclasses import replace

from kg.facts import Location, NodeKind, NodeReference, NodeType, StartedNode, StartKind
from kg.wiring.types import NodeTypes


def test_packages_without_node_types_are_there() -> None:
    """One of the build that declares no node, or only installs programs, is not taken for another's misspelling."""
    types = NodeTypes((), packages=["rover_maps"], programs={"rover_tools": ["calibrate"]})
    assert [types.like(name) for name in ("rover_maps", "rover_tools")] == [(), ()]
    assert [types.like(name) for name in ("rover_map", "rovr_tools")] == [("rover_maps",), ("rover_tools",)]


def test_each_way_to_start_a_node_leads_to_its_type() -> None:
    """A launch file can name the class, the executable or another executable of the same node type."""
    place = Location("a.cpp", 1)
    node = NodeType(
        "talker", NodeKind.COMPONENT, "cpp", 2, place, executable="talker", plugin="p::Talker", aliases=("talker_mt",)
    )
    types = NodeTypes([(NodeReference("local/p", "p", "talker"), node)])
    started = StartedNode(None, "/", StartKind.NODE, place, package="p")
    ways = [
        replace(started, plugin="p::Talker"),
        *(replace(started, executable=one) for one in ("talker", "talker_mt")),
    ]
    for way in ways:
        found, missing, _ = types.of(way, "local/p")
        assert missing is None
        assert found is not None
        assert found[1] is node
