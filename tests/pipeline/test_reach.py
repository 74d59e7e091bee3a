"""Tests of changes that no rule can react to: nothing runs, and the record of the last run moves on."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import Place
from kg.pipeline import inferring
from kg.pipeline.build import build
from kg.pipeline.inferring import LastRun, last_run, run_on_store
from kg.pipeline.updating.applying import apply
from kg.pipeline.updating.changes import Update
from kg.rules.dependencies import pattern, patterns
from kg.rules.form import Atom, EngineBlock, Exists, Rule, Variable
from kg.settings import load

if TYPE_CHECKING:
    from pipeline.conftest import Bench

    from kg.pipeline.updating.changes import Updated
    from kg.settings import Settings

RDFS = "http://www.w3.org/2000/01/rdf-schema#"
QUIET = "INSERT DATA { GRAPH <urn:notes> { <urn:a> rdfs:comment '%s' } }"


def settings(bench: Bench) -> Settings:
    """Return settings for the store of a bench."""
    return load({"jobs": 1, "store": str(bench.store.layout.root)}, environment={})


def recorded(bench: Bench) -> LastRun:
    """Return the record of the last run."""
    last = last_run(bench.store.layout.cache)
    assert last is not None
    return last


def updated(bench: Bench, text: str) -> Updated:
    """Make a change as `kg update` does."""
    return apply(bench.store, settings(bench), Update(text=text))


@pytest.fixture
def runs(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> list[None]:
    """Build a workspace; return a list that grows with every run of rules after that."""
    build([str(bench.source)], bench.store, settings(bench))
    seen: list[None] = []
    make = inferring._new_runner

    def counted(*arguments: object) -> object:
        seen.append(None)
        return make(*arguments)  # type: ignore[arg-type]  # passed on

    monkeypatch.setattr(inferring, "_new_runner", counted)
    return seen


def test_a_change_that_no_rule_reads_runs_none(bench: Bench, runs: list[None]) -> None:
    """The inferences stay; the counts are those that a run would report."""
    before = recorded(bench)
    result = updated(bench, QUIET % "one")
    after = recorded(bench)
    assert (runs, result.mode, result.inferred) == ([], "incremental", before.inferred)
    assert (after.asserted, after.generation) == (before.asserted + 1, int(result.snapshot))
    updated(bench, "INSERT DATA { <urn:a> rdfs:comment 'one' }")
    assert recorded(bench).asserted == after.asserted
    updated(bench, "DELETE DATA { GRAPH <urn:notes> { <urn:a> rdfs:comment 'one' } }")
    assert recorded(bench).asserted == after.asserted
    updated(bench, "DELETE DATA { <urn:a> rdfs:comment 'one' } ; INSERT DATA { <urn:a> rdfs:comment 'two', 'three' }")
    assert not runs
    assert recorded(bench).asserted == run_on_store(settings(bench), full=True).asserted == before.asserted + 2


@pytest.mark.parametrize(
    "text",
    [
        "INSERT DATA { GRAPH <urn:notes> { <urn:a> a rnkg:Topic } }",
        "INSERT DATA { GRAPH <urn:notes> { <urn:a> rdfs:label 'a' } }",
        "INSERT DATA { GRAPH <urn:notes> { <urn:p> rdfs:subPropertyOf rnkg:publishes } }",
        "DELETE { GRAPH ?g { ?a rnkg:path ?b } } WHERE { GRAPH ?g { ?a rnkg:path ?b } }",
        "DROP SILENT GRAPH <urn:other>",
        QUIET % "one" + "; CLEAR GRAPH <urn:notes>",
    ],
)
def test_other_changes_run_rules(bench: Bench, runs: list[None], text: str) -> None:
    """Rules run if one of them may read the change, if the schema changed, and if a graph was emptied."""
    updated(bench, "INSERT DATA { GRAPH <urn:other> { <urn:b> rdfs:comment 'b' } }")
    updated(bench, text)
    assert len(runs) == 1


def test_rules_run_after_changes_without_them(bench: Bench, runs: list[None]) -> None:
    """A change with `--no-rules` leaves inferences that may be old, so the next one runs the rules."""
    text = "INSERT DATA { <urn:a> rdfs:label 'a' }"
    apply(bench.store, settings(bench), Update(text=text), rules=False)
    updated(bench, QUIET % "one")
    assert len(runs) == 1


def test_rules_run_once_in_many_changes(bench: Bench, runs: list[None], monkeypatch: pytest.MonkeyPatch) -> None:
    """The saved columns do not fall behind by more generations than are recorded."""
    monkeypatch.setattr(inferring, "_MOST_UNREAD", 2)
    for number in range(4):
        updated(bench, QUIET % number)
    assert len(runs) == 1
    assert recorded(bench).unread == 1


def test_patterns_of_rules() -> None:
    """IRIs restrict a pattern, also within EXISTS; literals do not, and a block of unknown reads matches all."""
    subject, predicate, name = Variable("s"), NamedNode("urn:p"), NamedNode("urn:o")
    atoms = (Atom(subject, predicate, name), Atom(subject, predicate, Literal("1")))
    inner = Exists((Atom(subject, NamedNode("urn:q"), Variable("o")),), negated=True)
    rule = Rule("one", (Atom(subject, NamedNode("urn:r"), name),), (*atoms, inner), Place("one.rq"))
    expected = {"<urn:p> <urn:o>", "<urn:p>", "<urn:q>", "<urn:r> <urn:o>", "<urn:d>"}
    assert patterns([rule], [Triple(name, NamedNode("urn:d"), name)]) == expected
    assert pattern(subject, name) == ""
    block = EngineBlock("", (), reads=None)
    assert "" in patterns([Rule("two", rule.head, (block,), rule.place)])
