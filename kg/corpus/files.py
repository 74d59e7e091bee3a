"""The files of a source: their kinds, owning packages, and names in the build.

Kinds are those of RNKG section 3.2.1: code by the folder or suffix that ROS defines, and text. Other files (pictures,
meshes, bags) are not listed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from kg.facts import FileKind, Problem, Repository

_ENDINGS: Final = {
    **dict.fromkeys(("cpp", "cc", "cxx", "c", "c++", "h", "hpp", "hh", "hxx", "h++"), FileKind.CPP),
    **dict.fromkeys(("ipp", "tpp", "txx", "tcc", "inl", "impl", "inc", "cu", "cuh"), FileKind.CPP),
    "py": FileKind.PYTHON,
    "msg": FileKind.MESSAGE,
    "srv": FileKind.SERVICE,
    "action": FileKind.ACTION,
    "launch": FileKind.LAUNCH,
    "test": FileKind.LAUNCH,
    "cmake": FileKind.BUILD,
    **dict.fromkeys(("yaml", "yml", "cfg", "json", "xml", "ini", "toml"), FileKind.CONFIG),
    **dict.fromkeys(("urdf", "xacro", "srdf", "sdf", "world", "rviz"), FileKind.CONFIG),
    **dict.fromkeys(("md", "rst", "txt", "dox", "adoc", "markdown"), FileKind.TEXT),
}
_NAMES: Final = {
    "package.xml": FileKind.MANIFEST,
    "manifest.xml": FileKind.MANIFEST,
    "stack.xml": FileKind.MANIFEST,
    "CMakeLists.txt": FileKind.BUILD,
    "setup.py": FileKind.BUILD,
    "setup.cfg": FileKind.BUILD,
    "pyproject.toml": FileKind.BUILD,
    "LICENSE": FileKind.TEXT,
    "README": FileKind.TEXT,
    "CHANGELOG": FileKind.TEXT,
}
_IDL_FOLDERS: Final = {"msg": FileKind.MESSAGE, "srv": FileKind.SERVICE, "action": FileKind.ACTION}
_LAUNCH_ENDINGS: Final = tuple(
    f"{mark}launch.{ending}" for mark in (".", "_") for ending in ("py", "xml", "yaml", "yml")
)


class FilePath(NamedTuple):
    """A file of the build: the name of its repository and its path relative to the root of that source."""

    repository: str
    path: str


class Place(NamedTuple):
    """Identifies a package of the build: its repository, the path of its folder in that source, and its name."""

    repository: str
    path: str
    name: str


@dataclass(frozen=True, slots=True)
class FileEntry:
    """A file found in its source; `path` is relative to the root of the source."""

    path: str
    kind: FileKind
    bytes: int
    mtime_ns: int
    executable: bool


@dataclass(frozen=True, slots=True)
class PackageFolder:
    """A folder with a manifest and its files: those below it that no nested package owns.

    `path` is `.` for the root of the source; `manifest` is None for loose code treated as a package.
    """

    name: str
    path: str
    manifest: str | None
    files: tuple[FileEntry, ...]

    def join(self, relative: str) -> str:
        """Return the path, relative to the source, of `relative` to this package."""
        return relative if self.path == "." else f"{self.path}/{relative}"


@dataclass(frozen=True, slots=True)
class Pin:
    """A repository of a lock file at its commit: its name and address there."""

    name: str
    url: str
    commit: str


@dataclass(frozen=True, slots=True)
class Source:
    """A repository or folder of the build; `loose` are files outside of packages.

    `links` maps folders that are links to their targets in the same source. The files of a source with a `pin` are not
    in the folder `root`: workers of a cluster fetch them.
    """

    repository: Repository
    root: Path
    packages: tuple[PackageFolder, ...]
    loose: tuple[FileEntry, ...] = ()
    problems: tuple[Problem, ...] = ()
    links: tuple[tuple[str, str], ...] = ()
    pin: Pin | None = None


def sort_file(name: str, folder: str, *, in_module: bool = False) -> FileKind | None:
    """Return the kind of the file `name` in a folder called `folder`; None for ignored files.

    `in_module`: the folder is a Python package, whose modules are code even in a folder `launch`.
    """
    named = _NAMES.get(name)
    if named is not None:
        return named
    if name.endswith(_LAUNCH_ENDINGS):
        return FileKind.LAUNCH
    stem, dot, ending = name.rpartition(".")
    if not dot or not stem:
        return None
    kind = _ENDINGS.get(ending.lower())
    if kind is None and ending in {"in", "em"}:  # a template of CMake or C++ can be read as its output
        output = stem.rpartition(".")[2]
        return FileKind.BUILD if output == "cmake" else FileKind.CPP if output in {"h", "hpp", "cpp"} else None
    if ending == "idl":
        return _IDL_FOLDERS.get(folder)
    if folder == "launch" and not in_module and ending in {"py", "xml", "yaml", "yml"}:
        return FileKind.LAUNCH
    if kind is FileKind.CONFIG and ending == "xml" and ("plugin" in stem or "nodelet" in stem):
        return FileKind.PLUGIN
    return kind
