"""`kg query --on-demand`: rules evaluated for one query, compared with the same rules run over the store."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from cli.program import Program

RULES = """# Ancestors
#
# ## What it infers
#
# Parents are ancestors, and so are their ancestors.
#
# ## Why
#
# For this test.
#
# since: 0.2

PREFIX : <urn:x:>
DATA { :adam :ancestor :dust }
RULE { ?x :ancestor ?y } WHERE { ?x :parent ?y }
RULE { ?x :ancestor ?z } WHERE { ?x :parent ?y . ?y :ancestor ?z }
"""
MINTING = "CONSTRUCT { ?x <urn:x:next> [ a <urn:x:Node> ] } WHERE { ?x a <urn:x:Node> }"
DATA = """@prefix : <urn:x:> . :cain :parent :adam ; :name "Cain" .
:enoch :parent :cain . :irad :parent :enoch . :abel :parent :adam ."""
QUERIES = [
    "SELECT ?x { ?x :ancestor :cain } ORDER BY ?x",
    "SELECT ?x { :irad :ancestor ?x } ORDER BY ?x",
    "SELECT ?x ?y { ?x :ancestor ?y } ORDER BY ?x ?y",
    "SELECT ?x ?y { ?x :parent :cain OPTIONAL { ?y :ancestor ?x } } ORDER BY ?x ?y",
    "SELECT ?x ?p { ?x ?p :adam } ORDER BY ?x ?p",
    "SELECT ?g ?x { GRAPH ?g { ?x :ancestor :enoch } }",
    "SELECT ?x { ?x :ancestor ?y . ?y :name ?name } ORDER BY ?x",
    "ASK { :irad :ancestor :adam }",
    "CONSTRUCT { ?x :descendant ?y } WHERE { ?y :ancestor ?x . ?x :parent :adam }",
]


@pytest.fixture
def kg(kg: Program, tmp_path: Path) -> Program:
    """Return the program in a folder with an optional family of rules and a store of their input."""
    family = tmp_path / "rules" / "kinship"
    family.mkdir(parents=True)
    (family / "ancestor.srl").write_text(RULES)
    (family / "optional").write_text("For queries on demand.\n")
    (tmp_path / "family.ttl").write_text(DATA)
    kg("import", "family.ttl", "--no-rules")
    return kg


def answer(kg: Program, query: str, *options: str) -> list[str]:
    """Return the sorted lines printed by a query."""
    run = kg("query", *options, f"PREFIX : <urn:x:> {query}", "--format", "auto")
    assert run.code == 0, run.err
    return sorted(run.out.splitlines())


def test_answers_are_those_over_inferred_triples(kg: Program) -> None:
    """Every form of query gives the same result; the store does not receive the derived triples."""
    found = [answer(kg, query, "--on-demand", "kinship") for query in QUERIES]
    assert answer(kg, "ASK { ?x :ancestor ?y }") == ["false"]
    assert kg("rules", "run", "--rule-families", "+kinship").code == 0
    assert found == [answer(kg, query) for query in QUERIES]
    assert answer(kg, QUERIES[0], "--on-demand", "kinship") == found[0]
    assert all(len(lines) > 1 for lines in found[:-2])


def test_what_is_kept_for_the_next_query_is_not_used_after_a_change(kg: Program, tmp_path: Path) -> None:
    """A new generation or another rule is read again; a second query with the same ones uses the cache."""
    assert len(answer(kg, QUERIES[1], "--on-demand", "kinship")) == 5
    (kept,) = (tmp_path / ".kg" / "cache" / "on-demand" / "kinship" / "columns").iterdir()
    before = kept.stat().st_mtime_ns
    assert len(answer(kg, QUERIES[1], "--on-demand", "kinship")) == 5
    assert kept.stat().st_mtime_ns == before
    kg("update", "INSERT DATA { GRAPH <urn:x:g> { <urn:x:adam> <urn:x:parent> <urn:x:clay> } }")
    assert len(answer(kg, QUERIES[1], "--on-demand", "kinship")) == 6
    (tmp_path / "rules" / "kinship" / "ancestor.srl").write_text(RULES.replace("DATA { :adam :ancestor :dust }", ""))
    assert len(answer(kg, QUERIES[1], "--on-demand", "kinship")) == 5


def test_a_parameter_is_a_constant_of_the_query(kg: Program) -> None:
    """Values given with --param restrict the derived triples."""
    run = kg(
        "query", "SELECT ?x { VALUES ?of { UNDEF } ?x <urn:x:ancestor>/<urn:x:name> ?of }", "--param", "of=Cain",
        "--on-demand", "kinship", "--format", "csv",
    )  # fmt: skip
    assert sorted(run.out.split()) == ["urn:x:enoch", "urn:x:irad", "x"], run.err


def test_a_query_of_any_predicate_is_told_that_all_rules_were_evaluated(kg: Program) -> None:
    """A query of any predicate gets a note that all rules were evaluated; one with named predicates gets none."""
    whole = kg("query", "--on-demand", "kinship", "SELECT * { <urn:x:cain> ?p ?o }")
    assert "all rules of kinship were evaluated" in whole.err
    assert "evaluated" not in kg("query", "--on-demand", "kinship", "SELECT * { ?x <urn:x:ancestor> ?o }").err


def test_what_is_wrong_is_told_as_of_other_queries(kg: Program, tmp_path: Path) -> None:
    """An unknown family, invalid SPARQL, rules that may not terminate and a deadline are reported with their codes."""
    run = kg("query", "--on-demand", "kinshp", "ASK { ?s ?p ?o }")
    assert (run.code, "error[KG001]: unknown family of rules `kinshp`" in run.err) == (1, True)
    assert "Did you mean `kinship`?" in run.err
    assert "error[KG501]" in kg("query", "--on-demand", "kinship", "SELECT * { ?s <urn:x:ancestor> }").err
    assert "error[KG502]" in kg("query", "--on-demand", "kinship", "ASK { SERVICE <urn:x> { ?s ?p ?o } }").err
    (tmp_path / "rules" / "kinship" / "next.rq").write_text(MINTING)
    assert "error[KG204]" in kg("query", "--on-demand", "kinship", "ASK { ?s <urn:x:next> ?o }").err
    assert kg("query", "--on-demand", "kinship", "ASK { ?s <urn:x:ancestor> ?o }").code == 0
