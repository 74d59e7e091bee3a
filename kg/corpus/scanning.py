"""Scanning of a source: every folder is listed once, and every file examined once.

Skipped are hidden folders, folders with an ignore marker of catkin, colcon or ament, build artifacts, nested checkouts
(sources of their own), and links that lead out of the root or in a loop. Inside a package, a marker hides nested
packages only, as the build files of the package can name what is below it.
"""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from kg.corpus.files import FileEntry, PackageFolder, Source, sort_file
from kg.corpus.git import describe
from kg.errors import SourceError
from kg.facts import FileKind, Problem, Repository
from kg.xmltext import parse_xml

_IGNORE_MARKERS: Final = frozenset({"COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"})
_BUILD_FOLDERS: Final = frozenset({"build", "install", "devel", "log"})
_BUILD_TRACES: Final = frozenset({"CMakeCache.txt", "CMakeFiles", ".catkin", ".built_by", "setup.bash"})
_NEVER_SOURCE: Final = frozenset({"__pycache__", "node_modules", "CMakeFiles", "site-packages"})
_CODE: Final = frozenset({FileKind.CPP, FileKind.PYTHON, FileKind.LAUNCH, FileKind.MESSAGE})
_SHEBANG_BYTES: Final = 64
_MANIFEST_BYTES: Final = 1 << 20


@dataclass(slots=True)
class _Folder:
    """A package whose files are being collected; `marked` below an ignore marker."""

    path: str
    manifest: str | None
    files: list[FileEntry] = field(default_factory=list)
    marked: bool = False


@dataclass(slots=True)
class _Walk:
    """The state of a scan: pending folders and results."""

    root: str
    real_root: str
    pending: list[tuple[str, _Folder]]
    loose: _Folder
    packages: list[_Folder] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    links: list[tuple[str, str]] = field(default_factory=list)
    nested: list[str] = field(default_factory=list)
    excluded: list[tuple[str, str]] = field(default_factory=list)
    """Folders that may have packages, each with the marker file that excludes it."""

    def problem(self, path: str, message: str, code: str = "KG110") -> None:
        """Record that something at `path` was not read."""
        printable = os.fsencode(path).decode("utf-8", "backslashreplace")
        self.problems.append(Problem(code, message, printable))


def scan(root: Path, repository: Repository | None = None) -> Source:
    """Scan one source; `repository` overrides git's information about the folder.

    A folder inside a checkout is read as that part of the checkout, with paths relative to its root. Raises
    `SourceError` (KG101) if the folder cannot be listed; other failures are problems of the source.
    """
    return _scan(root, repository)[0]


def scan_tree(root: Path) -> tuple[Source, ...]:
    """Scan a folder and its nested checkouts (repositories of a workspace, submodules), each as a source."""
    source, nested = _scan(root, None)
    inner = tuple(inner_source for path in nested for inner_source in scan_tree(Path(path)))
    return (source, *inner) if source.packages or not inner else inner


def _scan(root: Path, repository: Repository | None) -> tuple[Source, list[str]]:
    start = os.path.abspath(root)  # noqa: PTH100  (links on the way to the root are the user's own)
    if not os.path.isdir(start):  # noqa: PTH112  (as fast as the rest of the walk)
        raise SourceError("KG101", f"the folder {root} does not exist", hint="Check the path.")
    described = repository or describe(Path(start))
    base = described.root
    loose = _Folder(".", None)
    within = os.path.relpath(start, base)
    walk = _Walk(base, os.path.realpath(base), [("" if within == "." else within, loose)], loose)
    _walk(walk)
    name = described.name.rpartition("/")[2]
    packages = _with_launch_files(_name_packages(walk, name), loose.files, name)
    problems = tuple(sorted(walk.problems, key=lambda problem: (problem.path, problem.code)))
    links = tuple(sorted(walk.links))
    owned = {entry.path for entry in packages[0].files} if packages else set()
    left = tuple(entry for entry in _by_path(loose.files) if entry.path not in owned)
    return Source(described, Path(base), packages, left, problems, links), [f"{base}/{path}" for path in walk.nested]


def _walk(walk: _Walk) -> None:
    first = True
    while walk.pending:
        folder, owner = walk.pending.pop()
        try:
            with os.scandir(f"{walk.root}/{folder}") as listing:
                entries = list(listing)
        except OSError as error:
            if first:
                raise SourceError("KG101", f"the folder {walk.root} cannot be listed: {error.strerror}") from error
            walk.problem(folder, f"the folder cannot be listed: {error.strerror}")
            continue
        _list_folder(walk, folder, owner, entries, top=first)
        first = False


def _list_folder(walk: _Walk, folder: str, owner: _Folder, entries: list[os.DirEntry[str]], *, top: bool) -> None:
    names = {entry.name for entry in entries}
    base = folder.rpartition("/")[2]
    if not top and "pyvenv.cfg" in names:
        return
    if not top and (markers := names & _IGNORE_MARKERS):
        owner = replace(owner, marked=True)
        walk.excluded.append((folder, min(markers)))
    if not top and ".git" in names:
        walk.nested.append(folder)
        return
    generated = owner.manifest is None or names & _BUILD_TRACES
    if base in _BUILD_FOLDERS and not top and generated and "package.xml" not in names:
        return
    manifest = next((name for name in ("package.xml", "manifest.xml") if name in names), None)
    if owner.marked and (manifest or owner.manifest is None):
        return
    if manifest and not (manifest == "manifest.xml" and owner.manifest):
        owner = _Folder(folder or ".", f"{folder}/{manifest}" if folder else manifest)
        walk.packages.append(owner)
    in_module = "__init__.py" in names
    for entry in entries:
        _take(walk, entry, f"{folder}/{entry.name}" if folder else entry.name, owner, in_module=in_module)


def _take(walk: _Walk, entry: os.DirEntry[str], path: str, owner: _Folder, *, in_module: bool) -> None:
    name = entry.name
    if not name.isascii() and not _is_text(name):
        walk.problem(path, "the name is not UTF-8; it was left out")
        return
    if entry.is_symlink() and not _follow(walk, entry, path):
        return
    if entry.is_dir():
        if not name.startswith(".") and name not in _NEVER_SOURCE and not name.endswith(".egg-info"):
            walk.pending.append((path, owner))
        return
    folder = path[: -len(name) - 1].rpartition("/")[2]
    kind = sort_file(name, folder, in_module=in_module)
    if kind is None and ("." in name or name == "Makefile"):
        return
    try:
        status = entry.stat()
    except OSError as error:
        walk.problem(path, f"the file cannot be read: {error.strerror}")
        return
    executable = bool(status.st_mode & stat.S_IXUSR)
    if not stat.S_ISREG(status.st_mode):
        return
    if kind is None:
        kind = _kind_by_beginning(entry.path, executable=executable)
    if kind is not None:
        owner.files.append(FileEntry(path, kind, status.st_size, status.st_mtime_ns, executable))


def _is_text(name: str) -> bool:
    try:
        name.encode()
    except UnicodeEncodeError:
        return False
    return True


def _follow(walk: _Walk, entry: os.DirEntry[str], path: str) -> bool:
    """Return whether a link is read as a file; links to folders are recorded, but not followed."""
    try:
        target = os.path.realpath(entry.path, strict=True)
    except OSError as error:
        walk.problem(path, f"the link leads nowhere: {error.strerror}")
        return False
    inside = target == walk.real_root or target.startswith(walk.real_root + "/")
    if not inside:
        if entry.name != "CMakeLists.txt":
            walk.problem(path, f"the link leads out of the source, to {target}; name that folder as a source too")
        return False
    if not entry.is_dir():
        return True
    walk.links.append((path, os.path.relpath(target, walk.real_root)))
    return False


def _kind_by_beginning(path: str, *, executable: bool) -> FileKind | None:
    """Return `PYTHON` for a program without a suffix whose first line names python, `PROGRAM` for other programs."""
    try:
        with open(path, "rb") as file:  # noqa: PTH123  (a Path for each file would cost more than the reading)
            first = file.read(_SHEBANG_BYTES)
    except OSError:
        return None
    if first.startswith(b"#!") and b"python" in first.split(b"\n", 1)[0]:
        return FileKind.PYTHON
    return FileKind.PROGRAM if executable and first.startswith((b"#!", b"\x7fELF")) else None


def _by_path(files: list[FileEntry]) -> list[FileEntry]:
    return sorted(files, key=lambda entry: entry.path)


def _name_packages(walk: _Walk, folder_name: str) -> tuple[PackageFolder, ...]:
    """Return the packages with their names, sorted by path; duplicates are named by their folder."""
    if not walk.packages:
        return _whole_root(walk, folder_name)
    taken: dict[str, str] = {}
    named = []
    for folder in sorted(walk.packages, key=lambda package: (package.path.count("/"), package.path)):
        fallback = folder_name if folder.path == "." else folder.path.rpartition("/")[2]
        name = _manifest_name(walk, folder) or fallback
        if name in taken:
            message = f"a package {name} already exists in {taken[name]}; this one is kept as {folder.path}"
            walk.problem(folder.manifest or folder.path, message, "KG120")
            name = folder.path
        taken[name] = folder.path
        named.append(PackageFolder(name, folder.path, folder.manifest, tuple(_by_path(folder.files))))
    return tuple(sorted(named, key=lambda package: package.path))


def _with_launch_files(
    packages: tuple[PackageFolder, ...], loose: list[FileEntry], name: str
) -> tuple[PackageFolder, ...]:
    """Return the packages, after one without a manifest for launch files outside of all others.

    Such files are started by their path (`roslaunch FILE`), often to start a whole robot.
    """
    files = tuple(entry for entry in _by_path(loose) if entry.kind is FileKind.LAUNCH)
    if all(_is_settings(entry.path) for entry in files) or not packages or packages[0].path == ".":
        return packages
    taken = any(package.name == name for package in packages)
    return (PackageFolder(f"{name}-root" if taken else name, ".", None, files), *packages)


def _is_settings(path: str) -> bool:
    """Return whether a file of a folder `launch` most likely has parameters: YAML without `launch` in its name."""
    return path.endswith((".yaml", ".yml")) and "launch" not in path.rpartition("/")[2]


def _whole_root(walk: _Walk, name: str) -> tuple[PackageFolder, ...]:
    files = walk.loose.files
    if walk.nested and not files:
        return ()
    for folder, marker in walk.excluded:
        walk.problem(folder, f"{marker} excludes this folder; to read it, name it as a source", "KG102")
    if not any(entry.kind in _CODE for entry in files):
        walk.problem(".", "found no package.xml and no code", "KG102")
        return ()
    walk.problem(".", f"found no package.xml; the whole folder is read as one package {name}", "KG102")
    return (PackageFolder(name, ".", None, tuple(_by_path(files))),)


def _manifest_name(walk: _Walk, folder: _Folder) -> str | None:
    """Return the name in a package.xml; None for a rosbuild manifest, which has none, or a missing one."""
    if folder.manifest is None or folder.manifest.endswith("manifest.xml"):
        return None
    try:
        with open(f"{walk.root}/{folder.manifest}", "rb") as file:  # noqa: PTH123  (as above)
            text = file.read(_MANIFEST_BYTES)
    except OSError:
        return None
    root = parse_xml(text).root
    name = root.findtext("name") if root is not None else None
    return "".join(name.split()) or None if name else None
