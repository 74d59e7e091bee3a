"""Tests of rules inside builds: what is inferred changes together with what it is inferred from."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from pyoxigraph import NamedNode, RdfFormat

from kg.errors import RuleError
from kg.pipeline.build import build
from kg.pipeline.forgetting import forget
from kg.pipeline.inferring import digest
from kg.settings import load
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

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
    """Return what is inferred, sorted."""
    with store.read() as snapshot:
        return sorted(snapshot.dump(RdfFormat.N_TRIPLES, graph=INFERRED).decode().splitlines())


def published(store: EmbeddedStore) -> set[str]:
    """Return the topics that nodes publish, as rules infer it."""
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
    """After a change of one package what is inferred is the same as after building everything anew."""
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
    """A rule of the user's that comes or goes is seen by the next build."""
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


def test_without_rules_what_was_inferred_stays_until_the_next_build(bench: Bench) -> None:
    """A build without rules changes nothing that was inferred; the next one brings it up to date."""
    built(bench)
    before = inferred(bench.store)
    bench.package("one", "murmur")
    assert built(bench, rules=False).inferred is None
    assert inferred(bench.store) == before
    assert built(bench).inferred is not None
    assert "/murmur" in published(bench.store)


def test_a_rule_that_cannot_be_read_leaves_the_store_as_it_was(bench: Bench, tmp_path: Path) -> None:
    """The build ends with the place in the rule, and nothing of it is in force."""
    built(bench)
    before = bench.content()
    (tmp_path / "rules" / "mine").mkdir(parents=True)
    (tmp_path / "rules" / "mine" / "broken.rq").write_text(LOUD.replace("WHERE {", "WHERE"))
    bench.package("one", "murmur")
    with pytest.raises(RuleError) as caught:
        built(bench, settings(rules=str(tmp_path / "rules")))
    assert caught.value.code == "KG201"
    assert caught.value.place is not None
    assert caught.value.place.path.endswith("broken.rq")
    assert bench.content() == before


def test_what_is_inferred_from_a_source_goes_with_it(bench: Bench) -> None:
    """When a source is forgotten, so is what rules inferred from it."""
    built(bench)
    found = forget(bench.store, settings(), ["local/src"])
    assert found is not None
    assert found.removed > 0
    assert not published(bench.store)
