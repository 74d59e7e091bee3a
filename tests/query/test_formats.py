"""Tests of writing answers, read back with other programs where there are any."""

from __future__ import annotations

import csv
import io
import json
from typing import TYPE_CHECKING, cast

import pyoxigraph
import pytest
import rdflib
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import BlankNode, Literal, NamedNode, QueryResultsFormat, RdfFormat
from rdflib.query import Result as RdflibResult

from kg.errors import QueryError
from kg.query.core import run
from kg.query.formats import BOOLEAN_FORMATS, GRAPH_FORMATS, SOLUTION_FORMATS, write
from kg.query.result import Boolean, Solutions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.store.snapshot import EmbeddedSnapshot

XML_TEXT = st.text(
    st.characters(codec="utf-8", exclude_characters="\ufffe\uffff", exclude_categories=("Cs", "Cc"))
    | st.sampled_from("\t\n\r\"',<>&|\\")
)
TERMS = st.one_of(
    st.none(),
    st.builds(Literal, XML_TEXT),
    st.builds(lambda text: Literal(text, language="de"), XML_TEXT),
    st.builds(Literal, st.integers()),
    st.builds(Literal, st.booleans()),
    st.sampled_from([NamedNode("https://example.org/\u00e9#a"), BlankNode("b1")]),
)
TABLES = st.lists(st.tuples(TERMS, TERMS), max_size=4).map(lambda rows: Solutions(("x", "y"), tuple(rows), 0.0, "1"))


@settings(deadline=None)
@given(TABLES)
@pytest.mark.parametrize("name", ["JSON", "TSV"])
def test_rows_read_back_by_the_engine(name: str, table: Solutions) -> None:
    """What is written as JSON or TSV reads back as the same terms; the engine trims the texts of XML."""
    parsed = pyoxigraph.parse_query_results(write(table, name.lower()), getattr(QueryResultsFormat, name))
    assert isinstance(parsed, pyoxigraph.QuerySolutions)
    assert [variable.value for variable in parsed.variables] == ["x", "y"]
    assert tuple(tuple(row) for row in parsed) == table.rows


@settings(deadline=None)
@given(TABLES)
@pytest.mark.parametrize("name", ["json", "xml"])
def test_rows_read_back_by_rdflib(name: str, table: Solutions) -> None:
    """A second library, which leaves rows without any binding out, reads the same values."""
    parsed = RdflibResult.parse(io.BytesIO(write(table, name)), format=name)
    found = [
        tuple(None if term is None else str(term) for term in row)
        for row in cast("Iterable[tuple[object, ...]]", parsed)
    ]
    assert found == [tuple(getattr(term, "value", None) for term in row) for row in table.rows if any(row)]


@settings(deadline=None)
@given(TABLES)
def test_csv_reads_back(table: Solutions) -> None:
    """CSV holds the bare values, quoted where they need it."""
    lines = list(csv.reader(io.StringIO(write(table, "csv").decode(), newline="")))
    expected = [["x", "y"]]
    for row in table.rows:
        bare = [f"_:{term.value}" if isinstance(term, BlankNode) else getattr(term, "value", "") for term in row]
        expected.append(bare)
    assert lines == expected


def test_jsonl_has_plain_values(snapshot: EmbeddedSnapshot) -> None:
    """Numbers and booleans are such, other terms are text, unbound is null."""
    text = "SELECT ?s ?n ?f ?u { ?s <https://example.org/size> ?n ; <https://example.org/flag> ?f }"
    line = json.loads(write(run(snapshot, text), "jsonl"))
    assert line == {"s": "https://example.org/a", "n": 3, "f": True, "u": None}


def test_markdown_escapes_bars(snapshot: EmbeddedSnapshot) -> None:
    """A bar in a value does not end its cell."""
    written = write(run(snapshot, "SELECT ?n { <https://example.org/b> rnkg:name ?n }"), "markdown")
    assert written.decode() == "| n |\n| --- |\n| b\\|c |\n"


@pytest.mark.parametrize("name", GRAPH_FORMATS)
def test_graphs_read_back_by_rdflib(snapshot: EmbeddedSnapshot, name: str) -> None:
    """A graph in each format is the same graph for a second library."""
    result = run(snapshot, "CONSTRUCT { ?s ?p ?o } { ?s ?p ?o FILTER(!isBlank(?o)) }")
    names = {"ntriples": "nt", "rdfxml": "xml", "jsonld": "json-ld"}
    graph = rdflib.Dataset(default_union=True)
    graph.parse(data=write(result, name), format=names.get(name, name))
    assert len(graph) == 5


@pytest.mark.parametrize("name", BOOLEAN_FORMATS)
def test_yes_or_no(name: str) -> None:
    """Each format says true."""
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
    """A format that cannot hold the answer is KG504, with those that can."""
    with pytest.raises(QueryError) as caught:
        write(run(snapshot, text), name)
    assert caught.value.code == "KG504"
    assert all(known in caught.value.message for known in named)


def test_formats_are_the_engines() -> None:
    """Names of graph formats stand for the formats of the same media types."""
    assert GRAPH_FORMATS["turtle"] == RdfFormat.TURTLE
