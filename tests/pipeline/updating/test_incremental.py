"""Property tests: updates have the effect of the engine's own, and inferences are those of a full run."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyoxigraph
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from patience import examples
from pipeline.updating.changing import PREFIX, bench
from pyoxigraph import CanonicalizationAlgorithm, Dataset, Store

from kg.pipeline.inferring import run_on_store
from kg.pipeline.updating.checking import parsed
from kg.pipeline.updating.executing import Executor
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hypothesis.strategies import SearchStrategy

    from kg.store.transaction import EmbeddedTransaction

NAMES = st.sampled_from([":a", ":b", ":c", ":d"])
GRAPHS = st.sampled_from([":g", ":h"])
VALUES = st.one_of(NAMES, st.sampled_from(["1", "-1.5", '"x"@en', "true", '"a{b"', "<<( :a :next :b )>>"]))
PREDICATES = st.sampled_from([":next", ":p"])


def triples(value: SearchStrategy[str] = VALUES) -> SearchStrategy[str]:
    """Return a few triples of data."""
    one = st.tuples(NAMES, PREDICATES, value).map(" ".join)
    return st.lists(one, min_size=1, max_size=3).map(lambda found: " . ".join(found) + " .")


def quads(value: SearchStrategy[str] = VALUES) -> SearchStrategy[str]:
    """Return data of the default graph and of named ones."""
    named = st.tuples(GRAPHS, triples(value)).map(lambda pair: f"GRAPH {pair[0]} {{ {pair[1]} }}")
    return st.lists(st.one_of(triples(value), named), min_size=1, max_size=3).map(" ".join)


PATTERNS = st.sampled_from(
    [
        "?x :next ?y",
        "GRAPH ?g { ?x :next ?y }",
        "{ ?x :next ?y } UNION { GRAPH ?g { ?x :p ?y } }",
        "?x :next+ ?y OPTIONAL { GRAPH ?g { ?y :p ?v } }",
        "GRAPH :g { ?x ?p ?y } # a } comment\n FILTER(ISIRI(?x) && ?x != :b)",
        "{ SELECT ?x ?y { GRAPH ?g { ?x ?p ?y } } LIMIT 100 }",
        "?x :next ?y MINUS { ?y :next ?x }",
    ]
)
TEMPLATES = st.sampled_from(
    [
        "?x :p ?y",
        "GRAPH :h { ?y :next ?x }",
        "GRAPH ?g { ?x :q :new }",
        "?x ?p ?y . ?y :p '}'",
        ":a :b :c . GRAPH :g {}",
    ]
)
FRESH = st.sampled_from(["?x :p [ :in ?y ]", "_:n :p ?x . GRAPH :g { _:n :of (?x ?y) }", "[] :p ?v"])


@st.composite
def modifies(draw: st.DrawFn) -> str:
    """Return an operation with WHERE."""
    delete = f"DELETE {{ {draw(TEMPLATES)} }}" if draw(st.booleans()) else ""
    insert = f"INSERT {{ {draw(st.one_of(TEMPLATES, FRESH))} }}" if draw(st.booleans()) or not delete else ""
    head = f"WITH {draw(GRAPHS)}" if draw(st.booleans()) else ""
    using = draw(st.sampled_from(["", "", f"USING {draw(GRAPHS)}", "USING :g USING NAMED :h", "USING NAMED :g"]))
    return f"{head} {delete} {insert} {using} WHERE {{ {draw(PATTERNS)} }}"


REFERENCES = st.one_of(st.just("DEFAULT"), GRAPHS, GRAPHS.map(lambda name: f"GRAPH {name}"))
MANAGING = st.one_of(
    st.tuples(
        st.sampled_from(["CLEAR SILENT", "DROP SILENT"]), st.sampled_from(["GRAPH :g", "DEFAULT", "NAMED", "ALL"])
    ),
    st.tuples(st.sampled_from(["CREATE SILENT GRAPH"]), GRAPHS),
    st.tuples(st.sampled_from(["ADD SILENT", "COPY SILENT", "MOVE SILENT"]), REFERENCES, st.just("TO"), REFERENCES),
).map(" ".join)
OPERATIONS = st.one_of(
    quads().map(lambda text: f"INSERT DATA {{ {text} }}"),
    quads().map(lambda text: f"DELETE DATA {{ {text} }}"),
    st.sampled_from(["DELETE WHERE { ?s :next ?o . GRAPH ?g { ?o ?p ?s } }", "DELETE WHERE { GRAPH :g { :a ?p ?o } }"]),
    modifies(),
    MANAGING,
)


def canonical(quads: list[pyoxigraph.Quad]) -> Dataset:
    """Return quads in a form that is equal except for the labels of blank nodes."""
    found = Dataset(quads)
    found.canonicalize(CanonicalizationAlgorithm.UNSTABLE)
    return found


@pytest.fixture(scope="module")
def scratch() -> Iterator[EmbeddedStore]:
    """A store for changes that are never committed."""
    with tempfile.TemporaryDirectory() as folder:
        yield EmbeddedStore.create(Path(folder) / ".kg")


def carried_out(transaction: EmbeddedTransaction, text: str) -> list[pyoxigraph.Quad]:
    """Return the content of an empty store after an update."""
    executor = Executor(transaction, ())
    normalised, found = parsed(text, "update", None)
    for operation in found:
        executor.run(operation, normalised, (), ())
    graphs: list[Any] = [pyoxigraph.DefaultGraph(), *transaction.graphs()]
    return [quad for graph in graphs for quad in transaction.quads(graph)]


def may_copy_nothing(found: list[str]) -> bool:
    """Return whether a missing graph may be copied: an error in the standard, an empty graph in the engine."""
    copies = sum(one.startswith(("ADD", "COPY", "MOVE")) for one in found)
    return copies > 1 or (copies == 1 and any(one.startswith("DROP") for one in found))


@given(st.lists(OPERATIONS, min_size=1, max_size=5))
@settings(max_examples=examples(20, 60), deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_updates_do_what_the_engines_own_do(scratch: EmbeddedStore, found: list[str]) -> None:
    """A sequence of operations leaves the same quads as the engine's own update, and reports its changes."""
    text = PREFIX + " ;\n".join(["CREATE GRAPH :g", "CREATE GRAPH :h", *found])
    own = Store()
    own.update(text)
    with scratch.write("test") as transaction:
        quads = carried_out(transaction, text)
        transaction.roll_back()
    assert may_copy_nothing(found) or canonical(quads) == canonical(list(own))


@given(st.lists(st.tuples(st.booleans(), quads(NAMES)), min_size=1, max_size=6), st.data())
@settings(max_examples=examples(3, 6), deadline=None)
def test_incremental_equals_from_scratch(changes: list[tuple[bool, str]], data: st.DataObject) -> None:
    """After any updates a full run of the rules adds and removes nothing."""
    with tempfile.TemporaryDirectory() as name:
        own = bench(Path(name))
        modes = set()
        own.update("INSERT DATA { " + " . ".join(f":n{number} :p :n{number + 1}" for number in range(40)) + " }")
        for insert, quad in changes:
            modes.add(own.update(f"{'INSERT' if insert else 'DELETE'} DATA {{ {quad} }}").mode)
            own.update(data.draw(modifies()))
        again = load(
            {"store": str(own.store.layout.root), "rules": str(own.settings.rules[0]), "rule_families": "mine"},
            environment={},
            folder=Path(name),
        )
        report = run_on_store(again, full=True)
        assert (report.added, report.removed) == (0, 0)
