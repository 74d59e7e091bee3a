"""A store on a server that supports the SPARQL 1.1 Protocol for queries and updates.

    store = RemoteStore("http://localhost:7878/query", "http://localhost:7878/update")
    with store.read() as snapshot: ...
    store.update("INSERT DATA { GRAPH <urn:g> { ... } } ; DROP GRAPH <urn:h>")

A server has no snapshots: its content may change between two requests. The operations of one request usually run
atomically (SPARQL 1.1 Update, section 3: "a request SHOULD be atomic").
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from tempfile import SpooledTemporaryFile
from typing import IO, Final, Self, cast
from uuid import uuid4

from pyoxigraph import (
    DefaultGraph,
    NamedNode,
    Quad,
    QueryBoolean,
    QueryResultsFormat,
    QuerySolutions,
    QueryTriples,
    RdfFormat,
    Store,
    Triple,
    Variable,
    parse,
    parse_query_results,
)

from kg.errors import Place, StoreError
from kg.store.http import Answer, Endpoint, RefusedError
from kg.store.serialization import serialized

_NO_UPDATES: Final = frozenset({400, 404, 405, 415, 501})
"""Statuses of responses to an update at an address for queries. Oxigraph and kg respond 400, as to invalid updates."""
SYSTEM_GRAPHS: Final = tuple(
    map(
        NamedNode,
        (
            "http://www.openlinksw.com/schemas/virtrdf#",
            "http://localuriqaserver/sparql",
            "http://www.w3.org/ns/ldp#",
        ),
    )
)
"""System graphs of every Virtuoso database."""
_VIRTUOSO_ASK: Final = Variable("__ASK_RETVAL")
"""Variable of Virtuoso's result of ASK, a row with 0 or 1."""
_VIRTUOSO: Final = b'\n{ "head": { "link": ['
"""Beginning of Virtuoso's rows in JSON."""
_VIRTUOSO_VALUES: Final = re.compile(
    rb'(XMLSchema#boolean", "value": ")([01])(?=")'
    rb'|("type": "bnode", "value": ")nodeID://'
    rb'|(XMLSchema#dateTime", "value": "[^".]+\.\d*?[1-9])0+(?=\D)'
)
"""Matches Virtuoso's booleans, which are 1 and 0, its labels of blank nodes, and fractions of seconds that end in 0."""
_IN_MEMORY: Final = 16 << 20
"""Largest result in memory, in bytes; a larger one goes to a temporary file."""
_ROWS: Final = "application/sparql-results+json"
SIZES: Final = "SELECT ?g (COUNT(*) AS ?n) WHERE { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g"
"""The query for the number of triples in each named graph that is not empty."""
_TRIPLES: Final = "application/n-triples, text/turtle;q=0.5"
_MAKES_TRIPLES: Final = re.compile(
    r"(?:\s|\#[^\n]*\n|(?:BASE|PREFIX\s+[^\s:]*:)\s*<[^>]*>)*(?:CONSTRUCT|DESCRIBE)\b", re.IGNORECASE
)
"""Matches queries that return triples; servers that may choose the format may return these as rows (Virtuoso)."""


class RemoteStore:
    """A SPARQL 1.1 server.

    Without an address for updates the one for queries takes them too. `timeout` is how many seconds the server may
    be silent, `from_environment` that of `kg.store.http.Endpoint`.

    Raises:
        StoreError: KG225 when an address is not one of http or https; so does every call that fails.
    """

    def __init__(
        self, query_url: str, update_url: str | None = None, *, timeout: float = 60.0, from_environment: bool = False
    ) -> None:
        self._queries = Endpoint(query_url, timeout=timeout, from_environment=from_environment)
        self._updates = Endpoint(update_url or query_url, timeout=timeout, from_environment=from_environment)
        self._one_address = update_url in {None, query_url}

    @property
    def address(self) -> str:
        """Address for queries, without credentials."""
        return self._queries.shown

    def read(self) -> RemoteSnapshot:
        """Return the content of the server, which may change between requests."""
        return RemoteSnapshot(self._queries)

    def update(self, text: str, *, timeout: float | None = None) -> None:
        """Send one SPARQL Update request now; never retried."""
        try:
            self._updates.post([("update", text)], timeout=timeout)
        except RefusedError as error:
            if self._one_address and error.status in _NO_UPDATES:
                error.hint = f"{error.hint} If this address takes queries only, name the other one with --update-url."
            raise


class RemoteSnapshot:
    """Content of a server; unlike that of the embedded store, it may change while it is read."""

    def __init__(self, endpoint: Endpoint) -> None:
        self._endpoint = endpoint
        self._identity = str(uuid4())
        self.is_virtuoso = False
        """Whether the last response with rows came from Virtuoso."""

    @property
    def identity(self) -> str:
        """A new identifier for each snapshot, as a server does not report changes of its content."""
        return self._identity

    def query(  # noqa: PLR0913 - what the protocol has
        self,
        text: str,
        *,
        prefixes: Mapping[str, str] | None = None,
        union: bool = True,
        timeout: float | None = None,
        default_graphs: Sequence[NamedNode] = (),
        named_graphs: Sequence[NamedNode] = (),
    ) -> QuerySolutions | QueryBoolean | QueryTriples:
        """Run a SPARQL query; graphs named here are its data set (SPARQL 1.1 Protocol, section 2.1.4).

        The protocol has no word for `union`: most servers have it always, Oxigraph takes a parameter of its own,
        which is sent, and Fuseki a setting of the data set (`unionDefaultGraph`).
        """
        declared = "".join(f"PREFIX {prefix}: <{iri}>\n" for prefix, iri in (prefixes or {}).items())
        fields = [("query", declared + text), *([("union-default-graph", "true")] if union else [])]
        fields += [("default-graph-uri", graph.value) for graph in default_graphs]
        fields += [("named-graph-uri", graph.value) for graph in named_graphs]
        accept = _TRIPLES if _MAKES_TRIPLES.match(text) else _ROWS
        answer = self._endpoint.post(fields, accept=accept, timeout=timeout)
        result = self._parsed(answer)
        if isinstance(result, QuerySolutions) and result.variables == [_VIRTUOSO_ASK]:
            answered = any(row[_VIRTUOSO_ASK].value == "1" for row in result)
            return Store().query(f"ASK {{ FILTER({str(answered).lower()}) }}")
        return result

    def rows(self, text: str) -> QuerySolutions:
        """Run a SELECT that names all its graphs."""
        return cast("QuerySolutions", self.query(text, union=False))

    def graphs(self) -> list[NamedNode]:
        """Return the names of all named graphs that are not empty, sorted, without system graphs of the server."""
        # Virtuoso 7 needs seconds for SELECT DISTINCT ?g over a small store, and milliseconds to group.
        terms = (row["g"] for row in self.rows("SELECT ?g WHERE { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g"))
        named = (graph for graph in terms if isinstance(graph, NamedNode) and graph not in SYSTEM_GRAPHS)
        return sorted(named, key=lambda graph: graph.value)

    def count(self, graph: NamedNode | None = None) -> int:
        """Return the number of quads in a graph, or in the whole store."""
        return int(next(self.rows(f"SELECT (COUNT(*) AS ?n) WHERE {{ {_everything(graph)} }}"))["n"].value)

    def quads(self, graph: NamedNode | None = None) -> Iterator[Quad]:
        """Yield the quads of a graph, or of the whole store."""
        for row in self.rows(f"SELECT ?s ?p ?o ?g WHERE {{ {_everything(graph)} }}"):
            yield Quad(row["s"], row["p"], row["o"], graph or row["g"] or DefaultGraph())

    def dump(self, rdf_format: RdfFormat, *, graph: NamedNode | None = None, prefixes: Mapping[str, str] = {}) -> bytes:
        """Serialise one graph, or everything; a format without graphs gets the union of all graphs.

        Blank nodes have the labels of this response. Raises QueryError KG504 for a triple that the format cannot
        represent.
        """
        statements: Iterable[Triple | Quad] = self.quads(graph)
        if not rdf_format.supports_datasets:
            statements = {cast("Quad", quad).triple: None for quad in statements}
        return serialized(statements, rdf_format, prefixes)

    def close(self) -> None:
        """Do nothing, as nothing is open."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _parsed(self, answer: Answer) -> QuerySolutions | QueryBoolean | QueryTriples:
        place = Place(self._endpoint.shown)
        try:
            if results := QueryResultsFormat.from_media_type(answer.media_type):
                self.is_virtuoso = _is_virtuoso(answer.body)
                body = _standard(answer.body) if self.is_virtuoso else answer.body
                return parse_query_results(body, format=results)
            if triples := RdfFormat.from_media_type(answer.media_type):
                # Only a query can create a result of triples.
                store = Store()
                store.bulk_extend(parse(answer.body, triples))
                return cast("QueryTriples", store.query("CONSTRUCT { ?s ?p ?o } WHERE { ?s ?p ?o }"))
        except (SyntaxError, ValueError) as error:
            raise StoreError("KG225", f"the answer of the server cannot be read: {error}", place=place) from error
        message = f"the server answered with `{answer.media_type}`, which is not a result of a query"
        raise StoreError("KG225", message, place=place, hint="Check that the address is the one for SPARQL queries.")


def _everything(graph: NamedNode | None) -> str:
    """Return the pattern of all quads of a graph, or of the whole store."""
    return f"GRAPH {graph} {{ ?s ?p ?o }}" if graph else "{ ?s ?p ?o } UNION { GRAPH ?g { ?s ?p ?o } }"


def _is_virtuoso(body: IO[bytes]) -> bool:
    """Return whether rows come from Virtuoso."""
    start = body.read(len(_VIRTUOSO))
    body.seek(0)
    return start == _VIRTUOSO


def _standard(body: IO[bytes]) -> IO[bytes]:
    """Return Virtuoso's rows with values in their usual form."""
    mended = SpooledTemporaryFile(_IN_MEMORY)  # noqa: SIM115 - closed with the response
    for line in body:  # quotes in values are escaped, so values cannot match
        mended.write(_VIRTUOSO_VALUES.sub(_standard_value, line))
    mended.seek(0)
    return cast("IO[bytes]", mended)


def _standard_value(match: re.Match[bytes]) -> bytes:
    if match[2]:
        return match[1] + (b"true" if match[2] == b"1" else b"false")
    return match[3] or match[4]
