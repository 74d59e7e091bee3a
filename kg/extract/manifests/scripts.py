"""Python programs of a package by the names that rosrun and ros2 run know them by."""

from __future__ import annotations

import posixpath
from typing import TYPE_CHECKING, Final

from kg.extract.buildmodel import Script
from kg.facts import FileKind, Location

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

_FOLDERS: Final = frozenset({"scripts", "script", "nodes", "bin"})
"""Folders in which ROS packages keep their programs, whether these are marked as executable or not."""


def read_scripts(
    reader: Reader,
    folder: PackageFolder,
    programs: Mapping[tuple[str, str], Location],
    declared: Iterable[Script] = (),
) -> list[Script]:
    """Return the scripts, each file once.

    They are Python files that CMake installs as programs, the `declared` ones of setup.py, and those marked as
    programs that have a shebang.
    """
    scripts = [Script(name, path, place) for (name, path), place in programs.items() if _is_python(reader, path)]
    taken = {script.path for script in scripts}
    scripts.extend(script for script in declared if script.path not in taken)
    taken |= {script.path for script in scripts}
    of_python = (entry for entry in folder.files if entry.kind is FileKind.PYTHON)
    marked = (
        entry
        for entry in of_python
        if entry.executable or posixpath.basename(posixpath.dirname(entry.path)) in _FOLDERS
    )
    scripts.extend(
        Script(posixpath.basename(entry.path), entry.path, Location(entry.path, 1))
        for entry in marked
        if entry.path not in taken and has_python_shebang(reader.read(entry.path))
    )
    return scripts


def _is_python(reader: Reader, path: str) -> bool:
    entry = reader.workspace.entry(reader.file(path))
    if entry is None or entry.kind not in {FileKind.PYTHON, FileKind.LAUNCH}:
        return False
    return has_python_shebang(reader.read(path)) or entry.kind is FileKind.PYTHON


def has_python_shebang(text: bytes | None) -> bool:
    """Return whether the first line of a file asks for a Python interpreter."""
    first = text.split(b"\n", 1)[0] if text else b""
    return first.startswith(b"#!") and b"python" in first
