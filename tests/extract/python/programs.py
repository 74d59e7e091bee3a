"""Python sources given as text: evaluated, indexed, or read as the nodes of a package."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.corpus.files import FilePath, PackageFolder, Source
from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace
from kg.extract import manifests
from kg.extract.python import read_nodes
from kg.extract.python.evaluate import Evaluator
from kg.extract.python.index import index_file
from kg.extract.python.program import Program
from kg.facts import Repository

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.extract.marks import Extracted
    from kg.extract.python.entities import Thing
    from kg.extract.python.unit import Unit

__all__ = ["nodes_of", "program", "unit_of", "values_of"]

_NOWHERE = Path("/nowhere")


def program() -> Program:
    """Return a program without any file."""
    package = PackageFolder("demo", ".", None, ())
    source = Source(Repository("local/demo", str(_NOWHERE)), _NOWHERE, (package,), (), ())
    return Program(Reader(Workspace([source]), source, package))


def unit_of(text: str) -> Unit:
    """Return the index of a file with this text."""
    return index_file(FilePath("local/demo", "demo.py"), text.encode())


def values_of(text: str, name: str = "x") -> list[Thing]:
    """Return what a variable of a module can be after the text has run."""
    found = program()
    unit = unit_of(text)
    evaluator = Evaluator(found)
    return [value for value, _ in evaluator.name(name, len(text.encode()) + 1, found.module_frame(unit), {})]


def nodes_of(root: Path, files: Mapping[str, str | bytes]) -> list[Extracted]:
    """Return the nodes of the package `demo` with these files, all Python files marked as programs."""
    placed = dict(files)
    for path, text in files.items():
        if path.endswith(".py") and isinstance(text, str):
            placed[path] = f"#!/usr/bin/env python3\n{text}"
    reader = reader_of(root, placed)
    for file in root.rglob("*.py"):
        file.chmod(0o755)
    reader = reader_of(root, {})
    return read_nodes(reader, reader.package, manifests.read_build(reader, reader.package))
