"""Which pages of documentation stand in a package or around it."""

from __future__ import annotations

import posixpath
import re
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath
from kg.facts import FileKind

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.corpus.files import FileEntry, Source

_README: Final = re.compile(r"readme\b|readme_|mainpage|wiki", re.IGNORECASE)
_ENDINGS: Final = (".md", ".rst", ".dox", ".adoc", ".markdown", ".wiki")
_FOLDERS: Final = frozenset({"doc", "docs", "documentation", "wiki"})
_OTHER: Final = re.compile(
    r"changelog|changes|license|licence|contributing|code_of_conduct|security|authors|history|release|install|copying"
    r"|pull_request|issue_template|todo|migration",
    re.IGNORECASE,
)
"""Names of pages that say nothing about what something is for."""


class Documents:
    """The pages of a source by the folder that they are about: the one they stand in, or that of their folder `doc`."""

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
        """Return the pages in the folder of a package, then those around it that are in no folder of another."""
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
    """Return the pages among files: READMEs, and those in formats of documentation."""
    return sorted(
        (e.path for e in entries if e.kind is FileKind.TEXT and _is_page(posixpath.basename(e.path))), key=_order
    )


def _is_page(name: str) -> bool:
    return _README.match(name) is not None or (name.lower().endswith(_ENDINGS) and not _OTHER.search(name))


def _order(path: str) -> tuple[int, bool, str]:
    return path.count("/"), not _README.match(posixpath.basename(path)), path


def _folder_of(path: str) -> str | None:
    """Return the folder that a page is about beyond its package; None unless it is a README or stands in `doc`."""
    parts = path.split("/")[:-1]
    inner = next((number for number, part in enumerate(parts) if part.lower() in _FOLDERS), None)
    if inner is not None:
        return "/".join(parts[:inner]) or "."
    return ("/".join(parts) or ".") if _README.match(posixpath.basename(path)) else None


def _outward(package: str) -> Iterator[str]:
    """Yield the folders around a package, its own first, to the root of the source."""
    folder = package
    while folder not in {"", "."}:
        yield folder
        folder = posixpath.dirname(folder)
    yield "."
