from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, parse
from rules.engine.comparing import tuples

from kg.rules import written as module
from kg.rules.columns import EVERYTHING, read
from kg.rules.engine.terms import Dictionary
from kg.rules.written import Written
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.store.transaction import EmbeddedTransaction

GRAPHS: Final = [NamedNode(f"urn:graph:{number}") for number in range(3)]
OBJECTS: Final = [
    "<urn:a>",
    "_:b",
    '"text"',
    '"> \\"<"',
    '"line\\nbreak"@en',
    '"01"^^<http://www.w3.org/2001/XMLSchema#integer>',
    '"1.50"^^<http://www.w3.org/2001/XMLSchema#decimal>',
]
lines = st.lists(st.tuples(st.sampled_from(["urn:p", "urn:q", "urn:r"]), st.sampled_from(OBJECTS)), max_size=4).map(
    lambda pairs: b"".join(f"<urn:s> <{predicate}> {value} .\n".encode() for predicate, value in pairs)
)
operations = st.lists(
    st.tuples(
        st.sampled_from(
            ["load", "replace", "small", "patch", "append", "remove", "drop", "clear", "quads", "update", "file"]
        ),
        st.sampled_from(GRAPHS),
        lines,
    ),
    min_size=1,
    max_size=8,
)


def do(transaction: EmbeddedTransaction, operation: str, graph: NamedNode, content: bytes) -> None:
    """Change a graph by one of the operations of a transaction."""
    if operation == "load":
        transaction.load(graph, [content])
    elif operation == "replace":
        transaction.replace_graphs({graph: [content]})
    elif operation == "small":
        transaction.replace_small_graphs({graph: content})
    elif operation in {"patch", "remove"}:
        removed = transaction.content(graph) if operation == "remove" else b""
        transaction.patch_graph(graph, removed, content)
    elif operation == "append":
        transaction.append(graph, content)
    elif operation == "drop":
        transaction.drop_graph(graph)
    elif operation == "clear":
        transaction.clear_graph(graph)
    elif operation == "file":
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "content.nt"
            path.write_bytes(b"# a comment\n" + content.removesuffix(b"\n"))
            transaction.load_file(path, graph=graph)
    elif operation == "quads":
        transaction.patch_quads([], list(parse(content, RdfFormat.N_TRIPLES)))
    else:
        transaction.update(f"INSERT DATA {{ GRAPH {graph} {{ <urn:s> <urn:p> <urn:updated> }} }}")


@settings(max_examples=40)
@given(operations, st.sampled_from([1, 1 << 20]))
def test_what_is_written_is_what_would_be_read(changes: list[tuple[str, NamedNode, bytes]], batch: int) -> None:
    """After any transaction on an empty store, a graph and its size equal what is read back, or are left to be read."""
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_BATCH_BYTES", batch)
        with EmbeddedStore.create(Path(folder)).write("test") as transaction:
            written = transaction.changes = Written(Path(folder))
            for operation, graph, content in changes:
                do(transaction, operation, graph, content)
            graphs = [*GRAPHS, None]
            counts = [transaction.count(graph or DefaultGraph()) for graph in graphs]
            dictionary, found = written.take(graphs)
            assert counts == [transaction.count(graph or DefaultGraph()) for graph in graphs]
            again = Dictionary()
            stored = read(transaction, EVERYTHING, graphs, again)
            known = {graph: tuples(facts.copy(), dictionary) for graph, facts in found.items()}
            assert known == {graph: tuples(stored[graph].copy(), again) for graph in known}


def test_a_graph_that_was_only_loaded_need_not_be_read(tmp_path: Path) -> None:
    """Loads, replacements and added triples are known; removed triples and engine updates are not."""
    line = b"<urn:s> <urn:p> <urn:a> .\n"
    with EmbeddedStore.create(tmp_path).write("test") as transaction:
        transaction.changes = Written(tmp_path)
        transaction.load(GRAPHS[0], [line, b"<urn:s> <urn:p> _:b .\n"])
        transaction.replace_small_graphs({GRAPHS[1]: line})
        transaction.append(GRAPHS[1], b"<urn:s> <urn:q> <urn:a> .\n")
        transaction.load(GRAPHS[2], [line])
        transaction.patch_graph(GRAPHS[2], line, b"")
        assert transaction.changes.take(list(GRAPHS))[1].keys() == set(GRAPHS[:2])


def test_a_file_without_blank_nodes_need_not_be_read(tmp_path: Path) -> None:
    """Blank nodes of a file get new labels, and other formats are not lines: their graphs are read back."""
    contents = {
        "a.nt": b"<urn:s> <urn:p> <urn:a> .\n",
        "b.nt": b"<urn:s> <urn:p> _:b .\n",
        "c.ttl": b"<urn:s> a <urn:a> .",
    }
    with EmbeddedStore.create(tmp_path / "store").write("test") as transaction:
        transaction.changes = Written(tmp_path)
        for graph, (name, content) in zip(GRAPHS, contents.items(), strict=True):
            (tmp_path / name).write_bytes(content)
            transaction.load_file(tmp_path / name, graph=graph)
        assert transaction.changes.take(list(GRAPHS))[1].keys() == {GRAPHS[0]}
