"""What the sources of nodes import and include: libraries, modules and headers from outside of their package.

The library that a node includes (`serial/serial.h`), or the module that it imports (`moveit_commander`), often shows
which device it works with where no name and no text does. Own headers and modules are followed, so that a driver's
class counts for the program that uses it. The C++ standard library (headers without an ending or folder) is left out.
"""

from __future__ import annotations

import posixpath
import re
from bisect import bisect_right
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.facts import FileKind, Import, Location

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.facts import NodeType

__all__ = ["add_imports"]

_INCLUDE: Final = re.compile(rb"^[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"\n]+)[>\"]", re.MULTILINE)
_IMPORT: Final = re.compile(
    rb"^[ \t]*(?:from[ \t]+(\.*[\w.]*)[ \t]+import[ \t]+\(?([^#\n\\)]*)|import[ \t]+([\w., \t]+))", re.MULTILINE
)
_NEWLINE: Final = re.compile(rb"\n")
_NAME: Final = re.compile(r"[\w./+-]+", re.ASCII)
_PARTS: Final = 3
"""How many last parts of a path the folders of a package are searched for; no include of one has more to tell."""


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
        self._named: dict[str, list[str]] = defaultdict(list)
        for path in sorted(self._kinds):
            self._named[posixpath.basename(path)].append(path)
        self._needs: dict[str, tuple[list[str], list[Import]]] = {}

    def outside(self, sources: Iterable[str]) -> tuple[Import, ...]:
        """Return what files need from outside of the package, directly or by way of files of the package."""
        found: dict[str, Import] = {}
        pending = sorted(path for path in sources if path in self._kinds)
        seen = set(pending)
        while pending:
            own, foreign = self._of(pending.pop(0))
            for each in foreign:
                found.setdefault(each.name, each)
            pending += [path for path in own if path not in seen]
            seen.update(own)
        return tuple(sorted(found.values(), key=lambda one: (one.name, one.location.path, one.location.line)))

    def _of(self, path: str) -> tuple[list[str], list[Import]]:
        if path not in self._needs:
            text = self._reader.read(path) or b""
            python = self._kinds[path] is FileKind.PYTHON
            own: list[str] = []
            foreign: list[Import] = []
            lines = [match.start() for match in _NEWLINE.finditer(text)]
            for names, at in (_imported if python else _included)(text):
                places = [self._own(name, path, python=python) for name in names]
                own += filter(None, places)
                if not any(places) and _counts(names[0], python=python):
                    foreign.append(Import(names[0], Location(path, bisect_right(lines, at) + 1)))
            self._needs[path] = own, foreign
        return self._needs[path]

    def _own(self, name: str, path: str, *, python: bool) -> str | None:
        """Return the file of the package that a name means in the file `path`, the nearest one if there are several."""
        if not python:
            return self._nearest(name, path)
        levels = len(name) - len(name.lstrip("."))
        module = name.lstrip(".").replace(".", "/")
        return self._nearest(f"{module}.py", path, relative=levels > 0) or self._nearest(f"{module}/__init__.py", path)

    def _nearest(self, wanted: str, path: str, *, relative: bool = False) -> str | None:
        beside = posixpath.normpath(posixpath.join(posixpath.dirname(path), wanted))
        if beside in self._kinds:
            return beside
        end = "/" + "/".join(wanted.split("/")[-_PARTS:])
        fit = [one for one in self._named[posixpath.basename(wanted)] if f"/{one}".endswith(end)]
        return fit[0] if fit and ("/" in wanted or relative or len(fit) == 1) else None


def _included(text: bytes) -> Iterator[tuple[list[str], int]]:
    """Yield the path of each header that C++ includes, and where."""
    for match in _INCLUDE.finditer(text):
        yield [match[1].decode("utf-8", "replace").strip()], match.start(1)


def _imported(text: bytes) -> Iterator[tuple[list[str], int]]:
    """Yield each module that Python imports, and where; behind it names that may be modules in it."""
    for match in _IMPORT.finditer(text):
        if match[3] is not None:
            for each in match[3].decode().split(","):
                yield [(each.split() or [""])[0]], match.start(3)
            continue
        module = match[1].decode()
        inside = [(each.split() or [""])[0] for each in match[2].decode("utf-8", "replace").split(",")]
        joint = "" if module.endswith(".") else "."
        yield [module, *(f"{module}{joint}{each}" for each in inside if each.isidentifier())], match.start(1)


def _counts(name: str, *, python: bool) -> bool:
    """Check whether a name means something outside of the package and of the C++ standard library."""
    if _NAME.fullmatch(name) is None or name.startswith("."):
        return False
    return python or "/" in name or "." in name
