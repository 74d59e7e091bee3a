"""The nodes of simulated robots: in the office those of a TurtleBot with navigation, else `ardrone_autonomy`.

Both have cameras, and detectors of tags. In ROS 2 the drone reports its state like a Tello.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from kg.robot.simulation.navigating import Grid, Navigator
from kg.robot.simulation.robots import Command, Pose, quaternion_of
from kg.robot.simulation.scene import TAG_SIZE, Camera, Vector, find_tags
from kg.robot.simulation.stage import Node, Stage, point, posed
from kg.robot.simulation.wheeled import LASER_RANGE, RADIUS, RAYS, Wheeled

if TYPE_CHECKING:
    from kg.robot.connection import Value
    from kg.robot.simulation.drone import Drone

Turned = Callable[[Vector], Vector]
"""Conversion from the axes of a camera (right, down, forward) to those of the robot (forward, left, up)."""


async def camera(node: Node, topic: str, eye: Camera, every: float, look: Callable[[], np.ndarray[Any, Any]]) -> None:
    """Publish a camera's images on `TOPIC/image_raw`, and its geometry on `TOPIC/camera_info`."""
    frame = f"{topic.strip('/').replace('/', '_')}_optical_frame"

    def picture() -> Value:
        return {
            "header": node.stage.header(frame),
            "height": eye.height,
            "width": eye.width,
            "encoding": "rgb8",
            "step": 3 * eye.width,
            "data": look().tobytes(),
        }

    def geometry() -> Value:
        inner = eye.matrix
        matrix, turned, shape = ("K", "R", "P") if node.connection.ros == 1 else ("k", "r", "p")
        return {
            "header": node.stage.header(frame),
            "height": eye.height,
            "width": eye.width,
            "distortion_model": "plumb_bob",
            "D" if node.connection.ros == 1 else "d": [0.0] * 5,
            matrix: inner,
            turned: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            shape: [*inner[:3], 0.0, *inner[3:6], 0.0, *inner[6:], 0.0],
        }

    await node.publish_every(f"{topic}/image_raw", "sensor_msgs/Image", every, picture)
    await node.publish_every(f"{topic}/camera_info", "sensor_msgs/CameraInfo", every, geometry)


async def tag_finder(node: Node, topic: str, turned: Turned, shift: Vector) -> None:
    """Detect tags in the images of a camera, as `ar_track_alvar` does, in the robot's frame.

    They are published as `AlvarMarkers` in ROS 1 and as `aruco_msgs/MarkerArray` in ROS 2, the nearest first.

    Args:
        node: the detecting node.
        topic: of the camera, without `/image_raw`.
        turned: conversion from the camera's axes to the robot's.
        shift: position of the camera on the robot: forward, left, up, in metres.
    """
    kind = "ar_track_alvar_msgs/AlvarMarkers" if node.connection.ros == 1 else "aruco_msgs/MarkerArray"
    publication = await node.advertise("/ar_pose_marker", kind)
    geometry: dict[str, list[float]] = {}

    def learn(value: Value) -> None:
        geometry["matrix"] = list(value["K" if node.connection.ros == 1 else "k"])

    async def see(value: Value) -> None:
        if "matrix" in geometry:
            pixels = np.frombuffer(value["data"], dtype=np.uint8).reshape(value["height"], value["width"], 3)
            tags = find_tags(pixels, geometry["matrix"], TAG_SIZE)
            header = value["header"] | {"frame_id": "base_link"}
            markers = []
            for one in tags:
                at = point(*(part + off for part, off in zip(turned(one.position), shift, strict=True)))
                pose = {"position": at, "orientation": dict(zip("xyzw", one.orientation, strict=True))}
                inner = {"header": header, "pose": pose} if node.connection.ros == 1 else {"pose": pose}
                markers.append({"header": header, "id": one.id, "pose": inner, "confidence": 1})
            await publication.publish({"header": header, "markers": markers})

    await node.hear(f"{topic}/camera_info", "sensor_msgs/CameraInfo", learn, queue=1)
    await node.hear(f"{topic}/image_raw", "sensor_msgs/Image", see, queue=1)


_RESOLUTION: Final = 0.05
_VOLTAGE: Final = (13.0, 16.4)
_COVARIANCE: Final = [0.0004 if index in {0, 7} else 0.0001 if index == 35 else 0.0 for index in range(36)]  # noqa: PLR2004 - x, y, yaw of 6 by 6


async def office_nodes(stage: Stage, robot: Wheeled) -> None:
    """Let all nodes of the robot join the graph and start."""
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
    await node.publish_every("/odom", "nav_msgs/Odometry", 0.1, odometry)
    await node.publish_every("/battery_state", "sensor_msgs/BatteryState", 1.0, battery)
    await node.publish_every(
        "/tf", "tf2_msgs/TFMessage", 0.1, lambda: _transform(node, "odom", "base_link", robot.odometry)
    )


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

    await node.publish_every("/scan", "sensor_msgs/LaserScan", 0.2, scan)


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

    await (await node.advertise("/map", "nav_msgs/OccupancyGrid", latch=True)).publish(whole)
    await (await node.advertise("/map_metadata", "nav_msgs/MapMetaData", latch=True)).publish(about)
    await node.connection.serve("/static_map", "nav_msgs/GetMap", answer)


async def _localisation(node: Node, robot: Wheeled) -> None:
    def located() -> Value:
        pose = {"pose": posed(robot.located()), "covariance": _COVARIANCE}
        return {"header": node.stage.header("map"), "pose": pose}

    def offset() -> Value:
        """Return the pose of the odometry frame on the map."""
        turn = robot.pose.heading - robot.odometry.heading
        cosine, sine = math.cos(turn), math.sin(turn)
        x = robot.pose.x - robot.odometry.x * cosine + robot.odometry.y * sine
        y = robot.pose.y - robot.odometry.x * sine - robot.odometry.y * cosine
        return _transform(node, "map", "odom", Pose(x, y, turn))

    await node.hear("/scan", "sensor_msgs/LaserScan", _nothing, queue=1)
    await node.hear("/map", "nav_msgs/OccupancyGrid", _nothing, queue=1)
    await node.publish_every("/amcl_pose", "geometry_msgs/PoseWithCovarianceStamped", 0.2, located)
    await node.publish_every("/tf", "tf2_msgs/TFMessage", 0.1, offset)


def _nothing(_value: Value) -> None:
    """Ignore messages: the simulation has the exact pose, but the graph should be that of a robot which computes it."""


_MILLI: Final = 1000.0
_CENTI: Final = 100.0
_STRONGEST: Final = 255.0
_LIFT: Final = 2.0  # the lift of a rotor in newtons that navdata reports as the maximum


async def drone_nodes(stage: Stage, drone: Drone) -> None:
    """Let all nodes of the drone join the graph and start."""
    driver = await stage.node("/ardrone_driver")
    await _commands(driver, drone)
    await _state(driver, drone)
    await camera(driver, "/ardrone/front", drone.camera, 0.5, lambda: drone.picture(down=False))
    await camera(driver, "/ardrone/bottom", drone.camera, 0.3, lambda: drone.picture(down=True))
    finder = await stage.node("/ar_track_alvar")
    await tag_finder(finder, "/ardrone/bottom", lambda at: (-at[1], -at[0], -at[2]), (0.0, 0.0, 0.0))


async def _commands(node: Node, drone: Drone) -> None:
    def fly(value: Value) -> None:
        linear = value["linear"]
        turn = value["angular"]["z"]
        drone.command(Command(linear["x"], linear["y"], linear["z"], turn, node.stage.world.time))

    def on(act: Callable[[], None]) -> Callable[[Value], None]:
        return lambda _: act()

    await node.hear("/cmd_vel", "geometry_msgs/Twist", fly)
    await node.hear("/ardrone/takeoff", "std_msgs/Empty", on(drone.take_off))
    await node.hear("/ardrone/land", "std_msgs/Empty", on(drone.land))
    await node.hear("/ardrone/reset", "std_msgs/Empty", on(drone.reset))


async def _state(node: Node, drone: Drone) -> None:
    stage = node.stage

    def odometry() -> Value:
        spin = point(*drone.rates)
        return {
            "header": stage.header("odom"),
            "child_frame_id": "base_link",
            "pose": {"pose": posed(drone.located())},
            "twist": {"twist": {"linear": point(*_ahead(drone)), "angular": spin}},
        }

    if stage.ros == 1:
        await node.publish_every("/ardrone/navdata", "ardrone_autonomy/Navdata", 0.1, lambda: _navdata(stage, drone))
    else:
        await node.publish_every("/flight_data", "tello_msgs/FlightData", 0.1, lambda: _flight_data(stage, drone))
    await node.publish_every("/ardrone/odometry", "nav_msgs/Odometry", 0.1, odometry)


def _ahead(drone: Drone) -> Vector:
    """Return its velocity in its own frame."""
    x, y, z = drone.velocity
    cosine, sine = math.cos(drone.pose.heading), math.sin(drone.pose.heading)
    return x * cosine + y * sine, y * cosine - x * sine, z


def _navdata(stage: Stage, drone: Drone) -> Value:
    velocity = dict(zip(("vx", "vy", "vz"), (one * _MILLI for one in _ahead(drone)), strict=True))
    motors = {
        f"motor{index}": round(min(_STRONGEST, _STRONGEST * force / _LIFT))
        for index, force in enumerate(drone.rotors, 1)
    }
    return {
        "header": stage.header("base_link"),
        "batteryPercent": drone.battery.charge * 100,
        "state": int(drone.state),
        "rotX": math.degrees(drone.tilt[0]),
        "rotY": math.degrees(drone.tilt[1]),
        "rotZ": math.degrees(drone.pose.heading),
        "altd": round(drone.altitude * _MILLI),
        "tm": stage.world.time * 1e6,
        **velocity,
        **motors,
    }


def _flight_data(stage: Stage, drone: Drone) -> Value:
    return {
        "header": stage.header("base_link"),
        "roll": round(math.degrees(drone.tilt[0])),
        "pitch": round(math.degrees(drone.tilt[1])),
        "yaw": round(math.degrees(drone.pose.heading)),
        "h": round(drone.altitude * _CENTI),
        "tof": round(drone.altitude * _CENTI),
        "bat": round(drone.battery.charge * 100),
        "time": round(stage.world.time),
    }
