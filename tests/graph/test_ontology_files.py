from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from graph.samples import loaded, rows, true

from kg import resources
from kg.errors import GraphError
from kg.graph.ontology_files import ONTOLOGIES, default_ontologies, ontologies_in_force, ontology_triples
from kg.settings import load

if TYPE_CHECKING:
    from pathlib import Path

CLASS = "@prefix owl: <http://www.w3.org/2002/07/owl#> . <urn:x:A> a owl:Class ; owl:disjointWith [ a owl:Class ] ."


def test_the_ontologies_are_the_same_bytes_every_time() -> None:
    """Reading the ontologies twice gives the same N-Triples, blank nodes included."""
    assert ontology_triples() == ontology_triples()
    assert true(loaded(ontology_triples()), "rnkg:NodeType rdfs:subClassOf ros:Node")


def test_blank_nodes_of_two_files_stay_apart(tmp_path: Path) -> None:
    """Blank nodes of one file differ from those of another."""
    for name in ("a.ttl", "b.ttl"):
        (tmp_path / name).write_text(CLASS.replace("urn:x:A", f"urn:x:{name}"))
    store = loaded(ontology_triples([tmp_path / "a.ttl", tmp_path / "b.ttl"]))
    assert len(rows(store, "SELECT DISTINCT ?b { ?a owl:disjointWith ?b }")) == 2


@pytest.mark.parametrize(
    ("name", "text"), [("x.ttl", "<a> <b> ."), ("x.rdf", "<rdf"), ("x.csv", ""), ("missing.ttl", None)]
)
def test_a_file_that_cannot_be_read_is_named(tmp_path: Path, name: str, text: str | None) -> None:
    """Malformed, unknown and missing files are errors with the place."""
    if text is not None:
        (tmp_path / name).write_text(text)
    with pytest.raises(GraphError) as caught:
        ontology_triples([tmp_path / name])
    assert caught.value.code == "KG601"
    assert caught.value.place is not None
    assert caught.value.place.path.endswith(name)


def test_a_syntax_error_has_its_line(tmp_path: Path) -> None:
    """The error has the line."""
    path = tmp_path / "x.ttl"
    path.write_text("<urn:a> <urn:b> <urn:c> .\n<urn:a> oops .\n")
    with pytest.raises(GraphError) as caught:
        ontology_triples([path])
    assert caught.value.place is not None
    assert caught.value.place.line == 2


def test_the_ontologies_are_there() -> None:
    """The ontologies are part of the installation."""
    assert [path.name for path in default_ontologies() if path.is_file()] == list(ONTOLOGIES)


def test_the_last_file_replaces_the_value_of_a_setting(tmp_path: Path) -> None:
    """A weight in a later file replaces the earlier one; other properties keep all their values."""
    prefix = "@prefix rnkg: <https://w3id.org/rnkg/ns#> ."
    (tmp_path / "mine.ttl").write_text(f'{prefix} <urn:sign> rnkg:weight 2 ; rnkg:recognizedByWord "laser" .')
    (tmp_path / "more.ttl").write_text(f'{prefix} <urn:sign> rnkg:weight 5 ; rnkg:recognizedByWord "lidar" .')
    store = loaded(ontology_triples([*default_ontologies(), tmp_path / "mine.ttl", tmp_path / "more.ttl"]))
    assert rows(store, "SELECT ?weight { <urn:sign> rnkg:weight ?weight }") == [("5",)]
    assert len(rows(store, "SELECT ?word { <urn:sign> rnkg:recognizedByWord ?word }")) == 2


def test_ontologies_of_the_user_come_last(tmp_path: Path) -> None:
    """The setting names folders and files; a folder gives its RDF files by name, and the shipped one nothing."""
    for name in ("b.ttl", "a.ttl", "notes.md"):
        (tmp_path / name).write_text("")
    settings = load({"ontology": f"{tmp_path}{os.pathsep}{resources.folder('ontology')}"}, environment={})
    assert ontologies_in_force(settings) == (*default_ontologies(), tmp_path / "a.ttl", tmp_path / "b.ttl")
