"""Tests of the guard against harmful queries."""

from __future__ import annotations

import contextlib
import socket
import threading
from typing import TYPE_CHECKING

import pyoxigraph
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kg.errors import QueryError
from kg.query.guard import MAX_CHAIN, MAX_DEPTH, check
from kg.syntax.lexer import normalise, tokens

if TYPE_CHECKING:
    from collections.abc import Iterator


def refused(text: str) -> str | None:
    """Return the message of the guard, None if it accepts the text."""
    text = normalise(text)
    try:
        check(tokens(text), text)
    except QueryError as error:
        return error.message if error.code in {"KG502", "KG516"} else None
    return None


DEEP = MAX_DEPTH + 1


@pytest.mark.parametrize(
    "text",
    [
        "SELECT * " + "{" * DEEP,
        "SELECT * {FILTER(" + "(" * DEEP,
        "SELECT * {?s ?p " + "[ ?p " * DEEP,
        "SELECT * {FILTER(" + "!" * DEEP + "true)}",
        "SELECT * {FILTER(1" + "-" * DEEP + "1)}",
        "SELECT * {?s " + "^" * DEEP + "<a:a> ?o}",
        "SELECT * {FILTER(" + "1<(" * DEEP + "1" + ")>1" * DEEP + ")}",
        "SELECT * {FILTER(" + "1<((((2>" * (DEEP // 4 + 1),
        "SELECT * {" + "{}UNION" * (MAX_CHAIN + 1) + "{}}",
        "SELECT * {FILTER(" + "?a||" * (MAX_CHAIN + 1) + "true)}",
        "SELECT * {" + "OPTIONAL{?s ?p ?o}" * (MAX_CHAIN + 1) + "}",
        "SELECT * {?s " + "<a:a>/" * (MAX_CHAIN + 1) + "<a:a> ?o}",
    ],
)
def test_too_deep_or_too_long_a_chain_is_refused(text: str) -> None:
    """Nesting and chains beyond the limits are refused before the engine parses them."""
    assert refused(text)


@pytest.mark.parametrize(
    "text",
    [
        "SELECT * " + "{" * 400 + "}" * 400,
        "SELECT * {?s ?p ?o FILTER(?s IN (" + ", ".join(["<http://x/(a>"] * 2000) + "))}",
        "SELECT * {VALUES ?x {" + "'((('" * 2000 + "}}",
        "SELECT * {?s ?p ?o} #" + "(" * 1000,
    ],
)
def test_what_only_looks_deep_passes(text: str) -> None:
    """Brackets in strings, IRIs and comments do not count; neither do long lists."""
    assert refused(text) is None


@pytest.mark.parametrize(
    "text",
    [
        'SELECT * {?s ?p "SERVICE <x> {}"}',
        "SELECT * {?s <http://x/service> ?SERVICE}",
        "SELECT * {?s kg:SERVICE $service} # SERVICE <x>",
        "PREFIX service: <http://x/> SELECT * {service:a ?p ?o}",
        "SELECT * {?s ?p '''a ' SERVICE ' b'''}",
        "SELECT * {?s ?p _:service . FILTER(?s<?p)}",
        "PREFIX load: <http://x/> SELECT * {?s load:a ?o}",
        "SELECT (?a<?b AS ?c) {?s ex:it\\'s ?o . ?o ?p 'SERVICE'}",
        "SELECT * {VALUES (?x ?y) {(1 <http://x/it's>) (2 <http://x/SERVICE>)}}",
    ],
)
def test_the_words_pass_where_they_are_no_keywords(text: str) -> None:
    """SERVICE and LOAD are accepted in strings, IRIs, comments, variables and names."""
    assert refused(text) is None


CALLS = [
    "SELECT * {SERVICE <IRI> {?s ?p ?o}}",
    "SELECT * {service silent<IRI>{?s ?p ?o}}",
    "SELECT * {SERVICE#x\n<IRI> {?s ?p ?o}}",
    "SELECT * {SERVICE ?s {?s ?p ?o}}",
    "SELECT * {SERVICE:a {?s ?p ?o}}",
    "SELECT * {SERVICEex:a {?s ?p ?o}}",
    "SELECT * {?s ?p 5SERVICE<IRI>{?s ?p ?o}}",
    "SELECT * {?s ?p trueSERVICE<IRI>{?s ?p ?o}}",
    "SELECT * {FILTER(1<2)SERVICE:foo#>\n{?s ?p ?o}}",
    "SELECT * {FILTER(1<2)#> '''\n SERVICE<IRI>{?s ?p ?o} #'''\n}",
    "SELECT * {?a ?b ?c FILTER(?c<?d).?s?p'> ' SERVICE <IRI>{?a ?b 'y'}}",
    "SELECT * {# \rSERVICE <IRI> {?s ?p ?o}\n}",
    "SELECT * {LATERAL{SERVICE<IRI>{?s ?p ?o}}}",
    "SELECT * {{SELECT ?x (1<2 AS ?y) {SERVICE <IRI> {?s ?p ?o}}}}",
    "SELECT * {{SELECT ?s {?s ?p ?o} GROUP BY ?s (1<2)SERVICE:a#>\n{}}}",
    "SELECT * {FILTER EXISTS {FILTER ex:f(1<2)SERVICE:foo#>\n{?s ?p ?o}}}",
    "SELECT * {BIND(IF(1<2,1,2)AS?x)SERVICE:foo#>\n{?s ?p ?o}}",
]


@pytest.mark.parametrize("text", [*CALLS, "LOAD <IRI>", "LOAD:a", "CLEAR ALL;LOADSILENT:a", "LOAD SILENT <IRI>"])
def test_calls_to_other_servers_are_refused(text: str) -> None:
    """Every form of SERVICE or LOAD is refused, also without whitespace around it."""
    assert refused(text.replace("<IRI>", "<http://127.0.0.1:9/>"))


@pytest.fixture(scope="module")
def server() -> Iterator[tuple[int, list[bool]]]:
    """A listening port, and a list that gets an entry for each connection."""
    listener = socket.create_server(("127.0.0.1", 0))
    hits: list[bool] = []

    def serve() -> None:
        with contextlib.suppress(OSError):
            while True:
                connection, _ = listener.accept()
                hits.append(True)
                connection.close()

    threading.Thread(target=serve, daemon=True).start()
    yield listener.getsockname()[1], hits
    listener.close()


WRITTEN = (
    "SELECT * WHERE { } { } ( ) FILTER FILTER( 1<2 ?a<?b ) BIND( AS ?x) SERVICE SERVICE:a SERVICE<IRI> "
    "SERVICE<IRI>{?s?p?o} SERVICE:a{} ' '' ''' # #> > < << . ; , a ex:a ex:SERVICE true 5 VALUES "
    "VALUES?x{ VALUES(?x?y){ (1<IRI>) ?s ?p ?o OPTIONAL UNION EXISTS <IRI> <a:b'> '> [ ] @en ^^ \\"
)
PIECES = st.sampled_from(WRITTEN.split())


@settings(max_examples=300, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.lists(st.tuples(PIECES, st.sampled_from(["", " ", "\n", "\r"])), max_size=14))
def test_no_query_that_passes_connects(server: tuple[int, list[bool]], pieces: list[tuple[str, str]]) -> None:
    """Whatever the query, the engine makes no connection if the guard accepted it."""
    port, hits = server
    iri = f"<http://127.0.0.1:{port}/>"
    body = "".join(piece + blank for piece, blank in pieces).replace("<IRI>", iri)
    text = f"PREFIX : {iri} PREFIX ex: {iri} PREFIX SERVICE: {iri} SELECT * {{ ?s ?p ?o . {body} }}"
    if refused(text):
        return
    store = pyoxigraph.Store()
    name = pyoxigraph.NamedNode("a:a")
    store.add(pyoxigraph.Quad(name, name, name))
    before = len(hits)
    with contextlib.suppress(SyntaxError, OSError, RuntimeError, ValueError):
        _exhaust(store.query(normalise(text)))
    assert len(hits) == before


def _exhaust(answer: object) -> None:
    """Read all rows of a result, because the engine only calls other servers for rows that are read."""
    if isinstance(answer, pyoxigraph.QuerySolutions):
        list(answer)


def test_the_engine_does_connect_without_the_guard(server: tuple[int, list[bool]]) -> None:
    """The tests above would detect a connection: the best hidden calls do connect without the guard."""
    port, hits = server
    iri = f"<http://127.0.0.1:{port}/>"
    store = pyoxigraph.Store()
    for text in ("SELECT * {FILTER(1<2)SERVICE:foo#>\n{?s ?p ?o}}", "SELECT * {SERVICEex:a {?s ?p ?o}}"):
        before = len(hits)
        with contextlib.suppress(OSError, RuntimeError):
            _exhaust(store.query(f"PREFIX : {iri} PREFIX ex: {iri} {text}"))
        assert len(hits) == before + 1
