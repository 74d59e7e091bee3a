"""Progress and final reports of a build."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.facts import Problem  # noqa: TC001 - results are read by these annotations

if TYPE_CHECKING:
    from kg.corpus.fetching.lock import Entry
    from kg.facts import Repository
    from kg.pipeline.inferring import Inferred
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

    `problems` contains those outside its packages.
    """

    repository: Repository
    packages: tuple[PackageResult, ...] = field(repr=False)
    read: int
    reused: int
    removed: int
    problems: tuple[Problem, ...] = ()

    def total(self, what: str) -> int:
        """Return the sum over the packages of a key of `PackageResult.counts`."""
        return sum(package.counts.get(what, 0) for package in self.packages)


@dataclass(frozen=True, slots=True)
class SystemsReport:
    """Number of launch configurations of a store, of the instances they start, and of changed graphs.

    `failed` contains those of this build that could not be wired, as `path: message`: a defect of `kg` (KG121).
    """

    configurations: int = 0
    instances: int = 0
    changed: int = 0
    failed: tuple[str, ...] = ()


def totals(systems: Systems) -> SystemsReport:
    """Return the counts of the systems of a store."""
    graphs = [
        one
        for of_package in systems.packages.values()
        for package in of_package.values()
        for one in package.graphs.values()
    ]
    return SystemsReport(len(graphs), sum(one.instances for one in graphs))


@dataclass(frozen=True, slots=True)
class BuildReport:
    """Result of a build; `generation` is the snapshot it created, None if nothing changed. Times are in seconds.

    `gone` contains the sources no longer in the folders built; they were removed from the store.
    `inferred` is None if no rules ran. `unfetched` contains the repositories that no worker of a cluster could fetch.
    """

    sources: tuple[SourceReport, ...]
    generation: int | None
    seconds: float
    jobs: int
    gone: tuple[str, ...] = ()
    inferred: Inferred | None = None
    systems: SystemsReport | None = None
    unfetched: tuple[Entry, ...] = ()

    @property
    def read(self) -> int:
        """Number of packages that were read."""
        return sum(source.read for source in self.sources)

    @property
    def reused(self) -> int:
        """Number of packages reused from the last build."""
        return sum(source.reused for source in self.sources)

    @property
    def problems(self) -> tuple[tuple[str, Problem], ...]:
        """All problems with the name of their source."""
        pairs = []
        for source in self.sources:
            listed = [*source.problems, *(one for package in source.packages for one in package.problems)]
            pairs += [(source.repository.name, one) for one in listed]
        return tuple(pairs)

    def total(self, what: str) -> int:
        """Return the sum over all sources of a key of `PackageResult.counts`."""
        return sum(source.total(what) for source in self.sources)

    def unresolved(self) -> dict[str, int]:
        """Return the number of unresolved names by reason, the most frequent first."""
        counts: dict[str, int] = {}
        for source in self.sources:
            for package in source.packages:
                for reason, number in package.unresolved.items():
                    counts[reason] = counts.get(reason, 0) + number
        return dict(sorted(counts.items(), key=lambda item: (-item[1], item[0])))


class Report:
    """Receiver of the progress of a build, which ignores it; every call comes from the process that called `build`."""

    def fetching(self, message: str) -> None:
        """Report the state of a git address."""

    def source(self, repository: Repository, packages: int, problems: tuple[Problem, ...]) -> None:
        """Report a source that was found, with its number of packages."""

    def planned(self, read: int, reused: int, jobs: int) -> None:
        """Report how many packages will be read, how many are unchanged, and the number of processes.

        `jobs` is 0 for a cluster.
        """

    def placed(self, worker: str, source: str) -> None:
        """Report that a worker of a cluster, by its address, starts to read packages of a source."""

    def done(self, result: PackageResult) -> None:
        """Report that a package was read."""

    def writing(self, triples: int) -> None:
        """Report the number of triples being written."""

    def inferring(self) -> None:
        """Report that the rules run."""

    def finished(self, report: BuildReport) -> None:
        """Report that the build is complete and committed."""
