"""Lines of ontologies: the place of a fact in the files shipped with `kg`."""

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
    """Return the line of the file at the reported place of a fact."""
    found = place_of(fact, KNOWN)
    assert found is not None
    return Path(found[0]).read_text("utf-8").splitlines()[found[1] - 1]


def test_the_line_of_the_object() -> None:
    """A label has its own line, a type the line that names the class."""
    assert '"publishes"' in line(Triple(NamedNode(RNKG + "publishes"), LABEL, Literal("publishes", language="en")))
    assert "owl:ObjectProperty" in line(Triple(NamedNode(RNKG + "publishes"), TYPE, PROPERTY))


def test_what_the_files_do_not_name() -> None:
    """A subject without an ontology has no place; an unknown object has the line of its subject."""
    assert place_of(Triple(NamedNode("https://example.org/x"), TYPE, PROPERTY), KNOWN) is None
    assert line(Triple(NamedNode(RNKG + "publishes"), LABEL, Literal("no such label"))).startswith("rnkg:publishes")
