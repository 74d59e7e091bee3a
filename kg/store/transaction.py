"""Transactions of the embedded store: changes go into a new generation, which becomes current at the end or not at all.

The new generation begins as a checkpoint of the current one (hard links, milliseconds), or empty with copies of the
remaining graphs. Costs measured with 750,000 quads of RNKG data on one machine, in microseconds per quad:
deleting 23, bulk loading 6, copying 17 (serializing and loading). So a transaction that replaces more than about two
fifths of the store begins empty.
"""

from __future__ import annotations

import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, cast

from pyoxigraph import (
    BlankNode,
    DefaultGraph,
    NamedNode,
    Quad,
    QueryBoolean,
    QuerySolutions,
    QueryTriples,
    RdfFormat,
    Store,
    Triple,
    parse,
    serialize,
)

from kg.store import bulk
from kg.store.allocator import give_back
from kg.store.changes import Changes
from kg.store.failure import translated
from kg.store.files import reading, required_format_of
from kg.store.layout import Layout, folder_bytes, write_atomically
from kg.store.snapshot import EmbeddedSnapshot

_MERGED_SHARE = 0.25
"""After a load of more than this share of a generation's bytes, its files are merged."""
_MERGED_BYTES = 32 << 20
"""Smaller loads are not merged: for 100,000 quads, merging costs 0.2 to 0.4 s, and saves a command 0.03 s."""

_DELETE_COST = 23
_COPY_COST = 17


class EmbeddedTransaction:
    """A new generation being written; created and finished by `EmbeddedStore.write`.

    Nothing is written before the first change. A transaction without changes leaves the store unchanged.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        numbers = layout.numbers()
        self._base = layout.current()
        self._number = max([self._base or 0, *numbers]) + 1
        self._db: Store | None = None
        self.changes = Changes()
        self._loaded = 0

    @property
    def layout(self) -> Layout:
        """The store being written."""
        return self._layout

    @property
    def base(self) -> int | None:
        """The generation that this one is based on, None in a store without data."""
        return self._base

    @property
    def changed(self) -> bool:
        """Whether anything was written."""
        return self._db is not None

    @property
    def merging(self) -> bool:
        """Whether the load is large enough to merge the files of the generation before it becomes current.

        Each batch creates files that every look-up has to search; after merging, reading is four times faster. The cost
        of merging depends on the size of the whole generation, so small loads skip it.
        """
        if self._loaded < _MERGED_BYTES:
            return False
        return self._loaded > folder_bytes(self._layout.generation(self._number)) * _MERGED_SHARE

    def start_from(self, snapshot: EmbeddedSnapshot | None) -> None:
        """Begin with the content of a snapshot, possibly of another store, or empty, instead of the current content.

        Only before the first change.
        """
        if self._db is not None:
            raise ValueError("the transaction has begun")
        folder = str(self._layout.generation(self._number))
        with translated(str(self._layout.root)):
            if snapshot is not None:
                snapshot.backup(folder)
            self._db = Store(folder)
        self.changes.forget()

    def start_with(self, files: Mapping[str, bytes]) -> None:
        """Begin with the files of a database, as `files` returns them, in a store without data.

        The caller notes the graphs in `changes`.
        """
        folder = self._layout.generation(self._number)
        with translated(str(self._layout.root)):
            folder.mkdir(parents=True)
            for name, content in files.items():
                write_atomically(folder / Path(name).name, content)
            self._db = Store(str(folder))

    def files(self) -> dict[str, bytes]:
        """Return the files of the database at this point. No iterator over the content may be in use."""
        folder = self._layout.generation(self._number)
        with self._begun():
            self._engine.flush()
            self._db = None
            found = {path.name: path.read_bytes() for path in folder.iterdir() if not path.name.startswith("LO")}
            self._db = Store(str(folder))
        return found

    def replace_graphs(self, graphs: Mapping[NamedNode, Iterable[bytes]]) -> None:
        """Replace the content of each named graph by chunks of N-Triples, each of whole lines.

        Labels of blank nodes are preserved, here and for all N-Triples passed to this transaction: the same label is
        the same node, also in other graphs and in the store.
        """
        with self._begun(frozenset(graphs)):
            self.changes.clear(*(graph.value for graph in graphs))
            for graph, chunks in graphs.items():
                if self._engine.contains_named_graph(graph):
                    self._engine.clear_graph(graph)
                self._engine.add_graph(graph)
                self.load(graph, chunks)

    def load(self, graph: NamedNode, chunks: Iterable[bytes]) -> None:
        """Add chunks of N-Triples, each of whole lines, to a graph, in bulk.

        The terms come from `kg.graph`, or from a store, and are valid: only their syntax is checked.
        """
        with self._begun():
            self._loaded += bulk.load(lambda: self._engine, graph, self._noted(graph, chunks))

    def _noted(self, graph: NamedNode, chunks: Iterable[bytes]) -> Iterator[bytes]:
        for chunk in chunks:
            self.changes.load(graph.value, chunk)
            yield chunk

    def replace_small_graphs(self, graphs: Mapping[NamedNode, bytes]) -> None:
        """Replace the content of each named graph by N-Triples; all of them are loaded together.

        The engine writes files for each index at every load, so many small loads cost far more than one large one.
        """
        with self._begun(frozenset(graphs)):
            self.changes.clear(*(graph.value for graph in graphs))
            for graph, content in graphs.items():
                self._engine.clear_graph(graph)
                self.changes.load(graph.value, content)
            self._loaded += bulk.load_quads(lambda: self._engine, graphs.items())

    def load_graphs(self, graphs: Mapping[NamedNode, Iterable[bytes]]) -> None:
        """Add chunks of N-Triples, each of whole lines, to graphs; all of them are loaded together."""
        chunks = ((graph, chunk) for graph, content in graphs.items() for chunk in self._noted(graph, content))
        with translated(str(self._layout.root)):
            self._begin(frozenset())
            self._loaded += bulk.load_quads(lambda: self._engine, chunks)

    def patch_graph(self, graph: NamedNode, removed: bytes, added: bytes) -> None:
        """Remove the N-Triples `removed` from a graph and add `added`: for changes small compared with the graph.

        Blank nodes keep their labels.
        """
        with self._begun():
            self.changes.patch(graph.value, removed, added)
            if removed.strip():
                bulk.remove(lambda: self._engine, graph, removed)
            bulk.add(lambda: self._engine, graph, added)

    def patch_quads(self, removed: Collection[Quad], added: Collection[Quad]) -> None:
        """Remove quads that exist, and add others that do not; blank nodes keep their labels."""
        with self._begun():
            for graph in {quad.graph_name: None for quad in (*removed, *added)}:
                gone, new = (
                    serialize((quad.triple for quad in quads if quad.graph_name == graph), format=RdfFormat.N_TRIPLES)
                    for quads in (removed, added)
                )
                self.changes.patch(_name(graph), gone or b"", new or b"")
            self._loaded += bulk.exchange(lambda: self._engine, removed, added)

    def count(self, graph: NamedNode | DefaultGraph) -> int:
        """Return the current number of triples in a graph."""
        with self._begun():
            if (known := self.changes.count(_name(graph))) is not None:
                return known
            rows = self._engine.query("SELECT (COUNT(*) AS ?n) WHERE { ?s ?p ?o }", default_graph=graph)
            return int(next(cast("QuerySolutions", rows))["n"].value)

    def contains(self, quad: Quad) -> bool:
        """Return whether the transaction contains a quad now."""
        with self._begun():
            return quad in self._engine

    def copies(self, triple: Triple) -> list[Quad]:
        """Return the quads of a triple, one for each graph that contains it now."""
        with self._begun():
            return list(self._engine.quads_for_pattern(triple.subject, triple.predicate, triple.object, None))

    def has_graph(self, graph: NamedNode) -> bool:
        """Return whether a named graph of that name exists at this point, even if empty."""
        with self._begun():
            return self._engine.contains_named_graph(graph)

    def quads(self, graph: NamedNode | DefaultGraph) -> Iterator[Quad]:
        """Yield the quads of a graph at this point of the transaction."""
        with self._begun():
            return self._engine.quads_for_pattern(None, None, None, graph)

    def graphs(self) -> list[NamedNode]:
        """Return the named graphs at this point of the transaction."""
        with self._begun():
            return [graph for graph in self._engine.named_graphs() if isinstance(graph, NamedNode)]

    def query(
        self, text: str, *, prefixes: Mapping[str, str] | None = None, union: bool = True
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a SPARQL query on the content at this point; with `union` over the union of all graphs."""
        with self._begun():
            return self._engine.query(text, prefixes=dict(prefixes or {}), use_default_graph_as_union=union)

    def solutions(
        self,
        select: str,
        *,
        default: Sequence[NamedNode | DefaultGraph],
        named: Sequence[NamedNode] | None,
        prefixes: Mapping[str, str],
    ) -> QuerySolutions:
        """Return the solutions of a SELECT whose default graph is the union of `default`.

        GRAPH sees the graphs `named`, None for all of them.
        """
        self._begin()
        result = self._engine.query(
            select,
            prefixes=dict(prefixes),
            default_graph=list(default),
            named_graphs=None if named is None else list(named),
        )
        return cast("QuerySolutions", result)

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph at this point; see `kg.store.bulk.table`."""
        with self._begun():
            return bulk.table(lambda: self._engine, select, graph)

    def content(self, graph: NamedNode) -> bytes:
        """Return the content of a graph at this point, as N-Triples."""
        with self._begun():
            return self._engine.dump(format=RdfFormat.N_TRIPLES, from_graph=graph) or b""

    def append(self, graph: NamedNode, triples: bytes) -> None:
        """Add N-Triples to a graph; blank nodes keep their labels."""
        with self._begun():
            self.changes.patch(graph.value, b"", triples)
            bulk.add(lambda: self._engine, graph, triples)

    def drop_graph(self, graph: NamedNode) -> None:
        """Remove a graph and its content; an unknown name is ignored."""
        with self._begun(frozenset([graph])):
            self.changes.clear(graph.value)
            self._engine.remove_graph(graph)

    def create_graph(self, graph: NamedNode) -> None:
        """Create an empty graph."""
        with self._begun():
            self.changes.patch(graph.value, b"", b"")
            self._engine.add_graph(graph)

    def clear_graph(self, graph: NamedNode | DefaultGraph) -> None:
        """Remove all triples of a graph, but not the graph."""
        with self._begun():
            self.changes.clear(_name(graph))
            self._engine.clear_graph(graph)

    def load_file(
        self,
        path: Path,
        rdf_format: RdfFormat | None = None,
        *,
        graph: NamedNode | None = None,
        keep_labels: bool = False,
    ) -> None:
        """Add the content of an RDF file: to `graph`, or to the graphs that the file names.

        The default format is that of the file name's suffix; `.gz` files are unpacked. Labels of blank nodes are local
        to the file, so its blank nodes get new ones; `keep_labels`, for an empty store, preserves them.

        Raises:
            GraphError: KG601 with the line if the file is invalid, or if its format is unknown.
            SourceError: KG101 if the file cannot be opened.
        """
        rdf_format = rdf_format or required_format_of(path)
        target = graph or DefaultGraph()
        with translated(str(self._layout.root)), reading(path, rdf_format) as file:
            self._begin()
            if rdf_format.supports_datasets:
                self.changes.forget()  # the file may write to any graph
            self._load(file, rdf_format, path.absolute().as_uri(), target, keep_labels=keep_labels)
            if not rdf_format.supports_datasets:
                self.changes.load_file(_name(target), path, rdf_format)

    def _load(
        self,
        file: IO[bytes],
        rdf_format: RdfFormat,
        base: str,
        target: NamedNode | DefaultGraph,
        *,
        keep_labels: bool,
    ) -> None:
        """Load a file; quads of its default graph go into `target`.

        The engine's own loader is faster than single quads, but gives blank nodes new labels, and puts quads of the
        file's default graph into that of the store.
        """
        default = DefaultGraph()
        placing = rdf_format.supports_datasets and target != default
        if keep_labels or (placing and any(self._engine.quads_for_pattern(None, None, None, default))):
            quads = parse(file, rdf_format, base_iri=base, rename_blank_nodes=not keep_labels)
            self._engine.bulk_extend(_into(target, quad) for quad in quads)
            return
        to_graph = None if rdf_format.supports_datasets else target
        self._engine.bulk_load(file, rdf_format, base_iri=base, to_graph=to_graph)
        if placing:
            loose = self._engine.quads_for_pattern(None, None, None, default)
            self._engine.bulk_extend(_into(target, quad) for quad in loose)
            self._engine.clear_graph(default)

    def update(self, text: str, *, prefixes: Mapping[str, str] | None = None) -> None:
        """Run a SPARQL update directly in the engine."""
        with self._begun():
            self.changes.forget()
            self._engine.update(text, prefixes=dict(prefixes or {}))

    def release(self) -> None:
        """Free the memory that the engine holds for what was loaded, by opening the new generation again.

        Nothing is done after small loads. No iterator over the content may be in use.
        """
        if self._db is None or self._loaded < _MERGED_BYTES:
            return
        with translated(str(self._layout.root)):
            self._db.flush()
            self._db = None
            give_back()
            self._db = Store(str(self._layout.generation(self._number)))

    def commit(self) -> int | None:
        """Make the new generation the current one and return its number; None if nothing changed."""
        if self._db is None:
            return None
        with translated(str(self._layout.root)):
            if self.merging:
                self._db.optimize()
            self._db.flush()
            self._db = None
            self.changes.record(self._layout, self._number, self._base)
            self._layout.switch(self._number)
        return self._number

    def roll_back(self) -> None:
        """Delete the new generation unless it became current; the store is unchanged."""
        self._db = None
        if self._layout.current() == self._number:
            return
        shutil.rmtree(self._layout.generation(self._number), ignore_errors=True)

    @property
    def _engine(self) -> Store:
        """The new generation. Do not store it in local variables: the traceback of an error would keep it open."""
        if self._db is None:
            raise ValueError("the transaction has ended")
        return self._db

    @contextmanager
    def _begun(self, leaving: frozenset[NamedNode] = frozenset()) -> Iterator[None]:
        """Begin as `_begin`, and raise errors of the engine in the body as errors about the store."""
        with translated(str(self._layout.root)):
            self._begin(leaving)
            yield

    def _begin(self, leaving: frozenset[NamedNode] = frozenset()) -> None:
        """Create the new generation before the first use; its graphs `leaving` are about to be removed."""
        if self._db is not None:
            return
        folder = str(self._layout.generation(self._number))
        if self._base is None:
            self._db = Store(folder)
            return
        with EmbeddedSnapshot(self._layout) as base:
            going = sum(base.count(graph) for graph in leaving)
            # Counting a whole store takes as long as all of a small change.
            if not going or going * _DELETE_COST <= (base.count() - going) * _COPY_COST:
                base.backup(folder)
                self._db = Store(folder)
                return
            self._db = Store(folder)
            for graph in base.every_graph():
                if graph in leaving:
                    continue
                if graph != DefaultGraph():
                    self._engine.add_graph(graph)
                bulk.load(lambda: self._engine, graph, [base.content(graph)])


def _name(graph: NamedNode | BlankNode | DefaultGraph) -> str:
    """Return the name of a graph in changes, empty for the default graph."""
    return "" if isinstance(graph, DefaultGraph) else graph.value


def _into(target: NamedNode | DefaultGraph, quad: Quad) -> Quad:
    """Return `quad` with the graph `target` unless it names one."""
    if quad.graph_name != DefaultGraph():
        return quad
    return Quad(quad.subject, quad.predicate, quad.object, target)
