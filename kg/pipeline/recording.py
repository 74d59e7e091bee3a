"""A workspace that records its look-ups, so a later build can check whether their results would differ."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Final, TypeAlias, TypeVar

from kg.corpus.workspace import FileEntry, FilePath, PackageFolder, Place, Source, Workspace
from kg.facts import FileKind

Lookup: TypeAlias = tuple[str, ...]
"""The name of a method of `Workspace` and its arguments; see `answer`."""

_Found = TypeVar("_Found")
_BYTES: Final = 16


class RecordingWorkspace(Workspace):
    """A workspace that records look-ups and their results, as text, since the last `forget`.

    `lookups` depend only on the paths of the build, `outside` on files that no scan lists.
    """

    def __init__(self, sources: Iterable[Source], installed: Iterable[Path] = ()) -> None:
        super().__init__(sources, installed)
        self.forget()

    def forget(self) -> None:
        """Start a new record, for another package."""
        self.lookups: dict[Lookup, str] = {}
        self.outside: dict[Lookup, str] = {}

    def prepare(self) -> None:
        """Build the indexes before forking processes, which then share them, and start a new record."""
        nowhere = FilePath("", "")
        super().package("")
        super().definition("", "", "")
        super().include("", near=nowhere)
        super().module("", near=nowhere)
        self.forget()

    def _record(self, result: _Found, *lookup: str) -> _Found:
        if lookup not in self.lookups:  # the sources are fixed during a build, so the result is too
            self.lookups[lookup] = _text(result)
        return result

    def source(self, repository: str) -> Source | None:
        """Return the source of a repository name."""
        return self._record(super().source(repository), "source", repository)

    def package(self, name: str, near: str = "") -> Place | None:
        """Return the package of that name."""
        return self._record(super().package(name, near), "package", name, near)

    def folder(self, place: Place) -> tuple[Source, PackageFolder]:
        """Return the folder of a package with all its files, and its source."""
        return self._record(super().folder(place), "folder", *place)

    def files(self, place: Place, kind: FileKind) -> tuple[FileEntry, ...]:
        """Return the files of one kind in a package."""
        return self._record(super().files(place, kind), "files", *place, kind.value)

    def is_alone(self, place: Place) -> bool:
        """Return whether a package is the only one of its source."""
        return self._record(super().is_alone(place), "is_alone", *place)

    def is_package(self, repository: str, name: str) -> bool:
        """Return whether a source has a package with this name."""
        return self._record(super().is_package(repository, name), "is_package", repository, name)

    def links(self, repository: str) -> tuple[tuple[str, str], ...]:
        """Return the folders of a source that are symbolic links."""
        return self._record(super().links(repository), "links", repository)

    def entry(self, file: FilePath) -> FileEntry | None:
        """Return the entry of a file of the build."""
        return self._record(super().entry(file), "entry", *file)

    def owner(self, file: FilePath) -> Place | None:
        """Return the package that owns a file."""
        return self._record(super().owner(file), "owner", *file)

    def include(self, path: str, *, near: FilePath) -> FilePath | None:
        """Return the file that an include directive in the file `near` refers to."""
        return self._record(super().include(path, near=near), "include", path, *near)

    def module(self, dotted: str, *, near: FilePath) -> FilePath | None:
        """Return the file of a Python module as imported in the file `near`."""
        return self._record(super().module(dotted, near=near), "module", dotted, *near)

    def definition(self, package: str, name: str, kind: str) -> FilePath | None:
        """Return the file that defines an interface."""
        return self._record(super().definition(package, name, kind), "definition", package, name, kind)

    def documents(self, repository: str, package: str) -> tuple[FilePath, ...]:
        """Return the documentation pages of a package and of the folders around it."""
        return self._record(super().documents(repository, package), "documents", repository, package)

    def installed_package(self, name: str) -> FilePath | None:
        """Return the folder of an installed package."""
        result = super().installed_package(name)
        self.outside["installed_package", name] = _text(result)
        return result

    def is_file(self, file: FilePath) -> bool:
        """Return whether the file exists."""
        exists = super().is_file(file)
        source = super().source(file.repository)
        # In a pinned source, unlisted files change only with the commit, and then so do the listed ones.
        fixed = super().entry(file) is not None or (source is not None and source.pin is not None)
        record = self.lookups if fixed else self.outside
        record["is_file", *file] = _text(exists)
        return exists


def answer(workspace: Workspace, lookup: Lookup) -> str:
    """Return the result, as text, of a recorded look-up in another workspace."""
    kind, *arguments = lookup
    if kind in {"folder", "files", "is_alone"}:
        place = Place(*arguments[:3])
        if workspace.package(place.name, place.repository) != place:
            return "gone"
        if kind == "files":
            return _text(workspace.files(place, FileKind(arguments[3])))
        return _text(workspace.folder(place) if kind == "folder" else workspace.is_alone(place))
    ask = getattr(workspace, kind)
    if kind in {"entry", "owner", "is_file"}:
        return _text(ask(FilePath(*arguments)))
    if kind in {"include", "module"}:
        return _text(ask(arguments[0], near=FilePath(*arguments[1:])))
    return _text(ask(*arguments))


def _text(result: object) -> str:
    """Return a result as text: names as they are, the files of a package by their digest."""
    match result:
        case None:
            return ""
        case bool():
            return str(result)
        case Source():
            return result.repository.name
        case FileEntry():
            return result.kind.value
        case FilePath():
            return f"{result.repository}:{result.path}"
        case Place():
            return f"{result.repository}:{result.path}:{result.name}"
        case (Source(), PackageFolder() as folder):
            return _text(folder.files)
        case tuple() if result and isinstance(result[0], FileEntry):
            listed = repr([(entry.kind.value, entry.executable, entry.path) for entry in result])
            return hashlib.blake2b(listed.encode(), digest_size=_BYTES).hexdigest()
        case _:
            return str(result)
