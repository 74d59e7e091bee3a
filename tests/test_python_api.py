"""Query results in Python programs, a store as an rdflib dataset, and the page that documents both."""

from __future__ import annotations

import contextlib
import io
from textwrap import dedent
from typing import TYPE_CHECKING, Any

import pytest
from pyoxigraph import Literal, NamedNode, Triple
from rdflib import RDF, URIRef, Variable
from rdflib.graph import ModificationException
from repository import ROOT

import kg
from kg.query.result import Boolean, Graph, Solutions

if TYPE_CHECKING:
    from pathlib import Path

INTEGER = NamedNode("http://www.w3.org/2001/XMLSchema#integer")
NODE_TYPE = URIRef("https://w3id.org/rnkg/ns#NodeType")


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the store of the example workspace."""
    folder = tmp_path_factory.mktemp("api") / "store"
    kg.build([ROOT / "examples" / "workspace" / "rover"], store=folder, jobs=1)
    return folder


def solutions(*rows: tuple[Any, ...], variables: tuple[str, ...] = ("node", "count")) -> Solutions:
    """Return a result with these rows."""
    return Solutions(variables, rows, 0.0, "1")


def ask(text: str, store: Path) -> Solutions:
    """Return the result of a SELECT query."""
    answer = kg.sparql(text, store=store)
    assert isinstance(answer, Solutions)
    return answer


def test_rows_have_plain_values_by_name() -> None:
    """IRIs are text, numbers are numbers, and unbound variables are None."""
    first, second = solutions((NamedNode("urn:a"), Literal("3", datatype=INTEGER)), (None, Literal("three")))
    assert (first.node, first.count) == ("urn:a", 3)
    assert tuple(second) == (None, "three")


def test_a_variable_that_python_cannot_name_is_called_by_its_position() -> None:
    """A variable named like a Python keyword is addressed by its position."""
    (row,) = solutions((Literal("a"), Literal("b")), variables=("class", "name"))
    assert (row[0], row.name) == ("a", "b")


def test_solutions_are_counted_and_become_dictionaries() -> None:
    """A result has a length, and is false without rows."""
    answer = solutions((NamedNode("urn:a"), None))
    assert len(answer) == 1
    assert answer.dicts() == [{"node": "urn:a", "count": None}]
    assert not solutions()


def test_a_notebook_shows_a_table_without_markup_of_the_data() -> None:
    """Texts of the data are escaped; only the first hundred rows are shown."""
    html = solutions(*[(Literal("<script>"), None)] * 103)._repr_html_()
    assert "<script>" not in html
    assert html.count("<td>&lt;script&gt;</td>") == 100
    assert "3 more rows" in html


def test_a_prompt_shows_columns_without_control_characters() -> None:
    """Only the first twenty rows are shown; the last line counts all."""
    lines = repr(solutions(*[(NamedNode("urn:a"), Literal("\x1b[2J\nlong"))] * 21)).splitlines()
    assert lines[0].split() == ["node", "count"]
    assert len(lines) == 22
    assert len({line.index("u") for line in lines[1:-1]}) == 1
    assert "\x1b" not in "".join(lines)
    assert lines[-1] == "(21 rows, the first 20 shown)"


def test_a_graph_is_iterated_and_counted() -> None:
    """A CONSTRUCT result yields triples and has a length."""
    triple = Triple(NamedNode("urn:a"), NamedNode("urn:b"), Literal("c"))
    answer = Graph((triple,), 0.0, "1")
    assert (list(answer), len(answer)) == ([triple], 1)
    assert "<td>c</td>" in answer._repr_html_()
    assert repr(answer).splitlines() == ["subject  predicate  object", "urn:a    urn:b      c", "(1 row)"]


@pytest.mark.parametrize("value", [True, False])
def test_the_answer_of_ask_is_a_condition(value: bool) -> None:  # noqa: FBT001 - a parameter of a test
    """The result of ASK works as a condition of `if`."""
    assert bool(Boolean(value, 0.0, "1")) is value


def test_rdflib_reads_the_triples_of_a_store(store: Path) -> None:
    """Patterns, lengths and queries of rdflib agree with those of `kg`."""
    counted = next(iter(ask("SELECT (COUNT(*) AS ?n) { ?s ?p ?o }", store))).n
    types = {row.node for row in ask("SELECT ?node { ?node a rnkg:NodeType }", store)}
    with kg.rdflib_dataset(store) as dataset:
        assert {str(node) for node in dataset.subjects(RDF.type, NODE_TYPE)} == types
        assert len(dataset) == counted
        assert sum(1 for _ in dataset.triples((None, None, None))) == counted
        answer = dataset.query("SELECT ?node { ?node a rnkg:NodeType }")
        assert {str(binding[Variable("node")]) for binding in answer.bindings} == types


def test_a_graph_of_the_dataset_has_its_triples_alone(store: Path) -> None:
    """Named graphs are contexts of rdflib."""
    with kg.rdflib_dataset(store) as dataset:
        name = next(one.identifier for one in dataset.graphs() if isinstance(one.identifier, URIRef) and len(one))
        text = f"SELECT (COUNT(*) AS ?n) {{ GRAPH <{name}> {{ ?s ?p ?o }} }}"
        assert len(dataset.graph(name)) == next(iter(ask(text, store))).n


@pytest.mark.parametrize(
    "text",
    [
        "SELECT ?node ?type { ?node a ?type }",
        "SELECT ?node { ?node a ?type }",
        "SELECT (COUNT(?node) AS ?n) { ?node a ?type }",
        "ASK { ?node a ?type }",
        "CONSTRUCT { ?node a ?type } WHERE { ?node a ?type }",
    ],
)
def test_variables_of_a_query_get_values(store: Path, text: str) -> None:
    """`initBindings` sets variables that a query returns or not, and ignores others, as rdflib does."""
    with kg.rdflib_dataset(store) as dataset:
        given = list(dataset.query(text, initBindings={"type": NODE_TYPE, "other": NODE_TYPE}))
        fixed = text.replace("{ ?node a ?type }", "{ VALUES ?type { rnkg:NodeType } ?node a ?type }")
        fixed = fixed.replace("CONSTRUCT { VALUES ?type { rnkg:NodeType }", "CONSTRUCT {")
        assert sorted(given) == sorted(dataset.query(fixed))
        assert given != list(dataset.query(text, initBindings={"type": URIRef("urn:none")}))


def test_a_dataset_calls_no_server(store: Path) -> None:
    """A query of the dataset with SERVICE is refused, as in `kg.sparql`."""
    with kg.rdflib_dataset(store) as dataset, pytest.raises(kg.KgError, match="KG502"):
        dataset.query("SELECT * { SERVICE <http://127.0.0.1:9/> { ?s ?p ?o } }")


def test_a_dataset_refuses_changes(store: Path) -> None:
    """A snapshot never changes."""
    with kg.rdflib_dataset(store) as dataset:
        with pytest.raises(ModificationException):
            dataset.add((NODE_TYPE, RDF.type, NODE_TYPE))
        with pytest.raises(ModificationException):
            dataset.remove((NODE_TYPE, RDF.type, NODE_TYPE))
        with pytest.raises(ModificationException):
            dataset.update("CLEAR ALL")


def test_the_examples_of_the_page_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The code of docs/python.md runs from top to bottom and prints the nodes of the example workspace twice."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    lines = (ROOT / "docs" / "python.md").read_text(encoding="utf-8").splitlines()
    code = dedent("\n".join(line for line in lines if line.startswith("    ") or not line.strip()))
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(code, {})  # noqa: S102 - the page's own code
    assert printed.getvalue().count("/rover_robot/base_controller\n") == 2
    assert "[{'package': 'rover_robot'}]" in printed.getvalue()
