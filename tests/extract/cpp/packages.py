"""Packages for one test: C++ given as text, and the facts extracted from it."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from extract.workspaces import manifest, written

from kg.corpus.reading import Reader
from kg.extract.package import extract_package

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.facts import Interface, NodeType

__all__ = ["interfaces_of", "names_of", "node_of", "nodes_of", "texts_of", "type_of"]

CMAKE = "cmake_minimum_required(VERSION 3.8)\nproject(demo)\nadd_executable(demo main.cpp)\n"


def nodes_of(files: Mapping[str, str]) -> tuple[NodeType, ...]:
    """Return the nodes of the package `demo`, built from `main.cpp`; files of other packages are below `../NAME`."""
    placed: dict[str, str | bytes] = {"demo/package.xml": manifest("demo"), "demo/CMakeLists.txt": CMAKE}
    placed |= {f"demo/{path}".replace("demo/../", ""): text for path, text in files.items()}
    with tempfile.TemporaryDirectory() as root:
        workspace = written(Path(root), placed)
        package = workspace.package("demo")
        assert package is not None
        facts = extract_package(Reader(workspace, *workspace.folder(package)))
    assert not facts.problems
    return facts.nodes


def node_of(source: str, more: Mapping[str, str] | None = None) -> NodeType:
    """Return the only node of a package with this `main.cpp`, and further files by path."""
    (node,) = nodes_of({"main.cpp": source, **(more or {})})
    return node


def interfaces_of(source: str, more: Mapping[str, str] | None = None) -> list[Interface]:
    """Return the interfaces created by the code of the only node, without implicit ones."""
    return [item for item in node_of(source, more).interfaces if not item.implicit]


def names_of(source: str, more: Mapping[str, str] | None = None) -> set[str | None]:
    """Return the names of the interfaces created by the code of the only node."""
    return {item.name for item in interfaces_of(source, more)}


def publisher_of(expression: str, local: str = "", outer: str = "", template: str = "std_msgs::String") -> str:
    """Return a ROS 1 program whose only publisher has the text of an expression as its name, after a slash."""
    return (
        f"{outer}\nint main(int argc, char** argv) {{\n  ros::NodeHandle nh;\n  {local}\n"
        f'  nh.advertise<{template}>(std::string("/") + ({expression}), 1);\n}}\n'
    )


def texts_of(expression: str, local: str = "", outer: str = "") -> set[str | None]:
    """Return the possible texts of an expression, with `{}` for unknown parts; None if entirely unknown."""
    found: Iterable[str | None] = names_of(publisher_of(expression, local, outer))
    return {name.removeprefix("/") if name is not None else None for name in found}


def type_of(spelled: str, before: str = "") -> str | None:
    """Return the message type of a subscriber whose callback has a parameter of a C++ type."""
    main = 'int main() { ros::NodeHandle nh; nh.subscribe("t", 1, called); }'
    (found,) = interfaces_of(f"{before}\nvoid called({spelled} message) {{}}\n{main}\n")
    return found.type
