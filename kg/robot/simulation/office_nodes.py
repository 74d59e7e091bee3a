"""The nodes of the robot in the office, as those of a TurtleBot with its navigation are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.grid import Grid
from kg.robot.simulation.navigating import Navigator
from kg.robot.simulation.pose import Pose, quaternion_of
from kg.robot.simulation.robots import Command
from kg.robot.simulation.seeing import camera, tag_finder
from kg.robot.simulation.stage import Node, Stage, point, posed
from kg.robot.simulation.wheeled import LASER_RANGE, RADIUS, RAYS, Wheeled

if TYPE_CHECKING:
    from kg.robot.connection import Value

__all__ = ["office_nodes"]

_RESOLUTION: Final = 0.05
_VOLTAGE: Final = (13.0, 16.4)
_COVARIANCE: Final = [0.0004 if index in {0, 7} else 0.0001 if index == 35 else 0.0 for index in range(36)]  # noqa: PLR2004 - x, y, yaw of 6 by 6


async def office_nodes(stage: Stage, robot: Wheeled) -> None:
    """Let all nodes of the robot join the graph and begin."""
    await _base(await stage.node("/mobile_base"), robot)
    await _laser(await stage.node("/laser"), robot)
    eye = await stage.node("/camera")
    await camera(eye, "/camera/rgb", robot.camera, 0.4, robot.picture)
    finder = await stage.node("/ar_track_alvar")
    await tag_finder(finder, "/camera/rgb", lambda at: (at[2], -at[0], -at[1]), (RADIUS, 0.0, 0.5))
    await _map(await stage.node("/map_server"))
    await _localisation(await stage.node("/amcl"), robot)
    await Navigator(await stage.node("/move_base" if stage.ros == 1 else "/bt_navigator"), robot).begin()


async def _base(node: Node, robot: Wheeled) -> None:
    stage = node.stage

    def drive(value: Value) -> None:
        robot.command(Command(value["linear"]["x"], turn=value["angular"]["z"], at=stage.world.time))

    def odometry() -> Value:
        return {
            "header": stage.header("odom"),
            "child_frame_id": "base_link",
            "pose": {"pose": posed(robot.odometry), "covariance": _COVARIANCE},
            "twist": {"twist": {"linear": point(robot.forward, 0), "angular": point(0, 0, robot.turn)}},
        }

    def battery() -> Value:
        low, high = _VOLTAGE
        charge = robot.battery.charge
        voltage = low + (high - low) * charge
        return {"header": stage.header("base_link"), "voltage": voltage, "percentage": charge, "present": True}

    await node.hear("/cmd_vel", "geometry_msgs/Twist", drive)
    await node.tells("/odom", "nav_msgs/Odometry", 0.1, odometry)
    await node.tells("/battery_state", "sensor_msgs/BatteryState", 1.0, battery)
    await node.tells("/tf", "tf2_msgs/TFMessage", 0.1, lambda: _transform(node, "odom", "base_link", robot.odometry))


def _transform(node: Node, parent: str, child: str, pose: Pose) -> Value:
    shift = {"translation": point(pose.x, pose.y), "rotation": quaternion_of(pose.heading)}
    return {"transforms": [{"header": node.stage.header(parent), "child_frame_id": child, "transform": shift}]}


async def _laser(node: Node, robot: Wheeled) -> None:
    def scan() -> Value:
        return {
            "header": node.stage.header("base_link"),
            "angle_min": -math.pi,
            "angle_max": math.pi - math.tau / RAYS,
            "angle_increment": math.tau / RAYS,
            "scan_time": 0.2,
            "range_min": RADIUS,
            "range_max": LASER_RANGE,
            "ranges": robot.scan(),
        }

    await node.tells("/scan", "sensor_msgs/LaserScan", 0.2, scan)


async def _map(node: Node) -> None:
    grid = Grid(node.stage.world.plan, _RESOLUTION)
    about = {
        "resolution": _RESOLUTION,
        "width": grid.columns,
        "height": grid.rows,
        "origin": {"position": point(grid.origin, grid.origin), "orientation": quaternion_of(0)},
    }
    whole = {"header": node.stage.header("map"), "info": about, "data": grid.occupancy()}

    async def answer(_request: Value) -> Value:
        return {"map": whole}

    await (await node.tell("/map", "nav_msgs/OccupancyGrid", latch=True)).publish(whole)
    await (await node.tell("/map_metadata", "nav_msgs/MapMetaData", latch=True)).publish(about)
    await node.connection.serve("/static_map", "nav_msgs/GetMap", answer)


async def _localisation(node: Node, robot: Wheeled) -> None:
    def located() -> Value:
        pose = {"pose": posed(robot.located()), "covariance": _COVARIANCE}
        return {"header": node.stage.header("map"), "pose": pose}

    def offset() -> Value:
        """Return where the frame of the odometry is on the map."""
        turn = robot.pose.heading - robot.odometry.heading
        cosine, sine = math.cos(turn), math.sin(turn)
        x = robot.pose.x - robot.odometry.x * cosine + robot.odometry.y * sine
        y = robot.pose.y - robot.odometry.x * sine - robot.odometry.y * cosine
        return _transform(node, "map", "odom", Pose(x, y, turn))

    await node.hear("/scan", "sensor_msgs/LaserScan", _nothing, queue=1)
    await node.hear("/map", "nav_msgs/OccupancyGrid", _nothing, queue=1)
    await node.tells("/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped", 0.2, located)
    await node.tells("/tf", "tf2_msgs/TFMessage", 0.1, offset)


def _nothing(_value: Value) -> None:
    """Take no notice: the simulation knows where the robot is, but the graph is that of a robot which computes it."""
