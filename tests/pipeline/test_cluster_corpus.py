"""Workers of a cluster fetch the repositories of a lock file, and the graph is that of checkouts on one machine."""

from __future__ import annotations

import shutil
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from corpus.repositories import commit_tree, git, repository
from pipeline.conftest import few_ontologies

from kg.corpus.fetching.cache import fetch_source
from kg.corpus.fetching.lock import Lock, checkouts, read_lock, standing, write_lock
from kg.corpus.fetching.many import fetch
from kg.corpus.fetching.one import Options
from kg.corpus.fetching.wanted import wanted_among
from kg.errors import SourceError
from kg.pipeline import cluster, corpus, extracting
from kg.pipeline.build import build
from kg.pipeline.estimating import pending
from kg.pipeline.report import Report
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from forks import Forked
    from pipeline.conftest import Bench

    from kg.corpus.fetching.lock import Entry
    from kg.corpus.files import Pin, Source
    from kg.pipeline.pool import Task
    from kg.pipeline.report import BuildReport

distributed = pytest.importorskip("distributed", reason="the extra `cluster` is not installed")


@pytest.fixture(scope="module")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """The folder of repositories that workers fetch."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield extracting.corpus_cache()


@pytest.fixture(scope="module")
def scheduler(cache: Path, extractors: list[Forked]) -> Iterator[str]:  # noqa: ARG001 - set for the workers
    """The address of a cluster of two workers in this process; their extractors are forked."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address="127.0.0.1:0"
    ) as started:
        yield started.scheduler_address


@dataclass
class Acting(Report):
    """Acts when the plan is known, and records what workers fetch."""

    act: Callable[[], object] = lambda: None
    fetched: list[str] = field(default_factory=list)

    def planned(self, read: int, reused: int, jobs: int) -> None:  # noqa: ARG002 - as in the protocol
        """Act."""
        self.act()

    def fetching(self, message: str) -> None:
        """Record the message."""
        self.fetched.append(message)


class Quiet:
    """Ignores the progress of `kg corpus fetch`."""

    def begin(self, repositories: int) -> None:
        """Ignore it."""

    def ended(self, entry: Entry) -> None:
        """Ignore it."""


@dataclass
class Remote:
    """Repositories, the lock file that pins them, and a store."""

    origins: Path
    lock: Path
    bench: Bench

    def update(self, *wanted: str) -> None:
        """Pin the newest commits of all or some repositories, and keep no checkout."""
        names = wanted or tuple(sorted(one.name for one in self.origins.iterdir()))
        listed = wanted_among([f"file://{self.origins / name}" for name in names])
        fetch(listed, self.lock.parent, self.lock, Options(update=True), Quiet())
        shutil.rmtree(self.lock.parent / "local")

    def pins(self) -> dict[str, Pin | None]:
        """Return the pins by folder."""
        lock = read_lock(self.lock)
        return checkouts(lock, standing(lock, elsewhere=True))

    def build(self, scheduler: str, report: Report | None = None) -> BuildReport:
        """Build the lock file on the cluster."""
        found = self.pins()
        settings = load({"cluster": scheduler, "artifacts": str(self.origins / "../artifacts")}, environment={})
        pins = {folder: pin for folder, pin in found.items() if pin}
        with few_ontologies():
            return build([*found], self.bench.store, settings, report, rules=False, pins=pins)

    def alone(self, *names: str) -> list[str]:
        """Return the quads of a build of checkouts on one machine; of some repositories if names are given."""
        listed = read_lock(self.lock).entries
        kept = [one for one in listed if not names or one.name.rpartition("/")[2] in names]
        at = self.lock.with_name("alone.lock.toml")
        write_lock(at, kept)
        fetch(wanted_among(one.url for one in kept), self.lock.parent, at, Options(), Quiet())
        folders = [*checkouts(Lock(at, tuple(kept)), standing(read_lock(at)))]
        other = self.bench.sibling("alone")
        with few_ontologies():
            build(folders, other.store, load({}, environment={}), rules=False)
        shutil.rmtree(self.lock.parent / "local")
        return other.content()


@pytest.fixture
def remote(bench: Bench, tmp_path: Path) -> Remote:
    """A repository with a header, one with two packages that need it, and one with one package."""
    files = {
        f"{path.relative_to(bench.source)}": path.read_text() for path in bench.source.rglob("*") if path.is_file()
    }
    parts = {"shared": ("shared",), "pair": ("one", "two"), "three": ("three",)}
    bench.package("three", "third")
    files |= {f"three/{path.relative_to(bench.source / 'three')}": path.read_text() for path in _files(bench, "three")}
    for name, packages in parts.items():
        own = {path: text for path, text in files.items() if path.split("/")[0] in packages}
        repository(tmp_path / "origins" / name, {"main": own})
    made = Remote(tmp_path / "origins", tmp_path / "corpus" / "corpus.lock.toml", bench)
    made.update()
    return made


def _files(bench: Bench, package: str) -> list[Path]:
    return [path for path in (bench.source / package).rglob("*") if path.is_file()]


def test_the_graph_is_that_of_checkouts(remote: Remote, scheduler: str) -> None:
    """Quads are equal though no checkout is beside the lock file, and workers report what they fetch."""
    report = Acting()
    assert remote.build(scheduler, report).read == 4
    assert not (remote.lock.parent / "local").exists()
    assert {message.rpartition(" ")[2] for message in report.fetched} == {"local/pair", "local/shared", "local/three"}
    assert remote.bench.content() == remote.alone()


def test_a_repository_that_is_gone_is_left_out(remote: Remote, scheduler: str, cache: Path) -> None:
    """It is reported with its reason, and the graph is that of the others."""
    shutil.rmtree(cache, ignore_errors=True)
    shutil.rmtree(remote.origins / "pair")
    report = remote.build(scheduler)
    assert [(one.name, one.state) for one in report.unfetched] == [("local/pair", "gone")]
    assert remote.bench.content() == remote.alone("shared", "three")


def test_without_any_repository_the_store_is_unchanged(remote: Remote, scheduler: str, cache: Path) -> None:
    """If none was fetched, the error is KG133 with the first reason."""
    shutil.rmtree(cache, ignore_errors=True)
    shutil.rmtree(remote.origins)
    with pytest.raises(SourceError) as caught:
        remote.build(scheduler)
    assert caught.value.code == "KG133"
    assert "of 3; the first: gone: " in caught.value.message
    assert remote.bench.store.layout.current() is None


def test_a_repository_that_is_gone_later_is_left_out(remote: Remote, scheduler: str, cache: Path) -> None:
    """If it cannot be fetched again for reading, the build begins again without it."""

    def lose() -> None:
        shutil.rmtree(cache)
        shutil.rmtree(remote.origins / "three", ignore_errors=True)

    report = remote.build(scheduler, Acting(lose))
    assert [(one.name, one.state) for one in report.unfetched] == [("local/three", "failed")]
    assert "gone: " in report.unfetched[0].reason
    assert remote.bench.content() == remote.alone("pair", "shared")


def test_no_repository_is_in_the_graph_by_half(remote: Remote, scheduler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """If one package of a repository could be read, but not the other, the graph contains neither."""
    original = extracting.Extractor.read
    folder = str(remote.lock.parent / "local" / "pair")

    def fails(self: extracting.Extractor, request: extracting.Request, task: Task) -> extracting.Reading:
        found = original(self, request, task)
        return replace(found, artifact="", again=True, unfetched=folder) if task.name == "two" else found

    monkeypatch.setattr(extracting.Extractor, "read", fails)
    report = remote.build(scheduler)
    assert [one.name for one in report.unfetched] == ["local/pair"]
    assert remote.bench.content() == remote.alone("shared", "three")


def test_another_machine_tries_after_a_failure(remote: Remote, scheduler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A disk that is full on one machine costs no repository."""
    full: dict[str, str] = {}

    def fails_there(pin: Pin, root: Path, folder: Path) -> tuple[Entry, Source | None]:
        entry, source = fetch_source(pin, root, folder)
        worker = distributed.get_worker().address
        there = full.setdefault(pin.name, worker) == worker
        return (replace(entry, state="failed", reason="full"), None) if there else (entry, source)

    monkeypatch.setattr("kg.pipeline.corpus.fetch_source", fails_there)
    for module in (corpus, cluster):
        monkeypatch.setattr(module, "machine_of", str)  # each worker is a machine
    assert remote.build(scheduler).unfetched == ()
    assert full
    assert remote.bench.content() == remote.alone()


def test_work_that_is_submitted_again_runs_again(scheduler: str) -> None:
    """Its result is not that of the first attempt, which the scheduler may still hold."""
    found = []
    with cluster.Cluster(scheduler, Report()) as connected:
        connected.connect()
        connected.submit("first", _attempt, 1, key="work")
        for work, result in connected.results():
            found.append((work, result))
            if result == 1:
                connected.submit(work, _attempt, 2, key="work")
    assert found == [("first", 1), ("first", 2)]


def _attempt(number: int) -> int:
    return number


def test_nothing_is_read_again_without_changes(remote: Remote, scheduler: str) -> None:
    """With the same commits, all packages are reused, without any file here."""
    remote.build(scheduler)
    again = remote.build(scheduler)
    assert (again.read, again.reused) == (0, 4)


def test_a_new_commit_is_read(remote: Remote, scheduler: str) -> None:
    """With another commit of one repository, packages that depend on it are read again."""
    remote.build(scheduler)
    origin = remote.origins / "shared"
    header = git(origin, "show", "main:shared/include/shared/topics.hpp").replace("/first", "/second")
    manifest = git(origin, "show", "main:shared/package.xml")
    files = {"shared/include/shared/topics.hpp": header, "shared/package.xml": manifest}
    git(origin, "update-ref", "refs/heads/main", commit_tree(origin, files))
    remote.update("shared")
    assert remote.build(scheduler).read == 4
    assert "/second" in remote.bench.topics()
    assert remote.bench.content() == remote.alone()


def test_status_does_not_call_them_gone(remote: Remote, scheduler: str) -> None:
    """Sources whose files are elsewhere have no pending changes here."""
    remote.build(scheduler)
    assert pending(remote.bench.store.layout, load({}, environment={})) == {}
