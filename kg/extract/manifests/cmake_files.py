"""The files that CMake code of a package refers to: parsed once, matched by patterns, searched for macros."""

from __future__ import annotations

import fnmatch
import posixpath
import re
from collections import deque
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.extract.manifests.cmake_run import BINARY, SOURCE, Definition
from kg.extract.manifests.cmake_syntax import Block, Statement, parse
from kg.facts import FileKind
from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader

__all__ = ["CMakeFiles"]

_PLACEHOLDER: Final = re.compile(r"@(\w+)@|\$\{(\w+)\}")
_SOURCE_ENDINGS: Final = ("cpp", "cc", "cxx", "c", "cu")
_REMEMBERED: Final = 256
"""Texts whose definitions are kept, for the macros of one package are called by many."""


class CMakeFiles:
    """Files of one package's source as CMake code sees them; paths are relative to the root of the source."""

    def __init__(self, reader: Reader, package: PackageFolder) -> None:
        self.reader = reader
        self.package = package
        self.packages: dict[str, None] = {}
        """Other packages that were asked for with find_package, whose macros may be called."""
        self.generated: dict[str, tuple[str, str]] = {}
        """Files that configure_file makes, by their path below `BINARY`: the template and the text it becomes."""
        self._parsed: dict[str, list[Statement] | None] = {}
        self._definitions: dict[tuple[str, int], Definition | None] = {}
        self._libraries: dict[str, dict[str, Definition]] = {}
        self._links = reader.workspace.links(reader.repository)
        self._entries = {entry.path: entry for entry in package.files}

    @property
    def size(self) -> int:
        """How many files the package has, which is what a pattern costs."""
        return len(self._entries)

    def parse(self, path: str) -> list[Statement] | None:
        """Return the statements of a CMake file; None, and a problem, when it cannot be read."""
        if path not in self._parsed:
            text = self.reader.read(path)
            self._parsed[path] = None if text is None else _parse(self.reader, path, text)
        return self._parsed[path]

    def locate(self, written: str, base: str) -> str | None:
        """Return the path of `written`, relative to `base` below `SOURCE`; None for one outside of the source."""
        whole = posixpath.normpath(posixpath.join(base, written))
        if whole.startswith(BINARY) or not (whole == SOURCE or whole.startswith(SOURCE + "/")):
            return None
        path = whole[len(SOURCE) + 1 :]
        for link, target in self._links:
            if path.startswith(link + "/"):
                return posixpath.normpath(target + path[len(link) :])
        return path

    def exists(self, path: str) -> bool:
        """Tell whether the source has that file."""
        return path in self._entries or self.reader.workspace.entry(self.reader.file(path)) is not None

    def source_file(self, written: str, base: str) -> str | None:
        """Return the path of a source of a target, with the ending that CMake adds; None when there is no such file."""
        path = self.locate(written, base)
        if path is None:
            return None
        if self.exists(path):
            return path
        return next((full for ending in _SOURCE_ENDINGS if self.exists(full := f"{path}.{ending}")), None)

    def configured(self, template: str, variables: Mapping[str, str]) -> str:
        """Return the text of a template with `@NAME@` and `${NAME}` replaced, as configure_file does."""
        text = (self.reader.read(template) or b"").decode("utf-8", "replace")
        return _PLACEHOLDER.sub(lambda match: variables.get(match[1] or match[2], ""), text)

    def glob(self, pattern: str, base: str, *, recurse: bool) -> list[str]:
        """Return the files of the package that a pattern of `file(GLOB)` matches, sorted."""
        located = self.locate(pattern, base)
        if located is None:
            return []
        head, tail = posixpath.split(located)
        plain = not any(mark in head for mark in "*?[")
        match = re.compile(fnmatch.translate(tail)).match
        inside = re.compile(fnmatch.translate(head)).match
        found = []
        for path in self._entries:
            where, name = posixpath.split(path)
            near = where == head if plain else inside(where) and where.count("/") == head.count("/")
            below = recurse and (where.startswith(head + "/") or not head)
            if (near or below) and match(name):
                found.append(path)
        return found

    def module(self, name: str, base: str) -> str | None:
        """Return the file that `include(name)` means: a path, or a module in a folder `cmake` of the package."""
        for candidate in (name, f"{name}.cmake"):
            path = self.locate(candidate, base)
            if path and self.exists(path):
                return path
        wanted = f"/{posixpath.basename(name).removesuffix('.cmake')}.cmake"
        fits = [path for path in self._entries if path.endswith(wanted)]
        return min(fits, key=len, default=None)

    def definition(self, name: str) -> Definition | None:
        """Return the macro or function `name` of this package, of one found, of the build, or of the known ones."""
        key = (name, len(self.packages))
        if key not in self._definitions:
            self._definitions[key] = self._find_definition(name)
        return self._definitions[key]

    def _find_definition(self, name: str) -> Definition | None:
        for package in (self.package.name, *self.packages):
            library = self._library(package)
            if name in library:
                return library[name]
        return _known_macros().get(name)

    def _library(self, package: str) -> dict[str, Definition]:
        """Return the macros and functions in the `.cmake` files of a package of the build."""
        if package not in self._libraries:
            library = self._libraries[package] = {}
            workspace = self.reader.workspace
            place = workspace.package(package, self.reader.repository)
            for entry in workspace.files(place, FileKind.BUILD) if place else ():
                if place and ".cmake" in entry.path:
                    text = self.reader.read(FilePath(place.repository, entry.path)) or b""
                    base = posixpath.dirname(posixpath.join(SOURCE, entry.path))
                    for name, definition in _definitions(text, base).items():
                        library.setdefault(name, definition)
        return self._libraries[package]


def _parse(reader: Reader, path: str, text: bytes) -> list[Statement]:
    statements, faults = parse(text.decode("utf-8", "replace"))
    for fault in faults:
        reader.problem("KG117", fault.message, path, fault.line)
    return statements


@lru_cache(_REMEMBERED)
def _definitions(text: bytes, base: str) -> Mapping[str, Definition]:
    """Return the macros and functions that a file in the folder `base` defines; of two alike the first."""
    lower = text.lower()
    if b"macro" not in lower and b"function" not in lower:
        return {}
    found: dict[str, Definition] = {}
    for name, definition in _collect(parse(text.decode("utf-8", "replace"))[0], base):
        found.setdefault(name, definition)
    return found


def _collect(statements: Iterable[Statement], base: str) -> Iterator[tuple[str, Definition]]:
    """Yield the definitions among statements, those inside of `if` too."""
    pending = deque(statements)
    while pending:
        statement = pending.popleft()
        if not isinstance(statement, Block):
            continue
        opener, body = statement.branches[0]
        words = tuple(argument.text for argument in opener.arguments)
        if opener.name in {"macro", "function"} and words:
            yield words[0].lower(), Definition(opener.name == "macro", words[1:], body, base)
        elif opener.name == "if":
            pending.extend(inner for _, branch in statement.branches for inner in branch)


@cache
def _known_macros() -> Mapping[str, Definition]:
    return _definitions((folder("ontology") / "cmake-macros.cmake").read_bytes(), "")
