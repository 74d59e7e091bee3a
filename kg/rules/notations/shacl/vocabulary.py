"""The names of SHACL and of RDF that rules are made of (namespaces: SHACL, section 1.1; SHACL-AF, section 1.1)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode

if TYPE_CHECKING:
    from kg.rules.form import Term

SH: Final = "http://www.w3.org/ns/shacl#"
RDF: Final = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
RDFS: Final = "http://www.w3.org/2000/01/rdf-schema#"
XSD: Final = "http://www.w3.org/2001/XMLSchema#"

FIRST: Final = NamedNode(f"{RDF}first")
REST: Final = NamedNode(f"{RDF}rest")
NIL: Final = NamedNode(f"{RDF}nil")
SUBCLASS: Final = NamedNode(f"{RDFS}subClassOf")
IMPORTS: Final = NamedNode("http://www.w3.org/2002/07/owl#imports")
CLASSES: Final = (NamedNode(f"{RDFS}Class"), NamedNode("http://www.w3.org/2002/07/owl#Class"))
"""A shape that is an instance of one of these is its own target class (SHACL, section 2.1.3.3)."""

_NAMES: Final = """
alternativePath and annotationProperty annotationValue annotationVarName ask class closed condition conforms
construct count datatype deactivated declare defaultValue desc description detail disjoint distinct else
entailment equals exists expression filterShape flags focusNode group groupConcat hasValue if
ignoredProperties in intersection inversePath js jsFunctionName jsLibrary jsLibraryURL labelTemplate
languageIn lessThan lessThanOrEquals limit max maxCount maxExclusive maxInclusive maxLength message min
minCount minExclusive minInclusive minLength minus name namespace node nodeKind nodeShape nodeValidator nodes
not object offset oneOrMorePath optional or order orderBy parameter path pattern predicate prefix prefixes
property propertyValidator qualifiedMaxCount qualifiedMinCount qualifiedValueShape
qualifiedValueShapesDisjoint result resultAnnotation resultMessage resultPath resultSeverity returnType rule
select separator severity shapesGraph shapesGraphWellFormed sourceConstraint sourceConstraintComponent
sourceRule sourceShape sparql subject suggestedShapesGraph sum target targetClass targetNode targetObjectsOf
targetSubjectsOf then this union uniqueLang update validator value values xone zeroOrMorePath zeroOrOnePath
"""
TERMS: Final = frozenset(_NAMES.split())
"""The local names of SHACL's properties; any other one in its namespace is a slip of the pen. `nodeShape` is
of a draft; the W3C's own tests have it."""


def local_name(path: Term) -> str:
    """Return the last part of an IRI, which names the variable of a parameter."""
    value = path.value if isinstance(path, NamedNode | Literal) else str(path)
    return value[max(value.rfind("#"), value.rfind("/"), value.rfind(":")) + 1 :]


def sh(name: str) -> NamedNode:
    """Return the IRI of a name of SHACL."""
    return NamedNode(SH + name)
