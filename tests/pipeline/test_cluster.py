"""A build on a cluster gives the graph of a build on one machine, whatever happens to its workers."""

from __future__ import annotations

import os
import random
import signal
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from patience import patient
from pipeline.conftest import few_ontologies
from ports import own_port

from kg.errors import SourceError, UsageError
from kg.pipeline import cluster, extracting, pool
from kg.pipeline.build import build
from kg.pipeline.pool import Task
from kg.pipeline.report import Report
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from forks import Forked
    from pipeline.conftest import Bench

    from kg.pipeline.report import BuildReport, PackageResult

distributed = pytest.importorskip("distributed", reason="the extra `cluster` is not installed")


@pytest.fixture(scope="module")
def scheduler(extractors: list[Forked]) -> Iterator[str]:  # noqa: ARG001 - used by the workers
    """The address of a cluster of two workers in this process; their extractors are forked."""
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=False, protocol="tcp", dashboard_address="127.0.0.1:0"
    ) as started:
        yield started.scheduler_address


@dataclass
class Told(Report):
    """Records reports of a build, and acts when a worker starts."""

    act: Callable[[str], None] = lambda _: None
    places: list[tuple[str, str]] = field(default_factory=list)
    results: list[PackageResult] = field(default_factory=list)

    def placed(self, worker: str, source: str) -> None:
        """Record it, and act."""
        self.places.append((worker, source))
        self.act(worker)

    def done(self, result: PackageResult) -> None:
        """Record it."""
        self.results.append(result)


def on_cluster(bench: Bench, address: str, artifacts: Path, told: Told | None = None) -> BuildReport:
    """Build the workspace into the store of `bench` on a cluster."""
    given = {"cluster": address, "artifacts": str(artifacts)}
    with few_ontologies():
        return build([str(bench.source)], bench.store, load(given, environment={}), told, rules=False)


def processes(extractors: list[Forked]) -> set[int]:
    """Return the running processes among extractors."""
    return {process.pid for process in extractors if _runs(process.pid)}


def forks(extractors: list[Forked]) -> set[int]:
    """Return the forks of extractors that read packages."""
    return {fork for process in processes(extractors) for fork in _children(process) if _runs(fork)}


def _children(process: int) -> set[int]:
    try:
        tasks = [task / "children" for task in Path(f"/proc/{process}/task").iterdir()]
        return {int(number) for task in tasks for number in task.read_text().split()}
    except OSError:  # it has ended
        return set()


def _runs(process: int) -> bool:
    """Return whether a process exists and has not ended; that of a process that has ended has no command line."""
    try:
        return bool(Path(f"/proc/{process}/cmdline").read_bytes())
    except OSError:
        return False


def wait_for(condition: Callable[[], object]) -> None:
    """Wait until a condition holds."""
    end = time.monotonic() + patient(30)
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_the_graph_is_that_of_one_machine(bench: Bench, scheduler: str, tmp_path: Path) -> None:
    """Quads are equal, packages are reported, and so are their workers."""
    bench.build()
    other, told = bench.sibling("other"), Told()
    report = on_cluster(other, scheduler, tmp_path / "artifacts", told)
    assert other.content() == bench.content()
    assert report.read == 3
    assert {result.name for result in told.results} == {"shared", "one", "two"}
    assert {source for _, source in told.places} == {report.sources[0].repository.name}


@pytest.mark.parametrize("seed", range(2))
def test_the_order_of_work_does_not_matter(
    bench: Bench, scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int
) -> None:
    """Single packages in a random order give the same quads."""

    def shuffled(tasks: Iterator[tuple[Task, int]]) -> list[list[Task]]:
        found = [[task] for task, _ in tasks]
        random.Random(seed).shuffle(found)  # noqa: S311 - an order, no secret
        return found

    bench.build()
    monkeypatch.setattr(cluster, "batches", shuffled)
    other = bench.sibling("other")
    on_cluster(other, scheduler, tmp_path / "artifacts")
    assert other.content() == bench.content()


def test_another_store_finds_what_was_read(bench: Bench, scheduler: str, tmp_path: Path) -> None:
    """Results are found by their key: the second build uses the files of the first."""
    artifacts = tmp_path / "artifacts"
    on_cluster(bench, scheduler, artifacts)
    before = {path: path.stat().st_mtime_ns for path in (artifacts / "results").rglob("*") if path.is_file()}
    assert len(before) == 3
    other = bench.sibling("other")
    on_cluster(other, scheduler, artifacts)
    assert {path: path.stat().st_mtime_ns for path in (artifacts / "results").rglob("*") if path.is_file()} == before
    assert other.content() == bench.content()


def test_a_change_elsewhere_makes_another_result(bench: Bench, scheduler: str, tmp_path: Path) -> None:
    """A package is read again when the header of another one changed, and its earlier result remains."""
    on_cluster(bench, scheduler, tmp_path / "artifacts")
    bench.header("shared", "/second")
    other, here = bench.sibling("other"), bench.sibling("here")
    here.build()
    on_cluster(other, scheduler, tmp_path / "artifacts")
    assert other.content() == here.content()
    assert "/second" in other.topics()


@pytest.mark.parametrize("damage", [b"", b"half"], ids=["empty", "cut"])
def test_damaged_results_are_read_again(bench: Bench, scheduler: str, tmp_path: Path, damage: bytes) -> None:
    """A file whose content does not match its name is never used."""
    artifacts = tmp_path / "artifacts"
    on_cluster(bench, scheduler, artifacts)
    for path in (artifacts / "results").rglob("*"):
        if path.is_file():
            path.write_bytes(path.read_bytes()[:9] + damage)
    other = bench.sibling("other")
    on_cluster(other, scheduler, artifacts)
    assert other.content() == bench.content()


@pytest.mark.parametrize("those", [processes, forks], ids=["process", "fork"])
def test_a_killed_reader_is_replaced(
    bench: Bench, scheduler: str, extractors: list[Forked], tmp_path: Path, those: Callable[[list[Forked]], set[int]]
) -> None:
    """If the process of a package, or its fork, is killed, another one reads it."""
    bench.build()
    other = bench.sibling("other")
    on_cluster(bench.sibling("warm"), scheduler, tmp_path / "other-artifacts")
    killed: list[int] = []

    def kill(_: str) -> None:
        if not killed:
            wait_for(lambda: those(extractors))
            killed.extend(those(extractors))
            for process in killed:
                os.kill(process, signal.SIGKILL)

    on_cluster(other, scheduler, tmp_path / "artifacts", Told(kill))
    assert killed
    assert not those(extractors) & set(killed)
    assert other.content() == bench.content()


class _Growing:
    """A reader that keeps memory for each package, and reports its process instead of a result."""

    kept: Final[list[bytes]] = []

    def read(self, task: Task) -> extracting.Reading:
        self.kept.append(os.urandom(int(task.path)))
        return extracting.Reading(task, problem=str(os.getpid()))


def test_a_fork_that_has_grown_makes_way_for_another() -> None:
    """The next package is read by a new process, which starts with the memory of the first."""
    fork = extracting._Fork(_Growing())  # type: ignore[arg-type]  # it only has to read
    sizes = [1000, 1000, 2 * extracting._MOST_GROWTH, 1000]
    first, second, third, last = (fork.read(Task("s", "p", str(size))).problem for size in sizes)
    assert first == second == third != last


def test_a_hanging_reader_is_replaced(
    bench: Bench, scheduler: str, extractors: list[Forked], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A package that exceeds its time limit is assigned to another process."""
    bench.build()
    on_cluster(bench.sibling("warm"), scheduler, tmp_path / "other-artifacts")
    wait_for(lambda: processes(extractors))
    monkeypatch.setattr(extracting, "_START_SECONDS", patient(0.1))
    monkeypatch.setattr(pool, "PACKAGE_SECONDS", patient(1))
    os.kill(min(processes(extractors)), signal.SIGSTOP)  # the others read its packages
    other = bench.sibling("other")
    report = on_cluster(other, scheduler, tmp_path / "artifacts")
    assert not report.problems
    assert other.content() == bench.content()


def test_a_package_that_kills_every_reader_is_left_out(bench: Bench, scheduler: str, tmp_path: Path) -> None:
    """After its attempts it is reported as KG121, the graph contains nothing of it, and the next build reads it."""
    (bench.source / "bad").mkdir()
    bench.package("bad")
    reader = extracting.Extractor
    original = reader.read

    def dies(self: extracting.Extractor, request: extracting.Request, task: Task) -> extracting.Reading:
        return (
            extracting.Reading(task, problem="the process that read the package ended with signal SIGSEGV", again=True)
            if task.name == "bad"
            else original(self, request, task)
        )

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(reader, "read", dies)
        report = on_cluster(bench, scheduler, tmp_path / "artifacts")
    assert [(one.code, one.path) for _, one in report.problems] == [("KG121", "bad")]
    assert not any("/bad" in line for line in bench.content() if "package/" in line and "/bad>" in line)
    assert on_cluster(bench, scheduler, tmp_path / "artifacts").read == 1


def test_a_killed_worker_of_the_cluster_is_replaced(bench: Bench, tmp_path: Path) -> None:
    """If workers are processes, killing one in the middle does not affect the graph."""
    bench.build()
    other = bench.sibling("other")
    killed: list[int] = []
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50
    ) as started:

        def kill(worker: str) -> None:
            if not killed:
                killed.append(next(one.pid for one in started.workers.values() if one.worker_address == worker))
                os.kill(killed[0], signal.SIGKILL)

        on_cluster(other, started.scheduler_address, tmp_path / "artifacts", Told(kill))
    assert killed
    assert other.content() == bench.content()


def test_a_worker_with_other_code_ends_the_build(
    bench: Bench, scheduler: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A worker with another version of kg is KG127, and the store remains without data."""
    monkeypatch.setattr("kg.pipeline.build.code_version", lambda *_: "another")
    with pytest.raises(SourceError) as caught:
        on_cluster(bench, scheduler, tmp_path / "artifacts")
    assert caught.value.code == "KG127"
    assert "has another version of kg" in caught.value.message
    assert bench.store.layout.current() is None


def test_no_scheduler_is_an_error(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An address without a server is KG126."""
    monkeypatch.setattr(cluster, "_CONNECT_SECONDS", 0.2)
    with own_port() as port, pytest.raises(SourceError) as caught:
        on_cluster(bench, f"tcp://127.0.0.1:{port}", tmp_path / "artifacts")
    assert caught.value.code == "KG126"
    assert bench.store.layout.current() is None


def test_results_that_cannot_be_written_are_an_error(bench: Bench, scheduler: str, tmp_path: Path) -> None:
    """A file in place of the folder of results is KG128."""
    (tmp_path / "file").write_text("")
    with pytest.raises(SourceError) as caught:
        on_cluster(bench, scheduler, tmp_path / "file")
    assert caught.value.code == "KG128"


def test_without_the_extra_the_error_names_it(bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Dask the error is KG125, with the command that installs it."""
    monkeypatch.setitem(sys.modules, "fsspec.core", None)
    with pytest.raises(UsageError) as caught:
        on_cluster(bench, "local", tmp_path / "artifacts")
    assert caught.value.code == "KG125"
    assert caught.value.hint == "Install the extra: pip install 'kg-ros[cluster]'"


def test_pieces_of_work_are_of_one_source() -> None:
    """Packages of a source stay together up to a size."""
    sizes = [("a", "1", 600_000), ("b", "1", 10), ("a", "2", 600_000), ("b", "2", 10), ("a", "3", 10)]
    found = cluster.batches((Task(source, path, path), size) for source, path, size in sizes)
    assert [[(task.source, task.path) for task in batch] for batch in found] == [
        [("a", "1")],
        [("b", "1"), ("b", "2")],
        [("a", "2"), ("a", "3")],
    ]
