from __future__ import annotations

from kg.wiring.types import NodeTypes


def test_packages_without_node_types_are_there() -> None:
    """One of the build that declares no node, or only installs programs, is not taken for another's misspelling."""
    types = NodeTypes((), packages=["rover_maps"], programs={"rover_tools": ["calibrate"]})
    assert [types.like(name) for name in ("rover_maps", "rover_tools")] == [(), ()]
    assert [types.like(name) for name in ("rover_map", "rovr_tools")] == [("rover_maps",), ("rover_tools",)]
