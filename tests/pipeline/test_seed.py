"""New stores begin with the ontologies and rules of the user's cache, and are as without it."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest
from pipeline.conftest import Bench
from pyoxigraph import RdfFormat

from kg.pipeline import inferring, reasoning
from kg.pipeline.build import build
from kg.rules.memory import load as load_memory
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """A package and its store, built with an empty cache of the user, `cache`; read-only."""
    folder = tmp_path_factory.mktemp("first")
    made = Bench(folder / "src", EmbeddedStore.create(folder / ".kg"))
    made.package("one")
    _forget()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
        build([str(made.source)], made.store, load({"jobs": 1}, environment={}))
    return made


@pytest.fixture
def cache(first: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of that cache, which is in force."""
    shutil.copytree(first.source.with_name("cache"), tmp_path / "cache")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kg"


def _forget() -> None:
    """Forget the ontologies and rules that this process has read."""
    for kept in (inferring._triples, reasoning._read, reasoning._cut, reasoning._packed):
        kept.cache_clear()


def _again(first: Bench, folder: Path) -> EmbeddedStore:
    """Build the same package into a new store, with the settings of a folder."""
    store = EmbeddedStore.create(folder / ".kg")
    build([str(first.source)], store, load({"jobs": 1}, environment={}, folder=folder))
    return store


def _quads(store: EmbeddedStore) -> list[str]:
    with store.read() as snapshot:
        lines = snapshot.dump(RdfFormat.N_QUADS).decode().splitlines()
    return sorted(line for line in lines if not line.endswith("/graph/builds> ."))


def _columns(store: EmbeddedStore) -> list[int]:
    memory = load_memory(store.layout.cache)
    assert memory is not None
    return [len(memory.asserted), len(memory.inferred), *map(len, memory.graphs.values())]


@pytest.mark.usefixtures("cache")
def test_a_later_store_reads_no_files(first: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ontologies and rules come from the cache; quads and columns are those of the first store."""
    monkeypatch.delattr(inferring, "ontology_triples")
    monkeypatch.delattr(reasoning, "discover")
    _forget()
    again = _again(first, tmp_path)
    assert _quads(again) == _quads(first.store)
    assert sorted(_columns(again)) == sorted(_columns(first.store))


def test_damaged_files_are_replaced(first: Bench, cache: Path, tmp_path: Path) -> None:
    """A build does not use them, and writes them again."""
    sizes = {}
    for path in (*cache.glob("ontologies/*"), *cache.glob("rules/*")):
        content = path.read_bytes()
        sizes[path] = len(content)
        path.write_bytes(content[: len(content) // 2])
    _forget()
    assert _quads(_again(first, tmp_path)) == _quads(first.store)
    assert len(sizes) == 2
    assert all(path.stat().st_size > size // 2 for path, size in sizes.items())


def test_without_a_cache_of_the_user_stores_are_built(first: Bench, cache: Path, tmp_path: Path) -> None:
    """A file in the place of the folder costs nothing but time."""
    shutil.rmtree(cache)
    cache.write_text("")
    _forget()
    assert _quads(_again(first, tmp_path)) == _quads(first.store)


def test_ontologies_of_the_user_are_read(first: Bench, cache: Path, tmp_path: Path) -> None:
    """The cache has those that `kg` brings along alone."""
    (tmp_path / "ontology").mkdir()
    (tmp_path / "kg.toml").write_text('ontology = ["ontology"]\n')
    (tmp_path / "ontology" / "own.ttl").write_text("<urn:a> <urn:b> <urn:c> .\n")
    assert any(line.startswith("<urn:a> <urn:b> <urn:c> ") for line in _quads(_again(first, tmp_path)))
    assert len(list(cache.glob("ontologies/*"))) == 1
