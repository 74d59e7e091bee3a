"""C5: results in each format, parsed by another library, preserve every kind of term."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, Any, Final

import pytest
import rdflib
from pyoxigraph import NamedNode
from rdflib.query import Result
from serving import application

from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from starlette.testclient import TestClient

X: Final = "https://example.org/"
XSD: Final = "http://www.w3.org/2001/XMLSchema#"
TERMS: Final[dict[str, Any]] = {
    "iri": rdflib.URIRef(X + "a/ö?q=1&r=2#f"),
    "plain": rdflib.Literal("text"),
    "empty": rdflib.Literal(""),
    "signs": rdflib.Literal("comma, \"quotes\", 'both', <tag> & ]]> \\ back"),
    "ends": rdflib.Literal("line\nfeed\r\nboth\ttab\rreturn"),
    "blanks": rdflib.Literal("  before and after  "),
    "wide": rdflib.Literal("🤖 ö \u200b"),
    "language": rdflib.Literal("fünf", lang="de-at"),
    "typed": rdflib.Literal("x", datatype=rdflib.URIRef(X + "type")),
    "integer": rdflib.Literal("42", datatype=rdflib.URIRef(XSD + "integer")),
    "decimal": rdflib.Literal("1.5", datatype=rdflib.URIRef(XSD + "decimal")),
    "boolean": rdflib.Literal("true", datatype=rdflib.URIRef(XSD + "boolean")),
    "date": rdflib.Literal("2026-11-22", datatype=rdflib.URIRef(XSD + "date")),
}
"""Name of a property to its value."""
TYPES: Final = {
    "json": "application/sparql-results+json",
    "xml": "application/sparql-results+xml",
    "tsv": "text/tab-separated-values",
    "csv": "text/csv",
}
ALL: Final = f"SELECT ?name ?value ?nothing WHERE {{ <{X}s> ?p ?value BIND(STRAFTER(STR(?p), '{X}') AS ?name) }}"


@pytest.fixture(scope="module")
def terms(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server of a store with all kinds of terms."""
    root: Path = tmp_path_factory.mktemp("terms") / ".kg"
    graph = rdflib.Graph()
    for name, value in TERMS.items():
        graph.add((rdflib.URIRef(X + "s"), rdflib.URIRef(X + name), value))
    graph.add((rdflib.URIRef(X + "s"), rdflib.URIRef(X + "node"), rdflib.BNode("b1")))
    with EmbeddedStore.create(root).write("test") as transaction:
        transaction.replace_graphs({NamedNode(X + "g"): [graph.serialize(format="nt", encoding="utf-8")]})
    with application(root, log="off") as found:
        yield found


def body(client: TestClient, query: str, name: str) -> bytes:
    """Return the response to a query in a format."""
    answer = client.get("/sparql", params={"query": query}, headers={"accept": TYPES[name]})
    assert answer.headers["content-type"].partition(";")[0] == TYPES[name]
    return answer.content


@pytest.mark.parametrize("name", ["json", "xml", "tsv"])
def test_rows(terms: TestClient, name: str) -> None:
    """Rows in JSON, XML and TSV have each term, and unbound values are absent."""
    found = Result.parse(io.BytesIO(body(terms, ALL, name)), format=name)
    rows = {str(row[rdflib.Variable("name")]): row for row in found.bindings}
    assert isinstance(rows.pop("node")[rdflib.Variable("value")], rdflib.BNode)
    assert {key: row[rdflib.Variable("value")] for key, row in rows.items()} == TERMS
    assert all(row.get(rdflib.Variable("nothing")) is None for row in rows.values())


def test_csv(terms: TestClient) -> None:
    """Rows in CSV have the text of each term, whatever its characters (RFC 4180)."""
    text = body(terms, ALL, "csv").decode()
    found = {row["name"]: row for row in csv.DictReader(io.StringIO(text, newline=""))}
    assert found.pop("node")["value"].startswith("_:")
    assert {name: row["value"] for name, row in found.items()} == {name: str(value) for name, value in TERMS.items()}
    assert {row["nothing"] for row in found.values()} == {""}


def test_direction(terms: TestClient) -> None:
    """JSON and XML have the direction of a text in the syntax of SPARQL 1.2."""
    query = 'SELECT (STRLANGDIR("abc", "ar", "rtl") AS ?text) WHERE { }'
    (row,) = json.loads(body(terms, query, "json"))["results"]["bindings"]
    assert row["text"]["xml:lang"] == "ar"
    assert row["text"]["its:dir"] == "rtl"
    assert b'its:dir="rtl"' in body(terms, query, "xml")


@pytest.mark.parametrize("name", ["json", "xml", "tsv"])
def test_no_rows(terms: TestClient, name: str) -> None:
    """An empty result has no rows, and the names of the variables."""
    found = Result.parse(io.BytesIO(body(terms, "SELECT ?a ?b WHERE { FILTER(false) }", name)), format=name)
    assert [str(variable) for variable in found.vars or ()] == ["a", "b"]
    assert list(found.bindings) == []


@pytest.mark.parametrize("name", ["json", "xml"])
@pytest.mark.parametrize("query", ["ASK { }", "ASK { FILTER(false) }"])
def test_boolean(terms: TestClient, name: str, query: str) -> None:
    """Booleans are parsed as such."""
    assert Result.parse(io.BytesIO(body(terms, query, name)), format=name).askAnswer == (query == "ASK { }")


@pytest.mark.parametrize("name", ["turtle", "nt", "xml", "json-ld", "trig", "nquads"])
def test_graphs(terms: TestClient, name: str) -> None:
    """A graph has each of its triples in every format."""
    accept = {"nt": "application/n-triples", "xml": "application/rdf+xml", "nquads": "application/n-quads"}
    accept |= {"turtle": "text/turtle", "json-ld": "application/ld+json", "trig": "application/trig"}
    query = f"CONSTRUCT {{ <{X}s> ?p ?value }} WHERE {{ <{X}s> ?p ?value FILTER(!ISBLANK(?value)) }}"
    answer = terms.get("/sparql", params={"query": query}, headers={"accept": accept[name]})
    found = rdflib.Dataset(default_union=True).parse(data=answer.content, format=name)
    values = {str(p).removeprefix(X): o for _, p, o in found.triples((None, None, None))}
    assert values == TERMS
