"""ROS 2 through its own client library, with any middleware: `rclpy://DOMAIN`, where ROS 2 is installed.

    connection = await connect("rclpy://0", "/kg")
    connection = await connect("rclpy://", "/kg")     # the domain of $ROS_DOMAIN_ID

`$RMW_IMPLEMENTATION`, security (`$ROS_SECURITY_ENABLE`) and discovery have the effect that they have for every node.
"""

from __future__ import annotations

import os

from kg.errors import RobotError
from kg.robot.messages import Types
from kg.robot.ros2 import Address, Ros2Connection
from kg.robot.ros2.names import absolute

__all__ = ["connect"]


async def connect(address: str, name: str, types: Types | None = None) -> Ros2Connection:
    """Become a node of a domain, which may have no other node yet.

    Raises:
        RobotError: KG801 for an address of another form, an invalid name, or without rclpy in this Python; KG817
            when the domain cannot be joined.
    """
    domain = "" if address.removeprefix("rclpy://")[:1].isdigit() else os.environ.get("ROS_DOMAIN_ID", "")
    read = Address.read(address.replace("rclpy://", f"rclpy://{domain}", 1))
    own = absolute(name)
    try:
        from kg.robot.rclpy.middleware import RclpyMiddleware  # noqa: PLC0415 - it needs an installation of ROS 2
    except ImportError as error:
        hint = "Run kg with the Python of ROS 2 after `source /opt/ros/DISTRIBUTION/setup.bash`, or use dds:// or zenoh://."
        raise RobotError("KG801", f"rclpy of ROS 2 cannot be imported: {error}", hint=hint) from None
    try:
        wire = RclpyMiddleware(read.domain, own, types or Types(2))
    except RuntimeError as error:  # rclpy's exception for all failures of the layers below
        message = f"the domain {read.domain} cannot be joined: {error}"
        raise RobotError("KG817", message, hint="Check the network and $RMW_IMPLEMENTATION.") from None
    return await Ros2Connection.open(wire, read, own)
