from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from graph.samples import loaded, rows, true

from kg.errors import GraphError
from kg.graph.ontology_files import ONTOLOGIES, default_ontologies, ontology_triples

if TYPE_CHECKING:
    from pathlib import Path

CLASS = "@prefix owl: <http://www.w3.org/2002/07/owl#> . <urn:x:A> a owl:Class ; owl:disjointWith [ a owl:Class ] ."


def test_the_ontologies_are_the_same_bytes_every_time() -> None:
    """Reading the ontologies twice gives the same N-Triples, blank nodes included."""
    assert ontology_triples() == ontology_triples()
    assert true(loaded(ontology_triples()), "rnkg:NodeType rdfs:subClassOf ros:Node")


def test_blank_nodes_of_two_files_stay_apart(tmp_path: Path) -> None:
    """The nameless things of one file are not those of another."""
    for name in ("a.ttl", "b.ttl"):
        (tmp_path / name).write_text(CLASS.replace("urn:x:A", f"urn:x:{name}"))
    store = loaded(ontology_triples([tmp_path / "a.ttl", tmp_path / "b.ttl"]))
    assert len(rows(store, "SELECT DISTINCT ?b { ?a owl:disjointWith ?b }")) == 2


@pytest.mark.parametrize(
    ("name", "text"), [("x.ttl", "<a> <b> ."), ("x.rdf", "<rdf"), ("x.csv", ""), ("missing.ttl", None)]
)
def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, name: str, text: str | None) -> None:
    """Malformed, unknown and missing files are errors with the place of the fault."""
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(GraphError) as caught:
        ontology_triples([tmp_path / name])
    assert caught.value.code == "KG601"
    assert caught.value.place is not None
    assert caught.value.place.path.endswith(name)


def test_a_syntax_error_has_its_line(tmp_path: Path) -> None:
    """The line of the fault is told."""
    path = tmp_path / "x.ttl"
    path.write_text("<urn:a> <urn:b> <urn:c> .\n<urn:a> oops .\n")
    with pytest.raises(GraphError) as caught:
        ontology_triples([path])
    assert caught.value.place is not None
    assert caught.value.place.line == 2


def test_the_ontologies_are_there() -> None:
    """The ontologies belong to the installation."""
    assert [path.name for path in default_ontologies() if path.is_file()] == list(ONTOLOGIES)
