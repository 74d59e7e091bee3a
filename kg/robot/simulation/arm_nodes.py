"""The nodes of the simulated arm, like those of a Franka Panda: joints, hand, gripper, camera."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from kg.robot.simulation.arm import JOINTS, WIDEST, Arm, Waypoint
from kg.robot.simulation.nodes import camera
from kg.robot.simulation.stage import Node, Stage, point

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.connection import Accepted, Value

TABLE: Final = "table"
"""The frame of poses of the hand: the corner of the table is its origin, z is the height above it."""
_FINGERS: Final = ("panda_finger_joint1", "panda_finger_joint2")
_PERIOD: Final = 0.1
_CLOSE: Final = 0.02  # A trajectory has ended when each joint is within so many radians of its position
_OPEN: Final = 0.002  # maximum difference of the gripper's opening in metres at its target
_STILL: Final = 0.002  # speed in m/s below which fingers count as standing still
_PATIENCE: Final = 3.0  # extra seconds for joints or fingers after the planned end
_INVALID: Final = -1
_MISSED: Final = -5  # `INVALID_GOAL` and `GOAL_TOLERANCE_VIOLATED` of `control_msgs/FollowJointTrajectory`


async def arm_nodes(stage: Stage, arm: Arm) -> None:
    """Let all nodes of the arm join the graph and start."""
    control = await stage.node("/franka_control")
    await _joints(control, arm)
    await _hand(control, arm)
    await _trajectories(control, arm)
    await _gripper(await stage.node("/franka_gripper"), arm)
    await camera(await stage.node("/camera"), "/camera/color", arm.camera, 0.5, arm.picture)


async def _joints(node: Node, arm: Arm) -> None:
    def states() -> Value:
        return {
            "header": node.stage.header(""),
            "name": [*JOINTS, *_FINGERS],
            "position": [*arm.positions, *arm.fingers],
            "velocity": [*arm.velocities, arm.closing, arm.closing],
            "effort": [*arm.efforts, arm.squeeze, arm.squeeze],
        }

    await node.publish_every("/joint_states", "sensor_msgs/JointState", 0.05, states)


async def _hand(node: Node, arm: Arm) -> None:
    def reach(value: Value) -> None:
        position, orientation = value["pose"]["position"], value["pose"]["orientation"]
        x, y, z, w = (orientation[one] for one in "xyzw")
        arm.reach((position["x"], position["y"], position["z"]), (x, y, z, w))

    def turned() -> Value:
        return dict(zip("xyzw", arm.turned, strict=True))

    def pose() -> Value:
        at = point(arm.pose.x, arm.pose.y, arm.pose.z)
        return {"header": node.stage.header(TABLE), "pose": {"position": at, "orientation": turned()}}

    def transform() -> Value:
        shift = {"translation": point(arm.pose.x, arm.pose.y, arm.pose.z), "rotation": turned()}
        header = node.stage.header(TABLE)
        return {"transforms": [{"header": header, "child_frame_id": "panda_hand_tcp", "transform": shift}]}

    target = "/cartesian_impedance_controller/equilibrium_pose"
    await node.hear(target, "geometry_msgs/PoseStamped", reach, queue=1)
    await node.publish_every("/tcp_pose_broadcaster/pose", "geometry_msgs/PoseStamped", 0.1, pose)
    await node.publish_every("/tf", "tf2_msgs/TFMessage", 0.1, transform)


async def _trajectories(node: Node, arm: Arm) -> None:
    clock = node.stage.world.clock

    async def carry_out(accepted: Accepted) -> Value:
        trajectory = accepted.goal["trajectory"]
        way = _way(trajectory, arm.positions, clock.now())
        if isinstance(way, str):
            accepted.abort(way)
            return {"error_code": _INVALID, "error_string": way}
        arm.follow(way)
        last = way[-1]
        while not accepted.cancelled:
            off = max(abs(to - now) for to, now in zip(last.positions, arm.positions, strict=True))
            if clock.now() >= last.time and off < _CLOSE:
                return {"error_code": 0, "error_string": ""}
            if clock.now() > last.time + _PATIENCE:
                why = f"a joint is {off:.2f} rad away from its position"
                accepted.abort(why)
                return {"error_code": _MISSED, "error_string": why}
            actual = {"positions": list(arm.positions), "velocities": list(arm.velocities)}
            await accepted.feedback({"joint_names": list(JOINTS), "actual": actual})
            await clock.sleep(_PERIOD)
        arm.hold()
        return {}

    name = "/position_joint_trajectory_controller/follow_joint_trajectory"
    await node.connection.serve_action(name, "control_msgs/FollowJointTrajectory", carry_out)


def _way(trajectory: Mapping[str, Any], now: tuple[float, ...], time: float) -> list[Waypoint] | str:
    """Return the waypoints of a trajectory that starts at a time, or its error.

    Unnamed joints keep their positions.
    """
    names, points = trajectory["joint_names"], trajectory["points"]
    if unknown := [one for one in names if one not in JOINTS]:
        return f"unknown joint {unknown[0]}; the joints are {', '.join(JOINTS)}"
    if not names or not points:
        return "the trajectory has no joints" if not names else "the trajectory has no points"
    way: list[Waypoint] = []
    for one in points:
        after = one["time_from_start"]
        positions, at = one["positions"], time + after["sec"] + after["nanosec"] / 1e9
        if len(positions) != len(names) or not all(math.isfinite(position) for position in positions):
            return f"a point has {len(positions)} positions for {len(names)} joints, or one that is not a number"
        if at <= (way[-1].time if way else time):
            return "times of points must increase"
        to = dict(zip(names, positions, strict=True))
        way.append(Waypoint(at, tuple(to.get(joint, old) for joint, old in zip(JOINTS, now, strict=True))))
    return way


async def _gripper(node: Node, arm: Arm) -> None:
    clock = node.stage.world.clock

    async def carry_out(accepted: Accepted) -> Value:
        command = accepted.goal["command"]
        wide = max(0.0, min(WIDEST, command["position"]))
        arm.grip(wide, command["max_effort"])
        end = clock.now() + _PATIENCE
        await clock.sleep(_PERIOD)
        while not accepted.cancelled:
            reached = abs(arm.opening - wide) < _OPEN
            stalled = not reached and arm.closing < _STILL
            state = {"position": arm.opening, "effort": arm.squeeze, "stalled": stalled, "reached_goal": reached}
            if reached or stalled or clock.now() > end:  # a grip on an object stalls, which is a success
                return state
            await accepted.feedback(state)
            await clock.sleep(_PERIOD)
        arm.grip(arm.opening, 0.0)
        return {}

    await node.connection.serve_action("/franka_gripper/gripper_action", "control_msgs/GripperCommand", carry_out)
