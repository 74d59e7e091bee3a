"""Places of rules and their parts in their Turtle file."""

from __future__ import annotations

from kg.rules.form import Assignment, Atom
from kg.rules.notations.shacl import rules

SHAPES = r'''@prefix ex: <http://example.org/> .
@prefix sh: <http://www.w3.org/ns/shacl#> .

ex: sh:declare [ sh:prefix "ex" ; sh:namespace "http://example.org/" ] .

ex:Shape a sh:NodeShape ;
    sh:targetNode ex:a ;
    sh:rule [
        a sh:TripleRule ;
        sh:subject sh:this ; sh:predicate ex:p ; sh:object ex:b ;
    ] ;
    sh:rule [
        a sh:SPARQLRule ; sh:prefixes ex: ;
        sh:construct """
            CONSTRUCT { $this ex:q ?text }
            WHERE {
                $this ex:name ?name .   # its \"name\"
                BIND(CONCAT("\\t", ?name) AS ?text)
            }""" ;
    ] .
'''


def test_a_triple_rule_stands_where_its_type_does() -> None:
    """A rule that is a blank node has the place of its type."""
    rule = rules(SHAPES, "tests/places", "shapes.ttl")[0]
    assert str(rule.place) == "shapes.ttl:9:11"
    assert rule.place.excerpt == "        a sh:TripleRule ;"


def test_parts_of_a_query_stand_inside_their_string() -> None:
    """A pattern and an expression have the place of their first character, also after escapes."""
    rule = rules(SHAPES, "tests/places", "shapes.ttl")[1]
    (atom,) = [element for element in rule.body if isinstance(element, Atom)]
    (bound,) = [element for element in rule.body if isinstance(element, Assignment)]
    assert str(atom.place) == "shapes.ttl:17:17"
    assert str(bound.expression.place) == "shapes.ttl:18:22"
    assert bound.expression.place is not None
    assert bound.expression.place.excerpt == r'                BIND(CONCAT("\\t", ?name) AS ?text)'


def test_parts_count_through_the_file() -> None:
    """Rules of one file have one name, and parts numbered from one."""
    found = rules(SHAPES, "tests/places", "shapes.ttl")
    assert [(rule.name, rule.part) for rule in found] == [("tests/places", 1), ("tests/places", 2)]
