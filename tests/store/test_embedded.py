"""Tests of transactions, snapshots and failed transactions."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, RdfFormat, Store

from kg.errors import GraphError, SourceError, StoreError
from kg.store import files
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

A, B = NamedNode("https://example.org/a"), NamedNode("https://example.org/b")


def triples(count: int, tag: str = "x") -> bytes:
    """Return `count` N-Triples that contain `tag`."""
    lines = (
        f"<https://example.org/{tag}{i}> <https://example.org/p> <https://example.org/o> .\n" for i in range(count)
    )
    return "".join(lines).encode()


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """A store with three triples in graph A and two in graph B."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({A: [triples(2), triples(1, "y")], B: [triples(2, "z")]})
    return store


def counts(store: EmbeddedStore) -> dict[str, int]:
    """Return the number of quads in each graph of the store."""
    with store.read() as snapshot:
        return {graph.value[-1]: snapshot.count(graph) for graph in snapshot.graphs()}


def test_replace_graphs_loads_all_chunks(store: EmbeddedStore) -> None:
    """All chunks of a graph are loaded, for each graph separately."""
    assert counts(store) == {"a": 3, "b": 2}


@pytest.mark.parametrize(("most", "opened"), [(1, 3), (1 << 20, 1)], ids=["large", "small"])
def test_released_memory_is_not_content(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int, opened: int
) -> None:
    """After large loads the generation is opened again, with all that was written; after small ones it is not."""
    folders: list[str] = []

    def noted(folder: str) -> Store:
        folders.append(folder)
        return Store(folder)

    monkeypatch.setattr("kg.store.transaction.Store", noted)
    monkeypatch.setattr("kg.store.transaction._MERGED_BYTES", most)
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.release()
        transaction.load(A, [triples(5)])
        transaction.append(B, triples(1))
        transaction.release()
        transaction.load(A, [triples(5, "y")])
        transaction.release()
        transaction.append(B, triples(1, "y"))
    assert counts(store) == {"a": 10, "b": 2}
    assert len(folders) == opened


@pytest.mark.parametrize("size", [1, 500])
def test_replacing_one_graph_keeps_the_others(store: EmbeddedStore, size: int) -> None:
    """Other graphs and the default graph remain, whether the new generation begins empty or as a checkpoint."""
    with store.write("test") as transaction:
        transaction.replace_graphs({B: [triples(size, "b")]})
        transaction.update("INSERT DATA { <urn:s> <urn:p> <urn:o> }")
    with store.write("test") as transaction:
        transaction.replace_graphs({A: [triples(4)]})
    assert counts(store) == {"a": 4, "b": size}
    with store.read() as snapshot:
        assert snapshot.count() == 5 + size


def test_each_transaction_gets_its_own_number(store: EmbeddedStore) -> None:
    """The number of a generation grows with each change, and old generations are deleted."""
    with store.write("test") as transaction:
        transaction.append(A, triples(1, "n"))
    with store.read() as snapshot:
        assert snapshot.identity == "2"
    assert store.layout.numbers() == [2]


def test_no_change_no_generation(store: EmbeddedStore) -> None:
    """A transaction without changes creates no generation."""
    with store.write("test"):
        pass
    assert store.layout.current() == 1


def test_a_snapshot_does_not_change(store: EmbeddedStore) -> None:
    """A reader keeps its data while a writer continues, and the generation is deleted after the reader closes it."""
    with store.read() as snapshot:
        with store.write("test") as transaction:
            transaction.drop_graph(A)
        assert snapshot.count(A) == 3
        assert counts(store) == {"b": 2}
        assert store.layout.numbers() == [1, 2]
    with store.write("test") as transaction:
        transaction.append(B, triples(1, "n"))
    assert store.layout.numbers() == [3]


def test_an_exception_leaves_the_store_as_it_was(store: EmbeddedStore) -> None:
    """If the body of a transaction raises, nothing of it remains."""

    def interrupted() -> Iterator[bytes]:
        yield triples(10)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt), store.write("test") as transaction:
        transaction.replace_graphs({A: interrupted()})
    assert counts(store) == {"a": 3, "b": 2}
    assert store.layout.numbers() == [1]


def test_interrupted_right_after_the_switch(store: EmbeddedStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupt after the new generation became current does not delete it."""
    switch = Layout.switch

    def interrupted(layout: Layout, generation: int) -> None:
        switch(layout, generation)
        raise KeyboardInterrupt

    monkeypatch.setattr(Layout, "switch", interrupted)
    with pytest.raises(KeyboardInterrupt), store.write("test") as transaction:
        transaction.replace_graphs({A: [triples(10)]})
    assert counts(store) == {"a": 10, "b": 2}


def test_patch_graph_changes_only_the_lines_given(store: EmbeddedStore) -> None:
    """Removed lines go, added lines come, the rest of the graph is unchanged."""
    with store.write("test") as transaction:
        transaction.patch_graph(A, removed=triples(1, "y"), added=triples(3, "n"))
    assert counts(store) == {"a": 5, "b": 2}


def test_a_busy_store_names_its_writer(store: EmbeddedStore) -> None:
    """The error of a second writer contains the process, the command and the start time of the first."""
    with store.write("kg build src"), pytest.raises(StoreError) as caught, store.write("other"):
        pass
    assert caught.value.code == "KG302"
    assert str(os.getpid()) in caught.value.message
    assert "kg build src" in caught.value.message


def test_damaged_generation(store: EmbeddedStore) -> None:
    """A damaged generation is KG303, not an exception of the engine."""
    (store.layout.generation(1) / "CURRENT").write_text("junk")
    with pytest.raises(StoreError) as caught:
        store.read()
    assert caught.value.code == "KG303"


def test_missing_generation(store: EmbeddedStore) -> None:
    """A pointer to a missing generation is KG303."""
    store.layout.switch(7)
    with pytest.raises(StoreError) as caught:
        store.read()
    assert caught.value.code == "KG303"


def test_empty_store(tmp_path: Path) -> None:
    """Reading an empty store is KG301."""
    with pytest.raises(StoreError) as caught:
        EmbeddedStore.create(tmp_path / ".kg").read()
    assert caught.value.code == "KG301"


def test_disk_full_at_the_switch(store: EmbeddedStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """A full disk while writing the pointer is KG304, and the store is unchanged."""

    def full(_handle: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(StoreError) as caught, store.write("test") as transaction:
        transaction.replace_graphs({A: [triples(10)]})
    assert caught.value.code == "KG304"
    assert counts(store) == {"a": 3, "b": 2}
    assert not list(store.layout.root.glob("*.tmp"))


def test_disk_full_in_the_engine(tmp_path: Path) -> None:
    """A full disk in the engine is KG304, and the store is unchanged."""
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(tmp_path)],
        check=False,
        capture_output=True,
    )
    if mounted.returncode:
        pytest.skip("mounting a small file system needs root")
    try:
        store = EmbeddedStore.create(tmp_path / ".kg")
        with store.write("test") as transaction:
            transaction.replace_graphs({A: [triples(3)]})
        with pytest.raises(StoreError) as caught, store.write("test") as transaction:
            transaction.replace_graphs({B: [triples(200_000, "full")]})
        assert caught.value.code == "KG304"
        assert counts(store) == {"a": 3}
        assert store.layout.numbers() == [1]
    finally:
        subprocess.run(["umount", "-l", str(tmp_path)], check=False)


def test_a_store_that_cannot_be_written(store: EmbeddedStore, monkeypatch: pytest.MonkeyPatch) -> None:
    """A read-only store can be read; writing is an error."""

    def closed(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr("pathlib.Path.open", closed)
    with pytest.raises(StoreError) as caught, store.write("test"):
        pass
    assert caught.value.code == "KG306"
    monkeypatch.undo()
    assert counts(store) == {"a": 3, "b": 2}


WRITER = """
import sys
from pathlib import Path
from pyoxigraph import NamedNode
from kg.store.embedded import EmbeddedStore
store = EmbeddedStore.create(Path(sys.argv[1]))
with store.write("writer") as transaction:
    lines = (f"<urn:s{i}> <urn:p> <urn:o> .\\n".encode() for i in range(200000))
    transaction.replace_graphs({NamedNode("https://example.org/a"): lines})
    print("written", flush=True)
    sys.stdin.read()
"""


def test_killed_writer_leaves_the_store(store: EmbeddedStore) -> None:
    """After kill -9 of a writer the store is unchanged, and the next writer is not blocked."""
    command = [sys.executable, "-c", WRITER, str(store.layout.root)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == b"written\n"
        process.kill()
    assert counts(store) == {"a": 3, "b": 2}
    with store.write("next") as transaction:
        transaction.append(A, triples(1, "n"))
    assert counts(store) == {"a": 4, "b": 2}
    assert len(store.layout.numbers()) == 1


@pytest.mark.parametrize("name", ["N_QUADS", "TRIG", "JSON_LD", "TURTLE", "RDF_XML", "N_TRIPLES"])
def test_dump_and_load_give_the_same_triples(store: EmbeddedStore, tmp_path: Path, name: str) -> None:
    """A dump in any format loads as the same triples."""
    rdf_format = getattr(RdfFormat, name)
    path = tmp_path / f"dump.{rdf_format.file_extension}"
    with store.read() as snapshot:
        path.write_bytes(snapshot.dump(rdf_format, prefixes={"ex": "https://example.org/"}))
    copy = EmbeddedStore.create(tmp_path / "copy")
    with copy.write("test") as transaction:
        transaction.load_file(path, rdf_format)
    with copy.read() as there, store.read() as here:
        assert sorted(there.dump(RdfFormat.N_TRIPLES).splitlines()) == sorted(
            here.dump(RdfFormat.N_TRIPLES).splitlines()
        )
        if rdf_format.supports_datasets:
            assert there.graphs() == here.graphs()


@pytest.mark.parametrize("filled", [False, True])
def test_what_a_file_has_without_a_graph_is_placed(tmp_path: Path, filled: bool) -> None:  # noqa: FBT001 - a case
    """Triples go into the given graph; quads keep their graph, and the default graph is unchanged."""
    default = tmp_path / "default.nt"
    default.write_text("<urn:d> <urn:d> <urn:d> .\n")
    path = tmp_path / "both.nq"
    path.write_text("<urn:a> <urn:p> _:x .\n_:x <urn:p> <urn:b> <urn:g> .\n")
    store = EmbeddedStore.create(tmp_path / "placed")
    if filled:
        with store.write("test") as transaction:
            transaction.load_file(default)
    with store.write("test") as transaction:
        transaction.load_file(path, graph=NamedNode("urn:into"))
    with store.read() as snapshot:
        found = {str(quad.graph_name): quad for quad in snapshot.quads()}
        assert set(found) == {"<urn:into>", "<urn:g>", *(["DEFAULT"] if filled else [])}
        assert found["<urn:into>"].object == found["<urn:g>"].subject


def test_ctrl_c_ends_a_load(store: EmbeddedStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The file is read by Python code, which a signal interrupts; nothing of the file is loaded."""

    def interrupted(_file: object, _size: int = -1) -> bytes:
        raise KeyboardInterrupt

    monkeypatch.setattr(files._Continued, "read", interrupted)
    path = tmp_path / "some.nt"
    path.write_text("<urn:d> <urn:d> <urn:d> .\n")
    with pytest.raises(KeyboardInterrupt), store.write("test") as transaction:
        transaction.load_file(path)
    assert counts(store) == {"a": 3, "b": 2}


def test_load_file_tells_the_line_of_an_error(store: EmbeddedStore, tmp_path: Path) -> None:
    """An invalid file is KG601 with the line, and nothing of it is loaded."""
    path = tmp_path / "bad.ttl"
    path.write_text("@prefix a: <urn:a> .\na:b a:c d e .\n")
    with pytest.raises(GraphError) as caught, store.write("test") as transaction:
        transaction.load_file(path)
    assert caught.value.place is not None
    assert caught.value.place.line == 2
    assert counts(store) == {"a": 3, "b": 2}


def test_load_file_that_is_not_there(store: EmbeddedStore, tmp_path: Path) -> None:
    """A file that cannot be opened is KG101."""
    with pytest.raises(SourceError), store.write("test") as transaction:
        transaction.load_file(tmp_path / "none.ttl")


def test_files_are_merged_after_large_loads_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A large load into an empty store is merged before it becomes current; small loads are not."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    graph = NamedNode("https://example.org/graph")
    lines = b"".join(b'<https://example.org/s%d> <https://example.org/p> "%d" .\n' % (n, n) for n in range(20_000))
    with store.write("fill") as transaction:
        transaction.load(graph, [lines])
        small = transaction.merging
        monkeypatch.setattr("kg.store.transaction._MERGED_BYTES", 1 << 20)
        large = transaction.merging
    assert (small, large) == (False, True)
    with store.write("add") as transaction:
        transaction.load(graph, [b"<https://example.org/s> <https://example.org/p> <https://example.org/o> .\n"])
        assert not transaction.merging
