"""Tests of the coverage of the capability ontologies: every type of the packages, and complete capabilities."""

from __future__ import annotations

import re
from collections import defaultdict
from itertools import product
from pathlib import Path

import ontologies
import pytest
from rdflib import OWL, RDF, RDFS, SKOS, Namespace, URIRef

CAPABILITY = "https://w3id.org/rnkg/capability#"
ROS = Namespace("http://data.mksmart.org/onto-ros/class#")
RNKG = Namespace("https://w3id.org/rnkg/ns#")
ONTOLOGY = ontologies.together("capability")
EVOKING, EXCLUDED = (
    {str(name) for name in ONTOLOGY.objects(None, relation)} for relation in (RNKG.evokedBy, RNKG.excludes)
)
TYPES = [
    (kind, name)
    for kind, name in (
        line.split()
        for line in (Path(__file__).parent / "interface-types.txt").read_text("utf-8").splitlines()
        if not line.startswith("#")
    )
]
PARTS = {"msg": [""], "srv": [" request", " response"], "action": [" goal", " result", " feedback"]}
MADE_OF_ACTIONS = ["Action", "ActionGoal", "ActionResult", "ActionFeedback", "Goal", "Result", "Feedback"]
CAPABILITIES = sorted({URIRef(str(one)) for one in ONTOLOGY.subjects(ROS.hasModality)})
TOP = {URIRef(CAPABILITY + name) for name in ("Sensing", "Movement", "RobotKnowledge")}
KINDS = {URIRef(str(one)) for one in ONTOLOGY.subjects(RDFS.subClassOf) if (one, RDF.type, OWL.Class) in ONTOLOGY}


def test_the_list_of_types_is_whole() -> None:
    """The list names each type once, and includes the expected ones of every package."""
    assert len(TYPES) == len(set(TYPES)) > 600
    packages = {name.partition("/")[0] for _, name in TYPES}
    assert packages >= {
        *("actionlib_msgs", "diagnostic_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "shape_msgs", "stereo_msgs"),
        *("trajectory_msgs", "visualization_msgs", "std_msgs", "std_srvs", "control_msgs", "move_base_msgs"),
        *("nav2_msgs", "tf", "tf2_msgs", "vision_msgs", "ar_track_alvar_msgs", "ar_pose", "apriltag_ros"),
        *("apriltag_msgs", "aruco_msgs", "aruco_opencv_msgs", "fiducial_msgs", "moveit_msgs", "mavros_msgs"),
        *("object_recognition_msgs", "ardrone_autonomy", "tello_msgs", "tello_driver", "map_msgs", "octomap_msgs"),
        *("rosgraph_msgs", "geographic_msgs", "lifecycle_msgs"),
    }


@pytest.mark.parametrize("package", sorted({name.partition("/")[0] for _, name in TYPES}))
def test_every_type_evokes_a_capability_or_is_excluded_with_a_reason(package: str) -> None:
    """Each type of a package, of ROS 1 or ROS 2, either evokes a capability or is excluded."""
    for kind, name in (each for each in TYPES if each[1].startswith(f"{package}/")):
        evokes = any(f"{name}{part}" in EVOKING for part in PARTS[kind])
        assert evokes or name in EXCLUDED, (kind, name)


def test_every_message_that_an_action_makes_in_ros_1_is_known() -> None:
    """The messages on the hidden topics of actions of ROS 1 evoke a capability or are excluded."""
    actions = [name for kind, name in TYPES if kind == "action"]
    assert not {f"{name}{end}" for name, end in product(actions, MADE_OF_ACTIONS)} - EVOKING - EXCLUDED


def test_no_message_is_both_evoking_and_excluded() -> None:
    """A type that evokes a capability is not excluded."""
    assert not EVOKING & EXCLUDED


def test_what_is_named_exists() -> None:
    """Every type named by the ontologies is in the list, with a kind that has such a part."""
    actions = [name for kind, name in TYPES if kind == "action"]
    known = {f"{name}{part}" for kind, name in TYPES for part in PARTS[kind]}
    known |= {name for _, name in TYPES} | {f"{name}{end}" for name, end in product(actions, MADE_OF_ACTIONS)}
    assert EVOKING - known <= {"apriltags2_ros/AprilTagDetectionArray"}
    assert not EXCLUDED - known


@pytest.mark.parametrize("capability", CAPABILITIES, ids=lambda one: str(one).removeprefix(CAPABILITY))
def test_every_capability_is_whole(capability: URIRef) -> None:
    """It has one modality, one class below one of the three, texts, and implies capabilities of its modality."""
    (modality,) = ONTOLOGY.objects(capability, ROS.hasModality)
    implied = list(ONTOLOGY.objects(capability, RNKG.impliesCapability))
    assert all((general, ROS.hasModality, modality) in ONTOLOGY for general in implied)
    (kind,) = set(ONTOLOGY.objects(capability, RDF.type)) - {OWL.NamedIndividual, ROS.Capability}
    assert len(set(ONTOLOGY.transitive_objects(kind, RDFS.subClassOf)) & TOP) == 1
    (label,) = ONTOLOGY.objects(capability, RDFS.label)
    alternatives = {str(one) for one in ONTOLOGY.objects(capability, SKOS.altLabel)}
    assert alternatives
    assert str(label) not in alternatives
    assert re.fullmatch(r"[a-z][A-Za-z]+", str(capability).removeprefix(CAPABILITY))


def test_labels_tell_capabilities_apart() -> None:
    """No two capabilities have the same label, and none has that of another as its alternative label."""
    labels = {str(label): one for one in CAPABILITIES for label in ONTOLOGY.objects(one, RDFS.label)}
    assert len(labels) == len(CAPABILITIES) > 100
    others = [(str(word), one) for one in CAPABILITIES for word in ONTOLOGY.objects(one, SKOS.altLabel)]
    assert [word for word, one in others if labels.get(word, one) != one] == []


@pytest.mark.parametrize("kind", sorted(KINDS), ids=lambda one: str(one).removeprefix(CAPABILITY))
def test_every_class_of_capabilities_is_described(kind: URIRef) -> None:
    """It has a label, a comment and an alternative label."""
    for told in (RDFS.label, RDFS.comment, SKOS.altLabel):
        assert ONTOLOGY.value(kind, told), told


def test_the_documentation_counts_right() -> None:
    """docs/capabilities.md has the right numbers of evoking and other types for each package."""
    page = (Path(__file__).parents[2] / "docs" / "capabilities.md").read_text("utf-8")
    counts: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0])
    for kind, name in TYPES:
        evokes = any(f"{name}{part}" in EVOKING for part in PARTS[kind])
        counts[name.partition("/")[0]][0 if evokes else 1] += 1
    for package, (evoking, none) in counts.items():
        assert f"| {package} | {evoking} | {none} |" in page
    assert f"{len(counts)} packages" in page
    assert f"{len(TYPES)} types" in page
    assert f"{len(CAPABILITIES)} capabilities" in page
