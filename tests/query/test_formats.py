"""Tests of serializing results, read back with other programs if possible."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, Any, cast
from xml.dom import minidom

import pyoxigraph
import pytest
import rdflib
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Quad, QueryResultsFormat, RdfFormat, Triple, parse
from rdflib.query import Result as RdflibResult

from kg.cli.commands.query import format_for
from kg.errors import QueryError
from kg.query.core import run
from kg.query.formats import BOOLEAN_FORMATS, GRAPH_FORMATS, SOLUTION_FORMATS, write, write_rows
from kg.query.result import Boolean, Graph, Solutions
from kg.query.writing.parquet import write_quads
from kg.query.writing.values import plain

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.store.snapshot import EmbeddedSnapshot

XML_TEXT = st.text(
    st.characters(codec="utf-8", exclude_characters="\ufffe\uffff", exclude_categories=("Cs", "Cc"))
    | st.sampled_from("\t\n\r\"',<>&|\\\x7f\x85\u2028")
)
XSD = "http://www.w3.org/2001/XMLSchema#"
LITERALS = st.one_of(
    st.builds(Literal, XML_TEXT),
    st.builds(lambda text: Literal(text, language="de-AT"), XML_TEXT),
    st.builds(lambda text: Literal(text, datatype=NamedNode("https://example.org/type")), XML_TEXT),
    st.builds(Literal, st.integers()),
    st.builds(Literal, st.booleans()),
    st.builds(lambda number: Literal(str(number), datatype=NamedNode(XSD + "double")), st.floats()),
)
IRIS = st.sampled_from([NamedNode("https://example.org/\u00e9#a"), NamedNode("https://example.org/p?a=1&b='2'")])
TERMS = st.one_of(st.none(), LITERALS, IRIS, st.just(BlankNode("b1")))
DIRECTED = Literal("\u0633\u0644\u0627\u0645", language="ar", direction=BaseDirection.RTL)
TRIPLE = Triple(NamedNode("https://example.org/a"), NamedNode("https://example.org/p"), DIRECTED)
TABLES = st.lists(st.tuples(TERMS, TERMS), max_size=4).map(lambda rows: Solutions(("x", "y"), tuple(rows), 0.0, "1"))


@settings(deadline=None)
@given(TABLES)
@pytest.mark.parametrize("name", ["JSON", "TSV"])
def test_rows_read_back_by_the_engine(name: str, table: Solutions) -> None:
    """JSON and TSV read back as the same terms; the engine trims the texts of XML."""
    parsed = pyoxigraph.parse_query_results(write(table, name.lower()), getattr(QueryResultsFormat, name))
    assert isinstance(parsed, pyoxigraph.QuerySolutions)
    assert [variable.value for variable in parsed.variables] == ["x", "y"]
    assert tuple(tuple(row) for row in parsed) == table.rows


@settings(deadline=None)
@given(TABLES)
@pytest.mark.parametrize("name", ["json", "xml"])
def test_rows_read_back_by_rdflib(name: str, table: Solutions) -> None:
    """A second library, which drops rows without bindings, reads the same values."""
    parsed = RdflibResult.parse(io.BytesIO(write(table, name)), format=name)
    found = [
        tuple(None if term is None else str(term) for term in row)
        for row in cast("Iterable[tuple[object, ...]]", parsed)
    ]
    assert found == [tuple(getattr(term, "value", None) for term in row) for row in table.rows if any(row)]


@settings(deadline=None)
@given(TABLES)
@pytest.mark.parametrize("name", ["json", "xml"])
def test_kinds_of_terms_read_back_by_rdflib(name: str, table: Solutions) -> None:
    """C5: a second library finds the same languages, datatypes, IRIs and blank nodes."""
    parsed = RdflibResult.parse(io.BytesIO(write(table, name)), format=name)
    found = [
        tuple(None if term is None else told(term) for term in row)
        for row in cast("Iterable[tuple[object, ...]]", parsed)
    ]
    assert found == [tuple(map(kind, row)) for row in table.rows if any(row)]


def told(term: object) -> tuple[str, str | None, str | None]:
    """Return the value, language and datatype of an rdflib term."""
    if isinstance(term, rdflib.Literal):
        return "literal", term.language, None if term.datatype is None else str(term.datatype)
    return ("iri" if isinstance(term, rdflib.URIRef) else "blank"), None, None


def kind(term: object) -> tuple[str, str | None, str | None] | None:
    """Return the value, language and datatype of a term, as `told`."""
    if isinstance(term, Literal):
        datatype = None if term.language or term.datatype.value == XSD + "string" else term.datatype.value
        return "literal", term.language and term.language.lower(), datatype
    return None if term is None else ("iri" if isinstance(term, NamedNode) else "blank", None, None)


def test_what_rdf_12_adds() -> None:
    """C5: base directions and triple terms are written as in SPARQL 1.2, in every format that supports them."""
    table = Solutions(("t", "d", "u"), ((TRIPLE, DIRECTED, None),), 0.0, "1")
    for name in ("JSON", "TSV"):
        parsed = pyoxigraph.parse_query_results(write(table, name.lower()), getattr(QueryResultsFormat, name))
        assert isinstance(parsed, pyoxigraph.QuerySolutions)
        assert tuple(tuple(row) for row in parsed) == table.rows
    document = minidom.parseString(write(table, "xml"))  # noqa: S318 - written two lines above
    literals = document.getElementsByTagName("literal")
    assert [literal.getAttributeNS("http://www.w3.org/2005/11/its", "dir") for literal in literals] == ["rtl", "rtl"]
    lines = list(csv.reader(io.StringIO(write(table, "csv").decode(), newline="")))
    assert lines[1] == [f"<<( {TRIPLE} )>>", DIRECTED.value, ""]
    triples = Graph((TRIPLE, Triple(TRIPLE.subject, TRIPLE.predicate, TRIPLE)), 0.0, "1")
    for name in ("turtle", "ntriples", "nquads", "trig", "rdfxml"):
        quads = pyoxigraph.parse(write(triples, name), GRAPH_FORMATS[name])
        assert {quad.triple for quad in quads} == set(triples.triples), name
    with pytest.raises(QueryError, match="KG504"):
        write(triples, "jsonld")


@settings(deadline=None)
@given(st.lists(LITERALS, max_size=4))
@pytest.mark.parametrize("name", GRAPH_FORMATS)
def test_literals_of_graphs_read_back(name: str, literals: list[Literal]) -> None:
    """C5: whatever a literal contains, the graph reads back as the same triples."""
    triples = tuple(Triple(TRIPLE.subject, TRIPLE.predicate, literal) for literal in dict.fromkeys(literals))
    quads = pyoxigraph.parse(write(Graph(triples, 0.0, "1"), name), GRAPH_FORMATS[name])
    assert {quad.triple for quad in quads} == set(triples)


@pytest.mark.parametrize("sign", ["\x00", "\x01", "\x0b", "\x1f", "\ufffe", "\uffff"])
def test_what_xml_cannot_hold_is_refused(sign: str) -> None:
    """C7: a character that XML cannot represent is KG504 with that character, not an unreadable document."""
    literal = Literal(f"a{sign}b")
    with pytest.raises(QueryError, match=f"KG504.*U\\+{ord(sign):04X}"):
        write(Solutions(("x",), ((literal,),), 0.0, "1"), "xml")
    with pytest.raises(QueryError, match="KG504"):
        write(Graph((Triple(TRIPLE.subject, TRIPLE.predicate, literal),), 0.0, "1"), "rdfxml")
    for name in ("json", "tsv", "csv"):
        assert write(Solutions(("x",), ((literal,),), 0.0, "1"), name)


@pytest.mark.parametrize("predicate", ["https://example.org/", "https://example.org/1", "https://example.org/p?x=2"])
def test_predicates_that_are_no_names(predicate: str) -> None:
    """C7: a predicate without a local name in XML is KG504 in RDF/XML, and valid in Turtle."""
    graph = Graph((Triple(TRIPLE.subject, NamedNode(predicate), Literal("x")),), 0.0, "1")
    with pytest.raises(QueryError, match="KG504"):
        write(graph, "rdfxml")
    assert predicate in write(graph, "turtle").decode()


def test_numbers_that_json_does_not_have() -> None:
    """Infinity, digits of other scripts and malformed numbers remain texts."""
    for value, datatype in [
        ("INF", "double"),
        ("1e999", "double"),
        ("NaN", "float"),
        ("\u0661", "integer"),
        ("x", "int"),
    ]:
        assert plain(Literal(value, datatype=NamedNode(XSD + datatype))) == value
    assert plain(Literal("9" * 40, datatype=NamedNode(XSD + "integer"))) == int("9" * 40)


@pytest.mark.parametrize("count", [0, 1, 63, 64, 65, 200])
@pytest.mark.parametrize("name", SOLUTION_FORMATS)
def test_rows_are_written_while_they_are_found(name: str, count: int) -> None:
    """Streamed and whole serializations are equal, with few rows or none; nothing waits for the last row."""
    rows = tuple((Literal(number), None) for number in range(count))
    parts: list[bytes] = []
    seen: list[int] = []

    def found() -> Iterator[Any]:
        for row in rows:
            seen.append(len(parts))
            yield row

    write_rows(name, ("x", "y"), found(), parts.append)
    assert b"".join(parts) == write(Solutions(("x", "y"), rows, 0.0, "1"), name)
    assert count < 200 or seen[-1] >= 4


@settings(deadline=None)
@given(TABLES)
def test_csv_reads_back(table: Solutions) -> None:
    """CSV contains the bare values, quoted if necessary."""
    lines = list(csv.reader(io.StringIO(write(table, "csv").decode(), newline="")))
    expected = [["x", "y"]]
    for row in table.rows:
        bare = [f"_:{term.value}" if isinstance(term, BlankNode) else getattr(term, "value", "") for term in row]
        expected.append(bare)
    assert lines == expected


def test_jsonl_has_plain_values(snapshot: EmbeddedSnapshot) -> None:
    """Numbers and booleans are plain, other terms are text, unbound is null."""
    text = "SELECT ?s ?n ?f ?u { ?s <https://example.org/size> ?n ; <https://example.org/flag> ?f }"
    line = json.loads(write(run(snapshot, text), "jsonl"))
    assert line == {"s": "https://example.org/a", "n": 3, "f": True, "u": None}


def test_markdown_escapes_bars(snapshot: EmbeddedSnapshot) -> None:
    """A bar in a value does not end its cell."""
    written = write(run(snapshot, "SELECT ?n { <https://example.org/b> rnkg:name ?n }"), "markdown")
    assert written.decode() == "| n |\n| --- |\n| b\\|c |\n"


@pytest.mark.parametrize("name", GRAPH_FORMATS)
def test_graphs_read_back_by_rdflib(snapshot: EmbeddedSnapshot, name: str) -> None:
    """A second library reads the same graph from each format."""
    result = run(snapshot, "CONSTRUCT { ?s ?p ?o } { ?s ?p ?o FILTER(!isBlank(?o)) }")
    names = {"ntriples": "nt", "rdfxml": "xml", "jsonld": "json-ld"}
    graph = rdflib.Dataset(default_union=True)
    graph.parse(data=write(result, name), format=names.get(name, name))
    assert len(graph) == 5


@pytest.mark.parametrize("name", BOOLEAN_FORMATS)
def test_yes_or_no(name: str) -> None:
    """Each format can represent a boolean."""
    assert "true" in write(Boolean(value=True, seconds=0.0, snapshot="1"), name).decode()


@pytest.mark.parametrize(
    ("text", "name", "named"),
    [
        ("SELECT * {?s ?p ?o}", "turtle", SOLUTION_FORMATS),
        ("CONSTRUCT WHERE {?s ?p ?o}", "csv", GRAPH_FORMATS),
        ("ASK {}", "ntriples", BOOLEAN_FORMATS),
    ],
)
def test_wrong_format_names_the_right_ones(
    snapshot: EmbeddedSnapshot, text: str, name: str, named: dict[str, object]
) -> None:
    """A format that cannot represent the result is KG504, with those that can."""
    with pytest.raises(QueryError) as caught:
        write(run(snapshot, text), name)
    assert caught.value.code == "KG504"
    assert all(known in (caught.value.hint or "") for known in named)


def test_formats_are_the_engines() -> None:
    """Names of graph formats map to formats of the same media types."""
    assert GRAPH_FORMATS["turtle"] == RdfFormat.TURTLE


def test_parquet_has_columns_of_types() -> None:
    """Columns of numbers and booleans have these types, any other is text; unbound is null."""
    parquet = pytest.importorskip("pyarrow.parquet")
    iri, huge = NamedNode("https://example.org/a"), Literal(1 << 70)
    rows = (
        (iri, Literal(1), Literal(1), Literal(True), Literal("é", language="fr"), huge, None),
        (None, Literal(2), Literal(0.5), None, Literal(7), Literal(1), None),
    )
    answer = Solutions(("i", "n", "x", "b", "m", "h", "u"), rows, 0.0, "1", None)
    found = parquet.read_table(io.BytesIO(write(answer, "parquet")))
    assert [str(field.type) for field in found.schema] == [
        "string", "int64", "double", "bool", "string", "string", "string",
    ]  # fmt: skip
    first, second = found.to_pylist()
    assert list(first.values()) == [iri.value, 1, 1.0, True, "é", str(1 << 70), None]
    assert list(second.values()) == [None, 2, 0.5, None, "7", "1", None]
    assert parquet.read_table(io.BytesIO(write(Solutions((), (), 0.0, "1", None), "parquet"))).num_rows == 0


def test_parquet_of_quads_is_complete() -> None:
    """Each row has the terms of a quad in the syntax of N-Triples; the default graph is null."""
    parquet = pytest.importorskip("pyarrow.parquet")
    text = (
        '<https://e.org/a> <https://e.org/p> "x\\n\\"é"@fr <https://e.org/g> .\n'
        '<https://e.org/a> <https://e.org/p> <<( _:b <https://e.org/p> "1"^^<https://e.org/t> )>> _:g .\n'
        "_:b <https://e.org/p> _:b .\n"
    )
    output = io.BytesIO()
    assert write_quads(parse(text, RdfFormat.N_QUADS), output) == 3
    rows = parquet.read_table(output).to_pylist()
    assert [*rows[0]] == ["subject", "predicate", "object", "graph"]
    assert "".join(" ".join(filter(None, row.values())) + " .\n" for row in rows) == text
    assert write_quads((), output) == 0


def test_parquet_of_quads_needs_little_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """Quads are written in batches, as they arrive."""
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("kg.query.writing.parquet._BATCH", 2)
    node, output = NamedNode("https://e.org/a"), io.BytesIO()
    assert write_quads((Quad(node, node, Literal(number)) for number in range(5)), output) == 5
    assert parquet.ParquetFile(output).num_row_groups == 3


def test_parquet_says_what_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without pyarrow the error contains the way out."""
    monkeypatch.setattr("kg.query.writing.parquet.is_installed", lambda: False)
    with pytest.raises(QueryError, match="pyarrow") as raised:
        write(Solutions(("x",), (), 0.0, "1", None), "parquet")
    assert "kg-ros[parquet]" in str(raised.value.hint)


@pytest.mark.parametrize(
    ("name", "meant"), [("ttl", "turtle"), ("nt", "ntriples"), ("n3", "turtle"), ("md", "markdown")]
)
def test_short_names_of_formats_are_known(name: str, meant: str) -> None:
    """`kg query --format` accepts the names of files that `kg export` writes."""
    assert format_for(name) == meant
