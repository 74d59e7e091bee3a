"""Dynamically typed parameters have no type."""

from __future__ import annotations

from typing import TYPE_CHECKING

from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.extract.package import extract_package

if TYPE_CHECKING:
    from pathlib import Path

_NODE = """import rclpy
from rcl_interfaces.msg import ParameterDescriptor
rclpy.init()
node = rclpy.create_node("n")
node.declare_parameter("x", 1.0{more})
rclpy.spin(node)
"""


def _types(root: Path, more: str) -> list[str | None]:
    script = ("#!/usr/bin/env python3\n" + _NODE).replace("{more}", more)
    workspace = written(root, {"demo/package.xml": manifest("demo"), "demo/scripts/n.py": script})
    (source,) = workspace.sources
    found = extract_package(Reader(workspace, source, source.packages[0]))
    return [one.type for node in found.nodes for one in node.parameters if one.name == "x"]


def test_dynamic_typing_leaves_the_type_open(tmp_path: Path) -> None:
    """A default gives the type, unless a descriptor enables dynamic typing."""
    assert _types(tmp_path / "a", "") == ["double"]
    assert _types(tmp_path / "b", ", ParameterDescriptor(dynamic_typing=True)") == [None]
