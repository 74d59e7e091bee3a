from __future__ import annotations

from dataclasses import replace

import pytest
from wiring.systems_of import started

from kg.facts import DataFile, Location, MissingType, NodeKind, NodeReference, NodeType, StartedNode, StartKind
from kg.launch.wiring.types import NodeTypes


def test_packages_without_node_types_are_there() -> None:
    """A package of the build without nodes, or with only programs, is not taken for a misspelling of another."""
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


def test_a_registered_class_without_a_node_is_not_missing() -> None:
    """It exists, and its behaviour is unknown."""
    types = NodeTypes((), programs={"filters": ["filters/Median"]})
    loaded = replace(started({"package": "nodelet", "kind": "nodelet"}), plugin="filters/Median")
    found, missing, reason = types.of(loaded, "local/here")
    assert (found, missing) == (None, MissingType.NO_NODE)
    assert reason == "no node was found in filters/Median of package filters"


def test_an_executable_can_have_another_name_than_its_node() -> None:
    """The executable and the node lead to the type; messages list the executable."""
    place = Location("a.cpp", 1)
    node = NodeType("Talker", NodeKind.EXECUTABLE, "cpp", 2, place, executable="talker_node")
    types = NodeTypes([(NodeReference("local/p", "p", "Talker"), node)])
    assert [len(types.started("p", name)) for name in ("talker_node", "Talker", "talker")] == [1, 1, 0]
    assert types.executables("p") == ["talker_node"]


@pytest.mark.parametrize(
    ("path", "found"),
    [
        ("package://nav/trees/main.xml", "nav/trees/main.xml"),
        ("package://nav/installed/elsewhere/backup.xml", "nav/trees/backup.xml"),
        ("package://nav/installed/main.xml", None),
        ("package://nav/trees/gone.xml", None),
        ("package://other/trees/main.xml", None),
        ("/trees/main.xml", None),
    ],
)
def test_installed_files_are_found_by_the_end_of_their_path(path: str, found: str | None) -> None:
    """A file that is installed elsewhere is found by its name, unless several files have it."""
    names = ("nav/trees/main.xml", "nav/trees/backup.xml", "nav/old/main.xml")
    types = NodeTypes((), data=[DataFile("local/p", "nav", name, "") for name in names])
    file = types.data_file(path)
    assert (file.path if file else None) == found
