"""What a build leaves behind for the next one: which packages gave what, from which files.

It stands in `.kg/cache/state.json`. It is never needed to answer queries; when it is lost or not readable,
everything is read again.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.facts import Problem, Repository
from kg.pipeline.report import PackageResult
from kg.store.layout import write_atomically

if TYPE_CHECKING:
    from pathlib import Path

    from kg.pipeline.recording import Lookup

__all__ = ["PackageState", "PackageSystems", "SourceState", "State", "Systems", "discard", "load", "save"]

Systems: TypeAlias = "dict[str, dict[str, PackageSystems]]"
"""The systems of each package that has launch files, by source and path of the package."""

_FORM: Final = 3
_NAME: Final = "state.json"


@dataclass(frozen=True, slots=True)
class PackageState:
    """A package as it was read last.

    `listing` is a digest of the paths of its files, `stamp` one of size and time of all that was read, `inputs`
    the mark of each file read (`repository:path`), `outside` the look-ups, with their answers, of files that no scan
    lists, `result` the name of its result in the cache.
    """

    name: str
    path: str
    listing: str
    stamp: str
    inputs: dict[str, str]
    outside: tuple[tuple[Lookup, str], ...]
    result: str
    counts: dict[str, int]
    unresolved: dict[str, int]
    problems: tuple[Problem, ...]

    def report(self, source: str) -> PackageResult:
        """Return what the report of a build says of the package."""
        return PackageResult(source, self.name, self.path, self.counts, self.unresolved, self.problems)


@dataclass(frozen=True, slots=True)
class PackageSystems:
    """The systems of one package as they were wired last.

    `uses` are the packages that its launch files name, `basis` is a digest of all that the systems depend on, `graphs`
    maps the paths of the launch files to digests of their graphs, `instances` counts what they start.
    """

    uses: tuple[str, ...]
    basis: str
    graphs: dict[str, str] = field(default_factory=dict)
    instances: int = 0


@dataclass(frozen=True, slots=True)
class SourceState:
    """A source as it was read last: `head` are the triples about itself, `quads` is the size of its graph."""

    repository: Repository
    problems: tuple[Problem, ...]
    packages: dict[str, PackageState]
    head: str
    quads: int


@dataclass(frozen=True, slots=True)
class State:
    """All sources of a store.

    `version` stands for everything in `kg` that results depend on, `shape` for the paths of all files of the build,
    `generation` is the snapshot of the store that the sources stand in, `roots` what the user named, `rules` the digest
    of the rules that ran last.
    """

    version: str = ""
    shape: str = ""
    generation: int = 0
    roots: tuple[str, ...] = ()
    sources: dict[str, SourceState] = field(default_factory=dict)
    rules: str = ""
    systems: Systems = field(default_factory=dict)


def load(cache: Path) -> State:
    """Return the state that the last build left in the folder `cache`; an empty one when there is none to be read."""
    try:
        return _state(json.loads((cache / _NAME).read_bytes()))
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return State()


def save(cache: Path, state: State) -> None:
    """Leave `state` for the next build; OSError when it cannot be written."""
    content = {"form": _FORM, **_fields(state)}
    written = json.dumps(content, separators=(",", ":"), default=_fields)
    write_atomically(cache / _NAME, written.encode())


def _fields(value: Any) -> dict[str, Any]:
    """Return the fields of a dataclass; `asdict` would copy all that is in them."""
    return {one.name: getattr(value, one.name) for one in fields(value)}


def discard(cache: Path) -> None:
    """Make the next build read everything again."""
    (cache / _NAME).unlink(missing_ok=True)


def _state(content: dict[str, Any]) -> State:
    if content.pop("form") != _FORM:
        return State()
    sources = {name: _source(source) for name, source in content.pop("sources").items()}
    systems = {
        name: {path: PackageSystems(**{**one, "uses": tuple(one["uses"])}) for path, one in packages.items()}
        for name, packages in content.pop("systems").items()
    }
    return State(**{**content, "roots": tuple(content["roots"])}, sources=sources, systems=systems)


def _source(content: dict[str, Any]) -> SourceState:
    packages = {path: _package(package) for path, package in content["packages"].items()}
    problems = tuple(Problem(**problem) for problem in content["problems"])
    repository = Repository(**content["repository"])
    return SourceState(repository, problems, packages, content["head"], content["quads"])


def _package(content: dict[str, Any]) -> PackageState:
    problems = tuple(Problem(**problem) for problem in content["problems"])
    outside = tuple((tuple(lookup), answer) for lookup, answer in content["outside"])
    return PackageState(**{**content, "problems": problems, "outside": outside})
