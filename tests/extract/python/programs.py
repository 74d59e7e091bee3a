"""Python sources given as text: run, or read as the nodes of a package."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from extract.workspaces import reader_of

from kg.corpus.files import FilePath, PackageFolder, Source
from kg.corpus.reading import Reader
from kg.corpus.workspace import Workspace
from kg.extract import manifests
from kg.extract.python import read_nodes
from kg.extract.python.language import Python
from kg.extract.python.modules import Modules, PythonUnit
from kg.facts import Repository
from kg.symbolic.descriptions import shipped
from kg.symbolic.effects import Framework
from kg.symbolic.machine import Machine
from kg.symbolic.state import Site
from kg.symbolic.values import Number, Text, Truth, Unknown, Value, alternatives

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.extract.marks import Extracted

__all__ = ["nodes_of", "plain", "values_of"]

_NOWHERE = Path("/nowhere")


def values_of(text: str, name: str = "x") -> list[Value]:
    """Return the possible values of a variable of a module after running the text."""
    package = PackageFolder("demo", ".", None, ())
    source = Source(Repository("local/demo", str(_NOWHERE)), _NOWHERE, (package,), (), ())
    language = Python(Modules(Reader(Workspace([source]), source, package), package))
    framework = Framework(shipped("python"))
    language.machine = framework.machine = Machine(language, framework)
    unit = PythonUnit(FilePath("local/demo", "demo.py"), text.encode())
    language.machine.stack.append(Site(unit, 1))
    module = language.module(unit)
    return list(alternatives(module.fields.get(name, Unknown("it has no value"))))


def plain(value: Value) -> str | float | bool | None:
    """Return the plain value of a known text, number or Boolean; None for others."""
    if isinstance(value, Text):
        return value.exact
    return value.value if isinstance(value, Number | Truth) else None


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
    return read_nodes(reader, reader.package, manifests.read_build(reader, reader.package), shipped("python"))
