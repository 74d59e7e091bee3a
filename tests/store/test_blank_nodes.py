"""Blank nodes keep their labels in a store in all writes, and files never share one."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import examples
from pyoxigraph import BlankNode, DefaultGraph, Literal, NamedNode, Quad, RdfFormat, Triple, serialize

from kg.store import bulk
from kg.store.backups import back_up, canonical, restore
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterable

P = NamedNode("urn:test:p")
GRAPHS = tuple(NamedNode(f"urn:test:g{number}") for number in range(4))
BLANK_GRAPH = BlankNode("g")

blanks = st.builds(lambda number: BlankNode(f"b{number}"), st.integers(0, 5))
names = st.builds(lambda number: NamedNode(f"urn:test:{number}"), st.integers(0, 5))
subjects = blanks | names
texts = st.builds(Literal, st.sampled_from(["_:b1", "x .\n_:b2"]))
objects = subjects | texts | st.builds(Triple, subjects, st.just(P), blanks)
quads = st.builds(Quad, subjects, st.just(P), objects, st.sampled_from([*GRAPHS, DefaultGraph(), BLANK_GRAPH]))


def text(quads: Iterable[Quad]) -> bytes:
    """Return the triples of quads as N-Triples."""
    return serialize((quad.triple for quad in quads), format=RdfFormat.N_TRIPLES) or b""


def filled(folder: str | Path, content: Iterable[Quad]) -> EmbeddedStore:
    """Return a store with some quads."""
    store = EmbeddedStore.create(Path(folder) / ".kg")
    with store.write("test") as transaction:
        transaction.create_graph(GRAPHS[0])
        transaction.patch_quads([], set(content))
    return store


def content_of(store: EmbeddedStore) -> set[Quad]:
    """Return all quads of a store."""
    with store.read() as snapshot:
        return set(snapshot.quads())


@given(st.sets(quads, max_size=40), st.sets(st.sampled_from(GRAPHS), min_size=1), st.sets(quads, max_size=20))
@settings(deadline=None, max_examples=examples(6, 20))
def test_replacing_any_share_of_a_store_keeps_the_rest(
    before: set[Quad], replaced: set[NamedNode], new: set[Quad]
) -> None:
    """Remaining and new quads keep their labels: a node in several graphs is one node afterwards."""
    with TemporaryDirectory() as folder:
        store = filled(folder, before)
        coming = {graph: [quad for quad in new if quad.graph_name == graph] for graph in replaced}
        with store.write("test") as transaction:
            transaction.replace_graphs({graph: [text(found)] for graph, found in coming.items()})
        left = {quad for quad in before if quad.graph_name not in replaced}
        assert content_of(store) == left | {quad for found in coming.values() for quad in found}


@given(st.sets(quads, max_size=30), st.sets(quads, max_size=30), st.sampled_from(GRAPHS))
@settings(deadline=None, max_examples=examples(6, 20))
def test_every_way_of_writing_keeps_labels(before: set[Quad], added: set[Quad], graph: NamedNode) -> None:
    """Patches, additions, small graphs and removals refer to the nodes of the store."""
    here = [quad for quad in before if quad.graph_name == graph]
    came = {Quad(quad.subject, quad.predicate, quad.object, graph) for quad in added}
    with TemporaryDirectory() as folder:
        store = filled(folder, before)
        with store.write("test") as transaction:
            transaction.patch_graph(graph, text(here), text(came))
        expected = (before - set(here)) | came
        assert content_of(store) == expected
        with store.write("test") as transaction:
            transaction.append(graph, text(here))
            transaction.load(graph, [text(here)])
        assert content_of(store) == expected | set(here)
        with store.write("test") as transaction:
            transaction.replace_small_graphs({graph: text(came)})
        assert content_of(store) == expected


def test_a_node_of_a_large_graph_is_one_node(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A hub in several batches of a large graph remains one node."""
    monkeypatch.setattr(bulk, "_BATCH_BYTES", 1000)
    lines = b"".join(b"_:hub <urn:test:p> <urn:test:%d> .\n" % number for number in range(1000))
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs({GRAPHS[0]: [lines]})
    assert {quad.subject for quad in content_of(store)} == {BlankNode("hub")}


@given(st.sets(quads, max_size=20))
@settings(deadline=None, max_examples=examples(6, 20))
def test_files_scope_their_blank_nodes(content: set[Quad]) -> None:
    """Files with the same labels share no node with each other or the store; within one, a node remains one."""
    with TemporaryDirectory() as folder:
        store = filled(folder, content)
        files = [Path(folder) / name for name in ("a.nq", "b.nq")]
        for file in files:
            file.write_bytes(serialize(content, format=RdfFormat.N_QUADS) or b"")
        with store.write("test") as transaction:
            for file in files:
                transaction.load_file(file)
        labels = {term for quad in content for term in _blanks(quad)}
        found = content_of(store)
        assert content <= found
        assert len({term for quad in found for term in _blanks(quad)}) == 3 * len(labels)
        # The store contains a copy of each file: without the labels of one copy, the rest is the content again.
        labelled = {quad for quad in content if any(True for _ in _blanks(quad))}
        assert len(found) == len(content) + 2 * len(labelled)


@pytest.mark.parametrize("name", ["copy", "copy.nq", "copy.nq.gz"])
@given(content=st.sets(quads, max_size=20))
@settings(deadline=None, max_examples=examples(3, 10))
def test_a_restored_store_has_the_same_nodes(name: str, content: set[Quad]) -> None:
    """A folder preserves the labels, a file renames them; in both, a node in several graphs remains one."""
    with TemporaryDirectory() as folder:
        store = filled(folder, content)
        back_up(store.layout, Path(folder) / name)
        with store.write("test") as transaction:
            transaction.replace_graphs({graph: [] for graph in GRAPHS})
        with store.write("test") as transaction:
            restore(transaction, Path(folder) / name)
        found = content_of(store)
        assert canonical(found) == canonical(content)
        assert name != "copy" or found == content


def _blanks(quad: Quad) -> Iterable[BlankNode]:
    waiting: list[object] = [quad.subject, quad.object, quad.graph_name]
    while waiting:
        term = waiting.pop()
        if isinstance(term, Triple):
            waiting += [term.subject, term.object]
        elif isinstance(term, BlankNode):
            yield term
