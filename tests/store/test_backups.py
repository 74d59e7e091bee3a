"""C30: backups made while the store is written open, are complete, and can be restored."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import patient
from pyoxigraph import BlankNode, Literal, NamedNode, Quad, RdfFormat

from kg.errors import KgError
from kg.store.backups import back_up, canonical, restore
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout

if TYPE_CHECKING:
    import random
    from pathlib import Path

G = NamedNode("urn:test:g")
P = NamedNode("urn:test:p")


def lines(begin: int, end: int) -> bytes:
    """Return N-Triples, some with blank nodes."""
    return b"".join(b"<urn:test:%d> <urn:test:p> _:b%d .\n" % (one, one % 7) for one in range(begin, end))


def filled(folder: Path) -> EmbeddedStore:
    """Return a store with quads in two graphs, blank nodes among them, and an empty graph."""
    store = EmbeddedStore.create(folder / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({G: [lines(0, 50)], NamedNode("urn:test:empty"): []})
        transaction.update('INSERT DATA { _:x <urn:test:p> _:y , "a\\nb\\t\\u0007" , 1.50 . _:y <urn:test:p> _:x }')
    return store


@pytest.mark.parametrize("name", ["copy", "copy.nq", "copy.nq.gz"])
def test_a_backup_is_put_back(tmp_path: Path, name: str) -> None:
    """The restored content is that of the backup, as a new snapshot, whatever happened in between."""
    store, target = filled(tmp_path), tmp_path / "below" / name
    with store.read() as snapshot:
        before = canonical(snapshot.quads())
    made = back_up(store.layout, target)
    assert (made.snapshot, made.quads) == (1, len(before))
    with store.write("test") as transaction:
        transaction.drop_graph(G)
    with store.write("test") as transaction:
        restore(transaction, target)
    with store.read() as snapshot:
        assert (canonical(snapshot.quads()), snapshot.generation) == (before, 3)
        assert name != "copy" or NamedNode("urn:test:empty") in snapshot.graphs()


def test_dump_load_dump_is_byte_equal(tmp_path: Path) -> None:
    """An N-Quads file is the same after restoring and dumping its content elsewhere, compressed or not."""
    store = filled(tmp_path)
    back_up(store.layout, tmp_path / "one.nq")
    back_up(store.layout, tmp_path / "one.nq.gz")
    other = EmbeddedStore.create(tmp_path / "other")
    with other.write("test") as transaction:
        restore(transaction, tmp_path / "one.nq.gz")
    back_up(other.layout, tmp_path / "two.nq")
    back_up(other.layout, tmp_path / "two.nq.gz")
    assert (tmp_path / "one.nq").read_bytes() == (tmp_path / "two.nq").read_bytes()
    assert (tmp_path / "one.nq.gz").read_bytes() == (tmp_path / "two.nq.gz").read_bytes()


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), max_size=12), st.randoms(use_true_random=False))
@settings(max_examples=60, deadline=None)
def test_names_of_blank_nodes_depend_on_the_data_alone(edges: list[tuple[int, int]], chance: random.Random) -> None:
    """The same graph with other labels, in another order, gives the same bytes."""
    names = [f"n{number}" for number in range(5)]
    chance.shuffle(names)
    plain = Quad(NamedNode("urn:test:a"), P, Literal("x"), G)
    one = [Quad(BlankNode(f"b{a}"), P, BlankNode(f"b{b}"), G) for a, b in edges]
    two = [Quad(BlankNode(names[a]), P, BlankNode(names[b]), G) for a, b in edges]
    chance.shuffle(two)
    assert canonical([plain, *one]) == canonical([*two, plain])


def test_a_backup_while_somebody_writes(tmp_path: Path) -> None:
    """Each backup opens as a store and contains as many quads as its manifest says."""
    store = EmbeddedStore.create(tmp_path / ".kg")
    sizes: dict[int, int] = {}
    stop = threading.Event()

    def write() -> None:
        number = 0
        while not stop.is_set():
            with store.write("test") as transaction:
                transaction.append(G, b"<urn:test:%d> <urn:test:p> <urn:test:o> .\n" % number)
                number += 1
                generation = transaction.commit()
            sizes[generation or 0] = number

    with store.write("test") as transaction:
        transaction.append(G, b"<urn:test:a> <urn:test:p> <urn:test:b> .\n")
    writer = threading.Thread(target=write)
    writer.start()
    try:
        made = [back_up(store.layout, tmp_path / f"copy{number}") for number in range(6)]
        end = time.monotonic() + patient(20)
        while store.layout.current() == made[0].snapshot:
            assert time.monotonic() < end
            time.sleep(0.01)
        made += [back_up(store.layout, tmp_path / f"copy{number}") for number in range(6, 12)]
    finally:
        stop.set()
        writer.join()
    assert len({one.snapshot for one in made}) > 1
    for number, one in enumerate(made):
        with EmbeddedStore(Layout(tmp_path / f"copy{number}")).read() as snapshot:
            held = snapshot.count()
            assert (snapshot.generation, held) == (one.snapshot, one.quads)
            assert held == sizes.get(one.snapshot, 0) + 1
            assert len(snapshot.dump(RdfFormat.N_QUADS).splitlines()) == held


def test_what_is_there_is_not_overwritten(tmp_path: Path) -> None:
    """A backup never overwrites anything, and leaves no files when it fails."""
    store = filled(tmp_path)
    (tmp_path / "taken").mkdir()
    with pytest.raises(KgError) as caught:
        back_up(store.layout, tmp_path / "taken")
    assert caught.value.code == "KG566"
    with pytest.raises(KgError):
        back_up(EmbeddedStore.create(tmp_path / "empty").layout, tmp_path / "copy")
    assert sorted(path.name for path in tmp_path.iterdir()) == [".kg", "empty", "taken"]


def damaged_manifest(target: Path) -> None:
    """Make the manifest claim more quads than there are."""
    manifest = target / "backup.json"
    manifest.write_text(manifest.read_text().replace('"quads": ', '"quads": 1'))


def no_manifest(target: Path) -> None:
    """Make the manifest unreadable."""
    (target / "backup.json").write_text("{}")


@pytest.mark.parametrize("damage", [damaged_manifest, no_manifest])
def test_what_is_not_whole_is_not_restored(tmp_path: Path, damage: object) -> None:
    """A backup with a wrong manifest, a truncated file, and a missing one are refused; the store is unchanged."""
    store = filled(tmp_path)
    back_up(store.layout, tmp_path / "copy")
    damage(tmp_path / "copy")  # type: ignore[operator]  # one of the functions above
    back_up(store.layout, tmp_path / "copy.nq.gz")
    packed = (tmp_path / "copy.nq.gz").read_bytes()
    (tmp_path / "cut.nq.gz").write_bytes(packed[:-20])
    for name in ("copy", "cut.nq.gz", "nothing"):
        with pytest.raises(KgError) as caught, store.write("test") as transaction:
            restore(transaction, tmp_path / name)
        assert caught.value.code == "KG567"
    assert store.layout.current() == 1
    assert store.layout.numbers() == [1]
