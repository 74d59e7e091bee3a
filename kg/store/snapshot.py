"""Snapshot of the embedded store: one generation, opened read-only and protected until it is closed."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Self, cast

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
    Variable,
)

from kg.store import bulk
from kg.store.failure import translated
from kg.store.locks import hold_generation
from kg.store.serialization import serialized

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.store.layout import Layout
    from kg.store.terms import Term


class EmbeddedSnapshot:
    """The generation that was current when it was opened; later builds do not change it.

    Raises on opening:
        StoreError: KG301 for a store without data, KG303 for a damaged one, KG305 for another layout.
    """

    def __init__(self, layout: Layout) -> None:
        self.layout: Layout | None = layout
        self.generation, self._handle = hold_generation(layout)
        folder = str(layout.generation(self.generation))
        try:
            with translated(folder):
                self._db = Store.read_only(folder)
        except BaseException:
            os.close(self._handle)
            raise

    @property
    def identity(self) -> str:
        """The number of the generation."""
        return str(self.generation)

    @property
    def engine(self) -> Store:
        """The engine itself, read-only, for libraries that need it."""
        return self._db

    def query(  # noqa: PLR0913 - the options of the engine
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        substitutions: Mapping[Variable, Term] | None = None,
        base: str | None = None,
        default_graphs: Sequence[NamedNode] | None = None,
        named_graphs: Sequence[NamedNode] | None = None,
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a SPARQL query directly in the engine; `kg.query.run` adds guards.

        `substitutions` replaces variables everywhere in the query; terms may be blank nodes. Relative IRIs are resolved
        against `base`. `default_graphs` and `named_graphs` override the dataset of the query. `union`, which excludes
        these, makes the default graph the union of all graphs, also overriding the query.
        """
        return self._db.query(
            text,
            base_iri=base,
            prefixes=dict(prefixes or {}),
            use_default_graph_as_union=union,
            default_graph=None if default_graphs is None else list(default_graphs),
            named_graphs=None if named_graphs is None else list(named_graphs),
            substitutions=dict(substitutions) if substitutions else None,
        )

    def graphs(self) -> list[NamedNode]:
        """Return the names of all named graphs, sorted."""
        named = (graph for graph in self._db.named_graphs() if isinstance(graph, NamedNode))
        return sorted(named, key=lambda graph: graph.value)

    def count(self, graph: NamedNode | None = None) -> int:
        """Return the number of quads in `graph`, or in the whole store."""
        if graph is None:
            return len(self._db)
        rows = self._db.query(f"SELECT (COUNT(*) AS ?n) WHERE {{ GRAPH {graph} {{ ?s ?p ?o }} }}")
        return int(next(cast("QuerySolutions", rows))["n"].value)

    def quads(self) -> Iterator[Quad]:
        """Yield all quads."""
        return self._db.quads_for_pattern(None, None, None, None)

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph; see `kg.store.bulk.table`."""
        return bulk.table(lambda: self._db, select, graph)

    def dump(self, rdf_format: RdfFormat, *, graph: NamedNode | None = None, prefixes: Mapping[str, str] = {}) -> bytes:
        """Serialise `graph`, or everything.

        A format without graphs gets the union of all graphs, without duplicates. Raises QueryError KG504 for a triple
        that the format cannot represent.
        """
        quads = self._db.quads_for_pattern(None, None, None, graph)
        statements: Iterable[Triple | Quad] = quads
        if graph is None and not rdf_format.supports_datasets:
            # CONSTRUCT removes duplicates of triples in several graphs.
            union = self._db.query("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }", use_default_graph_as_union=True)
            statements = cast("QueryTriples", union)
        elif not rdf_format.supports_datasets:
            statements = (quad.triple for quad in quads)
        return serialized(statements, rdf_format, prefixes)

    def every_graph(self) -> list[NamedNode | BlankNode | DefaultGraph]:
        """Return the default graph and all others, also those named by blank nodes."""
        return [DefaultGraph(), *self._db.named_graphs()]

    def content(self, graph: NamedNode | BlankNode | DefaultGraph) -> bytes:
        """Return the content of one graph, as N-Triples."""
        return self._db.dump(format=RdfFormat.N_TRIPLES, from_graph=graph) or b""

    def backup(self, folder: str) -> None:
        """Copy the generation to `folder`; its large files are hard links, so this takes milliseconds."""
        self._db.backup(folder)

    def close(self) -> None:
        """Close the database and release the generation; closing twice is allowed."""
        if self._handle >= 0:
            del self._db
            os.close(self._handle)
            self._handle = -1

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class MemorySnapshot(EmbeddedSnapshot):
    """Quads in memory with the interface of a snapshot; the caller must not change the store afterwards."""

    def __init__(self, store: Store) -> None:
        self.layout = None
        self.generation, self._handle = 0, -1
        self._db = store
