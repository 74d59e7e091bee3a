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
    found = infer(graph, load(), address="memory://robot").capabilities
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
        (S, "/wrench_command", "geometry_msgs/WrenchStamped", "applyingForce"),
    ],
)
def test_contexts(role: Role, name: str, kind: str, capability: str) -> None:
    """The name gives the purpose of a plain message."""
    assert capability in reached(("/node", role, name, kind))


@pytest.mark.parametrize(
    ("role", "name", "kind", "capability"),
    [
        (S, "/speech_recognizing", "std_msgs/String", "speaking"),
        (S, "/speaker_audio", "std_msgs/String", "speaking"),
        (S, "/ethercat/motors_halted", "std_msgs/Bool", "enablingMotors"),
        (SERVICE, "/spot/arm_stow", "std_srvs/Trigger", "enablingMotors"),
        (S, "/gripper/finger_joint/current", "std_msgs/Float64", "gripping"),
        (S, "/grasp_planner/event_in", "std_msgs/String", "gripping"),
        (P, "/force_disturbance", "geometry_msgs/Vector3", "sensingForce"),
        (P, "/odom_to_euler/euler", "geometry_msgs/Vector3Stamped", "sensingVelocity"),
        (P, "/imu/data_raw", "sensor_msgs/Imu", "sensingOrientation"),
        (P, "/setpoint_position/global", "geographic_msgs/GeoPoseStamped", "sensingGeographicPosition"),
        (P, "/map/image", "sensor_msgs/Image", "seeing"),
        (P, "/waypoints_reached", "geometry_msgs/Point", "knowingPlaces"),
        (P, "/nearest_point", "geometry_msgs/PoseStamped", "sensingPose"),
        (P, "/air_humidity/desired", "std_msgs/Float64", "sensingHumidity"),
        (P, "/target_heading", "std_msgs/Float32", "sensingOrientation"),
        (P, "/lidar_gimbal_mode", "std_msgs/Int16", "measuringOneDistance"),
        (S, "/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped", "beingToldPose"),
        (S, "/robot/pose", "geometry_msgs/PoseStamped", "goingToPose"),
        (P, "/debug_image", "sensor_msgs/Image", "seeing"),
        (P, "/flir/image", "sensor_msgs/Image", "sensingTemperature"),
        (P, "/face/mode", "std_msgs/String", "sensingMode"),
        (P, "/smart_move/object", "std_msgs/String", "recognizingObjects"),
        (S, "/display_server/stimulus_mode", "std_msgs/String", "showing"),
        (SERVICE, "/node/tf2_frames", "tf2_msgs/FrameGraph", "knowingFrames"),
        (SERVICE, "/gripper/emergency_release", "std_srvs/Trigger", "stoppingInEmergency"),
        (P, "/wind/true", "geometry_msgs/Pose2D", "sensingPose"),
    ],
)
def test_names_that_mean_something_else(role: Role, name: str, kind: str, capability: str) -> None:
    """The name excludes a possible purpose of a message."""
    assert capability not in reached(("/node", role, name, kind))


@pytest.mark.parametrize(
    ("name", "kind"),
    [("/detected_objects", "geometry_msgs/PoseArray"), ("/ball_position", "geometry_msgs/PointStamped")],
)
def test_places_of_things(name: str, kind: str) -> None:
    """Points and poses give positions of objects if the name mentions objects."""
    assert "knowingPlaces" in reached(("/node", P, name, kind))
