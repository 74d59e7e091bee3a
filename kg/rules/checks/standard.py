"""The terms of RDF, RDFS and OWL: closed vocabularies, so an unknown name is misspelt.

Sources: RDF 1.2 Schema, sections 2 to 5; OWL 2 Mapping to RDF Graphs, tables 1 and 2; RDF 1.2 Concepts for rdf:reifies
and the types of strings.
"""

from __future__ import annotations

import re
from typing import Final

from kg.syntax.names import PREFIXES

_TERMS: Final = {
    "rdf": """
        type subject predicate object first rest nil value reifies language direction
        Property Statement List Bag Seq Alt XMLLiteral HTML JSON langString dirLangString PlainLiteral CompoundLiteral
        langRange""",
    "rdfs": """
        label comment seeAlso isDefinedBy member domain range subClassOf subPropertyOf
        Class Resource Literal Datatype Container ContainerMembershipProperty Proposition""",
    "owl": """
        AllDifferent AllDisjointClasses AllDisjointProperties Annotation AnnotationProperty AsymmetricProperty Axiom
        Class DataRange DatatypeProperty DeprecatedClass DeprecatedProperty FunctionalProperty
        InverseFunctionalProperty IrreflexiveProperty NamedIndividual NegativePropertyAssertion Nothing ObjectProperty
        Ontology OntologyProperty ReflexiveProperty Restriction SymmetricProperty Thing TransitiveProperty
        allValuesFrom annotatedProperty annotatedSource annotatedTarget assertionProperty backwardCompatibleWith
        bottomDataProperty bottomObjectProperty cardinality complementOf datatypeComplementOf deprecated differentFrom
        disjointUnionOf disjointWith distinctMembers equivalentClass equivalentProperty hasKey hasSelf hasValue imports
        incompatibleWith intersectionOf inverseOf maxCardinality maxQualifiedCardinality members minCardinality
        minQualifiedCardinality onClass onDataRange onDatatype onProperties onProperty oneOf priorVersion
        propertyChainAxiom propertyDisjointWith qualifiedCardinality rational real sameAs someValuesFrom
        sourceIndividual targetIndividual targetValue topDataProperty topObjectProperty unionOf versionIRI versionInfo
        withRestrictions""",
}
STANDARD: Final = {PREFIXES[prefix]: frozenset(names.split()) for prefix, names in _TERMS.items()}
"""Namespace to the local names of its terms."""

_NUMBERED: Final = re.compile(r"_[1-9][0-9]*")


def namespace_of(iri: str) -> str:
    """Return an IRI up to its last `#` or `/`."""
    return iri[: max(iri.rfind("#"), iri.rfind("/")) + 1]


def is_standard(iri: str) -> bool:
    """Return whether an IRI is a term of one of the three vocabularies, `rdf:_1` and so on among them."""
    namespace = namespace_of(iri)
    local = iri.removeprefix(namespace)
    numbered = namespace == PREFIXES["rdf"] and _NUMBERED.fullmatch(local) is not None
    return numbered or local in STANDARD.get(namespace, ())
