"""The sources of a build, with the look-ups of code readers in them.

Indexes are built on first use, so workers pay only for what they use. Extraction accesses other packages only through
the public look-ups, which `kg.pipeline.recording` records. No public look-up uses another, so the record does not
depend on the state of the indexes.

`Documents` finds the pages of documentation in a package or around it.
"""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Final

from kg.corpus.files import FileEntry, FilePath, PackageFolder, Place, Source
from kg.corpus.scanning import scan, scan_tree
from kg.facts import FileKind
from kg.names import key

__all__ = [
    "INSTALLED",
    "FileEntry",
    "FilePath",
    "PackageFolder",
    "Place",
    "Source",
    "Workspace",
    "real_inside",
    "scan",
    "scan_tree",
]


INSTALLED: Final = "installed"
"""The repository name for files of installed packages, with absolute paths without the first slash."""

_MODULE_ROOTS: Final = ("", "src/", "scripts/", "nodes/", "python/", "script/")
_INCLUDE_ROOTS: Final = ("include/", "src/", "")
_MESSAGES: Final = ("_msgs", "_srvs", "_interfaces")
"""Suffixes of packages that only contain messages, whose headers are generated."""
_STANDARD: Final = frozenset(
    f"{name}.h"
    for name in (
        "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "limits", "locale", "math", "pthread",
        "setjmp", "signal", "stdarg", "stdbool", "stddef", "stdint", "stdio", "stdlib", "string", "time", "unistd",
        "wchar",
    )
)  # fmt: skip
"""Headers of C and POSIX, which are never those of another package."""

_README: Final = re.compile(r"readme\b|readme_|mainpage|wiki", re.IGNORECASE)
_ENDINGS: Final = (".md", ".rst", ".dox", ".adoc", ".markdown", ".wiki")
_FOLDERS: Final = frozenset({"doc", "docs", "documentation", "wiki"})
_OTHER: Final = re.compile(
    r"changelog|changes|license|licence|contributing|code_of_conduct|security|authors|history|release|install|copying"
    r"|pull_request|issue_template|todo|migration",
    re.IGNORECASE,
)
"""Names of pages without information about purpose."""


class Documents:
    """The pages of a source by the folder that they are about: their own, or the parent of their folder `doc`."""

    def __init__(self, source: Source) -> None:
        self._repository = source.repository.name
        self._packages = {package.path: package.name for package in source.packages}
        self._names = frozenset(self._packages.values())
        self._own = {package.path: _pages(package.files) for package in source.packages}
        self._around: dict[str, list[str]] = {}
        loose = [(".", path) for path in _pages(source.loose)]
        owned = [(folder, path) for folder, paths in self._own.items() for path in paths]
        for owner, path in (*loose, *owned):
            folder = _folder_of(path)
            if folder is not None and (owner in {".", folder} or folder.startswith(owner + "/")):
                self._around.setdefault(folder, []).append(path)

    def of(self, package: str) -> tuple[FilePath, ...]:
        """Return the pages in the folder of a package, then those around it outside of other packages."""
        own = self._own.get(package, [])
        name = self._packages.get(package, "")
        others = self._names - {name}
        around = [
            path
            for folder in _outward(package)
            for path in self._around.get(folder, ())
            if path not in own and others.isdisjoint(path.split("/")[:-1])
        ]
        named = [path for path in around if name in path.split("/")]
        ordered = dict.fromkeys([*own, *named, *around])
        return tuple(FilePath(self._repository, path) for path in ordered)


def _pages(entries: Iterable[FileEntry]) -> list[str]:
    """Return the pages among files, READMEs of outer folders first: READMEs, and those in documentation formats."""
    ranked: list[tuple[int, bool, str]] = []
    for path in (entry.path for entry in entries if entry.kind is FileKind.TEXT):
        name = posixpath.basename(path)
        readme = _README.match(name) is not None
        if readme or (name.lower().endswith(_ENDINGS) and not _OTHER.search(name)):
            ranked.append((path.count("/"), not readme, path))
    return [path for _, _, path in sorted(ranked)]


def _folder_of(path: str) -> str | None:
    """Return the subfolder that a page is about; None unless it is a README or in `doc`."""
    parts = path.split("/")[:-1]
    inner = next((number for number, part in enumerate(parts) if part.lower() in _FOLDERS), None)
    if inner is not None:
        return "/".join(parts[:inner]) or "."
    return ("/".join(parts) or ".") if _README.match(posixpath.basename(path)) else None


def _outward(package: str) -> Iterator[str]:
    """Yield the folders around a package, its own first, up to the root of the source."""
    folder = package
    while folder not in {"", "."}:
        yield folder
        folder = posixpath.dirname(folder)
    yield "."


class Workspace:
    """The sources of a build with their packages, headers, modules and interface definitions."""

    def __init__(self, sources: Iterable[Source], installed: Iterable[Path] = ()) -> None:
        """Index the sources, and the folders `installed` (`/opt/ros/jazzy/share`) with one folder per package."""
        self.sources = tuple(sources)
        self.installed = tuple(installed)
        self._includes: dict[tuple[str, str, Place | None, str], FilePath | None] = {}
        self._modules: dict[tuple[str, str, Place | None, str], FilePath | None] = {}
        self._documents: dict[str, Documents] = {}

    def source(self, repository: str) -> Source | None:
        """Return the source of a repository name."""
        return self._by_name.get(repository)

    def root(self, source: Source) -> Path:
        """Return the folder with the files of a source."""
        return source.root

    def package(self, name: str, near: str = "") -> Place | None:
        """Return the package of a name: of several that of the repository `near`, else the first."""
        return self._own_packages.get((near, name)) or self._packages.get(name)

    def folder(self, place: Place) -> tuple[Source, PackageFolder]:
        """Return the folder of a package of the build with all its files, and its source."""
        return self._by_name[place.repository], self._folders[place]

    def files(self, place: Place, kind: FileKind) -> tuple[FileEntry, ...]:
        """Return the files of one kind of a package of the build."""
        return tuple(entry for entry in self._folders[place].files if entry.kind is kind)

    def links(self, repository: str) -> tuple[tuple[str, str], ...]:
        """Return the folders of a source that are links, with their targets."""
        source = self._by_name.get(repository)
        return source.links if source else ()

    def is_package(self, repository: str, name: str) -> bool:
        """Return whether a source has a package whose name has the same `kg.names.key`."""
        return key(name) in self._package_keys.get(repository, ())

    def is_alone(self, place: Place) -> bool:
        """Return whether a package is the only one of its source."""
        return len(self._by_name[place.repository].packages) == 1

    def installed_package(self, name: str) -> FilePath | None:
        """Return the folder of an installed package; None if it is not installed."""
        if not name or "/" in name or name.startswith("."):
            return None
        folders = (root / name for root in self.installed)
        return next(
            (FilePath(INSTALLED, str(one).lstrip("/")) for one in folders if (one / "package.xml").exists()), None
        )

    def is_file(self, file: FilePath) -> bool:
        """Return whether a file exists inside the root of its source, even if it is not listed."""
        source = self._by_name.get(file.repository)
        if source is not None:
            return file in self._owners or _is_file_inside(self.root(source), self.root(source) / file.path)
        path = Path("/", file.path)
        return file.repository == INSTALLED and any(_is_file_inside(root, path) for root in self.installed)

    def entry(self, file: FilePath) -> FileEntry | None:
        """Return the entry of a file of the build; None for others."""
        owned = self._owners.get(file)
        return owned[0] if owned else None

    def owner(self, file: FilePath) -> Place | None:
        """Return the package that owns a file; None for loose files and files not in the build."""
        return self._home(file)

    def include(self, path: str, *, near: FilePath) -> FilePath | None:
        """Return the file that `#include "path"` in the file `near` refers to; None if it is not in the build.

        The search covers the folder of `near`, `include/` and `src/` of its package and other paths in it with this
        ending, then the other packages of the build (of the same source first).
        """
        folder, home = posixpath.dirname(near.path), self._home(near)
        request = (near.repository, folder, home, path)
        if request not in self._includes:
            self._includes[request] = self._find_include(path, near, folder, home)
        return self._includes[request]

    def module(self, dotted: str, *, near: FilePath) -> FilePath | None:
        """Return the file of the Python module `dotted` (leading dots: relative) as imported in the file `near`."""
        folder, home = posixpath.dirname(near.path), self._home(near)
        request = (near.repository, folder, home, dotted)
        if request not in self._modules:
            self._modules[request] = self._find_module(dotted, near, folder, home)
        return self._modules[request]

    def definition(self, package: str, name: str, kind: str) -> FilePath | None:
        """Return the file that defines the interface `package/name`; `kind` is msg, srv or action."""
        return self._definitions.get((package, name, kind))

    def documents(self, repository: str, package: str) -> tuple[FilePath, ...]:
        """Return the pages of documentation in the package in that folder of a source, then those around it."""
        source = self._by_name.get(repository)
        if source is None:
            return ()
        if repository not in self._documents:
            self._documents[repository] = Documents(source)
        return self._documents[repository].of(package)

    @cached_property
    def _by_name(self) -> dict[str, Source]:
        return {source.repository.name: source for source in reversed(self.sources)}

    @cached_property
    def _folders(self) -> dict[Place, PackageFolder]:
        return {
            Place(source.repository.name, package.path, package.name): package
            for source in self.sources
            for package in source.packages
        }

    @cached_property
    def _packages(self) -> dict[str, Place]:
        return {place.name: place for place in reversed(self._folders)}

    @cached_property
    def _own_packages(self) -> dict[tuple[str, str], Place]:
        return {(place.repository, place.name): place for place in reversed(self._folders)}

    @cached_property
    def _package_keys(self) -> dict[str, frozenset[str]]:
        return {
            source.repository.name: frozenset(key(package.name) for package in source.packages)
            for source in self.sources
        }

    @cached_property
    def _owners(self) -> dict[FilePath, tuple[FileEntry, Place | None]]:
        owners: dict[FilePath, tuple[FileEntry, Place | None]] = {}
        for source in self.sources:
            name = source.repository.name
            owners.update((FilePath(name, entry.path), (entry, None)) for entry in source.loose)
        for place, package in self._folders.items():
            owners.update((FilePath(place.repository, entry.path), (entry, place)) for entry in package.files)
        return owners

    def _home(self, file: FilePath) -> Place | None:
        owned = self._owners.get(file)
        return owned[1] if owned else None

    @cached_property
    def _definitions(self) -> dict[tuple[str, str, str], FilePath]:
        kinds = {FileKind.MESSAGE, FileKind.SERVICE, FileKind.ACTION}
        by_key: dict[tuple[str, str, str], FilePath] = {}
        for file, (entry, package) in self._owners.items():
            if entry.kind in kinds and package:
                stem = posixpath.basename(file.path).rpartition(".")[0]
                by_key.setdefault((package.name, stem, entry.kind.value), file)
        return by_key

    @cached_property
    def _headers(self) -> dict[str, list[FilePath]]:
        """The C++ files by their name, and by the name of their folder and theirs."""
        by_name: dict[str, list[FilePath]] = {}
        for file, (entry, _) in self._owners.items():
            if entry.kind is FileKind.CPP:
                for tail in {_tail(file.path), posixpath.basename(file.path)}:
                    by_name.setdefault(tail, []).append(file)
        return by_name

    @cached_property
    def _python(self) -> dict[str, list[FilePath]]:
        """The Python files by the name of their module, packages by that of their folder."""
        by_module: dict[str, list[FilePath]] = {}
        for file, (entry, _) in self._owners.items():
            if entry.kind is FileKind.PYTHON:
                by_module.setdefault(_last_part(file.path), []).append(file)
        return by_module

    def _find_include(self, path: str, near: FilePath, folder: str, home: Place | None) -> FilePath | None:
        if posixpath.basename(path) not in self._headers:
            return None
        neighbour = FilePath(near.repository, posixpath.normpath(posixpath.join(folder, path)))
        if neighbour in self._owners:
            return neighbour
        wanted = posixpath.normpath(path).lstrip("./")
        for root in [self._folders[home].join(root) for root in _INCLUDE_ROOTS] if home else ():
            inside = FilePath(near.repository, root + wanted)
            if inside in self._owners:
                return inside
        if wanted in _STANDARD:
            return None
        fits = [
            file
            for file in self._headers.get(_tail(wanted), ())
            if (file.path == wanted or file.path.endswith("/" + wanted))
            and self._is_reachable(file, wanted, near, home)
        ]
        return min(fits, key=lambda file: self._distance(file, near, home, "include/" + wanted), default=None)

    def _is_reachable(self, file: FilePath, wanted: str, near: FilePath, home: Place | None) -> bool:
        """Return whether a package can include a header of another one.

        A name without a folder must be in a public header folder, or next to the manifest. A package of another source
        exports its include roots and folders of its own name, but not its copies of ROS and its messages.
        """
        owner = self._home(file)
        if owner is None or owner == home:
            return True
        folder, parent = posixpath.dirname(file.path), posixpath.dirname(posixpath.dirname(file.path))
        if "/" not in wanted and "include" not in (posixpath.basename(folder), posixpath.basename(parent)):
            return folder == owner.path and file.repository == near.repository
        if file.repository == near.repository:
            return True
        head = wanted.partition("/")[0]
        if owner.name in (posixpath.basename(folder), head):
            return True
        public = f"/{file.path}".endswith(f"/include/{wanted}") and not (head == "ros" or head.endswith(_MESSAGES))
        return public or any(file.path == self._folders[owner].join(root + wanted) for root in _INCLUDE_ROOTS)

    def _distance(self, file: FilePath, near: FilePath, home: Place | None, tail: str) -> tuple[object, ...]:
        """Return the sort key of candidates: own package, own source, public headers, short paths, then by name."""
        own = home is not None and self._home(file) == home
        public = file.path.endswith(tail)
        return (not own, not public, file.repository != near.repository, len(file.path), file)

    def _find_module(self, dotted: str, near: FilePath, folder: str, home: Place | None) -> FilePath | None:
        name = dotted.lstrip(".")
        parts = name.replace(".", "/")
        if dotted.startswith("."):
            base = folder
            for _ in range(len(dotted) - len(name) - 1):
                base = posixpath.dirname(base)
            return self._module_at(near.repository, posixpath.join(base, parts))
        if not self._python.get(parts.rpartition("/")[2]):
            return None
        roots = [folder, *(self._folders[home].join(root) for root in _MODULE_ROOTS)] if home else [folder]
        for root in roots:
            module = self._module_at(near.repository, posixpath.join(root, parts))
            if module:
                return module
        return self._module_anywhere(parts, near, home) or self._module_above(parts, near, folder, home)

    def _module_above(self, parts: str, near: FilePath, folder: str, home: Place | None) -> FilePath | None:
        """Return a module next to a program of the package, whose folder is around that of the importing file."""
        module = None
        while module is None and home is not None and folder != home.path and folder:
            folder = posixpath.dirname(folder)
            module = self._module_at(near.repository, posixpath.join(folder, parts))
        return module

    def _module_at(self, repository: str, stem: str) -> FilePath | None:
        stem = posixpath.normpath(stem)
        for path in (f"{stem}.py", f"{stem}/__init__.py"):
            if FilePath(repository, path) in self._owners:
                return FilePath(repository, path)
        return None

    def _module_anywhere(self, parts: str, near: FilePath, home: Place | None) -> FilePath | None:
        """Return a module whose folder may be an import root: not a Python package itself, or a `src` of a ROS package.

        The name of a ROS package refers to its Python package, with its messages, not to a program of the same name.
        """
        fits = []
        for file in self._python[parts.rpartition("/")[2]]:
            if not file.path.endswith(".py") or (parts in self._packages and not file.path.endswith("/__init__.py")):
                continue
            stem = _module_stem(file.path)
            root = stem[: -len(parts)].rstrip("/")
            whole = stem == parts or stem.endswith("/" + parts)
            inner = FilePath(file.repository, posixpath.join(root, "__init__.py")) in self._owners
            source = posixpath.basename(root) == "src" and self._home(file) is not None
            if whole and (not inner or source):
                fits.append(file)
        return min(fits, key=lambda file: self._distance(file, near, home, ""), default=None)


def real_inside(root: Path, path: Path) -> str | None:
    """Return `path` with links resolved; None if that is outside of the folder `root`."""
    real = os.path.realpath(path)
    return real if real.startswith(os.path.realpath(root).rstrip("/") + "/") else None


def _is_file_inside(root: Path, path: Path) -> bool:
    real = real_inside(root, path)
    return real is not None and Path(real).is_file()


def _module_stem(path: str) -> str:
    return path.removesuffix("/__init__.py") if path.endswith("/__init__.py") else path.rpartition(".")[0] or path


def _tail(path: str) -> str:
    """Return the last two parts of a path."""
    return "/".join(path.rsplit("/", 2)[-2:])


def _last_part(path: str) -> str:
    """Return the name of a file or, for a Python file, of its module."""
    return posixpath.basename(_module_stem(path) if path.endswith(".py") else path)
