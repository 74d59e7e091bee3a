"""State of a build for the next one: results of packages, with the files they depend on.

It is in `.kg/cache/state.json`. Queries do not need it; if it is missing or unreadable, everything is read again.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Final, TypeAlias

import msgspec

from kg.facts import Known, Problem, Repository
from kg.pipeline.report import PackageResult
from kg.store.layout import write_atomically

Question: TypeAlias = tuple[str, ...]
"""A look-up of node types by wiring: the name of a method of `NodeTypes`, or `record`, and its arguments."""

_FORM: Final = 4
_NAME: Final = "state.json"


@dataclass(frozen=True, slots=True)
class PackageState:
    """State of a package when it was last read.

    `listing` is a digest of the paths of its files, `stamp` one of size and time of all files that were read. `inputs`
    maps each of these (`repository:path`) to its mark, `outside` contains look-ups, with results, of files that no scan
    lists. `result` is the name of its result in the cache, `known` what other packages can start from it.
    """

    name: str
    path: str
    listing: str
    stamp: str
    inputs: dict[str, str]
    outside: tuple[tuple[tuple[str, ...], str], ...]
    result: str
    counts: dict[str, int]
    unresolved: dict[str, int]
    problems: tuple[Problem, ...]
    known: Known = field(default_factory=Known)

    def report(self, source: str) -> PackageResult:
        """Return the entry of the package in the report of a build."""
        return PackageResult(source, self.name, self.path, self.counts, self.unresolved, self.problems)


@dataclass(frozen=True, slots=True)
class WiredSystem:
    """State of a system when it was last wired.

    `configuration` is a digest of the starts of its launch file, `graph` one of its triples. `instances` is the number
    of its starts, `asked` the indices of its look-ups in the `answers` of all systems.
    """

    configuration: str
    graph: str
    instances: int
    asked: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class PackageSystems:
    """The systems of one package, by the paths of their launch files.

    `result` is the result that they were read from.
    """

    result: str
    graphs: dict[str, WiredSystem] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Systems:
    """The systems of a store: for each package with launch files, by source and path of the package.

    `version` identifies the code that wired them. `answers` contains the look-ups of node types that they depend on,
    each with a digest of the result.
    """

    version: str = ""
    answers: tuple[tuple[Question, str], ...] = ()
    packages: dict[str, dict[str, PackageSystems]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class SourceState:
    """State of a source when it was last read.

    `head` contains the triples about itself, `quads` is the size of its graph. The files of one that is `elsewhere` are
    on other machines.
    """

    repository: Repository
    problems: tuple[Problem, ...]
    packages: dict[str, PackageState]
    head: str
    quads: int
    elsewhere: bool = False


@dataclass(frozen=True, slots=True)
class State:
    """All sources of a store.

    `version` identifies everything in `kg` that results depend on, `shape` the paths of all files of the build,
    `generation` is the snapshot of the store with these sources, `roots` contains the names given by the user, `rules`
    is the digest of the rules that ran last.
    """

    version: str = ""
    shape: str = ""
    generation: int = 0
    roots: tuple[str, ...] = ()
    sources: dict[str, SourceState] = field(default_factory=dict)
    rules: str = ""
    systems: Systems = field(default_factory=Systems)


def load(cache: Path) -> State:
    """Return the state saved by the last build in the folder `cache`; an empty one if it is missing or unreadable."""
    try:
        # The decoder of msgspec refuses names of files that are not Unicode, which JSON of Python can express.
        content = json.loads((cache / _NAME).read_bytes())
        return msgspec.convert(content, State) if content["form"] == _FORM else State()
    except (OSError, ValueError, KeyError, TypeError, msgspec.ValidationError):
        return State()


def save(cache: Path, state: State) -> None:
    """Save `state` for the next build; OSError if it cannot be written."""
    content = {"form": _FORM, **_fields(state)}
    written = json.dumps(content, separators=(",", ":"), default=_fields)
    write_atomically(cache / _NAME, written.encode())


def _fields(value: Any) -> dict[str, Any]:
    """Return the fields of a dataclass, without the deep copy that `asdict` makes."""
    return {one.name: getattr(value, one.name) for one in fields(value)}


def discard(cache: Path) -> None:
    """Make the next build read everything again."""
    (cache / _NAME).unlink(missing_ok=True)
