"""Tests of changes of a store: atomicity, inferences, and protection of kg's own graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pipeline.updating.changing import INFERRED

from kg.errors import KgError
from kg.pipeline.build import build
from kg.pipeline.updating.applying import apply
from kg.pipeline.updating.changes import GraphChange, Update
from kg.settings import load

if TYPE_CHECKING:
    from pipeline.conftest import Bench as Workspace
    from pipeline.updating.changing import Bench

CHAIN = "INSERT DATA { GRAPH :g { :a :next :b . :b :next :c } }"


def refused(own: Bench, text: str) -> str:
    """Return the error code of an update, and check that it changed nothing."""
    before, current = own.lines(), own.store.layout.current()
    with pytest.raises(KgError) as caught:
        own.update(text)
    assert (own.lines(), own.store.layout.current()) == (before, current)
    assert own.store.layout.numbers() == [current]
    return caught.value.code


def test_rules_follow_an_update_in_its_own_snapshot(own: Bench) -> None:
    """Inferences change with the data, and the result counts both."""
    made = own.update(CHAIN)
    assert (made.snapshot, made.graphs, made.inferred) == ("1", {"urn:test:g": (0, 2)}, 6)
    assert "<urn:test:a> <urn:test:reaches> <urn:test:c> ." in own.lines(INFERRED)
    gone = own.update("DELETE { GRAPH ?g { ?s :next :c } } WHERE { GRAPH ?g { ?s :next :c } }")
    assert (gone.snapshot, gone.removed, gone.added, gone.inferred_removed) == ("2", 1, 0, 4)
    assert own.lines(INFERRED) == own.lines(INFERRED.strip("<>"))
    assert not any("urn:test:c" in line for line in own.lines())


def test_a_failing_operation_undoes_those_before_it(own: Bench) -> None:
    """If the second operation of a sequence fails, nothing changes."""
    own.update(CHAIN)
    assert refused(own, "INSERT DATA { :x :y :z } ; CREATE GRAPH :g") == "KG560"
    assert refused(own, "INSERT DATA { :x :y :z } ; CLEAR GRAPH :nowhere") == "KG560"
    assert refused(own, "INSERT DATA { :x :y :z } ; COPY :nowhere TO :g") == "KG560"
    assert own.update("INSERT DATA { :x :y :z } ; CLEAR SILENT GRAPH :nowhere").added == 1


@pytest.mark.parametrize(
    "text",
    [
        f"INSERT DATA {{ GRAPH {INFERRED} {{ :x :y :z }} }}",
        f"WITH {INFERRED} DELETE {{ ?s ?p ?o }} WHERE {{ ?s ?p ?o }}",
        "DELETE WHERE { GRAPH ?g { ?s :reaches ?o } }",
        "INSERT { GRAPH ?g { :x :y :z } } WHERE { GRAPH ?g { ?s ?p ?o } }",
        f"CLEAR GRAPH {INFERRED}",
        f"DROP SILENT GRAPH {INFERRED}",
        f"MOVE {INFERRED} TO :g",
        f"COPY :g TO {INFERRED}",
        f"ADD :g TO {INFERRED}",
        f"INSERT DATA {{ :x :y :z }} ; INSERT {{ GRAPH ?g {{ :x :y :z }} }} WHERE {{ BIND({INFERRED} AS ?g) }}",
    ],
)
def test_what_rules_infer_is_written_by_rules_alone(own: Bench, text: str) -> None:
    """However an update names the graph, it is refused if it would change it."""
    own.update(CHAIN)
    assert refused(own, text) == "KG561"


def test_what_is_inferred_may_be_read_and_left_as_it_is(own: Bench) -> None:
    """An update that reads the graph, or would make no difference there, is allowed."""
    own.update(CHAIN)
    own.update(f"ADD {INFERRED} TO :copy")
    assert own.update(f"DELETE DATA {{ GRAPH {INFERRED} {{ :no :such :triple }} }}").changed is False


def test_clearing_everything_leaves_what_is_not_the_users(own: Bench) -> None:
    """CLEAR ALL clears the other graphs; earlier inferences then follow from nothing, and the rules remove them."""
    own.update(CHAIN)
    done = own.update("CLEAR ALL")
    assert (done.removed, done.inferred) == (2, 0)
    assert len(done.warnings) == 1
    assert own.lines(INFERRED) == []


def test_a_change_that_makes_no_difference_makes_no_snapshot(own: Bench) -> None:
    """The identity of the data is unchanged."""
    own.update(CHAIN)
    again = own.update(CHAIN)
    assert (again.snapshot, again.changed, again.mode) == ("1", False, "none")
    assert own.store.layout.numbers() == [1]


def test_a_dry_run_says_what_would_change(own: Bench) -> None:
    """The counts are those of the update, and the store is unchanged; the next update is correct."""
    own.update(CHAIN)
    tried = own.update("INSERT DATA { GRAPH :g { :c :next :zz } }", dry_run=True)
    assert (tried.graphs, tried.inferred_added, tried.snapshot) == ({"urn:test:g": (0, 1)}, 5, "1")
    assert not any("urn:test:zz" in line for line in own.lines())
    assert own.update("INSERT DATA { GRAPH :g { :c :next :zz } }").inferred_added == 5


def test_an_update_may_be_for_one_snapshot_only(own: Bench) -> None:
    """If the data has changed since that snapshot, nothing happens."""
    own.update(CHAIN)
    assert own.update("INSERT DATA { :x :y :z }", snapshot="1").snapshot == "2"
    with pytest.raises(KgError) as caught:
        own.update("INSERT DATA { :x :y :zz }", snapshot="1")
    assert caught.value.code == "KG512"


def test_the_default_graph_is_the_unnamed_one(own: Bench) -> None:
    """As in the standard: WHERE sees named graphs only by GRAPH, WITH and USING."""
    own.update(CHAIN)
    assert own.update("INSERT { ?a :seen ?b } WHERE { ?a :next ?b }").changed is False
    assert own.update("INSERT { ?a :seen ?b } USING :g WHERE { ?a :next ?b }").graphs == {"": (0, 2)}


def test_the_data_set_of_the_request_takes_the_place_of_the_stores(own: Bench) -> None:
    """Parameters of the protocol select the dataset of WHERE; together with USING or WITH they are refused."""
    own.update(CHAIN)
    text = "PREFIX : <urn:test:> INSERT { ?a :seen ?b } WHERE { ?a :next ?b }"
    assert own.applier.apply(Update(text=text, using=("urn:test:g",))).graphs == {"": (0, 2)}
    text = "PREFIX : <urn:test:> INSERT { ?a :seen2 ?b } WHERE { GRAPH ?g { ?a :next ?b } }"
    assert own.applier.apply(Update(text=text, using_named=("urn:test:none",))).changed is False
    for clash in ("WITH :g DELETE { ?a ?b ?c }", "DELETE { ?a ?b ?c } USING :g"):
        change = Update(text=f"PREFIX : <urn:test:> {clash} WHERE {{ ?a ?b ?c }}", using=("urn:test:g",))
        with pytest.raises(KgError) as caught:
            own.applier.apply(change)
        assert caught.value.code == "KG565"


def test_graphs_are_put_added_to_and_removed(own: Bench) -> None:
    """Content replaces that of a graph, or is added to it; blank nodes of two parts are different."""
    turtle = b"@prefix : <urn:test:> . :a :next :b , [] . <#x> :y 1 ."
    put = own.applier.apply(GraphChange(action="put", graph="urn:test:g", parts=((turtle, "text/turtle"),)))
    assert (put.created, put.added, put.inferred) == (True, 3, 5)
    assert "<urn:test:g#x>" in own.lines("urn:test:g")[-1]
    again = own.applier.apply(
        GraphChange(action="put", graph="urn:test:g", parts=((b"<urn:test:a> <urn:test:next> <urn:test:b> .", "nt"),))
    )
    assert (again.created, again.graphs) == (False, {"urn:test:g": (2, 0)})
    parts = ((b"_:a <urn:test:p> 1 .", "ttl"), (b"_:a <urn:test:p> 1 .", "text/turtle; charset=utf-8"))
    assert own.applier.apply(GraphChange(action="post", parts=parts)).graphs == {"": (0, 2)}
    empty = own.applier.apply(GraphChange(action="put", graph="urn:test:empty", parts=((b"", "ttl"),)))
    assert (empty.created, empty.changed) == (True, True)
    assert own.applier.apply(GraphChange(action="delete", graph="urn:test:g")).removed == 1
    assert own.applier.apply(GraphChange(action="delete", graph="urn:test:empty")).changed


@pytest.mark.parametrize(
    ("change", "code"),
    [
        (GraphChange(action="delete", graph="urn:test:none"), "KG564"),
        (GraphChange(action="put", graph=INFERRED.strip("<>"), parts=((b"", "ttl"),)), "KG561"),
        (GraphChange(action="delete", graph=INFERRED.strip("<>")), "KG561"),
        (GraphChange(action="post", graph="urn:test:g", parts=((b"<urn:a> <urn:b>", "ttl"),)), "KG562"),
        (GraphChange(action="post", graph="urn:test:g", parts=((b"", "application/trig"),)), "KG563"),
        (GraphChange(action="post", graph="urn:test:g", parts=((b"", "what"),)), "KG563"),
        (GraphChange(action="post", graph="no iri", parts=((b"", "ttl"),)), "KG560"),
    ],
)
def test_writes_of_graphs_that_cannot_be(own: Bench, change: GraphChange, code: str) -> None:
    """A missing graph, one of kg's own, content that does not parse, and a format with several graphs are refused."""
    own.update(CHAIN)
    with pytest.raises(KgError) as caught:
        own.applier.apply(change)
    assert caught.value.code == code
    assert own.store.layout.current() == 1


def test_a_broken_rule_is_a_warning(own: Bench) -> None:
    """The update is made, without the rule."""
    (own.settings.rules[0] / "mine" / "broken.rq").write_text("CONSTRUCT {")
    (warning,) = own.update(CHAIN).warnings
    assert "broken.rq" in warning


def test_a_build_writes_a_source_anew_that_an_update_changed(bench: Workspace) -> None:
    """The result contains a warning, and the next build of the source drops the change."""
    settings = load({"jobs": 1}, environment={})
    build([str(bench.source)], bench.store, settings)
    graph = next(one for one in bench.store.read().graphs() if "/source/" in one.value)
    text = f"INSERT DATA {{ GRAPH {graph} {{ <urn:test:a> <urn:test:b> <urn:test:c> }} }}"
    updated = apply(bench.store, settings, Update(text=text))
    assert (updated.mode, len(updated.warnings)) == ("incremental", 1)
    assert "next build" in updated.warnings[0]
    build([str(bench.source)], bench.store, settings)
    with bench.store.read() as snapshot:
        assert not snapshot.query("ASK { <urn:test:a> ?p ?o }")
