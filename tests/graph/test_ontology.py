from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from graph.samples import BUILD, FACTS, IRIS, REPOSITORY, loaded, rows, source_triples

from kg.errors import GraphError
from kg.graph.builds import build_triples
from kg.graph.ontology import check, classify, validate
from kg.graph.ontology_files import ONTOLOGIES, ontology_triples, shapes_file

EXAMPLES = tuple(sorted((Path(__file__).parent / "onto-ros").glob("*.ttl")))
HEAD = """
@prefix owl: <http://www.w3.org/2002/07/owl#> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix ros: <http://data.mksmart.org/onto-ros/class#> . @prefix : <urn:test:> .
: a owl:Ontology .
"""
DATA = source_triples(REPOSITORY, [FACTS], IRIS) + build_triples(BUILD, IRIS)

needs_java = pytest.mark.skipif(shutil.which("java") is None, reason="the OWL reasoner needs Java")


@pytest.fixture
def reasoner() -> None:
    """Skip if the reasoner is not installed."""
    pytest.importorskip("owlready2", reason="owlready2 is not installed: pip install 'kg-ros[ontology]'")


@pytest.fixture
def shacl() -> None:
    """Skip if the validator is not installed."""
    pytest.importorskip("pyshacl", reason="pyshacl is not installed: pip install 'kg-ros[ontology]'")


def written(folder: Path, name: str, text: str) -> Path:
    """Return the path of an ontology created for a test."""
    path = folder / name
    path.write_text(HEAD + text)
    return path


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_the_ontologies_are_consistent_alone_and_together() -> None:
    """HermiT finds no contradiction and no class without possible instances in each ontology, and in all of them."""
    checks = list(check())
    assert [[path.name for path in each.files] for each in checks] == [*([name] for name in ONTOLOGIES), [*ONTOLOGIES]]
    assert [each.error() for each in checks] == [None] * len(checks)


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_classes_properties_and_individuals_are_classified(tmp_path: Path) -> None:
    """Inferences from a file are returned, without its own statements and those from our ontologies alone."""
    path = written(
        tmp_path,
        "mine.ttl",
        """
        :drives a owl:ObjectProperty . :steers a owl:ObjectProperty ; owl:equivalentProperty :drives .
        :Wheeled a owl:Class . :Base a owl:Class . :Rover a owl:Class ; rdfs:subClassOf :Wheeled .
        :Wheeled owl:equivalentClass [ a owl:Restriction ; owl:onProperty :drives ; owl:someValuesFrom :Base ] .
        :spirit a owl:NamedIndividual ; :steers :ground . :ground a owl:NamedIndividual , :Base .
        """,
    )
    assert {str(each) for each in classify([path])} == {
        "<urn:test:spirit> <http://www.w3.org/1999/02/22-rdf-syntax-ns#type> <urn:test:Wheeled>"
    }


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_nothing_follows_from_a_contradiction(tmp_path: Path) -> None:
    """A contradiction is an error that explains how to find its file."""
    path = written(tmp_path, "odd.ttl", ":A a owl:Class . :B a owl:Class ; owl:disjointWith :A . :x a :A , :B .")
    with pytest.raises(GraphError) as caught:
        classify([path])
    assert caught.value.code == "KG602"
    assert "kg ontology check" in (caught.value.hint or "")


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_the_published_examples_and_what_kg_writes_are_consistent(tmp_path: Path) -> None:
    """The two examples of the paper, and the graph of a source, are consistent with the ontologies."""
    graph = tmp_path / "rover.nt"
    graph.write_bytes(DATA)
    *_, together = check([*EXAMPLES, graph])
    assert [path.name for path in together.files] == [*ONTOLOGIES, "cmd_vel.ttl", "map.ttl", "rover.nt"]
    assert together.good


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_a_component_of_node_and_communication_is_consistent_but_a_node_is_no_topic(tmp_path: Path) -> None:
    """Node and communication may both have `ros:hasComponent`; an entity that is both is inconsistent."""
    both = written(
        tmp_path,
        "both.ttl",
        ":n a ros:Node ; ros:hasComponent :p . :c a ros:TopicCommunication ; ros:hasComponent :p .",
    )
    wrong = written(tmp_path, "wrong.ttl", ":n a ros:Node, ros:Topic .")
    assert list(check([both]))[-1].good
    assert not list(check([wrong]))[-1].consistent


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_a_class_that_can_have_no_instance_is_named(tmp_path: Path) -> None:
    """A class below two disjoint ones is reported by its IRI."""
    path = written(
        tmp_path,
        "x.ttl",
        ":A a owl:Class ; owl:disjointWith :B . :B a owl:Class . :C a owl:Class ; rdfs:subClassOf :A, :B .",
    )
    outcome = next(check([path]))
    assert (outcome.consistent, outcome.unsatisfiable, outcome.good) == (True, ("urn:test:C",), False)
    error = outcome.error()
    assert error is not None
    assert str(error) == "KG602: x.ttl: no instance is possible of urn:test:C"


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_a_contradiction_is_reported(tmp_path: Path) -> None:
    """An individual of two disjoint classes makes an ontology inconsistent."""
    path = written(tmp_path, "x.ttl", ":A a owl:Class ; owl:disjointWith :B . :B a owl:Class . :i a :A, :B .")
    outcome = next(check([path]))
    error = outcome.error()
    assert not outcome.consistent
    assert error is not None
    assert (error.code, error.message) == ("KG602", "x.ttl: the axioms contradict each other")


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_what_the_reasoner_cannot_work_with_is_told(tmp_path: Path) -> None:
    """A value outside its data type is an error of the ontology, without a stack trace."""
    path = written(
        tmp_path, "x.ttl", ':p a owl:DatatypeProperty . :i :p "one"^^<http://www.w3.org/2001/XMLSchema#integer> .'
    )
    with pytest.raises(GraphError, match=r"the reasoner cannot work with it: .*one") as caught:
        next(check([path]))
    assert caught.value.code == "KG602"


@pytest.mark.java
@needs_java
@pytest.mark.usefixtures("reasoner")
def test_imports_are_not_followed(tmp_path: Path) -> None:
    """A dangling import needs no network and does no harm."""
    path = written(tmp_path, "x.ttl", ": owl:imports <http://nowhere.invalid/x> . :A a owl:Class .")
    assert next(check([path])).good


@pytest.mark.usefixtures("reasoner")
def test_without_java_the_error_says_so(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """KG603 is raised when no Java is found."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("JAVA_HOME", raising=False)
    with pytest.raises(GraphError) as caught:
        check()
    assert caught.value.code == "KG603"


def test_without_the_optional_part_the_error_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """KG605 is raised if owlready2 or pyshacl is not installed."""
    monkeypatch.setattr("kg.graph.ontology.find_spec", lambda _name: None)
    for ask in (check, lambda: validate(b"")):
        with pytest.raises(GraphError) as caught:
            ask()
        assert caught.value.code == "KG605"
        assert "kg-ros[ontology]" in (caught.value.hint or "")


@pytest.mark.usefixtures("shacl")
def test_what_kg_writes_conforms_to_the_shapes() -> None:
    """The graph of a source and of a build conforms."""
    assert validate(DATA) == ()


MISSING = {
    "<https://w3id.org/rnkg/ns#contains> <https://w3id.org/rnkg/node/": "it must be in exactly one package",
    "publisher/odom> <https://w3id.org/rnkg/ns#line>": "it must have exactly one line, counted from one",
    "publisher/odom> <https://w3id.org/rnkg/ns#resolution>": "it must have exactly one resolution of its name",
    "/port> <https://w3id.org/rnkg/ns#access>": "it must be read, written or declared",
    "<http://www.w3.org/ns/prov#endedAtTime>": "it must end once",
}
"""Removed triples, by a part of their line, and the resulting message of the shapes."""


@pytest.mark.usefixtures("shacl")
@pytest.mark.parametrize("without", MISSING)
def test_what_is_missing_is_found(without: str) -> None:
    """Removing one triple violates the shape that requires it."""
    lines = DATA.splitlines(keepends=True)
    kept = [line for line in lines if without.encode() not in line]
    assert len(kept) == len(lines) - 1
    assert MISSING[without] in {each.message for each in validate(b"".join(kept))}


@pytest.mark.usefixtures("shacl")
def test_a_type_has_the_form_package_and_type() -> None:
    """A message type without its package is reported, with code, thing and value."""
    findings = validate(DATA.replace(b'"nav_msgs/Odometry"', b'"Odometry"'))
    (found,) = [each for each in findings if each.value == '"Odometry"']
    assert found.focus == "<https://w3id.org/rnkg/message/nav_msgs/Odometry>"
    assert found.severity == "violation"
    assert str(found.error()).startswith("KG604: <https://w3id.org/rnkg/message/nav_msgs/Odometry>, ")


@pytest.mark.usefixtures("shacl")
def test_an_unresolved_name_connects_to_nothing() -> None:
    """A topic invented for an unresolved interface is reported."""
    part = "<https://w3id.org/rnkg/node/github.com/acme/rover/rover_base/driver#publisher/@unresolved>"
    guessed = f"{part} <https://w3id.org/rnkg/ns#connectsTo> <https://w3id.org/rnkg/topic/odom> .\n"
    assert [each.focus for each in validate(DATA + guessed.encode())] == [part]


@pytest.mark.usefixtures("shacl")
def test_data_that_does_not_parse_is_an_error() -> None:
    """Data other than N-Triples is an error."""
    with pytest.raises(GraphError) as caught:
        validate(b"<oops")
    assert caught.value.code == "KG601"


def test_the_shapes_are_there() -> None:
    """The shapes are part of the installation."""
    assert shapes_file().is_file()


def test_the_published_examples_answer() -> None:
    """Queries for the controller of the base and the source of the map work from node to node, by topic and service."""
    store = loaded(ontology_triples(EXAMPLES))
    query = """SELECT ?via ?message ?from ?to ?capability ?mode {
      { ?c ros:hasPublisher ?source ; ros:hasSubscriber ?target } UNION
      { ?c ros:hasServer ?source ; ros:hasClient ?target }
      ?c ros:isRoutedVia/rdfs:label ?via ; ros:hasMessage ?m . ?m rdfs:label ?message ; ros:evokes ?e .
      ?e rdfs:label ?capability ; ros:hasModality ?mode .
      ?a ros:hasComponent|ros:communicatesThrough ?source ; rdfs:label ?from .
      ?b ros:hasComponent|ros:communicatesThrough ?target ; rdfs:label ?to }"""
    onto = "http://data.mksmart.org/onto-ros/class#"
    assert rows(store, query) == [
        ("/cmd_vel", "geometry_msgs/Twist", "move_base", "kobuki_node", "movement", f"{onto}write"),
        ("/map", "nav_msgs/GetMap", "map_server", "move_base", "knowing the surroundings", f"{onto}read"),
    ]
