from __future__ import annotations

import pytest
from robot.driving.rover import CAPABILITIES, DRIVING, SAYING

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.capability import Capability, Way
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.driving.ways import choose, find, named


@pytest.mark.parametrize(
    "name",
    ["drivingAtVelocity", "DRIVINGATVELOCITY", "Driving at a velocity", "driving", "moving", "driving-at-velocity"],
)
def test_a_capability_is_found_by_its_names(name: str) -> None:
    """The local name, the label and alternative labels name a capability, in any case."""
    assert find(CAPABILITIES, name).name == "drivingAtVelocity"


def test_an_almost_right_name_is_mended() -> None:
    """An unknown name is KG821 with suggestions, or without any, with the available ones."""
    with pytest.raises(RobotError) as refused:
        find(CAPABILITIES, "drivingAtVelocty")
    assert refused.value.code == "KG821"
    assert "drivingAtVelocity" in (refused.value.hint or "")
    with pytest.raises(RobotError) as refused:
        find(CAPABILITIES, "zzzz", "read")
    assert refused.value.hint == "It can: `laserScanning`, `sensingPose`, `measuring`."


def test_a_capability_is_read_or_done() -> None:
    """A capability available only in the other direction is KG822 with the right command."""
    with pytest.raises(RobotError) as refused:
        find(CAPABILITIES, "laserScanning", "write")
    assert refused.value.code == "KG822"
    assert "kg robot read laserScanning" in (refused.value.hint or "")


def test_a_way_is_named_by_what_it_is() -> None:
    """A way is named by its channel, with or without the slash, its node or its type; another name is KG822."""
    for name in ("/stamped", "stamped", "/flyer", "geometry_msgs/TwistStamped"):
        assert [one.name for one in named(DRIVING, name)] == ["/stamped"]
    with pytest.raises(RobotError) as refused:
        named(DRIVING, "/cmd_vle")
    assert refused.value.code == "KG822"
    assert "/cmd_vel" in (refused.value.hint or "")


def _graph(*topics: str, problem: str | None = None) -> ComputationGraph:
    ends = tuple(LiveEnd("/base", Role.SUBSCRIBES, topic, "x/Y") for topic in topics)
    return ComputationGraph(1, (LiveNode("/base", None, problem),), ends)


def test_the_way_that_is_alive_and_specific() -> None:
    """Order of ways: live first, then those that take the given arguments, then the most specific, then the first."""
    ways = named(DRIVING, None)
    assert choose(ways, (), _graph("/cmd_vel"), reads=False).name == "/cmd_vel"
    assert choose(ways, (), _graph("/cmd_vel", "/stamped"), reads=False).name == "/stamped"
    assert choose(ways, ("up",), _graph("/cmd_vel"), reads=False).name == "/cmd_vel"
    assert choose(ways, ("up",), None, reads=False).name == "/stamped"
    assert choose(ways, (), _graph("/cmd_vel", problem="dead"), reads=False).name == "/stamped"
    topic = Way(kind="topic", name="/goal", type="a/B", node="/n")
    action = Way(kind="action", name="/move", type="a/B", node="/n")
    assert choose([topic, action], (), None, reads=False) == action
    assert choose([action, topic], (), None, reads=True) == topic


def test_what_has_no_way_says_what_implies_it() -> None:
    """A general capability without a way names the specific ones that imply it."""
    general = Capability(iri="#f", name="flying", label="Flying", modality="write", implied_by=("takingOff",))
    with pytest.raises(RobotError) as refused:
        named(general, None)
    assert "takingOff" in refused.value.message
    assert named(SAYING, None)
