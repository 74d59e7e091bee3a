"""The files that a launch configuration may read, and its limits.

Files are named `package://NAME/path`, and found in the build, else among installed packages. Nothing outside of these
can be named, so nothing else is ever read. A budget bounds the rest, since files that include each other can describe a
configuration without end.
"""

from __future__ import annotations

import posixpath
import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.corpus.files import FilePath, Place
from kg.extract.manifests.installing import Installed
from kg.facts import FileKind, LaunchProblemKind, StartedNode
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.corpus.reading import Reader

with lazily():
    from pathspec import GitIgnoreSpec

SCHEME: Final = "package://"
"""What the folder of a package begins with in texts; it stands for what `$(find NAME)` gives when it runs."""

UNREAD: Final = "its parameter file is unknown"
"""Why parameters are unknown that a node is given: their names are, too."""

_LOOSE: Final = "source://"
_TEMPLATES: Final = (".in", ".em", ".xacro")
"""What the names of files end in from which CMake, EmPy or xacro makes files when a package is built."""
_CODE: Final = frozenset({FileKind.CPP, FileKind.PYTHON})
_SUBMODULE: Final = re.compile(rb"^\s*path\s*=\s*(\S+)", re.MULTILINE)
_WRITES: Final = re.compile(rb"\bofstream\b|\bfopen\b|\.write\(|\bdump\(|[\"'][wa]b?\+?[\"']")
"""What code has that writes files."""
_LAUNCHES: Final = (".launch", ".xml")
_GIVEN: Final = re.compile(rb"<node\b[^>]*\bargs=\"(?P<args>[^\"]*)\"[^>]*>")
_TYPE: Final = re.compile(rb"(?<=type=\")[^\"]+")
_MOST_NAME: Final = 200
"""Characters of the name of a file or folder, which file systems bound to 255 bytes."""

MOST: Final = {
    "actions": 50_000,
    "bytes of files": 64 << 20,
    "elements": 200_000,
    "generated files": 1_000,
    "includes": 5_000,
    "nodes": 20_000,
    "parameters": 200_000,
    "places": 2_000_000,
    "substitutions": 500_000,
}
"""`places` are the lines that nodes, remappings and parameters are told with, and those of the includes before them."""
_PLACES_OF_A_REMAP: Final = 20


@dataclass(frozen=True, slots=True)
class Match:
    """The file that a text names, or the kind of problem if there is none, and the reason."""

    file: FilePath | None
    kind: LaunchProblemKind = LaunchProblemKind.UNRESOLVED
    reason: str | None = None
    subject: str | None = None


class Files:
    """The files that launch files of one build may name, read through `reader`, which keeps the record."""

    def __init__(self, reader: Reader) -> None:
        self.reader = reader
        self._near = reader.repository
        self._installed: dict[Place, Installed] = {}

    def share(self, package: str) -> str | None:
        """Return the text for the folder of a package; None when it is neither in the build nor installed."""
        workspace = self.reader.workspace
        exists = workspace.package(package, self._near) or workspace.installed_package(package)
        return f"{SCHEME}{package}" if exists else None

    def launch_file(self, package: str, name: str) -> str:
        """Return the text that names a launch file of a package, which `ros2 launch` finds in any of its folders."""
        workspace = self.reader.workspace
        place = workspace.package(package, self._near)
        if place is not None:
            for entry in workspace.files(place, FileKind.LAUNCH):
                if posixpath.basename(entry.path) == name:
                    return self.text(FilePath(place.repository, entry.path))
        return f"{SCHEME}{package}/launch/{name}"

    def text(self, file: FilePath) -> str:
        """Return the text that names a file of the build, by its package where one owns it."""
        owner = self.reader.workspace.owner(file)
        if owner is not None and self.reader.workspace.package(owner.name, self._near) == owner:
            inner = file.path if owner.path == "." else file.path.removeprefix(f"{owner.path}/")
            return f"{SCHEME}{owner.name}/{inner}"
        return f"{_LOOSE}{file.repository.replace('/', '!')}/{file.path}"

    def folder(self, file: FilePath) -> str:
        """Return the text that names the folder of a file."""
        return self.text(file).rpartition("/")[0]

    def at(self, text: str) -> FilePath | None:
        """Return the path that a text names, whether the file exists or not; None if it names nothing known."""
        scheme, _, rest = text.partition("//")
        head, _, inner = rest.partition("/")
        if f"{scheme}//" == _LOOSE:
            return _below(head.replace("!", "/"), "", inner)
        if f"{scheme}//" != SCHEME:
            return None
        package = self.reader.workspace.package(head, self._near)
        if package is not None:
            return _below(package.repository, "" if package.path == "." else package.path, inner)
        installed = self.reader.workspace.installed_package(head)
        return _below(installed.repository, installed.path, inner) if installed else None

    def existing(self, text: str) -> FilePath | None:
        """Return the file that a text names, if the source has it there or installs it there."""
        file = self.at(text)
        if file is None or self.exists(file):
            return file
        package, _, inner = text.removeprefix(SCHEME).partition("/")
        place = self.reader.workspace.package(package, self._near)
        if place is None or not text.startswith(SCHEME) or not inner:
            return None
        if place not in self._installed:
            other = self.reader.for_package(place)
            self._installed[place] = Installed(other, other.package)
        source = self._installed[place].source(inner)
        if source is not None:
            return FilePath(place.repository, source)
        return None if self._installed[place].complete else self.likely(place, inner)

    def likely(self, place: Place, inner: str) -> FilePath | None:
        """Return the one file of a package whose path ends as a path that is installed or found from somewhere."""
        parts = [part for part in inner.split("/") if part not in ("", ".", "..")]
        paths = [entry.path for entry in self.reader.workspace.folder(place)[1].files]
        for length in range(len(parts), 0, -1):
            tail = "/" + "/".join(parts[-length:])
            ending = [path for path in paths if f"/{path}".endswith(tail)]
            if ending:
                return FilePath(place.repository, ending[0]) if len(ending) == 1 else None
        return None

    def names(self, text: str) -> list[str] | None:
        """Return the paths of all files below the folder that a text names, sorted; None if it is not in the build."""
        folder = self.at(text)
        package = self.reader.workspace.package(text.removeprefix(SCHEME).partition("/")[0], self._near)
        if folder is None or package is None or not text.startswith(SCHEME):
            return None
        begin = "" if folder.path == "." else f"{folder.path}/"
        files = self.reader.workspace.folder(package)[1].files
        paths = [entry.path.removeprefix(begin) for entry in files if entry.path.startswith(begin)]
        return sorted(paths) or None

    def find(self, text: str) -> Match:
        """Return the file that a text names."""
        if any(len(part) > _MOST_NAME for part in text.split("/")):
            return Match(None, reason="the name of the file is too long")
        existing = self.existing(text)
        if existing is not None:
            return Match(existing)
        file = self.at(text)
        if file is not None:
            return self.absent(file, text)
        package = text.removeprefix(SCHEME).partition("/")[0]
        if text.startswith(SCHEME) and self.share(package) is None:
            reason = f"the package '{package}' is neither in the build nor installed"
            return Match(None, LaunchProblemKind.UNKNOWN_PACKAGE, reason, package)
        return Match(None, reason=f"the file {text} is outside the build", subject=text)

    def absent(self, file: FilePath, text: str) -> Match:
        """Return why a file is absent: it has no name, a build, the robot or a submodule has it, or none of these."""
        unresolved = LaunchProblemKind.UNRESOLVED
        if text.endswith("/"):
            return Match(None, unresolved, f"{text} names a folder: the name of the file is empty", text)
        for template in (f"{file.path}{ending}" for ending in _TEMPLATES):
            if self.exists(FilePath(file.repository, template)):
                return Match(None, unresolved, f"{text} is made from {template} when the package is built", text)
        modules = self.read(FilePath(file.repository, ".gitmodules")) or b""
        for folder in _SUBMODULE.findall(modules):
            if file.path.startswith(f"{folder.decode()}/"):
                return Match(None, unresolved, f"{text} is in the submodule {folder.decode()}, which is empty", text)
        if self._is_ignored(file):
            return Match(None, unresolved, f"{text} is not in the source: git ignores it", text)
        writer = self._writer(text) or self._program(file)
        if writer is not None:
            return Match(None, unresolved, f"{text} is not in the source: {writer} presumably writes it", text)
        return Match(None, LaunchProblemKind.MISSING_FILE, f"file not found: {text}", text)

    def _writer(self, text: str) -> str | None:
        """Return the code of a package that names an absent file of it and writes files; None if there is none."""
        package, _, inner = text.removeprefix(SCHEME).partition("/")
        place = self.reader.workspace.package(package, self._near) if text.startswith(SCHEME) else None
        if place is None or "/" not in inner:
            return None
        named = posixpath.normpath(inner).encode()
        for entry in self.reader.workspace.folder(place)[1].files:
            code = self.read(FilePath(place.repository, entry.path)) if entry.kind in _CODE else None
            if code is not None and named in code and _WRITES.search(code):
                return entry.path
        return None

    def _program(self, file: FilePath) -> str | None:
        """Return the program that a launch file gives its own path, if the name of an absent one only adds to it."""
        folder, name = posixpath.split(file.path)
        stem, ending = posixpath.splitext(name)
        for length in range(len(stem) - 1, 0, -1) if ending in _LAUNCHES else ():
            sibling = FilePath(file.repository, posixpath.join(folder, f"{stem[:length]}{ending}"))
            # A look at the file system for each would take longer than all else.
            text = self.read(sibling) if self.reader.workspace.entry(sibling) is not None else None
            for node in _GIVEN.finditer(text or b""):
                if node["args"].endswith(f"/{stem[:length]}{ending}".encode()):
                    return (_TYPE.search(node[0]) or node)[0].decode()
        return None

    def _is_ignored(self, file: FilePath) -> bool:
        """Return whether the nearest `.gitignore` with a pattern for a file leaves it out."""
        parts = file.path.split("/")
        for depth in range(len(parts) - 1, -1, -1):
            folder, inner = "/".join(parts[:depth]), "/".join(parts[depth:])
            text = self.read(FilePath(file.repository, posixpath.join(folder, ".gitignore")))
            checked = GitIgnoreSpec.from_lines(text.decode().splitlines()).check_file(inner) if text else None
            if checked is not None and checked.include is not None:
                return checked.include
        return False

    def exists(self, file: FilePath) -> bool:
        """Return whether a file can be read."""
        return self.reader.workspace.is_file(file)

    def read(self, file: FilePath) -> bytes | None:
        """Return the text of a file as UTF-8; None if it is missing, too large or binary."""
        return self.reader.read(file) if self.exists(file) else None


def _below(repository: str, folder: str, inner: str) -> FilePath | None:
    """Return a file of a source; None for a path that leads out of it."""
    path = posixpath.normpath(posixpath.join(folder, inner.lstrip("/")))
    return None if path.startswith("..") else FilePath(repository, path)


class Budget:
    """The resources that one configuration has used so far."""

    def __init__(self) -> None:
        self._spent: Counter[str] = Counter()

    def allows(self, report: Callable[[str], None], what: str, amount: int = 1) -> bool:
        """Count something and return whether that is within the limit; `report` is called the first time that not."""
        before, most = self._spent[what], MOST[what]
        self._spent[what] += amount
        if before <= most < self._spent[what]:
            report(f"the configuration has more than {most} {what}")
        return self._spent[what] <= most

    def allows_node(self, report: Callable[[str], None], node: StartedNode) -> bool:
        """Count a node with its remappings and parameters; return whether that is within the limits."""
        chains = [node.chain, *(one.chain for one in node.remaps), *(one.chain for one in node.parameters)]
        places = len(chains) + sum(map(len, chains)) + _PLACES_OF_A_REMAP * len(node.remaps)
        return self.allows(report, "nodes") and self.allows(report, "places", places)
