from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING
from uuid import uuid4

import pytest
from robot.connections import types_for_tests
from robot.live.seen import ADDRESS, ROVER, without

from kg.facts import Role
from kg.robot.capability import Way
from kg.robot.connecting import look
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live import infer
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from kg.settings import Settings


def test_the_graph_alone_tells_what_a_robot_can_do(settings: Settings) -> None:
    """Without any store, topics that nodes publish are readable, and those they subscribe to or serve are writable."""
    found = {one.name: one for one in infer(ROVER, settings, address=ADDRESS).capabilities}
    drive = found["drivingAtVelocity"]
    assert drive.modality == "write"
    assert [parameter.name for parameter in drive.parameters] == ["forward", "left", "up", "turn"]
    (way,) = drive.ways
    assert (way.kind, way.name, way.type, way.node) == ("topic", "/cmd_vel", "geometry_msgs/Twist", "/base")
    assert way.fields["forward"] == "linear.x"
    assert way.rate == 10
    assert found["sensingPose"].ways[0].fields["heading"] == "yaw(pose.pose.orientation)"
    assert found["goingToPose"].ways == (
        Way(
            kind="action",
            name="/move_base",
            type="move_base_msgs/MoveBase",
            node="/move_base",
            fields=found["goingToPose"].ways[0].fields,
            constants={"target_pose.header.frame_id": "map"},
        ),
    )
    assert found["knowingMap"].ways[0].kind == "service"


def test_node_topic_and_message_together_tell_what_a_message_alone_does_not(settings: Settings) -> None:
    """An empty message means take-off if its topic is named so."""
    found = {one.name: one for one in infer(ROVER, settings, address=ADDRESS).capabilities}
    assert [way.name for way in found["takingOff"].ways] == ["/takeoff"]
    assert "landing" not in found


def test_general_capabilities_follow_and_have_no_way_of_their_own(settings: Settings) -> None:
    """A general capability is present with the specific ones that imply it."""
    found = {one.name: one for one in infer(ROVER, settings, address=ADDRESS).capabilities}
    assert found["localizing"].ways == ()
    assert found["localizing"].implied_by == ("sensingPose",)
    assert found["sensingPose"].kinds == ("sensing", "localization")


def test_capabilities_are_those_of_the_nodes_that_run(settings: Settings) -> None:
    """Without its node the robot cannot be moved; nothing of an earlier graph remains."""
    names = {one.name for one in infer(without(ROVER, "/base"), settings, address=ADDRESS).capabilities}
    assert "takingOff" in names
    assert "drivingAtVelocity" not in names
    assert not infer(ComputationGraph(1), settings, address=ADDRESS).capabilities


@pytest.mark.parametrize(
    ("name", "known"),
    [
        ("/play_1796025656", {"sensingPose", "sensingVelocity"}),
        ("/rosbag2_player", {"sensingPose", "sensingVelocity"}),
        ("/record_1796025656", set()),
        ("/rosbag2_recorder", set()),
    ],
)
def test_what_a_player_plays_is_read(settings: Settings, name: str, known: set[str]) -> None:
    """Values of a recording that is played can be read, its player not commanded; a recorder has no capability."""
    ends = (
        LiveEnd(name, Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
        LiveEnd(name, Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
    )
    found = infer(ComputationGraph(1, (LiveNode(name, ADDRESS),), ends), settings, address=ADDRESS)
    assert {one.name for one in found.capabilities if one.ways} == known


def test_a_robot_in_memory_is_looked_at_as_any_other(settings: Settings) -> None:
    """A connection gives the graph, without our own node, and rules derive the capabilities."""
    with Bus(uuid4().hex, types=types_for_tests(1)) as bus:

        async def seen() -> ComputationGraph:
            base = bus.join("/base")
            await base.subscribe("/cmd_vel", "geometry_msgs/Twist")
            return await look(bus.address)

        graph = asyncio.run(seen())
        found = infer(graph, settings, address=bus.address)
    assert [node.name for node in graph.nodes] == ["/base"]
    assert found.of == bus.address
    assert "drivingAtVelocity" in {one.name for one in found.capabilities}
