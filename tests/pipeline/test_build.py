"""Tests of builds: the packages read, the graphs written, and the next build."""

from __future__ import annotations

import errno
import gc
import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, Store

from kg.errors import SourceError, StoreError
from kg.pipeline.build import build
from kg.pipeline.report import Report
from kg.pipeline.state import load
from kg.settings import load as load_settings

if TYPE_CHECKING:
    from pathlib import Path

    from pipeline.conftest import Bench

    from kg.facts import Problem, Repository
    from kg.pipeline.report import BuildReport, PackageResult

IMPLICIT = {"/rosout", "/clock"}


def test_a_cold_build_reads_everything(bench: Bench) -> None:
    """The first build reads all packages, and the graph contains their facts, across packages."""
    report = bench.build()
    assert (report.read, report.reused, report.generation) == (3, 0, 1)
    assert report.total("nodes") == 2
    assert bench.topics() - IMPLICIT == {"/first", "/chatter", "/talk"}


def test_nothing_changed_nothing_written(bench: Bench) -> None:
    """The second build reads nothing and keeps the generation, with the same totals."""
    first = bench.build(rules=True)
    second = bench.build(rules=True)
    assert (second.read, second.reused, second.generation) == (0, 3, None)
    assert bench.store.layout.current() == 1
    assert second.total("interfaces") == first.total("interfaces")


def test_touched_files_are_not_read_again(bench: Bench) -> None:
    """A file with a new time but the same content changes nothing, and is read only once for that."""
    bench.build(rules=True)
    (bench.source / "one" / "src" / "node.cpp").touch()
    assert bench.build(rules=True).read == 0
    state = load(bench.store.layout.cache)
    bench.build(rules=True)
    assert load(bench.store.layout.cache) == state


def test_a_changed_package_is_read_again(bench: Bench) -> None:
    """Only the package with the changed file is read, and the graph is that of a clean build."""
    bench.build()
    bench.package("two", "news")
    report = bench.build()
    assert (report.read, report.reused) == (1, 2)
    assert bench.topics() - IMPLICIT == {"/first", "/chatter", "/news"}
    fresh = bench.sibling("fresh")
    fresh.build()
    assert bench.content() == fresh.content()


def test_a_changed_header_concerns_all_who_include_it(bench: Bench) -> None:
    """Packages that read a file of another package are read again when it changes."""
    bench.build()
    bench.header("shared", "/second")
    assert bench.build().read == 3
    assert "/second" in bench.topics()
    assert "/first" not in bench.topics()


def test_a_new_file_that_answers_an_include_otherwise(bench: Bench) -> None:
    """A file that appears nearer than the one found before is detected for its look-ups only."""
    bench.package("of_its_own")
    bench.build()
    folder = bench.source / "of_its_own" / "include" / "shared"
    folder.mkdir(parents=True)
    (folder / "topics.hpp").write_text('#define SHARED_TOPIC "/near"\n')
    report = bench.build()
    assert report.read == 1
    assert "/near" in bench.topics()


def test_a_header_that_appears(bench: Bench) -> None:
    """A failed look-up is repeated when the file appears in another package."""
    shutil.rmtree(bench.source / "shared")
    bench.build()
    assert "/first" not in bench.topics()
    bench.header("later", "/late")
    assert bench.build().read == 3
    assert "/late" in bench.topics()


def test_a_removed_package_leaves_the_graph(bench: Bench) -> None:
    """Triples only of a removed package are gone, those of others remain."""
    bench.build()
    shutil.rmtree(bench.source / "two")
    report = bench.build()
    assert (report.read, report.sources[0].removed) == (0, 1)
    assert bench.topics() - IMPLICIT == {"/first", "/chatter"}


def test_small_changes_are_patched_to_the_same_graph(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a large source, a changed, an added and a removed package give the graph of a clean build."""
    for number in range(40):
        bench.package(f"many{number}", f"topic{number % 7}")
    bench.build()
    loads: list[str] = []
    monkeypatch.setattr(
        "kg.store.transaction.EmbeddedTransaction.load", lambda *_: loads.append("a graph was written anew")
    )
    bench.package("many3", "other")
    bench.package("added")
    shutil.rmtree(bench.source / "many9")
    report = bench.build()
    monkeypatch.undo()
    assert report.read == 2
    assert not loads
    fresh = bench.sibling("fresh")
    fresh.build()
    assert bench.content() == fresh.content()


def test_another_version_reads_everything(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Results of another version of kg are not used."""
    bench.build()
    monkeypatch.setattr("kg.pipeline.build.version", lambda *_: "another")
    assert bench.build().read == 3


def test_a_forgotten_graph_comes_back(bench: Bench) -> None:
    """A graph dropped from the store is written again, without reading any file."""
    bench.build()
    before = bench.content()
    with bench.store.write("test") as transaction:
        transaction.drop_graph(NamedNode("https://w3id.org/rnkg/graph/source/local/src"))
    report = bench.build()
    assert report.read == 0
    assert report.generation is not None
    assert bench.content() == before


def test_other_graphs_do_not_matter(bench: Bench) -> None:
    """Data imported into other graphs remains and causes no work."""
    bench.build(rules=True)
    extra = NamedNode("https://example.org/g")
    with bench.store.write("test") as transaction:
        transaction.append(extra, b"<urn:a> <urn:b> <urn:c> .\n")
    assert bench.build(rules=True).generation is None
    bench.package("one", "changed")
    bench.build(rules=True)
    with bench.store.read() as snapshot:
        assert snapshot.count(extra) == 1


def test_a_lost_result_is_read_again(bench: Bench) -> None:
    """A result missing from the cache is read again; a damaged one is refused once, then read again."""
    bench.build()
    results = sorted(bench.store.layout.cache.glob("*.z"))
    results[0].unlink()
    assert bench.build().read == 1
    for result in bench.store.layout.cache.glob("*.z"):
        result.write_bytes(b"junk")
    bench.package("one", "changed")
    with pytest.raises(StoreError):
        bench.build()
    assert bench.build().read == 3


def test_sources_are_kept_apart(bench: Bench, tmp_path: Path) -> None:
    """Another source is added to the first; without names all known sources are built."""
    bench.build()
    other = bench.sibling(".kg")
    elsewhere = type(bench)(tmp_path / "elsewhere", other.store)
    elsewhere.package("three", "third")
    elsewhere.build()
    assert {"/third", "/talk"} <= bench.topics()
    report = elsewhere.store
    assert report.layout.current() == 2
    again = bench.build(str(bench.source), str(elsewhere.source))
    assert [source.repository.name for source in again.sources] == ["local/src", "local/elsewhere"]


def test_named_again_by_nothing(bench: Bench) -> None:
    """A build without names reads the sources of earlier builds."""
    bench.build()
    bench.package("one", "changed")
    assert build([], bench.store, load_settings({}, environment={})).read == 1


def test_checkouts_of_a_workspace_are_sources(bench: Bench) -> None:
    """A folder that contains git checkouts gives one source for each, with its commit."""
    for name in ("one", "two"):
        folder = bench.source / name
        subprocess.run(["git", "init", "-q"], cwd=folder, check=True)
        subprocess.run(["git", "add", "."], cwd=folder, check=True)
        identity = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        subprocess.run(["git", *identity, "commit", "-qm", "x"], cwd=folder, check=True)
    report = bench.build()
    found = {source.repository.name: source.repository.commit for source in report.sources}
    assert set(found) == {"local/src", "local/one", "local/two"}
    assert found["local/one"]
    assert found["local/src"] is None


def test_a_checkout_that_is_gone(bench: Bench) -> None:
    """A checkout deleted from a workspace leaves the store with the next build; so does a renamed source."""
    subprocess.run(["git", "init", "-q"], cwd=bench.source / "one", check=True)
    bench.build(rules=True)
    shutil.rmtree(bench.source / "one")
    report = bench.build(rules=True)
    assert report.gone == ("local/one",)
    assert report.read == 0
    assert bench.topics() - IMPLICIT == {"/first", "/talk"}
    assert bench.build(rules=True).generation is None
    subprocess.run(["git", "init", "-q"], cwd=bench.source, check=True)
    subprocess.run(["git", "remote", "add", "origin", "https://example.org/a/b.git"], cwd=bench.source, check=True)
    assert bench.build(rules=True).gone == ("local/src",)
    assert bench.topics() - IMPLICIT == {"/first", "/talk"}
    with bench.store.read() as snapshot:
        graphs = {graph.value.rpartition("/graph/")[2] for graph in snapshot.graphs()}
    assert graphs == {"builds", "inferred", "ontology", "shared", "source/example.org/a/b"}


def test_what_sources_share_stands_once(bench: Bench) -> None:
    """A topic used by two sources is one result, and remains until both are gone."""
    bench.package("two", "chatter")
    subprocess.run(["git", "init", "-q"], cwd=bench.source / "one", check=True)
    bench.build()
    assert bench.answers("/chatter") == 1
    shutil.rmtree(bench.source / "one")
    bench.build()
    assert bench.answers("/chatter") == 1
    bench.package("two", "news")
    bench.build()
    assert bench.answers("/chatter") == 0
    assert bench.answers("/news") == 1


def test_a_repository_is_cloned(bench: Bench, tmp_path: Path) -> None:
    """A git address is cloned into the store; if it is unreachable later, the clone is read again."""
    origin = tmp_path / "origin"
    shutil.copytree(bench.source / "one", origin)
    subprocess.run(["git", "init", "-q"], cwd=origin, check=True)
    subprocess.run(["git", "add", "."], cwd=origin, check=True)
    identity = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
    subprocess.run(["git", *identity, "commit", "-qm", "x"], cwd=origin, check=True)
    listed = tmp_path / "sources.txt"
    listed.write_text(f"file://{origin}  # a comment\nsrc\n")
    report = bench.build(str(listed), rules=True)
    assert len(report.sources) == 2
    assert len(list(bench.store.layout.checkouts.iterdir())) == 1
    shutil.rmtree(origin)
    again = build([], bench.store, load_settings({}, environment={}))
    assert (again.read, again.generation) == (0, None)
    with pytest.raises(SourceError) as caught:
        bench.build(f"file://{origin}")
    assert caught.value.code == "KG103"


@pytest.mark.parametrize(("named", "code"), [("nowhere", "KG101"), (".", "KG102")])
def test_what_cannot_be_read(bench: Bench, tmp_path: Path, named: str, code: str) -> None:
    """A missing folder and one without packages have different errors; the store is unchanged."""
    bench.build()
    (tmp_path / "empty").mkdir()
    with pytest.raises(SourceError) as caught:
        bench.build(str(tmp_path / "empty" / named))
    assert caught.value.code == code
    assert bench.store.layout.current() == 1


def test_builds_leave_the_collection_of_garbage_as_it_was(bench: Bench) -> None:
    """It runs less often during a build, and as before afterwards, also after a failure."""
    before = gc.get_threshold()
    bench.build()
    assert gc.get_threshold() == before
    with pytest.raises(SourceError):
        bench.build("nowhere")
    assert gc.get_threshold() == before


def test_a_busy_store(bench: Bench) -> None:
    """A build while another process writes is refused at once."""
    with bench.store.write("kg import big.nq"), pytest.raises(StoreError) as caught:
        bench.build()
    assert caught.value.code == "KG302"
    assert "kg import big.nq" in caught.value.message


def test_a_full_disk(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk while caching results is KG304, and the store is unchanged."""
    bench.build()
    before = bench.content()

    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("kg.pipeline.cache.write_atomically", full)
    bench.package("one", "changed")
    with pytest.raises(StoreError) as caught:
        bench.build()
    assert caught.value.code == "KG304"
    assert bench.content() == before
    assert bench.store.layout.numbers() == [1]


class _Notes(Report):
    """A report that records its calls."""

    def __init__(self) -> None:
        self.told: list[str] = []

    def fetching(self, message: str) -> None:
        self.told.append(f"fetching {message}")

    def source(self, repository: Repository, packages: int, problems: tuple[Problem, ...]) -> None:
        self.told.append(f"source {repository.name} {packages} {len(problems)}")

    def planned(self, read: int, reused: int, jobs: int) -> None:
        self.told.append(f"planned {read} {reused} {jobs}")

    def placed(self, worker: str, source: str) -> None:
        self.told.append(f"placed {worker} {source}")

    def done(self, result: PackageResult) -> None:
        self.told.append(f"done {result.name}")

    def writing(self, triples: int) -> None:
        self.told.append("writing" if triples else "writing nothing")

    def inferring(self) -> None:
        self.told.append("inferring")

    def finished(self, report: BuildReport) -> None:
        self.told.append(f"finished {report.generation}")


def test_progress_is_told(bench: Bench) -> None:
    """The report receives sources, plan, each package, the writing, the rules and the end."""
    notes = _Notes()
    build([str(bench.source)], bench.store, load_settings({"jobs": 2}, environment={}), notes)
    assert notes.told[:2] == ["source local/src 3 0", "planned 3 0 2"]
    assert sorted(notes.told[2:5]) == ["done one", "done shared", "done two"]
    assert notes.told[5:] == ["writing", "inferring", "finished 1"]


def test_memory_is_released_during_a_build(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """If much is loaded, the engine is opened again after writing and after wiring, and the graph is the same."""
    opened: list[str] = []

    def noted(folder: str) -> Store:
        opened.append(folder)
        return Store(folder)

    other = bench.sibling("other")
    other.build()
    monkeypatch.setattr("kg.store.transaction.Store", noted)
    monkeypatch.setattr("kg.store.transaction._MERGED_BYTES", 1)
    bench.build()
    assert len(opened) == 3
    assert bench.content() == other.content()
