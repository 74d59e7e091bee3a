"""Finds the sources of installed files: the share folder that launch files name often differs from the source folder.

Read are `install` in CMake and `data_files` in setup.py. The destinations of loops over the files of a folder, and of
paths that CMake computes, are unknown.
"""

from __future__ import annotations

import fnmatch
import posixpath
from typing import TYPE_CHECKING, Final

from kg.extract.manifests.cmake import read_cmake
from kg.extract.manifests.package_xml import read_package_xml
from kg.extract.python.programs import calls_of, lines
from kg.symbolic.values import Sequence, Text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.corpus.files import PackageFolder
    from kg.corpus.reading import Reader
    from kg.symbolic.values import Value

_ROS2: Final = 2


class Installed:
    """The installed files of a ROS 2 package; packages of ROS 1 can run from the source folder."""

    def __init__(self, reader: Reader, folder: PackageFolder) -> None:
        self._reader = reader
        self._share = f"share/{folder.name}"
        self._rules: list[tuple[str, str]] = []
        """Pairs of installed path and source. Both end in a slash for folders; names can be patterns."""
        self._unknown = False
        package = read_package_xml(reader, folder).package
        if package.ros == _ROS2:
            for destination, source in read_cmake(reader, folder, package).installed:
                self._add(destination, source)
            for destination, source in self._data_files(folder):
                self._add(destination, folder.join(source))

    @property
    def complete(self) -> bool:
        """Whether there are destinations, and all are known."""
        return bool(self._rules) and not self._unknown

    def source(self, inner: str) -> str | None:
        """Return the repository path of the file installed as `inner` in the share folder; None if there is none."""
        wanted = posixpath.normpath(f"{self._share}/{inner}")
        for destination, source in self._rules:
            if destination.endswith("/"):
                path = source + wanted[len(destination) :] if wanted.startswith(destination) else None
            else:
                folder, name = posixpath.split(wanted)
                matches = folder == posixpath.dirname(destination) and fnmatch.fnmatchcase(
                    name, posixpath.basename(destination)
                )
                pattern = any(mark in source for mark in "*?[")
                path = (posixpath.join(posixpath.dirname(source), name) if pattern else source) if matches else None
            if path is not None and self._reader.workspace.is_file(self._reader.file(posixpath.normpath(path))):
                return posixpath.normpath(path)
        return None

    def _add(self, destination: str, source: str) -> None:
        if "$" in destination or "$" in source:
            self._unknown = True
        elif destination.startswith(self._share):
            self._rules.append((destination, source))

    def _data_files(self, folder: PackageFolder) -> Iterator[tuple[str, str]]:
        """Yield the files that setup.py installs as pairs of destination and source, relative to the package folder."""
        path = self._reader.file(folder.join("setup.py"))
        if self._reader.workspace.owner(path) is None:
            return
        for call in calls_of(self._reader, path):
            given = call.named.get("data_files") if call.name == "setup" else None
            if given is None:
                continue
            self._unknown |= not isinstance(given, Sequence) or given.open
            for pair in given.items if isinstance(given, Sequence) else ():
                yield from self._pair(pair)

    def _pair(self, pair: Value) -> Iterator[tuple[str, str]]:
        """Yield each file of a pair of a destination and a list of files."""
        match pair:
            case Sequence(items=(Text(exact=str() as destination), Sequence(open=False) as files)):
                names = lines(files)
                self._unknown |= len(names) != len(files.items)
                for source in names:
                    yield f"{destination.rstrip('/')}/{posixpath.basename(source)}", source
            case _:
                self._unknown = True
