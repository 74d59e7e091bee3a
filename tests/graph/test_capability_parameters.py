"""Tests of the parameters of capabilities: their paths, their units, and the messages with their fields."""

from __future__ import annotations

from collections import defaultdict

import ontologies
import pytest
from rdflib import RDF, Namespace, URIRef

from kg.robot.driving.paths import FUNCTIONS, Call, Each, Element, Field, parse
from kg.robot.messages.types import Types
from kg.robot.programs.units import UNITS

CAPABILITY = "https://w3id.org/rnkg/capability#"
ROS = Namespace("http://data.mksmart.org/onto-ros/class#")
RNKG = Namespace("https://w3id.org/rnkg/ns#")
ONTOLOGY = ontologies.together("capability")
PARAMETERS = sorted(map(URIRef, map(str, ONTOLOGY.subjects(RDF.type, RNKG.CapabilityParameter))))
PARTS = {"request", "response", "goal", "result", "feedback"}
KINDS = {"number", "integer", "boolean", "text", "list"}


def placed(text: str) -> tuple[str, str]:
    """Return the name of the message, with its part, and the path of a place."""
    words = text.split(" ")
    length = 2 if len(words) > 2 and words[1] in PARTS else 1
    return " ".join(words[:length]), " ".join(words[length:])


def standing() -> dict[str, set[str]]:
    """Return the messages for each capability, directly or in a context."""
    found: defaultdict[str, set[str]] = defaultdict(set)
    for capability, name in ONTOLOGY.subject_objects(RNKG.evokedBy):
        found[str(capability)].add(str(name))
    for context, capability in ONTOLOGY.subject_objects(RNKG.suggests):
        for name in ONTOLOGY.objects(context, RNKG.contextMessage):
            found[str(capability)] |= {str(name), f"{name} request"}
    return found


STANDING = standing()


def functions(path: object) -> set[str]:
    """Return the names of the functions in a path."""
    if isinstance(path, Call):
        return {path.function}.union(*map(functions, path.arguments))
    return functions(path.of) if isinstance(path, Field | Each | Element) else set()


def test_the_capabilities_that_everybody_uses_have_their_parameters() -> None:
    """The names used by programs and simulated robots exist."""
    names: defaultdict[str, set[str]] = defaultdict(set)
    for capability, parameter in ONTOLOGY.subject_objects(RNKG.hasParameter):
        names[str(capability).removeprefix(CAPABILITY)] |= {str(one) for one in ONTOLOGY.objects(parameter, RNKG.name)}
    assert names["drivingAtVelocity"] == {"forward", "left", "up", "turn"}
    assert names["goingToPose"] == names["sensingPose"] == {"x", "y", "z", "heading"}
    assert names["laserScanning"] >= {"nearest", "ahead", "left", "right"}
    assert names["recognizingTags"] >= {"count", "tag", "distance", "x", "y", "z", "tags"}
    assert names["knowingMap"] == {"width", "height", "resolution"}
    assert names["sensingBattery"] >= {"charge", "voltage"}
    assert len(PARAMETERS) > 150


@pytest.mark.parametrize(
    "parameter",
    [
        *(f"{capability}-{name}" for capability in ("goingToPose", "goingToPoint", "beingToldPose") for name in "xy"),
        *(f"goingToGeographicPoint-{name}" for name in ("latitude", "longitude", "altitude")),
        *("turning-heading", "movingJoints-position"),
    ],
)
def test_where_to_is_never_a_default(parameter: str) -> None:
    """A missing place defaults neither to the origin of the map nor to that of the globe."""
    assert URIRef(CAPABILITY + parameter) in PARAMETERS
    assert ONTOLOGY.value(URIRef(CAPABILITY + parameter), RNKG.defaultValue) is None


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda one: str(one).removeprefix(CAPABILITY))
def test_every_parameter_is_whole(parameter: URIRef) -> None:
    """It belongs to one capability, has a kind, a known unit, and fields of messages for the capability."""
    (capability,) = ONTOLOGY.subjects(RNKG.hasParameter, parameter)
    (name,) = ONTOLOGY.objects(parameter, RNKG.name)
    assert str(parameter) == f"{capability}-{name}"
    assert {str(kind) for kind in ONTOLOGY.objects(parameter, RNKG.parameterKind)} <= KINDS
    assert {str(unit) for unit in ONTOLOGY.objects(parameter, RNKG.unit)} <= set(UNITS)
    fields = [placed(str(field)) for field in ONTOLOGY.objects(parameter, RNKG.field)]
    assert fields
    assert {message for message, _ in fields} <= STANDING[str(capability)]
    for _, path in fields:
        assert functions(parse(path)) <= set(FUNCTIONS), path


def test_what_is_written_can_be_written() -> None:
    """The fields of a written capability use only functions with an inverse, or none."""
    for capability, parameter in ONTOLOGY.subject_objects(RNKG.hasParameter):
        if (capability, ROS.hasModality, ROS.write) in ONTOLOGY:
            for field in ONTOLOGY.objects(parameter, RNKG.field):
                used = functions(parse(placed(str(field))[1]))
                assert all(FUNCTIONS[one].write for one in used), field


def test_constants_are_of_messages_that_stand_for_the_capability() -> None:
    """A constant is a place, an equals sign and a value."""
    for capability, constant in ONTOLOGY.subject_objects(RNKG.constantField):
        place, equals, value = str(constant).partition(" = ")
        assert equals
        assert value
        assert placed(place)[0] in STANDING[str(capability)]


def test_first_fields_exist_in_the_types_that_are_known() -> None:
    """If the definition of a message is known, the path starts with one of its fields."""
    versions = [Types(1), Types(2)]
    for field in ONTOLOGY.objects(None, RNKG.field):
        message, path = placed(str(field))
        step: object = parse(path)
        while isinstance(step, Call | Each | Element) or (isinstance(step, Field) and step.of is not None):
            step = step.arguments[0] if isinstance(step, Call) else step.of
        known = [types.fields(message) for types in versions if " " not in message and types.has(message)]
        assert isinstance(step, Field)
        assert not known or any(step.name in {one.name for one in fields} for fields in known), field
