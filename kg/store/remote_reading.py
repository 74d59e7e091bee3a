"""A SPARQL server with the interface of a snapshot, by queries, for commands that only read.

    with RemoteReading(Layout(folder, "https://example.org/query")) as snapshot: ...

The unnamed graph of a server is not read: servers disagree about whether it is the union of the others, and graphs of
`kg` are all named. Blank nodes of a response cannot be named in the next query, so a look-up of one is refused.
Credentials come from the environment (`kg.store.http`).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final
from urllib.parse import urlsplit

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
    Variable,
)

from kg.errors import Place, StoreError
from kg.store.bulk import as_tsv
from kg.store.failure import LOCAL_HINT
from kg.store.http import Endpoint
from kg.store.remote import RemoteSnapshot
from kg.store.snapshot import EmbeddedSnapshot

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from kg.store.layout import Layout
    from kg.store.terms import Term

_EVERY_GRAPH: Final = re.compile(r"\bGRAPH\s+(\?\w+)\s*\{\s*\}", re.IGNORECASE)
_NAMES_GRAPHS: Final = re.compile(r"\b(?:GRAPH|FROM)\b", re.IGNORECASE)


class RemoteReading(EmbeddedSnapshot):
    """The content of a SPARQL server, whose address the layout has; unlike the embedded store's it is not held still.

    Raises:
        StoreError: KG225 for an address that is not one of http or https, or has credentials in it; so does every
            request that fails.
    """

    def __init__(self, layout: Layout) -> None:
        address = layout.address or ""
        without_credentials(address)
        self.layout = layout
        self._followed = layout.current()
        self.generation, self._handle = self._followed or 0, -1
        self._remote = RemoteSnapshot(Endpoint(address, timeout=layout.silence, from_environment=True))
        self._graphs: list[NamedNode] | None = None
        self._place = Place(address)

    @property
    def identity(self) -> str:
        """The number in force where somebody follows the server (`kg.store.following`), else a new one each time."""
        return self._remote.identity if self._followed is None else str(self._followed)

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
            StoreError: KG225 when the server does not answer, KG309 for blank nodes.
            SyntaxError: the query is not SPARQL.
        """
        whole = self._substituted(text, substitutions or {})
        namespaces = dict(prefixes or {})
        given = default_graphs is not None or named_graphs is not None
        if not union and not given and not _NAMES_GRAPHS.search(whole):
            return Store().query(whole, prefixes=namespaces, base_iri=base)
        # Raises SyntaxError with the place of a syntax error, as the embedded store does.
        Store().query(whole, prefixes=namespaces, base_iri=base)
        if not given:
            whole = _EVERY_GRAPH.sub(self._named, whole)
        declared = f"BASE <{base}>\n" if base else ""
        return self._remote.query(
            declared + whole,
            # Declarations of the query itself follow and take precedence.
            prefixes={name: iri for name, iri in namespaces.items() if f"{name}:" in whole},
            union=union and not given,
            default_graphs=default_graphs or (),
            named_graphs=named_graphs or (),
        )

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
            yield from self._remote.quads(graph)

    def rows(self, text: str) -> QuerySolutions:
        """Run a SELECT that names all its graphs."""
        return self._remote.rows(text)

    def table(self, select: str, graph: NamedNode | None) -> bytes:
        """Return the rows of a SELECT over one graph, as `kg.store.bulk.table`."""
        if graph is None:
            return b""
        return as_tsv(self.query(select.replace("WHERE {", f"FROM {graph} WHERE {{", 1), union=False))

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

    def _named(self, match: re.Match[str]) -> str:
        """Return the names of all graphs, for a pattern that servers match with none of them (Virtuoso)."""
        return f"VALUES {match[1]} {{ {' '.join(map(str, self.graphs()))} }}"

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
        return StoreError("KG309", f"a SPARQL server cannot answer this: {reason}", place=self._place, hint=LOCAL_HINT)


def without_credentials(address: str) -> None:
    """Raise StoreError KG225 for an address with credentials in it."""
    if urlsplit(address).username is not None:
        hint = "Set KG_REMOTE_USER and KG_REMOTE_PASSWORD, or KG_REMOTE_TOKEN, and leave them out of the address."
        place = Place(urlsplit(address).hostname or "")
        raise StoreError("KG225", "credentials do not belong on the command line", place=place, hint=hint)
