"""Shared parts of all ROS 2 middlewares: names, type hashes, actions, and the connection."""

from __future__ import annotations

from kg.robot.ros2.address import Address
from kg.robot.ros2.connection import Ros2Connection
from kg.robot.ros2.middleware import Handle, Middleware, Neighbourhood, Writer

__all__ = ["Address", "Handle", "Middleware", "Neighbourhood", "Ros2Connection", "Writer"]
