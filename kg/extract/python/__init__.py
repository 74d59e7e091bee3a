"""Declarations of Python code: nodes, their interfaces and parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.corpus.reading import Reader
    from kg.corpus.workspace import PackageFolder
    from kg.extract.buildmodel import BuildModel
    from kg.extract.marks import Extracted
    from kg.symbolic.descriptions import Descriptions

with lazily():
    from kg.extract.python.nodes import read_nodes as read

__all__ = ["read_nodes"]


def read_nodes(reader: Reader, package: PackageFolder, build: BuildModel, calls: Descriptions) -> list[Extracted]:
    """Return the Python nodes of a package, with the frameworks that each uses."""
    return read(reader, package, build, calls)
