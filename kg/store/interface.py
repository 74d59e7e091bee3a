"""Interface of the content of stores, local or remote.

Terms and results are those of pyoxigraph: they are plain values, and a remote store can parse them from the responses
of a SPARQL server (`pyoxigraph.parse_query_results`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping

    from pyoxigraph import NamedNode, QueryBoolean, QuerySolutions, QueryTriples, RdfFormat


class Queryable(Protocol):
    """What can be asked in SPARQL: a snapshot, a transaction, a store in memory, the columns of a store."""

    def query(self, text: str, /, *, prefixes: Any = None) -> Any:
        """Run a query over the union of all graphs; `prefixes` is a mapping, for a store in memory a `dict`."""
        ...


class Snapshot(Protocol):
    """Content of a store at one time; it does not change while the snapshot is open."""

    @property
    def identity(self) -> str:
        """Identifier of this content, unique in the store."""
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
        """Return the number of quads in a graph, or in the whole store."""
        ...

    def dump(
        self, rdf_format: RdfFormat, *, graph: NamedNode | None = None, prefixes: Mapping[str, str] = ...
    ) -> bytes:
        """Serialise one graph, or everything; a format without graphs gets the union of all graphs."""
        ...

    def close(self) -> None:
        """Release the content."""
        ...
