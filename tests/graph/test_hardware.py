"""Tests of the content of ontology/hardware.ttl."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import ontologies
import pytest
from rdflib import RDF, RDFS, SKOS, Literal, Namespace, URIRef

if TYPE_CHECKING:
    from collections.abc import Iterable

RNKG = Namespace("https://w3id.org/rnkg/ns#")
HARDWARE = Namespace("https://w3id.org/rnkg/hardware#")
ONTOLOGY = ontologies.together("hardware")


def _all(of_class: URIRef) -> set[URIRef]:
    """Return the instances of a class."""
    return {each for each in ONTOLOGY.subjects(RDF.type, of_class) if isinstance(each, URIRef)}


KINDS, DEVICES = _all(RNKG.Hardware), _all(RNKG.Device)


def _general(thing: URIRef) -> set[URIRef]:
    """Return a kind or device with all broader ones."""
    return {each for each in ONTOLOGY.transitive_objects(thing, SKOS.broader) if isinstance(each, URIRef)}


def _recognized(things: Iterable[URIRef], relation: URIRef) -> dict[str, set[URIRef]]:
    """Return the kinds and devices recognised by each text."""
    told: dict[str, set[URIRef]] = {}
    for thing in things:
        for text in ONTOLOGY.objects(thing, relation):
            told.setdefault(str(text), set()).add(thing)
    return told


def test_there_are_enough() -> None:
    """The taxonomy has dozens of kinds, and more than 150 devices."""
    assert len(KINDS) > 60
    assert len(DEVICES) >= 150
    assert not KINDS & DEVICES


@pytest.mark.parametrize("relation", [RNKG.recognizedByTerm, RNKG.recognizedByWord])
def test_no_word_stands_for_two_kinds(relation: URIRef) -> None:
    """No two kinds, and no two devices, have a term or word in common unless one is broader."""
    for text, things in _recognized(KINDS | DEVICES, relation).items():
        for one, other in combinations(things, 2):
            assert one in _general(other) or other in _general(one), (text, one, other)


def test_every_device_has_a_kind_and_a_maker() -> None:
    """A device has one kind, one maker, and at least one recognised term."""
    for device in DEVICES:
        (kind,) = ONTOLOGY.objects(device, SKOS.broader)
        assert kind in KINDS, device
        (maker,) = ONTOLOGY.objects(device, RNKG.maker)
        assert str(maker), device
        assert (device, RNKG.recognizedByTerm, None) in ONTOLOGY, device


def test_every_kind_is_a_concept_below_a_top_concept() -> None:
    """Kinds and devices are in the scheme; their broader chains end at top concepts."""
    scheme = HARDWARE.scheme
    tops = {each for each in KINDS if (each, SKOS.topConceptOf, scheme) in ONTOLOGY}
    for thing in KINDS | DEVICES:
        assert (thing, RDF.type, SKOS.Concept) in ONTOLOGY
        assert (thing, SKOS.inScheme, scheme) in ONTOLOGY
        assert ONTOLOGY.value(thing, SKOS.prefLabel) == ONTOLOGY.value(thing, RDFS.label)
        assert len(_general(thing) & tops) == 1, thing
    assert all(not set(ONTOLOGY.objects(each, SKOS.broader)) for each in tops)


def test_labels_tell_things_apart() -> None:
    """No two kinds or devices have the same label."""
    labels = [str(ONTOLOGY.value(thing, RDFS.label)) for thing in KINDS | DEVICES]
    assert len(labels) == len(set(labels))


def test_terms_are_written_as_phrases_are() -> None:
    """Terms have one to four words in lower case, separated by single spaces; words of names have no space."""
    for term in ONTOLOGY.objects(None, RNKG.recognizedByTerm):
        assert str(term) == str(term).lower()
        assert str(term) == " ".join(str(term).split()[:4])
    for word in ONTOLOGY.objects(None, RNKG.recognizedByWord):
        assert str(word).isalnum(), word


@pytest.mark.parametrize(
    ("word", "kind"),
    [("depth", "depthCamera"), ("vehicle", "car"), ("kinematics", "arm")],
)
def test_words_of_many_devices_name_none(word: str, kind: str) -> None:
    """The depth of a submarine, a flying vehicle and the kinematics of a base are not devices of a kind."""
    assert HARDWARE[kind] not in _recognized(KINDS, RNKG.recognizedByWord).get(word, set())


@pytest.mark.parametrize("term", ["sensor", "motor", "led", "lidar", "cpu", "nvidia", "firmware", "end effector"])
def test_general_words_of_texts_name_no_hardware(term: str) -> None:
    """Texts use them for whatever a robot has; kinds with a name of their own are still recognised."""
    assert not set(ONTOLOGY.subjects(RNKG.recognizedByTerm, Literal(term)))
    assert set(ONTOLOGY.subjects(RNKG.recognizedByTerm, Literal("motor controller")))


def test_parts_of_other_data_name_no_sensor() -> None:
    """Motors and boards report a temperature, and commands can be wrenches."""
    assert not set(ONTOLOGY.subjects(RNKG.recognizedByField, Literal("temperature")))
    assert not set(ONTOLOGY.subjects(RNKG.recognizedByEndWord, Literal("wrench")))
