"""A SPARQL server with the interface of a snapshot, for read-only commands.

    with RemoteReading("https://example.org/query") as snapshot: ...

The default graph of a server is not read: servers disagree about whether it is the union of the others, and all graphs
of `kg` are named. Blank nodes of a response cannot be used in later queries, so looking one up is refused. Credentials
come from the environment (`kg.store.http`).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, cast
from urllib.parse import urlsplit

from pyoxigraph import (
    BlankNode,
    DefaultGraph,
    NamedNode,
    Quad,
    QueryBoolean,
    QueryResultsFormat,
    QuerySolutions,
    QueryTriples,
    RdfFormat,
    Store,
    Variable,
)

from kg.errors import Place, StoreError
from kg.store.http import Endpoint
from kg.store.remote import RemoteSnapshot
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.store.terms import Term

_GRAPH: Final = re.compile(r"\bGRAPH\b", re.IGNORECASE)


class RemoteReading(EmbeddedSnapshot):
    """Content of a SPARQL server; unlike that of the embedded store, it may change while it is read.

    `timeout` is how long the server may be silent, in seconds.

    Raises:
        StoreError: KG225 for an address with credentials or another scheme than http or https; also for each failed
            request.
    """

    def __init__(self, address: str, *, timeout: float = 60.0) -> None:
        if urlsplit(address).username is not None:
            hint = "Set KG_REMOTE_USER and KG_REMOTE_PASSWORD, or KG_REMOTE_TOKEN, and leave them out of the address."
            place = Place(urlsplit(address).hostname or "")
            raise StoreError("KG225", "credentials do not belong on the command line", place=place, hint=hint)
        self.layout = None
        self.generation, self._handle = 0, -1
        self._remote = RemoteSnapshot(Endpoint(address, timeout=timeout, from_environment=True))
        self._graphs: list[NamedNode] | None = None
        self._place = Place(address)

    @property
    def identity(self) -> str:
        """A new identifier for each snapshot, as a server does not report changes of its content."""
        return self._remote.identity

    @property
    def engine(self) -> Store:
        """Raise StoreError KG309: a server has no local engine."""
        raise self._unsupported("the command works on files of the store")

    def query(  # noqa: PLR0913 - the options of the embedded store
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
        """Run a SPARQL query; see `EmbeddedSnapshot.query`.

        Raises:
            StoreError: KG225 if the server does not respond, KG309 for blank nodes and given datasets.
            SyntaxError: invalid SPARQL.
        """
        if default_graphs is not None or named_graphs is not None:
            raise self._unsupported("the query names a data set")
        whole = self._substituted(text, substitutions or {})
        known = dict(prefixes or {})
        if not union and not _GRAPH.search(whole):
            return Store().query(whole, prefixes=known, base_iri=base)
        _check(whole, known, base)
        declared = f"BASE <{base}>\n" if base else ""
        return self._remote.query(declared + whole, prefixes=_used(whole, known), union=union)

    def graphs(self) -> list[NamedNode]:
        """Return the names of all named graphs, sorted; cached after the first call."""
        if self._graphs is None:
            self._graphs = self._remote.graphs()
        return self._graphs

    def count(self, graph: NamedNode | None = None) -> int:
        """Return the number of quads in a graph, or in all named graphs."""
        if graph is not None:
            return self._remote.count(graph)
        rows = self._remote.rows("SELECT (COUNT(*) AS ?n) WHERE { GRAPH ?g { ?s ?p ?o } }")
        return int(next(rows)["n"].value)

    def quads(self) -> Iterator[Quad]:
        """Yield all quads of named graphs, graph by graph."""
        for graph in self.graphs():
            yield from self._remote._quads(graph)  # noqa: SLF001 - the other half of this class

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph, as `kg.store.bulk.table`."""
        if graph is None:
            return b""
        rows = cast("QuerySolutions", self.query(select.replace("WHERE {", f"FROM {graph} WHERE {{", 1)))
        text = cast("bytes", rows.serialize(format=QueryResultsFormat.TSV))
        return text[text.index(b"\n") + 1 :]

    def dump(self, rdf_format: RdfFormat, *, graph: NamedNode | None = None, prefixes: Mapping[str, str] = {}) -> bytes:
        """Serialise `graph`, or everything; see `kg.store.remote.RemoteSnapshot.dump`."""
        return self._remote.dump(rdf_format, graph=graph, prefixes=prefixes)

    def every_graph(self) -> list[NamedNode | BlankNode | DefaultGraph]:
        """Return all named graphs."""
        return list(self.graphs())

    def content(self, graph: NamedNode | BlankNode | DefaultGraph) -> bytes:
        """Return the content of one graph, as N-Triples."""
        return self.dump(RdfFormat.N_TRIPLES, graph=graph) if isinstance(graph, NamedNode) else b""

    def backup(self, folder: str) -> None:  # noqa: ARG002 - the signature of a snapshot
        """Raise StoreError KG309: there are no files to copy."""
        raise self._unsupported("the command works on files of the store")

    def close(self) -> None:
        """Do nothing, as nothing is open."""

    def _substituted(self, text: str, given: Mapping[Variable, Term]) -> str:
        """Return an internal query with terms substituted for variables, in its body and its SELECT clause."""
        head, brace, body = text.partition("{")
        for variable, term in given.items():
            if isinstance(term, BlankNode):
                raise self._unsupported("the answer depends on a blank node")
            name = re.compile(rf"[?$]{variable.value}\b")
            written = str(term)
            body = name.sub(lambda _, written=written: written, body)  # type: ignore[misc] # bound at once
            value = f"({written} AS ?{variable.value})"
            head = name.sub(lambda _, value=value: value, head)  # type: ignore[misc] # the same
        return head + brace + body

    def _unsupported(self, reason: str) -> StoreError:
        hint = "Use a store of this machine; `kg pull` makes one of a published graph."
        return StoreError("KG309", f"a SPARQL server cannot answer this: {reason}", place=self._place, hint=hint)


def _used(text: str, prefixes: Mapping[str, str]) -> dict[str, str]:
    """Return the prefixes that a query uses; its own declarations follow and take precedence."""
    return {name: iri for name, iri in prefixes.items() if f"{name}:" in text}


def _check(text: str, prefixes: Mapping[str, str], base: str | None) -> None:
    """Raise SyntaxError with the place of a syntax error, as the embedded store does."""
    Store().query(text, prefixes=dict(prefixes), base_iri=base)
