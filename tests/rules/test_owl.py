"""The rules of OWL 2 RL: those needed by the ontologies are active, and the whole profile is complete."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

import ontologies
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import NamedNode, RdfFormat, Triple, parse
from rdflib import OWL, RDF, RDFS, Graph

from kg.resources import folder
from kg.rules.authoring.runs import infer
from kg.rules.engine.evaluate import Program
from kg.rules.reading import discover
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rdflib.term import Node

    from kg.rules.files import RuleSet


NEEDS: dict[tuple[Node | None, Node | None], set[str]] = {
    (RDFS.subClassOf, None): {"cax-sco", "scm-sco"},
    (RDFS.subPropertyOf, None): {"prp-spo1", "scm-spo"},
    (RDFS.domain, None): {"prp-dom"},
    (RDFS.range, None): {"prp-rng"},
    (OWL.allValuesFrom, None): {"cls-avf"},
    (OWL.inverseOf, None): {"prp-inv1", "prp-inv2"},
    (OWL.equivalentClass, None): {"cax-eqc1", "cax-eqc2"},
    (OWL.equivalentProperty, None): {"prp-eqp1", "prp-eqp2"},
    (OWL.someValuesFrom, None): {"cls-svf1"},
    (OWL.hasValue, None): {"cls-hv1", "cls-hv2"},
    (OWL.propertyChainAxiom, None): {"prp-spo2"},
    (RDF.type, OWL.SymmetricProperty): {"prp-symp"},
    (RDF.type, OWL.TransitiveProperty): {"prp-trp"},
    (RDF.type, OWL.FunctionalProperty): {"prp-fp"},
    (RDF.type, OWL.InverseFunctionalProperty): {"prp-ifp"},
}
"""The rules of the profile needed for an axiom with this predicate and object. Unions only have members, by no
active rule, and disjointness only contradicts, which `kg ontology check` reports."""

NAMES = st.sampled_from([NamedNode(f"urn:x:{letter}") for letter in "abcde"])
RELATIONS = [
    *("rdfs:subClassOf", "rdfs:subPropertyOf", "rdfs:domain", "rdfs:range", "owl:equivalentClass", "owl:sameAs"),
    *("owl:equivalentProperty", "owl:inverseOf", "rdf:type", "rdf:type"),
]
KINDS = ["owl:SymmetricProperty", "owl:TransitiveProperty", "owl:FunctionalProperty", "owl:InverseFunctionalProperty"]


def named(name: str) -> NamedNode:
    """Expand a prefixed name."""
    prefix, _, local = name.partition(":")
    return NamedNode(PREFIXES[prefix] + local)


FACTS = st.one_of(
    st.builds(Triple, NAMES, NAMES, NAMES),
    st.builds(Triple, NAMES, st.sampled_from(RELATIONS).map(named), NAMES),
    st.builds(Triple, NAMES, st.just(named("rdf:type")), st.sampled_from(KINDS).map(named)),
)


def test_the_rules_in_force_are_those_that_the_ontologies_need() -> None:
    """Each kind of axiom that occurs has its rules, and no other rules are active."""
    occurring = [
        names for (predicate, value), names in NEEDS.items() if (None, predicate, value) in ontologies.together()
    ]
    in_force = {file.name.split("/")[1] for file in discover([folder("rules")], families=["owl"]).files}
    assert set().union(*occurring) == in_force


def test_the_whole_profile_is_there() -> None:
    """The tables of the profile have 78 rules; the three about literals as subjects cannot be expressed in RDF."""
    tables = [re.search(r"table (\d)", file.documentation.sections["References"]) for file in profile().files]
    counted = [int(found[1]) for found in tables if found]
    assert [counted.count(table) for table in range(4, 10)] == [9, 20, 19, 5, 2, 20]


@cache
def profile() -> RuleSet:
    """Return the rules of the whole profile."""
    return discover([folder("rules")], families=["owl-rl"])


@cache
def program() -> Program:
    """Return the profile, ready to run."""
    return Program(profile().rules)


@cache
def axiomatic() -> frozenset[Triple]:
    """Return the inferences of the profile from no data."""
    return frozenset(infer(program(), [])[0])


def ours(data: Iterable[Triple]) -> set[str]:
    """Return the inferences of the profile together with the data, as text, without those from no data."""
    given = set(data)
    inferred, _ = infer(program(), given)
    return {str(each) for each in {*given, *inferred} - axiomatic()}


def theirs(data: Iterable[Triple]) -> set[str]:
    """Return the inferences of owlrl together with the data, as text."""
    owlrl = pytest.importorskip("owlrl", reason="owlrl is not installed: pip install -e '.[dev]'")
    graph = Graph().parse(data="\n".join(f"{each} ." for each in data), format="nt")
    owlrl.DeductiveClosure(owlrl.OWLRL_Semantics, axiomatic_triples=False, datatype_axioms=False).expand(graph)
    closure = parse(graph.serialize(format="nt", encoding="utf-8"), RdfFormat.N_TRIPLES)
    return {str(quad.triple) for quad in closure} - {str(each) for each in axiomatic()}


def compared(found: set[str]) -> set[str]:
    """Return the comparable triples: those about the data, without trivial ones about a class or property.

    owlrl has more data types, and does not derive that every class is a subclass of and equivalent to itself.
    """
    parts = {text: text.split() for text in found if "urn:x:" in text}
    trivial = ("subClassOf>", "subPropertyOf>", "equivalentClass>", "equivalentProperty>")
    return {text for text, (one, how, other) in parts.items() if one != other or not how.endswith(trivial)}


@given(st.lists(FACTS, max_size=7))
@settings(deadline=None, max_examples=8)
def test_the_profile_infers_what_owlrl_infers(data: list[Triple]) -> None:
    """On small ontologies both give the same triples, within `compared`."""
    assert compared(ours(data)) == compared(theirs(data))
