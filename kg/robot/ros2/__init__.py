"""What all middlewares of ROS 2 share: names, type hashes, actions upon services, the connection above the wire."""

from __future__ import annotations

from kg.robot.ros2.address import Address
from kg.robot.ros2.connection import Ros2Connection
from kg.robot.ros2.middleware import Handle, Middleware, Neighbourhood, Writer

__all__ = ["Address", "Handle", "Middleware", "Neighbourhood", "Ros2Connection", "Writer"]
