"""New stores begin with the ontologies and rules of the user's cache, and are as without it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import RdfFormat

from kg.pipeline import inferring, reasoning
from kg.pipeline.build import build
from kg.rules.memory import load as load_memory
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pipeline.conftest import Bench


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of the seed, in an empty cache of the user."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "kg" / "ontologies"


def _build(bench: Bench, name: str, folder: Path | None = None) -> EmbeddedStore:
    """Build the workspace into a new store."""
    store = EmbeddedStore.create(bench.store.layout.root.with_name(name))
    build([str(bench.source)], store, load({"jobs": 1}, environment={}, folder=folder))
    return store


def _quads(store: EmbeddedStore) -> list[str]:
    with store.read() as snapshot:
        lines = snapshot.dump(RdfFormat.N_QUADS).decode().splitlines()
    return sorted(line for line in lines if not line.endswith("/graph/builds> ."))


def _forget() -> None:
    """Forget the rules that this process has read."""
    for kept in (reasoning._read, reasoning._cut, reasoning._packed):
        kept.cache_clear()


def _columns(store: EmbeddedStore) -> list[int]:
    memory = load_memory(store.layout.cache)
    assert memory is not None
    return [len(memory.asserted), len(memory.inferred), *map(len, memory.graphs.values())]


def test_a_store_from_the_seed_is_that_of_the_files(bench: Bench, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first build writes the seed, the next one reads no ontology; quads and columns are equal."""
    first = _build(bench, "first")
    assert len(list(cache.iterdir())) == 1
    monkeypatch.delattr(inferring, "ontology_triples")
    inferring._triples.cache_clear()
    second = _build(bench, "second")
    assert _quads(second) == _quads(first)
    assert _columns(second) == _columns(first)


def test_a_new_process_reads_no_rules(bench: Bench, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has those that an earlier store of the user had, and infers the same."""
    _forget()
    first = _build(bench, "first")
    assert len(list((cache.parent / "rules").iterdir())) == 1
    monkeypatch.delattr(reasoning, "discover")
    _forget()
    assert _quads(_build(bench, "second")) == _quads(first)


def test_a_damaged_seed_is_replaced(bench: Bench, cache: Path) -> None:
    """A build does not use it, and writes it again."""
    first = _build(bench, "first")
    (seed,) = cache.iterdir()
    content = seed.read_bytes()
    seed.write_bytes(content[: len(content) // 2])
    assert _quads(_build(bench, "second")) == _quads(first)
    assert seed.stat().st_size > len(content) // 2


def test_without_a_cache_of_the_user_stores_are_built(bench: Bench, cache: Path) -> None:
    """A file in the place of the folder costs nothing but time."""
    cache.parent.parent.mkdir()
    cache.parent.write_text("")
    assert _quads(_build(bench, "first"))


def test_ontologies_of_the_user_are_read(bench: Bench, cache: Path, tmp_path: Path) -> None:
    """The seed has those that `kg` brings along alone."""
    _build(bench, "first")
    (tmp_path / "own" / "ontology").mkdir(parents=True)
    (tmp_path / "own" / "kg.toml").write_text('ontology = ["ontology"]\n')
    (tmp_path / "own" / "ontology" / "own.ttl").write_text("<urn:a> <urn:b> <urn:c> .\n")
    own = _quads(_build(bench, "second", tmp_path / "own"))
    assert any(line.startswith("<urn:a> <urn:b> <urn:c> ") for line in own)
    assert len(list(cache.iterdir())) == 1
