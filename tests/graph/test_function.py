"""Tests of the content of ontology/function.ttl."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import ontologies
import pytest
from rdflib import RDF, RDFS, Literal, Namespace

if TYPE_CHECKING:
    from rdflib.term import Node

RNKG: Final = Namespace("https://w3id.org/rnkg/ns#")
ONTOLOGY: Final = ontologies.named()["function"]
SIGNS: Final = sorted(set(ONTOLOGY.subjects(RDF.type, RNKG.Sign)), key=str)
FUNCTIONS: Final = set(ONTOLOGY.subjects(RDF.type, RNKG.Function))


def _weights(sign: Node) -> list[int]:
    return [int(str(weight)) for weight in ONTOLOGY.objects(sign, RNKG.weight)]


def test_every_sign_has_one_weight_for_one_function() -> None:
    """Two signs of one name would be merged, with both weights for the words of both."""
    assert len(SIGNS) > 2 * len(FUNCTIONS)
    for sign in SIGNS:
        assert len(_weights(sign)) == 1, sign
        assert len(list(ONTOLOGY.objects(sign, RDFS.label))) == 1, sign
        assert len(FUNCTIONS.intersection(ONTOLOGY.objects(sign, RNKG.indicates))) == 1, sign


def test_every_function_has_a_sign_for_it() -> None:
    """A function without a sign could never be inferred."""
    positive = [sign for sign in SIGNS if min(_weights(sign)) > 0]
    assert {one for sign in positive for one in ONTOLOGY.objects(sign, RNKG.indicates)} == FUNCTIONS


@pytest.mark.parametrize(
    ("relation", "word"),
    [
        (RNKG.recognizedByPassed, "geometry_msgs/PoseStamped"),
        (RNKG.recognizedByPassed, "std_msgs/String"),
        (RNKG.recognizedByShape, "source"),
        (RNKG.recognizedByImport, "image_geometry"),
    ],
)
def test_what_nodes_of_all_functions_have_is_no_sign(relation: Node, word: str) -> None:
    """Nodes pass poses and texts on, or publish without any input, whatever they are for."""
    assert not list(ONTOLOGY.subjects(relation, Literal(word)))


@pytest.mark.parametrize(
    ("relation", "word", "function"),
    [
        (RNKG.recognizedByImport, "gphoto2", "hardware"),
        (RNKG.recognizedByImport, "uavcan", "hardware"),
        (RNKG.recognizedByImport, "onnxruntime", "analysisAndDetection"),
        (RNKG.recognizedByBaseClass, "gazebo_ros2_control::GazeboSystemInterface", "simulation"),
        (RNKG.recognizedByBaseClass, "nav_core2::GlobalPlanner", "navigation"),
    ],
)
def test_libraries_and_base_classes_decide(relation: Node, word: str, function: str) -> None:
    """A library or base class with one purpose is at least a good sign of that function."""
    (sign,) = ONTOLOGY.subjects(relation, Literal(word))
    assert str(ONTOLOGY.value(sign, RNKG.indicates)).endswith(f"#{function}")
    assert _weights(sign)[0] >= 3


def test_keys_read_in_a_terminal_are_a_weak_sign() -> None:
    """Monitors use such libraries too, so they do not decide alone."""
    for word in ("curses", "pynput", "termios"):
        assert [_weights(sign) for sign in ONTOLOGY.subjects(RNKG.recognizedByImport, Literal(word))] == [[2]]
