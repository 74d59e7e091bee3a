from __future__ import annotations

import string
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyoxigraph import RdfFormat, Store

from kg.graph.ontology_files import ontology_triples
from kg.robot.capabilities import Definition, definitions
from kg.robot.capability import Capability, Way
from kg.robot.driving.paths import parse, type_at
from kg.robot.messages import Types
from kg.store.snapshot import MemorySnapshot

_PREFIXES = """
@prefix : <https://w3id.org/rnkg/capability#> .
@prefix rnkg: <https://w3id.org/rnkg/ns#> .
@prefix ros: <http://data.mksmart.org/onto-ros/class#> .
@prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .
@prefix skos: <http://www.w3.org/2004/02/skos/core#> .
"""
_HOPPING = """
:Movement rdfs:subClassOf ros:Capability ; rdfs:label "movement" .
:Jumping rdfs:subClassOf :Movement ; rdfs:label "jumping" .
:hopping a :Jumping ; ros:hasModality ros:write ; rdfs:label "hop" ; skos:altLabel "jump" ; rnkg:renewedEvery 0.5 ;
    rnkg:movedPart "legs" ;
    rnkg:constantField "a_msgs/Hop mode = 2", "a_msgs/Hop frame = map", "a_msgs/Jump request sure = true" ;
    rnkg:hasParameter :height, :way .
:height a rnkg:CapabilityParameter ; rnkg:name "height" ; rdfs:label "how high" ; rnkg:order 2 ; rnkg:unit "m" ;
    rnkg:parameterKind "number" ; rnkg:defaultValue 0.5 ; rnkg:minimum 0.0 ; rnkg:maximum 2.0 ;
    rnkg:field "a_msgs/Hop size.z", "a_msgs/Jump request height" .
:way a rnkg:CapabilityParameter ; rnkg:name "way" ; rnkg:order 1 ; rnkg:parameterKind "text" ; rnkg:defaultValue "1" ;
    rnkg:choice "1", "2" .
"""
_PAIRS = """
SELECT DISTINCT ?context ?capability ?type WHERE {
    ?context rnkg:contextMessage ?type ; rnkg:suggests ?capability .
}
"""
_SENT = {"write": ("", "_Request", "_Goal"), "read": ("", "_Response", "_Result", "_Feedback")}


def _read(text: str) -> dict[str, Definition]:
    store = Store()
    store.load(f"{_PREFIXES}{text}".encode(), RdfFormat.TURTLE)
    return {one.described.name: one for one in definitions(MemorySnapshot(store)).values()}


def test_a_capability_is_read_with_its_parameters() -> None:
    """Kinds start with the most general, parameters are in order, with units, limits and typed defaults."""
    hopping = _read(_HOPPING)["hopping"]
    described = hopping.described
    assert (described.label, described.alternatives, described.modality) == ("hop", ("jump",), "write")
    assert described.kinds == ("movement", "jumping")
    assert (hopping.rate, hopping.capability().moves) == (2, "legs")
    way, height = described.parameters
    assert (way.name, way.type, way.default, way.choices) == ("way", "text", "1", ("1", "2"))
    assert (height.label, height.unit, height.default, height.minimum, height.maximum) == ("how high", "m", 0.5, 0, 2)


def test_fields_and_constants_are_those_of_the_message() -> None:
    """Only the paths of a message, or of one part of a service, are used."""
    hopping = _read(_HOPPING)["hopping"]
    assert hopping.fields_of(frozenset({"a_msgs/Hop"})) == {"height": "size.z"}
    assert hopping.fields_of(frozenset({"a_msgs/Jump request"})) == {"height": "height"}
    assert hopping.constants_of(frozenset({"a_msgs/Hop"})) == {"mode": 2, "frame": "map"}
    assert hopping.constants_of(frozenset({"a_msgs/Jump request"})) == {"sure": True}
    assert not hopping.fields_of(frozenset({"a_msgs/Other"}))


def test_a_service_named_as_a_whole_has_the_fields_of_the_part_that_is_sent() -> None:
    """For a service without a part, a command fills its request, and nothing of its response."""
    hopping = _read(
        _HOPPING.replace('"a_msgs/Jump request height"', '"a_msgs/Jump response x", "a_msgs/Jump request y"')
    )
    whole = frozenset({"a_msgs/Jump"})
    assert hopping["hopping"].fields_of(whole) == {"height": "y"}
    assert hopping["hopping"].constants_of(whole) == {"sure": True}


def _every_pair() -> list[tuple[str, str, str]]:
    store = Store()
    store.bulk_load(ontology_triples(), RdfFormat.N_TRIPLES)
    prefixes = _PREFIXES.replace("@prefix", "PREFIX").replace(" .\n", "\n")
    rows: Any = store.query(prefixes + _PAIRS)
    return sorted(tuple(row[name].value for name in ("context", "capability", "type")) for row in rows)


@pytest.fixture(scope="module")
def shipped() -> dict[str, Definition]:
    """The capabilities of the shipped ontologies."""
    store = Store()
    store.bulk_load(ontology_triples(), RdfFormat.N_TRIPLES)
    return definitions(MemorySnapshot(store))


@pytest.mark.parametrize("ros", [1, 2])
def test_what_a_context_suggests_names_fields_of_its_messages(shipped: dict[str, Definition], ros: int) -> None:
    """For every context, message and suggested capability, each path exists in a type known to kg."""
    types = Types(ros)
    reached = []
    for context, capability, name in _every_pair():
        definition = shipped[capability]
        paths = [*definition.fields_of(frozenset({name})).values(), *definition.constants_of(frozenset({name}))]
        sent = [name + part for part in _SENT[definition.described.modality] if types.has(name + part)]
        for path in paths:
            assert " " not in path, (context, capability, name)
            if sent:
                type_at(parse(path), types, sent[0])
                reached.append(name)
    assert "std_msgs/Bool" in reached
    assert "std_srvs/SetBool" in reached


def test_parameters_are_those_that_a_way_has_a_field_for() -> None:
    """A parameter without a field in a robot's ways is left out; without ways, all are present."""
    hopping = _read(_HOPPING)["hopping"]
    fields = hopping.fields_of(frozenset({"a_msgs/Hop"}))
    by_topic = Way(kind="topic", name="/hop", type="a_msgs/Hop", node="/legs", fields=fields)
    by_signal = Way(kind="topic", name="/hop_now", type="std_msgs/Empty", node="/legs")
    assert [one.name for one in hopping.capability().parameters] == ["way", "height"]
    assert [one.name for one in hopping.capability(ways=(by_topic, by_signal)).parameters] == ["height"]
    assert not hopping.capability(ways=(by_signal,)).parameters


def test_classes_in_a_circle_end() -> None:
    """A cycle of subclasses does no harm."""
    text = """
    :A rdfs:subClassOf :B, ros:Capability ; rdfs:label "a" . :B rdfs:subClassOf :A ; rdfs:label "b" .
    :x a :A ; ros:hasModality ros:read ; rdfs:label "x" .
    """
    assert _read(text)["x"].described.kinds == ("b", "a")


@given(st.text(string.printable, max_size=20))
def test_any_text_may_stand_for_a_constant(text: str) -> None:
    """JSON is parsed as such, other text is taken literally; nothing raises."""
    described = Capability(iri="urn:x", name="x", label="x", modality="write")
    definition = Definition(described, fields={}, constants=(f"a/B field = {text}",), implied=(), rate=0)
    (value,) = definition.constants_of(frozenset({"a/B"})).values()
    assert isinstance(value, bool | int | float | str)


def test_every_capability_that_kg_brings_can_be_read(shipped: dict[str, Definition]) -> None:
    """Each has a label, a modality, a kind, and parameters with different names."""
    assert len(shipped) > 50
    for one in (definition.described for definition in shipped.values()):
        assert one.label
        assert one.modality in {"read", "write"}
        assert one.kinds[0] in {"sensing", "movement", "robot knowledge"}
        names = [parameter.name for parameter in one.parameters]
        assert len(names) == len(set(names))
