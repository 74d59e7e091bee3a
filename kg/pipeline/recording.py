"""A workspace that remembers what was looked up in it, so that a later build knows whether the answers would differ."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

from kg.corpus.workspace import FileEntry, FilePath, PackageFolder, Source, Workspace

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["Lookup", "RecordingWorkspace", "answer"]

Lookup: TypeAlias = tuple[str, ...]
"""The kind of a look-up and what was asked for; see `answer`."""


class RecordingWorkspace(Workspace):
    """A workspace whose `lookups` are those made since the last `forget`, with their answers as text."""

    def __init__(self, sources: Iterable[Source], installed: Iterable[Path] = ()) -> None:
        super().__init__(sources, installed)
        self.lookups: dict[Lookup, str] = {}

    def forget(self) -> None:
        """Begin a new record, for another package."""
        self.lookups = {}

    def prepare(self) -> None:
        """Make the indexes before processes are forked, which then share them."""
        nowhere = FilePath("", "")
        super().package("")
        super().definition("", "", "")
        super().include("", near=nowhere)
        super().module("", near=nowhere)

    def package(self, name: str, near: str = "") -> tuple[Source, PackageFolder] | None:
        """Return the package of that name and its source."""
        found = super().package(name, near)
        self.lookups[("package", name, near)] = _place(found)
        return found

    def entry(self, file: FilePath) -> FileEntry | None:
        """Return the entry of a file of the build."""
        found = super().entry(file)
        self.lookups[("entry", *file)] = str(found is not None)
        return found

    def installed_package(self, name: str) -> FilePath | None:
        """Return the folder of an installed package."""
        found = super().installed_package(name)
        self.lookups[("installed", name)] = _name(found)
        return found

    def is_file(self, file: FilePath) -> bool:
        """Tell whether there is such a file."""
        found = super().is_file(file)
        self.lookups[("file", *file)] = str(found)
        return found

    def include(self, path: str, *, near: FilePath) -> FilePath | None:
        """Return the file that an include directive in the file `near` means."""
        found = super().include(path, near=near)
        self.lookups[("include", path, *near)] = _name(found)
        return found

    def module(self, dotted: str, *, near: FilePath) -> FilePath | None:
        """Return the file of a Python module as imported in the file `near`."""
        found = super().module(dotted, near=near)
        self.lookups[("module", dotted, *near)] = _name(found)
        return found

    def definition(self, package: str, name: str, kind: str) -> FilePath | None:
        """Return the file that defines an interface."""
        found = super().definition(package, name, kind)
        self.lookups[("definition", package, name, kind)] = _name(found)
        return found

    def documents(self, repository: str, package: str) -> tuple[FilePath, ...]:
        """Return the pages of documentation of a package and of the folders around it."""
        found = super().documents(repository, package)
        self.lookups[("documents", repository, package)] = _names(found)
        return found


def answer(workspace: Workspace, lookup: Lookup) -> str:
    """Return what a workspace answers to a look-up that was recorded in another."""
    kind, *asked = lookup
    if kind == "package":
        return _place(workspace.package(*asked))
    if kind == "entry":
        return str(workspace.entry(FilePath(*asked)) is not None)
    if kind == "installed":
        return _name(workspace.installed_package(asked[0]))
    if kind == "file":
        return str(workspace.is_file(FilePath(*asked)))
    if kind == "definition":
        return _name(workspace.definition(*asked))
    if kind == "documents":
        return _names(workspace.documents(*asked))
    find = workspace.include if kind == "include" else workspace.module
    return _name(find(asked[0], near=FilePath(*asked[1:])))


def _name(file: FilePath | None) -> str:
    return "" if file is None else f"{file.repository}:{file.path}"


def _names(files: Iterable[FilePath]) -> str:
    return "\n".join(map(_name, files))


def _place(found: tuple[Source, PackageFolder] | None) -> str:
    return "" if found is None else f"{found[0].repository.name}:{found[1].path}"
