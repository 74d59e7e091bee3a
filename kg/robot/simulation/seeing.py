"""The nodes that see, which both robots have: cameras, and what finds tags in their pictures."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from kg.robot.simulation.scene import TAG_SIZE, Camera, Vector
from kg.robot.simulation.stage import Node, point
from kg.robot.simulation.tags import Sighting, find_tags

if TYPE_CHECKING:
    from kg.robot.connection import Value

__all__ = ["camera", "tag_finder"]

Turned = Callable[[Vector], Vector]
"""From right, down and ahead of a camera to ahead, left and up of the robot."""


async def camera(node: Node, topic: str, eye: Camera, every: float, look: Callable[[], np.ndarray[Any, Any]]) -> None:
    """Let a node publish what a camera sees on `TOPIC/image_raw`, and its geometry on `TOPIC/camera_info`."""
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

    await node.tells(f"{topic}/image_raw", "sensor_msgs/Image", every, picture)
    await node.tells(f"{topic}/camera_info", "sensor_msgs/CameraInfo", every, geometry)


async def tag_finder(node: Node, topic: str, turned: Turned, shift: Vector) -> None:
    """Let a node find tags in the pictures of a camera, as `ar_track_alvar` does, in the robot's own frame.

    They are published as `AlvarMarkers` in ROS 1 and as `aruco_msgs/MarkerArray` in ROS 2, the nearest first.

    Args:
        node: which finds them.
        topic: of the camera, without `/image_raw`.
        turned: from the camera's axes to the robot's.
        shift: where the camera is on the robot: ahead, left, up, in metres.
    """
    kind = "ar_track_alvar_msgs/AlvarMarkers" if node.connection.ros == 1 else "aruco_msgs/MarkerArray"
    found = await node.tell("/ar_pose_marker", kind)
    geometry: dict[str, list[float]] = {}

    def learn(value: Value) -> None:
        geometry["matrix"] = list(value["K" if node.connection.ros == 1 else "k"])

    async def see(value: Value) -> None:
        if "matrix" in geometry:
            pixels = np.frombuffer(value["data"], dtype=np.uint8).reshape(value["height"], value["width"], 3)
            tags = find_tags(pixels, geometry["matrix"], TAG_SIZE)
            header = value["header"] | {"frame_id": "base_link"}
            markers = [_marker(node.connection.ros, header, one, _placed(turned(one.position), shift)) for one in tags]
            await found.publish({"header": header, "markers": markers})

    await node.hear(f"{topic}/camera_info", "sensor_msgs/CameraInfo", learn, queue=1)
    await node.hear(f"{topic}/image_raw", "sensor_msgs/Image", see, queue=1)


def _placed(at: Vector, shift: Vector) -> Value:
    return point(*(part + off for part, off in zip(at, shift, strict=True)))


def _marker(ros: int, header: Value, one: Sighting, at: Value) -> Value:
    pose = {"position": at, "orientation": dict(zip("xyzw", one.orientation, strict=True))}
    inner = {"header": header, "pose": pose} if ros == 1 else {"pose": pose}
    return {"header": header, "id": one.id, "pose": inner, "confidence": 1}
