from __future__ import annotations

import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import pytest
from cli.rover import build

from kg.errors import GraphError, RuleError, SourceError, UsageError
from kg.graph.iris import Iris
from kg.graph.vocabulary import RNKG
from kg.pipeline.inferring import Inference, last_run, run_on_files, run_on_store, unchanged
from kg.pipeline.reasoning import digest
from kg.pipeline.updating.applying import apply
from kg.pipeline.updating.changes import Update
from kg.rules.authoring.runs import rule_runs, run_objects
from kg.rules.engine.limits import Limits
from kg.settings import load
from kg.store.opening import existing, layout_of, reading
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from kg.settings import Settings

CASE: Final = Path(__file__).parent.parent / "cli" / "rules_case"
SCHEMA: Final = (
    "<urn:talks> <http://www.w3.org/2000/01/rdf-schema#subPropertyOf> <https://example.org/wiring#talksTo> .\n"
)


@pytest.fixture
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Settings:
    """Return the settings of a folder with rules."""
    shutil.copytree(CASE, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return load({"rule_families": "wiring,owl"}, environment={})


def test_a_run_over_the_store_tells_what_each_rule_did(settings: Settings, tmp_path: Path) -> None:
    """The rules of one file are reported as one; the next run has nothing to do."""
    build(tmp_path / ".kg")
    report = run_on_store(settings, full=True)
    derived = {one.rule: one.derived for one in rule_runs(report.rules)}
    assert (derived["wiring/talks-to"], derived["wiring/reaches"], derived["wiring/silent"]) == (2, 2, 2)
    *_, last = run_objects(report)
    assert (last["run"], last["mode"], last["inferred"]) == (True, "full", report.inferred)
    again = run_on_store(settings)
    assert (again.mode, again.added, again.removed, again.generation) == ("incremental", 0, 0, None)


def test_a_dry_run_and_a_limit_leave_the_store_as_it_was(settings: Settings, tmp_path: Path) -> None:
    """Neither creates a generation."""
    build(tmp_path / ".kg")
    with reading(settings) as snapshot:
        before = snapshot.identity
    assert run_on_store(settings, dry_run=True, full=True).added > 0
    with pytest.raises(RuleError, match="KG205"):
        run_on_store(settings, full=True, limits=Limits(max_triples=1))
    with reading(settings) as snapshot:
        assert snapshot.identity == before


def _least_weights(settings: Settings) -> list[str]:
    with reading(settings) as snapshot:
        found: Any = snapshot.query(
            "SELECT ?least { GRAPH ?_g { <urn:own> rnkg:leastWeight ?least } }", prefixes=PREFIXES
        )
        return [row[0].value for row in found]


def _built(settings: Settings, tmp_path: Path) -> None:
    """Build a store with a record of its ontologies, as `kg build` does."""
    build(tmp_path / ".kg")
    store = existing(settings)
    inference = Inference(store, settings)
    with store.write("test") as transaction:
        inference.update_ontologies(transaction, anew=True)
        inference.remember(transaction.commit())


def test_a_run_reads_the_ontologies_that_changed(settings: Settings, tmp_path: Path) -> None:
    """An edit of a user's ontology is in the store after the next run, but not after a dry run."""
    _built(settings, tmp_path)
    own = tmp_path / "ontology" / "own.ttl"
    own.parent.mkdir()
    for weight, dry_run, expected in ((4, True, []), (4, False, ["4"]), (6, False, ["6"])):
        own.write_text(f"<urn:own> <{RNKG}leastWeight> {weight} .")
        run_on_store(settings, dry_run=dry_run)
        assert _least_weights(settings) == expected
    own.unlink()
    run_on_store(settings)
    assert _least_weights(settings) == []


def test_what_was_added_to_the_ontologies_stays_when_they_change(settings: Settings, tmp_path: Path) -> None:
    """Only triples removed from the files are removed."""
    _built(settings, tmp_path)
    graph = f"<{Iris(settings.base).graph('ontology')}>"
    insert = f"INSERT DATA {{ GRAPH {graph} {{ <urn:own> <{RNKG}leastWeight> 3 }} }}"
    apply(existing(settings), settings, Update(text=insert))
    own = tmp_path / "ontology" / "own.ttl"
    own.parent.mkdir()
    own.write_text(f"<urn:other> <{RNKG}leastWeight> 4 .")
    run_on_store(settings)
    assert _least_weights(settings) == ["3"]


def test_an_ontology_that_cannot_be_read_stops_a_run(settings: Settings, tmp_path: Path) -> None:
    """The error names the file; the store is unchanged."""
    _built(settings, tmp_path)
    (tmp_path / "ontology").mkdir()
    (tmp_path / "ontology" / "own.ttl").write_text("<urn:a> oops .")
    with pytest.raises(GraphError, match="KG601"):
        run_on_store(settings)
    assert _least_weights(settings) == []


def test_a_run_over_files_writes_what_it_infers(settings: Settings, tmp_path: Path) -> None:
    """Rules over any schema are specialized for the axioms of the files."""
    data = tmp_path / "data.nt"
    data.write_text(SCHEMA + "<urn:a> <urn:talks> <urn:b> .\n<urn:b> <urn:talks> <urn:c> .\n")
    output = tmp_path / "inferred.nt"
    run_on_files(settings, [data], output)
    lines = output.read_text().splitlines()
    assert "<urn:a> <https://example.org/wiring#reaches> <urn:c> ." in lines
    assert len([line for line in lines if "#reaches" in line]) == 3
    assert run_on_files(settings, [data], None).inferred == len(lines)


def test_a_file_that_is_not_there_is_named(settings: Settings, tmp_path: Path) -> None:
    """KG101 with the file."""
    with pytest.raises(SourceError, match="KG101") as caught:
        run_on_files(settings, [tmp_path / "none.nt"], None)
    assert str(caught.value.place).endswith("none.nt")


def test_a_file_that_cannot_be_written_is_named(settings: Settings, tmp_path: Path) -> None:
    """KG003 with the file and the reason, before anything is read."""
    for output, reason in ((tmp_path / "no" / "x.nt", "does not exist"), (tmp_path, "it is a folder")):
        with pytest.raises(UsageError, match=f"KG003.*{reason}") as caught:
            run_on_files(settings, [tmp_path / "none.nt"], output)
        assert str(caught.value.place) == str(output)


def test_a_run_is_remembered_by_its_rules(settings: Settings, tmp_path: Path) -> None:
    """Later changes are detected by the digest of the rules; a run that writes nothing keeps the record."""
    build(tmp_path / ".kg")
    cache = tmp_path / ".kg" / "cache"
    before = last_run(cache)
    run_on_store(settings, dry_run=True)
    assert last_run(cache) == before
    report = run_on_store(settings)
    last = last_run(cache)
    assert last is not None
    assert (last.digest, last.inferred, last.asserted) == (digest(settings), report.inferred, report.asserted)


def test_a_store_and_rules_that_are_as_they_were_are_known(settings: Settings, tmp_path: Path) -> None:
    """They are, until a rule or a generation is new."""
    build(tmp_path / ".kg")
    run_on_store(settings)
    layout = layout_of(settings)
    assert unchanged(settings, layout) == last_run(layout.cache)
    rule = tmp_path / "rules" / "wiring" / "more.rq"
    rule.write_text("CONSTRUCT { ?x <urn:p> ?y } WHERE { ?x <urn:q> ?y }")
    assert unchanged(settings, layout) is None
    rule.unlink()
    assert unchanged(settings, layout) is not None
    with existing(settings).write("test") as transaction:
        transaction.drop_graph(transaction.graphs()[0])
        transaction.commit()
    assert unchanged(settings, layout) is None
