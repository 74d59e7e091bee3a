"""The nodes of the drone, as `ardrone_autonomy` and a finder of tags; in ROS 2 it tells its state as a Tello does."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

from kg.robot.simulation.robots import Command
from kg.robot.simulation.seeing import camera, tag_finder
from kg.robot.simulation.stage import Node, Stage, point, posed

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Value
    from kg.robot.simulation.drone import Drone
    from kg.robot.simulation.scene import Vector

__all__ = ["drone_nodes"]

_MILLI: Final = 1000.0
_CENTI: Final = 100.0
_STRONGEST: Final = 255.0
_LIFT: Final = 2.0
"""The lift of a rotor in newtons that navdata calls the strongest."""


async def drone_nodes(stage: Stage, drone: Drone) -> None:
    """Let all nodes of the drone join the graph and begin."""
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
        await node.tells("/ardrone/navdata", "ardrone_autonomy/Navdata", 0.1, lambda: _navdata(stage, drone))
    else:
        await node.tells("/flight_data", "tello_msgs/FlightData", 0.1, lambda: _flight_data(stage, drone))
    await node.tells("/ardrone/odometry", "nav_msgs/Odometry", 0.1, odometry)


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
