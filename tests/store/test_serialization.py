"""Statements read back from each format, or are refused before they are written."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.dom import minidom

import pyoxigraph
import pytest
from pyoxigraph import BaseDirection, BlankNode, Literal, NamedNode, Quad, RdfFormat, Triple

from kg.errors import QueryError
from kg.store.embedded import EmbeddedStore
from kg.store.serialization import FORMATS, serialized
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from pathlib import Path

S, P = NamedNode("https://example.org/s"), NamedNode("https://example.org/p")
RDF = "http://www.w3.org/1999/02/22-rdf-syntax-ns#"
DIRECTED = Literal("\u0633", language="ar", direction=BaseDirection.RTL)
UNFIT = {
    "a predicate that ends in no name": (Triple(S, NamedNode("https://example.org/1"), S), "rdfxml"),
    "a predicate that ends in no letter of XML": (Triple(S, NamedNode("https://example.org/\xaa"), S), "rdfxml"),
    "a term of the syntax as predicate": (Triple(S, NamedNode(f"{RDF}li"), S), "rdfxml"),
    "an old term of the syntax as predicate": (Triple(S, NamedNode(f"{RDF}bagID"), S), "rdfxml"),
    "a predicate in the namespace of declarations": (
        Triple(S, NamedNode("http://www.w3.org/2000/xmlns/a"), S),
        "rdfxml",
    ),
    "a class that ends in no name": (Triple(S, NamedNode(f"{RDF}type"), NamedNode("https://example.org/1")), "rdfxml"),
    "a control character": (Triple(S, P, Literal("a\x01b")), "rdfxml"),
    "a control character in a triple term": (Triple(S, P, Triple(S, P, Literal("\x01"))), "rdfxml"),
    "a triple term in JSON-LD": (Triple(S, P, Triple(S, P, S)), "jsonld"),
}


@pytest.mark.parametrize("case", UNFIT)
def test_what_a_format_cannot_represent_is_an_error(case: str) -> None:
    """KG504 names the triple and the formats that can represent it, in which it reads back."""
    triple, name = UNFIT[case]
    with pytest.raises(QueryError) as caught:
        serialized([Triple(S, P, S), triple], FORMATS[name], {})
    assert (caught.value.code, str(triple) in caught.value.message) == ("KG504", True)
    for other, rdf_format in FORMATS.items():
        if other in (caught.value.hint or ""):
            data = serialized([triple], rdf_format, {})
            assert [quad.triple for quad in pyoxigraph.parse(data, rdf_format)] == [triple], other
    assert name not in (caught.value.hint or "")


def test_n3_has_no_terms_of_rdf_12() -> None:
    """A triple term or a base direction in N3 is KG504, as its parsers reject both."""
    for value in (Triple(S, P, S), DIRECTED):
        with pytest.raises(QueryError, match="N3 cannot represent"):
            serialized([Triple(S, P, value)], RdfFormat.N3, {})


def test_labels_of_blank_nodes_are_names_in_xml() -> None:
    """Labels that begin with a digit are valid in RDF/XML, and different labels stay different."""
    nodes = [BlankNode(label) for label in ("1", "_1", "a1")]
    data = serialized([Triple(node, P, node) for node in nodes], RdfFormat.RDF_XML, {})
    quads = list(pyoxigraph.parse(data, RdfFormat.RDF_XML))
    assert len({quad.subject for quad in quads}) == len(nodes)
    assert all(quad.subject == quad.object for quad in quads)


def test_an_export_keeps_carriage_returns() -> None:
    """A carriage return reads back from RDF/XML, where a parser reads a bare one as a line feed."""
    store = pyoxigraph.Store()
    store.add(Quad(S, P, Literal("a\rb")))
    with MemorySnapshot(store) as snapshot:
        document = minidom.parseString(snapshot.dump(RdfFormat.RDF_XML))  # noqa: S318 - written here
    (element,) = document.getElementsByTagName("p")
    assert [child.nodeValue for child in element.childNodes] == ["a\rb"]


def test_an_export_names_the_triple(tmp_path: Path) -> None:
    """A dump of a store, of a graph or of everything, is refused like a query."""
    graph = NamedNode("https://example.org/g")
    store = EmbeddedStore.create(tmp_path / ".kg")
    with store.write("test") as transaction:
        transaction.append(graph, b"<urn:a> <urn:b/> <urn:c> .\n")
    with store.read() as snapshot:
        for one in (graph, None):
            with pytest.raises(QueryError, match=r"KG504.*<urn:b/>"):
                snapshot.dump(RdfFormat.RDF_XML, graph=one)
