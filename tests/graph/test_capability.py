"""Tests of what ontology/capability.ttl covers."""

from __future__ import annotations

import tomllib

import pytest
from rdflib import RDF, Graph, Namespace, URIRef

from kg.resources import folder

ROS = Namespace("http://data.mksmart.org/onto-ros/class#")
RNKG = Namespace("https://w3id.org/rnkg/ns#")
ONTOLOGY = Graph().parse(folder("ontology") / "capability.ttl")
STANDARD = tomllib.loads((folder("ontology") / "standard_messages.toml").read_text("utf-8"))
EVOKING, EXCLUDED = (
    {str(name) for name in ONTOLOGY.objects(None, relation)} for relation in (RNKG.evokedBy, RNKG.excludes)
)


@pytest.mark.parametrize("package", ["geometry_msgs", "sensor_msgs", "nav_msgs", "std_msgs"])
def test_every_message_evokes_a_capability_or_is_excluded_with_a_reason(package: str) -> None:
    """No message type of the four packages, of ROS 1 or ROS 2, was forgotten, and none is both."""
    assert {f"{package}/{name}" for name in STANDARD[package]} <= EVOKING ^ EXCLUDED


def test_no_message_is_both() -> None:
    """What evokes a capability is not excluded."""
    assert not EVOKING & EXCLUDED


def test_every_capability_has_one_modality() -> None:
    """A capability is read from the robot or written to it; those that it implies have the same modality."""
    capabilities = set(ONTOLOGY.subjects(ROS.hasModality))
    assert len(capabilities) > 40
    for capability in capabilities:
        (modality,) = ONTOLOGY.objects(capability, ROS.hasModality)
        implied = ONTOLOGY.objects(capability, RNKG.impliesCapability)
        assert {*ONTOLOGY.objects(capability, RDF.type)} & set(CLASSES)
        assert all((general, ROS.hasModality, modality) in ONTOLOGY for general in implied), capability


CLASSES = tuple(
    URIRef(f"https://w3id.org/rnkg/capability#{name}")
    for name in (
        *("Sensing", "Vision", "Ranging", "Localization", "MotionSensing", "BodySensing", "ForceSensing"),
        *("EnvironmentSensing", "OperatorSensing", "Movement", "Locomotion", "Actuation", "RobotKnowledge"),
        *("MapKnowledge", "PlanKnowledge", "SpaceKnowledge", "BodyKnowledge", "TimeKnowledge"),
    )
)
