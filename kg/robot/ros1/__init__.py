"""ROS 1 without a ROS installation: graph by XML-RPC, messages and services by TCPROS, actions, and a small master."""

from __future__ import annotations

from kg.robot.ros1.connection import Ros1Connection, connect
from kg.robot.ros1.master import Master

__all__ = ["Master", "Ros1Connection", "connect"]
