"""Wiring of launch files: the graph of each, with the look-ups of node types that it depends on.

A build with several workers shares out the launch files of packages that it has not wired before; these are pure
functions of cached results, so that workers need no store.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Final

import msgspec

from kg.errors import guarded
from kg.facts import LaunchConfiguration, LaunchProblem, LaunchProblemKind, Location, System
from kg.graph.systems import system_triples
from kg.launch.wiring.systems import wire
from kg.pipeline import cache
from kg.pipeline.catalogue import Catalogue
from kg.pipeline.visible import digest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from kg.graph.iris import Iris
    from kg.pipeline.plan import Key
    from kg.pipeline.pool import Pool
    from kg.pipeline.state import PackageState, Question

_PART: Final = 8
"""Number of launch files that a worker wires at a time."""


@dataclass(frozen=True, slots=True)
class Wired:
    """A system as N-Triples; `configuration` and `graph` are digests of its launch file's starts and of the triples.

    `instances` is the number of its starts, `asked` the look-ups of its wiring, `failed` why it could not be wired.
    """

    path: str
    configuration: str
    graph: str
    content: bytes
    instances: int
    asked: tuple[Question, ...]
    failed: str = ""


def wired(configuration: LaunchConfiguration, catalogue: Catalogue, iris: Iris) -> Wired:
    """Wire a configuration.

    One that triggers a defect of `kg` gets a problem and no instances.
    """
    failures: list[str] = []

    def failed(words: str) -> System:
        message = f"its nodes could not be wired: {words}"
        failures.append(f"{configuration.repository} {configuration.path}: {message}")
        problem = LaunchProblem(LaunchProblemKind.UNRESOLVED, message, Location(configuration.path, 1))
        return System(replace(configuration, problems=(*configuration.problems, problem)))

    catalogue.questions.clear()
    system = guarded(partial(wire, configuration, catalogue), failed)
    content = system_triples(system, catalogue.records(system), iris)
    mark, asked = mark_of(configuration), tuple(catalogue.questions)
    return Wired(configuration.path, mark, digest(content), content, len(system.instances), asked, *failures)


def mark_of(configuration: LaunchConfiguration) -> str:
    """Return a digest of the starts of a launch file."""
    return digest(msgspec.msgpack.encode(configuration))


@dataclass(frozen=True, slots=True)
class _Part:
    """Every `of`-th launch file of a package from the one `at` on."""

    key: Key
    at: int
    of: int

    def run(self, shared: _Shared) -> tuple[list[Wired], dict[Question, str]]:
        """Return the systems, and the digests of the results of their look-ups."""
        found = cache.launches(shared.folder, shared.packages[self.key].result) or ()
        catalogue = shared.catalogue
        systems = [wired(one, catalogue, shared.iris) for one in found[self.at :: self.of]]
        return systems, {question: catalogue.mark(question) for one in systems for question in one.asked}


class _Shared:
    """What all parts are wired with; a worker makes its own catalogue."""

    def __init__(self, folder: Path, iris: Iris, packages: Mapping[Key, PackageState]) -> None:
        self.folder = folder
        self.iris = iris
        self.packages = {
            key: replace(one, inputs={}, outside=(), counts={}, unresolved={}, problems=())
            for key, one in packages.items()
        }
        self._catalogue: Catalogue | None = None

    @property
    def catalogue(self) -> Catalogue:
        """The node types of the packages."""
        if self._catalogue is None:
            self._catalogue = Catalogue(self.folder, self.packages)
        return self._catalogue


def wired_by(
    pool: Pool, wanted: Mapping[Key, int], folder: Path, iris: Iris, packages: Mapping[Key, PackageState]
) -> Iterator[tuple[Key, list[Wired], dict[Question, str]]]:
    """Yield packages with their systems, and the digests of their look-ups, as the workers of a pool wire them.

    `wanted` has the number of launch files of each package. One whose worker dies is left out.
    """
    parts = [_Part(key, at, of) for key, number in wanted.items() for of in [-(-number // _PART)] for at in range(of)]
    answers: dict[Key, list[tuple[list[Wired], dict[Question, str]]]] = {}
    for at, answer in pool.answers(_Shared(folder, iris, packages), parts):
        if answer is None:
            continue
        part = parts[at]
        have = answers.setdefault(part.key, [])
        have.append(answer)
        if len(have) == part.of:
            systems = [one for some, _ in have for one in some]
            yield part.key, systems, {question: mark for _, marks in have for question, mark in marks.items()}
            have.clear()
