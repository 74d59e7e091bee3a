"""Tests of the capabilities inferred for whole systems: a drone, an office robot, and tools."""

from __future__ import annotations

from typing import Final

import pytest

from kg.facts import Role
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live.inference import infer
from kg.settings import load

P, S, SERVICE, ACTION = Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES, Role.ACTION_SERVERS
DRONE: Final = (
    ("/ardrone_driver", P, "/ardrone/odometry", "nav_msgs/Odometry"),
    ("/ardrone_driver", P, "/ardrone/image_raw", "sensor_msgs/Image"),
    ("/ardrone_driver", S, "/ardrone/takeoff", "std_msgs/Empty"),
    ("/ardrone_driver", S, "/ardrone/land", "std_msgs/Empty"),
    ("/ardrone_driver", S, "/ardrone/reset", "std_msgs/Empty"),
    ("/ardrone_driver", S, "/cmd_vel", "geometry_msgs/Twist"),
    ("/ar_track_alvar", P, "/ar_pose_marker", "ar_track_alvar_msgs/AlvarMarkers"),
    ("/rviz_1699", P, "/initialpose", "geometry_msgs/PoseWithCovarianceStamped"),
    ("/record_1699999999", S, "/ardrone/trajectory", "trajectory_msgs/JointTrajectory"),
)
OFFICE: Final = (
    ("/base", S, "/cmd_vel", "geometry_msgs/Twist"),
    ("/base", P, "/odom", "nav_msgs/Odometry"),
    ("/laser", P, "/scan", "sensor_msgs/LaserScan"),
    ("/amcl", S, "/initialpose", "geometry_msgs/PoseWithCovarianceStamped"),
    ("/amcl", P, "/particlecloud", "geometry_msgs/PoseArray"),
    ("/map_server", SERVICE, "/static_map", "nav_msgs/GetMap"),
    ("/move_base", ACTION, "/move_base", "move_base_msgs/MoveBase"),
    ("/move_base", P, "/move_base/current_goal", "geometry_msgs/PoseStamped"),
    ("/move_base", SERVICE, "/move_base/clear_costmaps", "std_srvs/Empty"),
    ("/odometer", S, "/reset", "std_msgs/Empty"),
    ("/cmd_vel_mux", S, "/teleop/cmd_vel", "geometry_msgs/Twist"),
)


def reached(*ends: tuple[str, Role, str, str]) -> dict[str, set[str]]:
    """Return the nodes that provide each capability."""
    nodes = tuple(LiveNode(name) for name in sorted({end[0] for end in ends}))
    graph = ComputationGraph(ros=1, nodes=nodes, ends=tuple(LiveEnd(*end) for end in ends))
    found = infer(graph, load(), name="robot").capabilities
    return {one.name: {way.node for way in one.ways} for one in found if one.ways}


def test_a_drone() -> None:
    """Names distinguish its signals; topics of rviz and rosbag are not capabilities."""
    driver = {"/ardrone_driver"}
    assert reached(*DRONE) == {
        **dict.fromkeys(("sensingPose", "sensingVelocity", "seeing", "drivingAtVelocity"), driver),
        **dict.fromkeys(("takingOff", "landing", "stoppingInEmergency"), driver),
        "recognizingTags": {"/ar_track_alvar"},
    }


def test_a_robot_of_an_office() -> None:
    """Goals and guesses are not positions, resetting an odometer is no emergency, a multiplexer is not a base."""
    assert reached(*OFFICE) == {
        "drivingAtVelocity": {"/base"},
        "sensingPose": {"/base"},
        "sensingVelocity": {"/base"},
        "laserScanning": {"/laser"},
        "beingToldPose": {"/amcl"},
        "knowingMap": {"/map_server"},
        "goingToPose": {"/move_base"},
        "clearingMap": {"/move_base"},
    }


@pytest.mark.parametrize(
    ("role", "name", "kind", "capability"),
    [
        (S, "/head/led", "std_msgs/Bool", "lighting"),
        (S, "/gripper/command", "std_msgs/Float64", "gripping"),
        (P, "/sensors/battery_voltage", "std_msgs/Float32", "sensingBattery"),
        (S, "/speech/say", "std_msgs/String", "speaking"),
        (P, "/recognizer/output", "std_msgs/String", "recognizingSpeech"),
        (P, "/imu/gyro", "geometry_msgs/Vector3Stamped", "sensingRotation"),
        (SERVICE, "/mavros/cmd/takeoff", "mavros_msgs/CommandTOL", "takingOff"),
        (SERVICE, "/drone/motors/arm", "std_srvs/SetBool", "enablingMotors"),
        (ACTION, "/navigate_to_pose", "nav2_msgs/NavigateToPose", "goingToPose"),
    ],
)
def test_contexts(role: Role, name: str, kind: str, capability: str) -> None:
    """The name gives the purpose of a plain message."""
    assert capability in reached(("/node", role, name, kind))
