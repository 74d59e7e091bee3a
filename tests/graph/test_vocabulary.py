from __future__ import annotations

import re
from itertools import product
from pathlib import Path

import ontologies
import pytest
from rdflib import OWL, RDF, RDFS, Graph, URIRef

from kg.graph import vocabulary

ONTO_ROS_TERMS = {
    "ROSCommunication",
    "TopicCommunication",
    "ServiceCommunication",
    "Mode",
    "Topic",
    "Service",
    "Message",
    "RequestMessage",
    "ResponseMessage",
    "CommunicationComponent",
    "Publisher",
    "Subscriber",
    "ServiceClient",
    "ServiceServer",
    "Node",
    "Package",
    "Capability",
    "Modality",
    "read",
    "write",
    "isRoutedVia",
    "hasMessage",
    "hasComponent",
    "communicatesThrough",
    "hasPublisher",
    "hasSubscriber",
    "hasClient",
    "hasServer",
    "evokes",
    "hasModality",
}
KINDS = (OWL.Class, OWL.ObjectProperty, OWL.DatatypeProperty, OWL.AnnotationProperty, OWL.NamedIndividual)
GRAPHS = {name: graph for name, graph in ontologies.named().items() if name != "hardware-products"}
"""The ontologies that declare terms."""
ONTO_ROS, RNKG = GRAPHS["onto-ros"], GRAPHS["rnkg"]
BOTH = ONTO_ROS + RNKG + GRAPHS["architecture"]
ALL = ontologies.together()
NAMESPACES = {
    "onto-ros": vocabulary.ROS,
    "rnkg": vocabulary.RNKG,
    **{name: f"https://w3id.org/rnkg/{name}#" for name in ("capability", "function", "hardware", "architecture")},
    "ontobot-alignment": "https://w3id.org/onto-bot#",
    **dict.fromkeys(
        ("capability-contexts", "capability-exclusions", "capability-parameters"), "https://w3id.org/rnkg/capability#"
    ),
}


def declared(graph: Graph, namespace: str) -> set[str]:
    """Return the local names of the terms of a namespace declared by an ontology."""
    subjects = {subject for kind in KINDS for subject in graph.subjects(RDF.type, kind)}
    return {str(term).removeprefix(namespace) for term in subjects if str(term).startswith(namespace)}


def test_onto_ros_has_exactly_its_terms() -> None:
    """No term of onto-ros is missing or added."""
    assert declared(ONTO_ROS, vocabulary.ROS) == ONTO_ROS_TERMS


@pytest.mark.parametrize("ontology", GRAPHS)
def test_every_term_is_explained(ontology: str) -> None:
    """Each term of an ontology has one label and one comment, a sentence."""
    graph, own = GRAPHS[ontology], NAMESPACES[ontology]
    assert declared(graph, own)
    for name in declared(graph, own):
        labels, comments = (list(graph.objects(URIRef(own + name), which)) for which in (RDFS.label, RDFS.comment))
        assert len(labels) == len(comments) == 1, name
        assert str(comments[0]).endswith("."), name


def test_every_term_that_is_written_is_defined() -> None:
    """Every term used by the writers is in the ontologies."""
    used = {value[1:-1] for value in vars(vocabulary).values() if isinstance(value, str) and value.startswith("<")}
    ours = {term for term in used if term.startswith((vocabulary.ROS, vocabulary.RNKG))}
    assert len(ours) > 100
    assert {URIRef(term) for term in ours} <= set(BOTH.subjects(RDF.type))


def test_every_term_that_is_written_is_in_the_documentation() -> None:
    """docs/graph-model.md shows each term used by the writers."""
    page = (Path(__file__).parents[2] / "docs" / "graph-model.md").read_text("utf-8")
    shown = set(re.findall(r"\b(rnkg|ros):([A-Za-z-]+)", page))
    used = {value[1:-1] for value in vars(vocabulary).values() if isinstance(value, str) and value.startswith("<")}
    for prefix, namespace in (("rnkg", vocabulary.RNKG), ("ros", vocabulary.ROS)):
        names = {term.removeprefix(namespace) for term in used if term.startswith(namespace)}
        assert names <= {name for known, name in shown if known == prefix}


def test_terms_of_others_are_declared() -> None:
    """Every term of an axiom is declared, in each ontology alone, as required by OWL 2 DL."""
    axioms = (RDFS.subClassOf, RDFS.subPropertyOf, RDFS.domain, RDFS.range, OWL.disjointWith, OWL.onProperty)
    for graph in GRAPHS.values():
        mentioned = {term for axiom in axioms for term in graph.objects(None, axiom) if isinstance(term, URIRef)}
        members = {term for term in graph.objects(None, RDF.first) if isinstance(term, URIRef)}
        known = {subject for kind in KINDS for subject in graph.subjects(RDF.type, kind)}
        builtin = {term for term in mentioned if str(term).startswith(vocabulary.XSD)}
        assert (mentioned | members) - known == builtin


def test_no_term_plays_two_parts() -> None:
    """No IRI is more than one of class, kind of property, and individual (the restriction of OWL 2 DL on punning)."""
    for one, other in product(KINDS, KINDS):
        if one != other:
            assert not set(ALL.subjects(RDF.type, one)) & set(ALL.subjects(RDF.type, other))


def test_every_property_has_the_kind_of_its_range() -> None:
    """The range of a data property is a data type, that of an object property is not."""
    for kind, literal in ((OWL.DatatypeProperty, True), (OWL.ObjectProperty, False)):
        for term in ALL.subjects(RDF.type, kind):
            for span in ALL.objects(term, RDFS.range):
                assert str(span).startswith(vocabulary.XSD) == literal, term
