"""Graphs of running systems for tests, as returned by connections."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.facts import Role
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode

if TYPE_CHECKING:
    from kg.facts import System

__all__ = ["ADDRESS", "ROVER", "graph_of", "without"]

ADDRESS: Final = "ros1://localhost:11311"

_ENDS: Final = (
    LiveEnd("/base", Role.SUBSCRIBES, "/cmd_vel", "geometry_msgs/Twist"),
    LiveEnd("/base", Role.PUBLISHES, "/odom", "nav_msgs/Odometry"),
    LiveEnd("/base", Role.PUBLISHES, "/rosout", "rosgraph_msgs/Log"),
    LiveEnd("/base", Role.SERVICES, "/base/get_loggers", "roscpp/GetLoggers"),
    LiveEnd("/drone", Role.SUBSCRIBES, "/takeoff", "std_msgs/Empty"),
    LiveEnd("/map_server", Role.SERVICES, "/static_map", "nav_msgs/GetMap"),
    LiveEnd("/move_base", Role.ACTION_SERVERS, "/move_base", "move_base_msgs/MoveBase"),
    LiveEnd("/teleop", Role.PUBLISHES, "/cmd_vel", "geometry_msgs/Twist"),
)
ROVER: Final = ComputationGraph(
    1,
    tuple(
        LiveNode(name, f"http://127.0.0.1:{port}/")
        for port, name in enumerate(("/base", "/drone", "/map_server", "/move_base", "/teleop"), 40001)
    ),
    _ENDS,
)


def without(graph: ComputationGraph, *names: str) -> ComputationGraph:
    """Return a graph without some nodes."""
    return ComputationGraph(
        graph.ros,
        tuple(one for one in graph.nodes if one.name not in names),
        tuple(one for one in graph.ends if one.node not in names),
        graph.problems,
        graph.complete,
    )


def graph_of(system: System) -> ComputationGraph:
    """Return the graph of the running system of a launch file."""
    ends = {
        LiveEnd(node.name, end.declared.role, end.resolved, end.declared.type, end.qos)
        for node in system.instances
        for end in node.interfaces
        if end.resolved and "{}" not in end.resolved
    }
    return ComputationGraph(
        system.configuration.ros,
        tuple(
            LiveNode(name, f"http://127.0.0.1:{port}/")
            for port, name in enumerate(sorted({one.name for one in system.instances}), 40001)
        ),
        tuple(sorted(ends, key=lambda end: (end.node, end.role, end.name, end.type or ""))),
    )
