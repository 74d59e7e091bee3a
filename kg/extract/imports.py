"""What the sources of nodes import and include: libraries, modules and headers from outside of their package.

The library that a node includes (`serial/serial.h`), or the module that it imports (`moveit_commander`), often shows
which device it works with where no name and no text does. Own headers and modules are followed, so that a driver's
class counts for the program that uses it. The C++ standard library (headers without an ending or folder) is left out.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.cpp.units import included
from kg.extract.python.importing import imported
from kg.facts import FileKind, Import, Location, NodeType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import FilePath, PackageFolder
    from kg.corpus.reading import Reader

_NAME: Final = re.compile(r"[\w./+-]+", re.ASCII)


def add_imports(reader: Reader, package: PackageFolder, nodes: tuple[NodeType, ...]) -> tuple[NodeType, ...]:
    """Return the nodes with what their sources, and files of the package that these need, take from outside."""
    files = _Files(reader, package)
    return tuple(replace(node, imports=files.outside({*node.sources, node.location.path})) for node in nodes)


class _Files:
    """The code of a package, and what each file of it needs."""

    def __init__(self, reader: Reader, package: PackageFolder) -> None:
        self._reader = reader
        self._kinds = {
            entry.path: entry.kind for entry in package.files if entry.kind in (FileKind.CPP, FileKind.PYTHON)
        }
        self._needs: dict[str, tuple[list[str], list[Import]]] = {}

    def outside(self, sources: Iterable[str]) -> tuple[Import, ...]:
        """Return what files need from outside of the package, directly or by way of files of the package."""
        imports: dict[str, Import] = {}
        pending = sorted(path for path in sources if path in self._kinds)
        seen = set(pending)
        while pending:
            own, foreign = self._needs_of(pending.pop(0))
            for each in foreign:
                imports.setdefault(each.name, each)
            pending += [path for path in own if path not in seen]
            seen.update(own)
        return tuple(sorted(imports.values(), key=lambda one: (one.name, one.location.path, one.location.line)))

    def _needs_of(self, path: str) -> tuple[list[str], list[Import]]:
        """Return the files of the package that a file needs, and what it needs from outside."""
        if path not in self._needs:
            text = self._reader.read(path) or b""
            read = self._imported if self._kinds[path] is FileKind.PYTHON else self._included
            own: list[str] = []
            foreign: list[Import] = []
            for name, line, files in read(text, self._reader.file(path)):
                own_files = (file for file in files if file.repository == self._reader.repository)
                inside = [file.path for file in own_files if file.path in self._kinds]
                own += inside
                if not inside and _NAME.fullmatch(name) and not name.startswith("."):
                    foreign.append(Import(name, Location(path, line)))
            self._needs[path] = own, foreign
        return self._needs[path]

    def _included(self, text: bytes, near: FilePath) -> Iterator[tuple[str, int, list[FilePath]]]:
        """Yield what C++ includes, but for the standard library: the path as written, its line, the file meant."""
        for path, line in included(text).items():
            if "/" in path or "." in path:
                header = self._reader.workspace.include(path, near=near)
                yield path, line, [header] if header is not None else []

    def _imported(self, text: bytes, near: FilePath) -> Iterator[tuple[str, int, list[FilePath]]]:
        """Yield what Python imports: the module as written, its line, its file and those of modules in it."""
        for names, line in imported(text):
            modules = (self._reader.workspace.module(name, near=near) for name in names if name)
            yield names[0], line, [file for file in modules if file is not None]
