"""SHACL rules by cases: each folder of `cases` has rules, data, and the inferred triples, all in Turtle."""

from __future__ import annotations

from pathlib import Path

import pytest
from rules.notations.shacl.running import canonical, evaluated, triples

from kg.errors import RuleError
from kg.rules.engine.evaluate import Program
from kg.rules.notations.shacl import rules
from kg.rules.specialise import specialise

CASES = sorted((Path(__file__).parent / "cases").iterdir())


@pytest.mark.parametrize("cut", [False, True], ids=["as written", "cut to the schema"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_rules_infer_what_the_case_expects(case: Path, *, cut: bool) -> None:
    """The rules infer exactly the expected triples, also with class hierarchies resolved in advance."""
    shapes, data, expected = ((case / f"{name}.ttl").read_text() for name in ("rules", "data", "expected"))
    assert canonical(evaluated(shapes, triples(data), cut=cut)) == canonical(triples(expected))


TYPES = """
@prefix ex: <http://example.org/> .
@prefix sh: <http://www.w3.org/ns/shacl#> .
ex:address a sh:SPARQLFunction ;
    sh:parameter [ sh:path ex:of ] ;
    sh:select "SELECT ?result WHERE { BIND(IRI(CONCAT(STR($of), '-address')) AS ?result) }" .
ex:Shape a sh:NodeShape ;
    sh:targetClass ex:Person ;
    sh:rule [ a sh:TripleRule ; sh:subject [ ex:address ( sh:this ) ] ; sh:predicate a ; sh:object ex:Address ] .
""".replace("predicate a", "predicate <http://www.w3.org/1999/02/22-rdf-syntax-ns#type>")


def test_types_may_be_given_to_new_terms_where_the_hierarchy_is_known() -> None:
    """A class as target reads any type, unless the schema gives its subclasses."""
    written = rules(TYPES, "tests/types", "types.ttl")
    with pytest.raises(RuleError, match="makes new terms"):
        Program(written).refuse_minting()
    prefixes = "PREFIX ex: <http://example.org/> PREFIX rdfs: <http://www.w3.org/2000/01/rdf-schema#> "
    below = triples(prefixes + "ex:Child rdfs:subClassOf ex:Person .")
    Program(specialise(written, below)).refuse_minting()
