"""Progress and final reports of a build."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.errors import KgError
    from kg.facts import Problem, Repository
    from kg.pipeline.state import Systems


@dataclass(frozen=True, slots=True)
class PackageResult:
    """Result of one package.

    `counts` has the keys of `kg.graph.Counts`; `unresolved` counts the unknown names by reason.
    """

    source: str
    name: str
    path: str
    counts: Mapping[str, int]
    unresolved: Mapping[str, int]
    problems: tuple[Problem, ...] = ()
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class SourceReport:
    """Result of one source: how many of its packages were read, reused from the last build, or removed.

    `problems` are those that belong to none of its packages.
    """

    repository: Repository
    packages: tuple[PackageResult, ...]
    read: int
    reused: int
    removed: int
    problems: tuple[Problem, ...] = ()

    def total(self, what: str) -> int:
        """Return the sum over the packages of a key of `PackageResult.counts`."""
        return sum(package.counts.get(what, 0) for package in self.packages)


@dataclass(frozen=True, slots=True)
class Inferred:
    """Result of rules: how many triples are inferred now, how many were added and removed.

    `mode` is full or incremental, or none where the rules could not run, so that nothing is inferred. `problems` are
    the errors of the rules and ontologies that were left out.
    """

    triples: int
    added: int
    removed: int
    seconds: float
    mode: str
    problems: tuple[KgError, ...] = ()


@dataclass(frozen=True, slots=True)
class SystemsReport:
    """How many launch configurations a store has, how many instances they start, and how many graphs changed.

    `failed` are those of this build that could not be wired, as `path: message`: a defect of `kg` (KG121).
    """

    configurations: int = 0
    instances: int = 0
    changed: int = 0
    failed: tuple[str, ...] = ()


def totals(systems: Systems) -> SystemsReport:
    """Return the counts of the systems of a store."""
    graphs = [
        one for found in systems.packages.values() for package in found.values() for one in package.graphs.values()
    ]
    return SystemsReport(len(graphs), sum(one.instances for one in graphs))


@dataclass(frozen=True, slots=True)
class BuildReport:
    """Result of a build; `generation` is the snapshot it made, None if nothing had changed. Times in seconds.

    `gone` are the sources no longer in the folders built; they were removed from the store.
    `inferred` is None when no rules ran.
    """

    sources: tuple[SourceReport, ...]
    generation: int | None
    seconds: float
    jobs: int
    gone: tuple[str, ...] = ()
    inferred: Inferred | None = None
    systems: SystemsReport | None = None

    @property
    def read(self) -> int:
        """How many packages were read."""
        return sum(source.read for source in self.sources)

    @property
    def reused(self) -> int:
        """How many packages were as the last build left them."""
        return sum(source.reused for source in self.sources)

    @property
    def problems(self) -> tuple[tuple[str, Problem], ...]:
        """All problems with the name of their source."""
        found = []
        for source in self.sources:
            listed = [*source.problems, *(one for package in source.packages for one in package.problems)]
            found += [(source.repository.name, one) for one in listed]
        return tuple(found)

    def total(self, what: str) -> int:
        """Return the sum over all sources of a key of `PackageResult.counts`."""
        return sum(source.total(what) for source in self.sources)

    def unresolved(self) -> dict[str, int]:
        """Return how many names are not known by the reason why, the most frequent first."""
        found: dict[str, int] = {}
        for source in self.sources:
            for package in source.packages:
                for reason, number in package.unresolved.items():
                    found[reason] = found.get(reason, 0) + number
        return dict(sorted(found.items(), key=lambda item: (-item[1], item[0])))


class Report(Protocol):
    """Receiver of the progress of a build; every call comes from the process that called `build`."""

    def fetching(self, message: str) -> None:
        """Report the state of a git address."""
        ...

    def source(self, repository: Repository, packages: int, problems: tuple[Problem, ...]) -> None:
        """Report a source that was found, with how many packages."""
        ...

    def planned(self, read: int, reused: int, jobs: int) -> None:
        """Report how many packages will be read, how many are unchanged, and the number of processes.

        `jobs` is 0 for a cluster.
        """
        ...

    def placed(self, worker: str, source: str) -> None:
        """Report that a worker of a cluster, by its address, begins to read packages of a source."""
        ...

    def done(self, result: PackageResult) -> None:
        """Report that a package was read."""
        ...

    def writing(self, triples: int) -> None:
        """Report the number of triples being written."""
        ...

    def inferring(self) -> None:
        """Report that the rules run."""
        ...

    def finished(self, report: BuildReport) -> None:
        """Report that the build has ended and is in force."""
        ...


class Silent:
    """A report that prints nothing."""

    def fetching(self, message: str) -> None:
        """Ignore the state of a git address."""

    def source(self, repository: Repository, packages: int, problems: tuple[Problem, ...]) -> None:
        """Take note of a source."""

    def planned(self, read: int, reused: int, jobs: int) -> None:
        """Take note of the plan."""

    def placed(self, worker: str, source: str) -> None:
        """Ignore what a worker of a cluster reads."""

    def done(self, result: PackageResult) -> None:
        """Take note of a package that was read."""

    def writing(self, triples: int) -> None:
        """Take note of the writing."""

    def inferring(self) -> None:
        """Take note of the rules."""

    def finished(self, report: BuildReport) -> None:
        """Take note of the end."""
