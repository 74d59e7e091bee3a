"""The endpoint's description of itself: SPARQL 1.1 Service Description, and the size of its data (VoID)."""

from __future__ import annotations

import json
from collections import OrderedDict
from typing import TYPE_CHECKING, Final

import pyoxigraph
from pyoxigraph import BlankNode, Literal, NamedNode, Triple
from starlette.responses import Response

from kg.errors import QueryError
from kg.query.formats import GRAPH_FORMATS, OF_GRAPHS, OF_RESULTS
from kg.query.readers.messages import Question
from kg.server.addresses import address
from kg.server.errors import RequestError
from kg.server.negotiation import GRAPH, choose
from kg.server.parameters import Parameters
from kg.server.safety.tokens import client
from kg.server.state import state
from kg.syntax.names import RDF_TYPE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.requests import Request

    from kg.server.options import Options

_SD: Final = "http://www.w3.org/ns/sparql-service-description#"
_VOID: Final = "http://rdfs.org/ns/void#"
_FORMATS: Final = "http://www.w3.org/ns/formats/"
_INTEGER: Final = NamedNode("http://www.w3.org/2001/XMLSchema#integer")
_COUNTS: Final = "SELECT ?g (COUNT(*) AS ?n) WHERE { GRAPH ?g { ?s ?p ?o } } GROUP BY ?g ORDER BY ?g"
_COUNT: Final = "SELECT (COUNT(*) AS ?n) WHERE { ?s ?p ?o }"

_Counts = tuple[int, dict[str, int]]
_KNOWN: Final[OrderedDict[tuple[str, str, bool], _Counts]] = OrderedDict()
_KEPT: Final = 4


async def description(request: Request) -> Response:
    """Return the description of the endpoint at the requested address, in an RDF format.

    Raises:
        RequestError: KG523 the client accepts none of these formats.
    """
    choices = choose(request.headers.get("accept"), Parameters(request.scope["query_string"]).formats)
    if "graph" not in choices:
        types = ", ".join(dict.fromkeys(media_type for media_type, _ in GRAPH))
        raise RequestError("KG523", "the service description is a graph", hint=f"Accept one of {types}.")
    choice = choices["graph"]
    body = pyoxigraph.serialize(
        _triples(address(request), state(request).options, await _counts(request)),
        format=GRAPH_FORMATS[choice.format],
        prefixes={"sd": _SD, "void": _VOID, "format": _FORMATS} if choice.format != "ntriples" else {},
    )
    return Response(body, headers={"Content-Type": choice.content_type, "Vary": "Accept", "Cache-Control": "no-cache"})


def _triples(endpoint: str, options: Options, counts: _Counts | None) -> Iterator[Triple]:
    service, dataset = BlankNode("service"), BlankNode("dataset")
    yield Triple(service, RDF_TYPE, _sd("Service"))
    yield Triple(service, _sd("endpoint"), NamedNode(endpoint))
    yield Triple(service, _sd("supportedLanguage"), _sd("SPARQL11Query"))
    if not options.no_union:
        yield Triple(service, _sd("feature"), _sd("UnionDefaultGraph"))
    yield Triple(service, _sd("feature"), _sd("EmptyGraphs"))
    for one in (*OF_RESULTS, *OF_GRAPHS):
        if one.registered:
            yield Triple(service, _sd("resultFormat"), NamedNode(_FORMATS + one.registered))
    yield Triple(service, _sd("defaultDataset"), dataset)
    yield Triple(dataset, RDF_TYPE, _sd("Dataset"))
    default = BlankNode("default")
    yield Triple(dataset, _sd("defaultGraph"), default)
    yield from _graph(default, counts[0] if counts else None)
    for index, (name, count) in enumerate((counts[1] if counts else {}).items()):
        named, graph = BlankNode(f"named{index}"), BlankNode(f"graph{index}")
        yield Triple(dataset, _sd("namedGraph"), named)
        yield Triple(named, RDF_TYPE, _sd("NamedGraph"))
        yield Triple(named, _sd("name"), NamedNode(name))
        yield Triple(named, _sd("graph"), graph)
        yield from _graph(graph, count)
    if options.write:
        yield from _updates(endpoint)


def _graph(graph: BlankNode, count: int | None) -> Iterator[Triple]:
    yield Triple(graph, RDF_TYPE, _sd("Graph"))
    if count is not None:
        yield Triple(graph, NamedNode(_VOID + "triples"), Literal(str(count), datatype=_INTEGER))


def _updates(endpoint: str) -> Iterator[Triple]:
    """Describe the update service, which is separate from the query service."""
    service = BlankNode("updates")
    yield Triple(service, RDF_TYPE, _sd("Service"))
    yield Triple(service, _sd("endpoint"), NamedNode(endpoint.rstrip("/").rpartition("/")[0] + "/update"))
    yield Triple(service, _sd("supportedLanguage"), _sd("SPARQL11Update"))
    for one in OF_GRAPHS:
        yield Triple(service, _sd("inputFormat"), NamedNode(_FORMATS + one.registered))


def _sd(name: str) -> NamedNode:
    return NamedNode(_SD + name)


async def _counts(request: Request) -> _Counts | None:
    """Return the number of triples of the default graph and of each named graph; None if counting takes too long.

    Counts are cached until the data changes.
    """
    shared = state(request)
    key = (str(shared.readers.layout.root), str(shared.readers.layout.current()), not shared.options.no_union)
    if key not in _KNOWN:
        try:
            rows = await _rows(request, _COUNTS)
            total = await _rows(request, _COUNT)
        except QueryError as error:
            if error.code == "KG503":
                return None
            raise
        named = {row["g"]["value"]: int(row["n"]["value"]) for row in rows}
        _KNOWN[key] = (int(total[0]["n"]["value"]), named)
        while len(_KNOWN) > _KEPT:
            _KNOWN.popitem(last=False)
    return _KNOWN[key]


async def _rows(request: Request, text: str) -> list[dict[str, dict[str, str]]]:
    shared = state(request)
    question = Question(text=text, formats={"rows": "json"}, union=not shared.options.no_union)
    async with shared.readers.ask(question, seconds=shared.options.seconds, client=client(request)) as response:
        body = b"".join([part async for part in response.parts()])
    bindings: list[dict[str, dict[str, str]]] = json.loads(body)["results"]["bindings"]
    return bindings
