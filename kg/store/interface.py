"""Interface of stores of quads, embedded or remote.

Terms and results are pyoxigraph's: they are plain values, and a remote store can make them from what a SPARQL
server answers (`pyoxigraph.parse_query_results`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from contextlib import AbstractContextManager
    from pathlib import Path

    from pyoxigraph import NamedNode, QueryBoolean, QuerySolutions, QueryTriples, RdfFormat


class Snapshot(Protocol):
    """The content of a store at one moment; it does not change while it is held."""

    @property
    def identity(self) -> str:
        """Identifier of this content among all of the same store."""
        ...

    def query(
        self, text: str, *, prefixes: Mapping[str, str] | None = None, union: bool = True
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a SPARQL query; with `union` its default graph is the union of all graphs."""
        ...

    def graphs(self) -> list[NamedNode]:
        """Return the names of all named graphs, sorted."""
        ...

    def count(self, graph: NamedNode | None = None) -> int:
        """Return how many quads a graph holds, or the whole store."""
        ...

    def dump(
        self, rdf_format: RdfFormat, *, graph: NamedNode | None = None, prefixes: Mapping[str, str] = ...
    ) -> bytes:
        """Serialise one graph, or everything; a format without graphs gets the union of all graphs."""
        ...

    def close(self) -> None:
        """Release the content."""
        ...


class Transaction(Protocol):
    """Changes that take effect together or not at all."""

    def replace_graphs(self, graphs: Mapping[NamedNode, Iterable[bytes]]) -> None:
        """Give each named graph a new content, as chunks of N-Triples that end at ends of lines."""
        ...

    def append(self, graph: NamedNode, triples: bytes) -> None:
        """Add N-Triples to a graph."""
        ...

    def drop_graph(self, graph: NamedNode) -> None:
        """Remove a graph with all it holds."""
        ...

    def load_file(self, path: Path, rdf_format: RdfFormat | None = None, *, graph: NamedNode | None = None) -> None:
        """Add the content of a file of RDF."""
        ...

    def update(self, text: str, *, prefixes: Mapping[str, str] | None = None) -> None:
        """Run a SPARQL update."""
        ...


class QuadStore(Protocol):
    """A place where quads are kept."""

    def read(self) -> AbstractContextManager[Snapshot]:
        """Return the content in force, to be used in a `with` statement."""
        ...

    def write(self, command: str) -> AbstractContextManager[Transaction]:
        """Begin a transaction that takes effect at the end of the `with` statement unless its body raises."""
        ...
