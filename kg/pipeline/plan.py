"""Plan a build: packages are read again if their files, or the results of their look-ups in the build, have changed.

Cheap checks come first. Sizes and times of all files that a result depends on decide for most packages; if these
differ, the digests of the contents do. Most look-ups (which file does this include refer to?) depend only on the paths
of the build, so they are repeated only if paths were added or removed; those of files that no scan lists are always
repeated.
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from kg import resources
from kg.corpus.files import FilePath
from kg.corpus.reading import load, mark
from kg.corpus.workspace import INSTALLED, FileEntry, PackageFolder, Source, Workspace
from kg.facts import FileKind
from kg.language.loading import identity
from kg.lazily import lazily
from kg.pipeline import cache
from kg.pipeline.calls import call_files, read_calls
from kg.pipeline.filecache import State as FileState
from kg.pipeline.filecache import cached_text, installations, states, unless_changed
from kg.pipeline.recording import answer

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.pipeline.state import PackageState, State
    from kg.settings import Settings

with lazily():
    from importlib.metadata import version as installed_version

Key = tuple[str, str]
"""Name of the source and path of the package in it."""

CODE: Final = (
    *(
        "facts",
        "holes.py",
        "lazily.py",
        "names.py",
        "xmltext.py",
        "yamltext.py",
        "corpus",
        "symbolic",
        "extract",
        "language",
    ),
    *("launch", "graph", "syntax/__init__.py", "syntax/names.py"),
    *("pipeline/cache.py", "pipeline/visible.py", "pipeline/recording.py", "pipeline/work.py"),
)
"""Code and data of `kg` that results depend on."""
LIBRARIES: Final = (
    *("lxml", "msgspec", "numpy", "pathspec", "pyoxigraph", "pyyaml", "rosbags", "spacy"),
    *("thinc", "tree-sitter", "tree-sitter-cpp", "tree-sitter-python"),
)
"""Distributions that results depend on."""

_LANGUAGES: Final = frozenset({FileKind.CPP, FileKind.PYTHON})
_BYTES: Final = 16
_VERSION: Final = "version"
"""Cache file with the version of code, data and libraries."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Packages to read, and the earlier results that are still valid."""

    version: str
    shape: str
    read: tuple[tuple[Source, PackageFolder], ...]
    reused: dict[Key, PackageState] = field(default_factory=dict)


def version(settings: Settings, folder: Path | None = None) -> str:
    """Return a digest of the code and data of `kg`, its libraries, and the settings that results depend on.

    It contains the contents of code, data and the users' descriptions of framework calls, so installations with the
    same files have the same version. The part for code, data and libraries is cached in `folder` until one of their
    files changes. Raises as `kg.pipeline.calls.read_calls`.
    """
    set_to = [settings.base, str(settings.max_file_bytes), *read_calls(call_files(settings)).values()]
    return _digest([code_version(settings.nlp_model, folder), *set_to])


def code_version(model: str, folder: Path | None = None) -> str:
    """Return a digest of the code and data of `kg`, its libraries and the spaCy pipeline `model`, as `version`."""
    package = Path(__file__).resolve().parent.parent
    knowledge = [path for path in resources.folder("ontology").iterdir() if path.suffix != ".ttl"]  # only used by rules
    own = [*(package / name for name in CODE), *sorted(knowledge)]
    files, place = tuple(state for root in own for state in states(root)), folder and folder / _VERSION

    def compute() -> str:
        libraries = [f"{name} {installed_version(name)}" for name in ("kg-ros", *LIBRARIES)]
        return _digest([unless_changed(_contents, tuple(own), seen=files), *libraries])

    text = cached_text(place, (*files, *installations()), sys.version, compute)
    return _digest([text, sys.version, identity(model)])


@lru_cache(maxsize=1)
def _contents(own: tuple[Path, ...], _seen: tuple[FileState, ...]) -> str:
    """Return a digest of the contents of files and folders, cached in this process."""
    return resources.digest(own)


def shape(sources: Iterable[Source]) -> str:
    """Return a digest of the paths of all files of a build and the packages that own them."""
    lines: list[str] = []
    for source in sources:
        lines.append(f"{source.repository.name} {source.root}")
        for package in source.packages:
            lines.append(f"{package.name} {package.path} {package.manifest}")
            lines += [f"{entry.kind} {entry.executable} {entry.path}" for entry in package.files]
        lines += [f"{entry.kind} {entry.path}" for entry in source.loose]
        lines += [f"{link} {target}" for link, target in source.links]
    return _digest(lines)


def listing(package: PackageFolder) -> str:
    """Return a digest of the paths, kinds and permissions of the files of a package."""
    lines = [f"{entry.kind} {entry.executable} {entry.path}" for entry in package.files]
    return _digest([f"{package.name} {package.manifest}", *lines])


def stamp(
    workspace: Workspace, source: str, package: PackageFolder, inputs: Iterable[str], entries: dict[str, FileEntry]
) -> str:
    """Return a digest of size and time of all files that the result of a package depends on."""
    own = {f"{source}:{entry.path}": entry for entry in package.files}
    lines = [f"{key} {entry.bytes} {entry.mtime_ns}" for key, entry in own.items()]
    for key in inputs:
        if key not in own:
            entry = entries.get(key)
            now = f"{entry.bytes} {entry.mtime_ns}" if entry else _size_and_time(workspace, key)
            lines.append(f"{key} {now}")
    return _digest(lines)


def make_plan(workspace: Workspace, state: State, folder: Path, now: str, limit_bytes: int) -> Plan:
    """Return the packages of `workspace` to read; `folder` is the cache, `now` the current `version`.

    Files larger than `limit_bytes` are not read.
    """
    current = shape(workspace.sources)
    entries = entries_by_name(workspace.sources)
    read: list[tuple[Source, PackageFolder]] = []
    reused: dict[Key, PackageState] = {}
    for source in workspace.sources:
        name = source.repository.name
        packages = state.sources[name].packages if name in state.sources and state.version == now else {}
        for package in source.packages:
            earlier = packages.get(package.path)
            cached = earlier if earlier and cache.exists(folder, earlier.result) else None
            same = cached and _still_holds(workspace, source, package, cached, entries, limit_bytes)
            if same and (state.shape == current or _same_answers(workspace, folder, same)):
                reused[name, package.path] = same
            else:
                read.append((source, package))
    return Plan(now, current, tuple(read), reused)


def entries_by_name(sources: Iterable[Source]) -> dict[str, FileEntry]:
    """Return the entries of all files of a build by `repository:path`."""
    entries: dict[str, FileEntry] = {}
    for source in sources:
        name = source.repository.name
        for files in (source.loose, *(package.files for package in source.packages)):
            entries.update((f"{name}:{entry.path}", entry) for entry in files)
    return entries


def _still_holds(  # noqa: PLR0913, PLR0917 - called in one place
    workspace: Workspace,
    source: Source,
    package: PackageFolder,
    earlier: PackageState,
    entries: dict[str, FileEntry],
    limit_bytes: int,
) -> PackageState | None:
    """Return the earlier result, with its stamp updated, if all its inputs are unchanged."""
    if earlier.listing != listing(package) or any(
        answer(workspace, lookup) != before for lookup, before in earlier.outside
    ):
        return None
    now = stamp(workspace, source.repository.name, package, earlier.inputs, entries)
    # A mark with a space is a problem: more than size and time decides whether a file can be read.
    doubtful = (
        earlier.inputs if now != earlier.stamp else [key for key, before in earlier.inputs.items() if " " in before]
    )
    if any(mark_of(workspace, key, limit_bytes) != earlier.inputs[key] for key in doubtful):
        return None
    return earlier if now == earlier.stamp else replace(earlier, stamp=now)


def mark_of(workspace: Workspace, key: str, limit_bytes: int) -> str:
    """Return the current mark of a file, given as `repository:path`."""
    repository, _, path = key.partition(":")
    return mark(load(workspace, FilePath(repository, path), limit_bytes))


def code_bytes(package: PackageFolder) -> int:
    """Return the size of the code of a package, in C++ and Python."""
    return sum(entry.bytes for entry in package.files if entry.kind in _LANGUAGES)


def _size_and_time(workspace: Workspace, key: str) -> str:
    """Return size and time of a file that no scan lists: one with another suffix, or an installed one.

    For a file that only workers have, return the commit.
    """
    repository, _, inner = key.partition(":")
    source = workspace.source(repository)
    if source is not None and source.pin is not None:
        return source.pin.commit
    path = Path("/", inner) if repository == INSTALLED else None
    if source is not None:
        path = source.root / inner
    try:
        status = path.stat() if path else None
    except OSError:
        status = None
    return f"{status.st_size} {status.st_mtime_ns}" if status else "gone"


def _same_answers(workspace: Workspace, folder: Path, earlier: PackageState) -> bool:
    lookups = cache.lookups(folder, earlier.result)
    return lookups is not None and all(answer(workspace, lookup) == before for lookup, before in lookups.items())


def _digest(lines: list[str]) -> str:
    return hashlib.blake2b("\n".join(lines).encode("utf-8", "surrogateescape"), digest_size=_BYTES).hexdigest()
