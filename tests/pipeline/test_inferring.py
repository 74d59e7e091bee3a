"""Tests of rules inside builds: inferences change together with their premises."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode, RdfFormat

from kg.errors import RuleError
from kg.pipeline import inferring, reasoning
from kg.pipeline.build import build
from kg.pipeline.forgetting import forget
from kg.pipeline.inferring import LastRun, last_run
from kg.pipeline.reasoning import digest
from kg.rules.running import Runner
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    import pytest
    from pipeline.conftest import Bench

    from kg.pipeline.report import BuildReport
    from kg.settings import Settings

INFERRED = NamedNode("https://w3id.org/rnkg/graph/inferred")
LOUD = """# Nodes that publish are loud
#
# ## What it infers
#
# A word.
#
# ## Why
#
# To be found.
#
# since: 0.2

PREFIX rnkg: <https://w3id.org/rnkg/ns#>

CONSTRUCT { ?node rnkg:nameWord "loud" } WHERE { ?node rnkg:publishes [] }
"""


def inferred(store: EmbeddedStore) -> list[str]:
    """Return the inferred triples, sorted."""
    with store.read() as snapshot:
        return sorted(snapshot.dump(RdfFormat.N_TRIPLES, graph=INFERRED).decode().splitlines())


def published(store: EmbeddedStore) -> set[str]:
    """Return the topics that nodes publish according to inferred triples."""
    with store.read() as snapshot:
        rows = snapshot.query("SELECT ?name { [] rnkg:publishes/rdfs:label ?name }", prefixes=PREFIXES)
        return {row[0].value for row in rows}  # type: ignore[union-attr]  # a SELECT gives rows


PREFIXES = {"rnkg": "https://w3id.org/rnkg/ns#", "rdfs": "http://www.w3.org/2000/01/rdf-schema#"}


def settings(**flags: object) -> Settings:
    """Return the settings with some flags."""
    return load({"jobs": 1, **flags}, environment={})


def built(bench: Bench, chosen: Settings | None = None, *, rules: bool = True) -> BuildReport:
    """Build the workspace."""
    return build([str(bench.source)], bench.store, chosen or settings(), rules=rules)


def test_a_build_infers(bench: Bench) -> None:
    """Direct relations are inferred with the first build, and a build without changes runs no rule."""
    report = built(bench)
    assert report.inferred is not None
    assert (report.inferred.mode, report.inferred.triples) == ("full", len(inferred(bench.store)))
    assert {"/talk", "/chatter"} <= published(bench.store)
    again = built(bench)
    assert (again.inferred, again.generation) == (None, None)


def test_what_is_inferred_follows_a_change(bench: Bench, tmp_path: Path) -> None:
    """After a change of one package, the inferences are those of a clean build."""
    built(bench)
    bench.package("one", "murmur")
    report = built(bench)
    assert report.inferred is not None
    assert report.inferred.mode == "incremental"
    assert "/murmur" in published(bench.store)
    fresh = EmbeddedStore.create(tmp_path / "fresh")
    build([str(bench.source)], fresh, settings())
    assert inferred(bench.store) == inferred(fresh)


def test_a_new_rule_runs_though_no_source_changed(bench: Bench, tmp_path: Path) -> None:
    """The next build detects an added or removed user rule."""
    rules = tmp_path / "rules"
    (rules / "mine").mkdir(parents=True)
    with_rules = settings(rules=str(rules))
    built(bench, with_rules)
    before = digest(with_rules)
    (rules / "mine" / "loud.rq").write_text(LOUD)
    assert digest(with_rules) != before
    report = built(bench, with_rules)
    assert report.generation is not None
    assert any('"loud"' in line for line in inferred(bench.store))
    (rules / "mine" / "loud.rq").unlink()
    built(bench, with_rules)
    assert not any('"loud"' in line for line in inferred(bench.store))


def test_rules_are_read_again_only_when_a_file_changed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A changed file with the same size and time is detected; a file written a moment ago is not trusted."""
    chosen = own_rule(tmp_path, "quiet.rq", NEGATING)
    file = tmp_path / "mine" / "quiet.rq"
    reads: list[Path] = []

    def reading(path: Path) -> bytes:
        reads.append(path)
        return path.read_bytes()

    monkeypatch.setattr(reasoning, "_content", reading)
    monkeypatch.setattr("kg.pipeline.filecache._SETTLED", -1)
    before, once = digest(chosen), len(reads)
    assert digest(chosen) == before
    assert len(reads) == once
    told = file.stat()
    file.write_text(NEGATING.replace('"a"', '"b"'))
    os.utime(file, ns=(told.st_atime_ns, told.st_mtime_ns))
    assert digest(chosen) != before
    monkeypatch.undo()
    assert digest(chosen) != before


def test_without_rules_what_was_inferred_stays_until_the_next_build(bench: Bench) -> None:
    """A build without rules changes no inferences; the next one updates them."""
    built(bench)
    before = inferred(bench.store)
    bench.package("one", "murmur")
    assert built(bench, rules=False).inferred is None
    assert inferred(bench.store) == before
    assert built(bench).inferred is not None
    assert "/murmur" in published(bench.store)


NEGATING = """PREFIX rnkg: <https://w3id.org/rnkg/ns#>
CONSTRUCT { ?node rnkg:nameWord "a" } WHERE { ?node rnkg:publishes [] FILTER NOT EXISTS { ?node rnkg:nameWord "a" } }
"""


def own_rule(folder: Path, name: str, text: str) -> Settings:
    """Write a user rule, and return settings that contain it."""
    (folder / "mine").mkdir(parents=True, exist_ok=True)
    (folder / "mine" / name).write_text(text)
    return settings(rules=str(folder))


def test_a_rule_that_cannot_be_read_is_left_out(bench: Bench, tmp_path: Path) -> None:
    """Asserted triples are stored, the other rules run, and every build reports the rule until it is fixed."""
    own_rule(tmp_path / "rules", "loud.rq", LOUD)
    chosen = own_rule(tmp_path / "rules", "broken.rq", LOUD.replace("WHERE {", "WHERE"))
    for _ in range(2):
        report = built(bench, chosen)
        assert report.inferred is not None
        (problem,) = report.inferred.problems
        assert (problem.code, problem.place and problem.place.path.endswith("broken.rq")) == ("KG201", True)
        assert any('"loud"' in line for line in inferred(bench.store))
    assert (last_run(bench.store.layout.cache) or LastRun("none")).digest == ""
    (tmp_path / "rules" / "mine" / "broken.rq").unlink()
    report = built(bench, chosen)
    assert report.inferred is not None
    assert not report.inferred.problems
    assert (last_run(bench.store.layout.cache) or LastRun("none")).digest == digest(chosen)


def test_rules_without_an_order_leave_those_that_kg_brings(bench: Bench, tmp_path: Path) -> None:
    """If user rules cannot run, they are left out together; their earlier inferences are removed."""
    chosen = own_rule(tmp_path / "rules", "loud.rq", LOUD)
    built(bench, chosen)
    own_rule(tmp_path / "rules", "negating.rq", NEGATING)
    bench.package("one", "murmur")
    report = built(bench, chosen)
    assert report.inferred is not None
    assert [problem.code for problem in report.inferred.problems] == ["KG202"]
    assert not any('"loud"' in line for line in inferred(bench.store))
    assert "/murmur" in published(bench.store)


def test_nothing_is_inferred_where_no_rules_can_run(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """Earlier inferences are not kept with data from which they may no longer follow."""
    built(bench)
    bench.package("one", "murmur")
    monkeypatch.setattr(Runner, "run_within", refuse)
    report = built(bench)
    assert report.inferred is not None
    assert (report.inferred.mode, report.inferred.removed > 0) == ("none", True)
    assert not inferred(bench.store)
    monkeypatch.undo()
    built(bench)
    assert "/murmur" in published(bench.store)


def refuse(*_: object, **__: object) -> None:
    """Fail as rules without an order do."""
    raise RuleError("KG202", "no order")


def test_what_is_inferred_from_a_source_goes_with_it(bench: Bench) -> None:
    """Removing a source removes its inferences."""
    built(bench)
    found = forget(bench.store, settings(), ["local/src"])
    assert found is not None
    assert found.removed > 0
    assert not published(bench.store)


def test_two_stores_have_the_same_ontologies(tmp_path: Path) -> None:
    """Blank nodes of the ontologies are named by the files alone, so equal builds have equal exports."""
    dumps = []
    for name in ("one", "two"):
        store = EmbeddedStore.create(tmp_path / name / ".kg")
        with store.write("test") as transaction:
            inferring.Inference(store, load(environment={}, folder=tmp_path)).update_ontologies(transaction)
        with store.read() as snapshot:
            dumps.append(sorted(snapshot.dump(RdfFormat.N_QUADS).splitlines()))
    assert dumps[0] == dumps[1]
    assert any(b"_:" in line for line in dumps[0])
