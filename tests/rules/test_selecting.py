from __future__ import annotations

import tempfile
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import Literal, NamedNode

from kg.rules import selecting
from kg.rules.files import RuleSet
from kg.rules.questions import question
from kg.rules.recording import Names
from kg.rules.running import Runner
from kg.rules.selecting import Columns, columns_of
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.store.snapshot import EmbeddedSnapshot

NAMES: Final = Names.of("http://example.org/", "http://example.org/ns#")
GRAPHS: Final = [NamedNode(f"http://example.org/graph/{name}") for name in ("a", "b", "launch/c")]
PREFIXES: Final = {"": "urn:"}
OBJECTS: Final = [
    "<urn:a>",
    "<urn:b>",
    "<urn:c>",
    '"text"',
    '"a \\"quoted\\" one"',
    '"so"@en',
    '"7"^^<urn:kind>',
    "_:b",
]
QUERIES: Final = [
    "SELECT ?s ?o { ?s :p ?o }",
    "SELECT DISTINCT ?o { ?s :p ?o }",
    "SELECT ?o WHERE { ?s ?p ?o . ?s :q ?other }",
    "SELECT ?s ?o ?more { ?s :p ?o OPTIONAL { ?s :q ?more } }",
    "SELECT ?s ?more { VALUES ?s { :a :b } OPTIONAL { ?s :p/:q ?more } }",
    "SELECT ?s ?o { { SELECT * WHERE { ?s :p ?o } LIMIT 1000000000 } MINUS { ?s :q :a } }",
    "SELECT ?s ?kind ?o { { ?s :p ?o BIND(:p AS ?kind) } UNION { ?s :q ?o BIND(:q AS ?kind) } }",
    "SELECT DISTINCT ?x ?y { ?s :p|:q ?x . BIND(?s AS ?y) FILTER(ISIRI(?x)) }",
    """SELECT DISTINCT ?s ?o {
      { SELECT ?graph { GRAPH ?graph {} FILTER(!CONTAINS(STR(?graph), '/launch/')) } }
      GRAPH ?graph { ?s :p ?o }
      ?o :q ?any
    }""",
    "SELECT ?s { GRAPH ?g { ?s :p ?o } }",
    "SELECT ?g ?s { GRAPH ?g { ?s :p ?o } }",
    "SELECT ?s { GRAPH ?g { ?s :p ?o . ?o :q ?s } }",
    "SELECT ?s { GRAPH ?g { ?s :p/:q ?o } }",
    "SELECT ?s { GRAPH ?g { ?s :p ?o } GRAPH ?g { ?o :q ?other } }",
    "SELECT DISTINCT ?s ?o { GRAPH ?g { ?s :p|^:q ?o } FILTER(CONTAINS(STR(?g), '/a')) }",
    "SELECT ?s { { GRAPH ?g { ?s :p ?o } FILTER(STRENDS(STR(?g), '/b')) } UNION { GRAPH ?g { ?s :q ?o } } }",
    "SELECT ?s { { GRAPH ?g { ?s :p ?o } } UNION { GRAPH ?g { ?s :q ?o } } FILTER(STRENDS(STR(?g), '/b')) }",
    "SELECT ?s ?o { { SELECT ?s { GRAPH ?g { ?s :p ?x } } } { SELECT ?o { GRAPH ?g { ?o :q ?x } } } }",
    "SELECT ?s (COUNT(*) AS ?n) { ?s :p ?o } GROUP BY ?s",
    "SELECT (COUNT(*) AS ?n) { ?s :p ?o }",
    "SELECT (COUNT(*) AS ?n) { ?s :p ?o } VALUES ?o { :a :b }",
    "SELECT DISTINCT ?s { ?s :p ?o } VALUES ?o { :a :b }",
    "SELECT ?s (COUNT(?more) AS ?n) { ?s :p ?o OPTIONAL { ?s :q ?more } } GROUP BY ?s",
    "SELECT ?p (COUNT(DISTINCT ?o) AS ?n) { GRAPH ?g { ?s ?p ?o } ?s :p ?any } GROUP BY ?p ?s",
    "SELECT ?s (COUNT(DISTINCT ?o) AS ?n) (COUNT(*) AS ?all) { ?s :p ?o } GROUP BY ?s",
    "SELECT ?s ?o { ?s :p ?o } ORDER BY ?s ?o LIMIT 2",
    "SELECT DISTINCT ?s { ?s :p ?o } ORDER BY DESC(?s) LIMIT 2",
    "SELECT ?o (COUNT(DISTINCT ?s) AS ?n) { ?s :p ?o } GROUP BY ?o ORDER BY DESC(?n) ?o LIMIT 3",
    "SELECT ?s ?n { ?s ?p ?o VALUES ?n { 10 9 'x' } } ORDER BY ?n ?s LIMIT 4",
    "SELECT ?s ?n { VALUES (?s ?n) { (:a 10) (:b 9) (:c UNDEF) } } ORDER BY ?n LIMIT 2",
]
ORDERED: Final = [
    "SELECT DISTINCT ?s ?o { ?s ?p ?o } ORDER BY ?s DESC(?o)",
    "SELECT ?s (COUNT(DISTINCT ?o) AS ?n) { ?s ?p ?o } GROUP BY ?s ORDER BY ?n DESC(?s)",
    "SELECT DISTINCT ?s { VALUES ?s { :n9 :n :n98 :n9-1 <urn:n9/1> <urn:n9#1> } } ORDER BY DESC(?s)",
    "SELECT DISTINCT ?text { VALUES ?text { 'b' 'a\\tb' 'a b' 'ä' '' } } ORDER BY ?text",
    "SELECT DISTINCT ?n ?s { ?s :p ?o VALUES ?n { 10 9 UNDEF } } ORDER BY DESC(?n) ?s",
]
quads = st.dictionaries(
    st.tuples(st.sampled_from("abc"), st.sampled_from("pq"), st.sampled_from(OBJECTS)), st.integers(0, 2), max_size=12
)


def contents_of(placed: dict[tuple[str, str, str], int]) -> list[list[bytes]]:
    """Return the content of each graph; each triple is in one, because the store repeats those of several."""
    contents: list[list[bytes]] = [[] for _ in GRAPHS]
    for (s, p, o), graph in placed.items():
        contents[graph].append(f"<urn:{s}> <urn:{p}> {o} .\n".encode())
    return contents


def with_columns(folder: Path, contents: Sequence[list[bytes]]) -> EmbeddedStore:
    """Return a store of some graphs, with saved columns."""
    store = EmbeddedStore.create(folder / ".kg")
    with store.write("test") as transaction:
        transaction.replace_graphs(dict(zip(GRAPHS, contents, strict=False)))
    Runner(NAMES, store.layout.cache).run(store, RuleSet(()))
    return store


def rows(found: Iterable[Any]) -> Counter[tuple[str | None, ...]]:
    """Return the values of rows with their multiplicity."""
    return Counter(tuple(None if term is None else term.value for term in row) for row in found)


def same(snapshot: EmbeddedSnapshot, columns: Columns | EmbeddedSnapshot, text: str) -> bool:
    """Whether columns and the store give the same result."""
    return rows(columns.query(text, prefixes=PREFIXES)) == rows(snapshot.query(text, prefixes=PREFIXES))  # type: ignore[arg-type]  # a SELECT


@settings(max_examples=25, deadline=None)
@given(quads)
def test_columns_answer_as_the_store_does(placed: dict[tuple[str, str, str], int]) -> None:
    """Each row has the same multiplicity as in the store, whether rules can express the query or not."""
    with tempfile.TemporaryDirectory() as folder, with_columns(Path(folder), contents_of(placed)).read() as snapshot:
        columns = columns_of(snapshot)
        assert isinstance(columns, Columns)
        assert [text for text in QUERIES if not same(snapshot, columns, text)] == []
        assert columns.count() == snapshot.count()


@settings(max_examples=10, deadline=None)
@given(quads)
def test_the_order_is_that_of_the_store(placed: dict[tuple[str, str, str], int]) -> None:
    """Ordered rows are in the order of the store."""
    with tempfile.TemporaryDirectory() as folder, with_columns(Path(folder), contents_of(placed)).read() as snapshot:
        columns = columns_of(snapshot)
        for text in ORDERED:
            found = [list(rows([row])) for row in columns.query(text, prefixes=PREFIXES)]  # type: ignore[union-attr]  # a SELECT
            expected = [list(rows([row])) for row in snapshot.query(text, prefixes=PREFIXES)]  # type: ignore[union-attr]  # a SELECT
            assert found == expected, text


@pytest.mark.parametrize(
    "text",
    [
        "SELECT ?s { GRAPH ?g { ?s :p ?o } }",
        "SELECT ?s (COUNT(*) AS ?n) { GRAPH ?g { ?s :p ?o } } GROUP BY ?s",
        "SELECT ?s { GRAPH ?g { ?s :p ?o } FILTER(!STRENDS(STR(?g), '/a')) }",
    ],
)
def test_a_triple_of_several_graphs_is_found_in_each(tmp_path: Path, text: str) -> None:
    """A pattern in any graph has one solution for each graph with the triple."""
    line = b"<urn:a> <urn:p> <urn:b> .\n"
    with with_columns(tmp_path, [[line], [line], [line]]).read() as snapshot:
        columns = columns_of(snapshot)
        assert isinstance(columns, Columns)
        assert same(snapshot, columns, text)


def test_whole_answers_are_those_of_the_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Terms are complete, and a triple of several graphs is one; uncertain cases are left to the store."""
    monkeypatch.setattr(selecting, "_MANY", 1)
    line = b'<urn:a> <urn:p> "so"@en .\n'
    store = with_columns(tmp_path, [[line], [line, b"<urn:a> <urn:p> <urn:b> .\n"]])
    with store.read() as snapshot:
        columns = columns_of(snapshot)
        assert isinstance(columns, Columns)
        text = "SELECT DISTINCT ?s ?o { ?s :p ?o }"
        names, found = columns.answer(text, prefixes=PREFIXES) or ((), [])
        assert names == ("s", "o")
        assert set(found) == {tuple(row) for row in snapshot.query(text, prefixes=PREFIXES)}  # type: ignore[union-attr]  # a SELECT
        counted = "SELECT ?s (COUNT(DISTINCT ?o) AS ?n) { ?s :p ?o } GROUP BY ?s"
        assert columns.answer(counted, prefixes=PREFIXES) == (("s", "n"), [(NamedNode("urn:a"), Literal(2))])
        for inexact in ("SELECT ?s ?o { ?s :p ?o }", "SELECT ?s (COUNT(*) AS ?n) { ?s :p ?o } GROUP BY ?s"):
            assert columns.answer(inexact, prefixes=PREFIXES) is None
        for selective in ("SELECT DISTINCT ?s { ?s :p :c }", "SELECT DISTINCT ?o { :b :p ?o }"):
            assert columns.answer(selective, prefixes=PREFIXES) is None


def test_a_question_with_several_lists_of_classes_is_one_rule() -> None:
    """One for each choice from the lists would read the store as often."""
    classes = " ".join(f":c{number}" for number in range(12))
    lists = f"{{ VALUES ?one {{ {classes} }} ?s a ?one }} {{ VALUES ?other {{ {classes} }} ?o a ?other }}"
    asked = question(f"SELECT ?s ?o {{ ?s :p ?o {lists} }}", {"": "urn:"})
    assert asked is not None
    assert len(asked.rules) == 1


def test_later_patches_are_followed(tmp_path: Path) -> None:
    """Columns of an earlier generation give the result of the current store."""
    store = with_columns(tmp_path, [[b"<urn:a> <urn:p> <urn:b> .\n"]])
    with store.write("test") as transaction:
        transaction.patch_graph(GRAPHS[0], b"<urn:a> <urn:p> <urn:b> .\n", b"<urn:c> <urn:p> <urn:new> .\n")
        transaction.patch_graph(GRAPHS[1], b"", b"<urn:d> <urn:p> <urn:b> .\n")
    with store.read() as snapshot:
        found = rows(columns_of(snapshot).query(QUERIES[0], prefixes=PREFIXES))  # type: ignore[arg-type]  # a SELECT
        assert found == {("urn:c", "urn:new"): 1, ("urn:d", "urn:b"): 1}


@pytest.mark.parametrize("kept", [True, False])
def test_the_store_answers_what_columns_do_not_know(tmp_path: Path, *, kept: bool) -> None:
    """A graph without recorded content, or a store without columns, is queried directly."""
    store = with_columns(tmp_path, [[b"<urn:a> <urn:p> <urn:b> .\n"]])
    if kept:
        with store.write("test") as transaction:
            transaction.replace_graphs({GRAPHS[0]: [b"<urn:c> <urn:p> <urn:b> .\n"]})
    else:
        for path in (store.layout.cache / "columns").iterdir():
            path.unlink()
    with store.read() as snapshot:
        assert columns_of(snapshot) is snapshot
