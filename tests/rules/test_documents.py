"""Lines of ontologies: where a fact stands in the files that `kg` brings along."""

from __future__ import annotations

from pathlib import Path

from pyoxigraph import Literal, NamedNode, Triple

from kg.graph.ontology_files import default_ontologies
from kg.rules.documents import place_of, statements

KNOWN = statements(default_ontologies())
RNKG = "https://w3id.org/rnkg/ns#"
LABEL = NamedNode("http://www.w3.org/2000/01/rdf-schema#label")
TYPE = NamedNode("http://www.w3.org/1999/02/22-rdf-syntax-ns#type")
PROPERTY = NamedNode("http://www.w3.org/2002/07/owl#ObjectProperty")


def line(fact: Triple) -> str:
    """Return the line of the file that a fact is said to stand on."""
    found = place_of(fact, KNOWN)
    assert found is not None
    return Path(found[0]).read_text("utf-8").splitlines()[found[1] - 1]


def test_the_line_of_the_object() -> None:
    """A label stands on the line that has it, a type on the line that names the class."""
    assert '"publishes"' in line(Triple(NamedNode(RNKG + "publishes"), LABEL, Literal("publishes", language="en")))
    assert "owl:ObjectProperty" in line(Triple(NamedNode(RNKG + "publishes"), TYPE, PROPERTY))


def test_what_the_files_do_not_name() -> None:
    """A subject that no ontology describes stands nowhere; an unknown object stands where its subject begins."""
    assert place_of(Triple(NamedNode("https://example.org/x"), TYPE, PROPERTY), KNOWN) is None
    assert line(Triple(NamedNode(RNKG + "publishes"), LABEL, Literal("no such label"))).startswith("rnkg:publishes")
