"""Lists over the whole store."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from graph.reading.test_nodes import stored

from kg.facts import Access, Interface, Location, NodeKind, NodeType, Parameter, Resolution, Role
from kg.graph.reading.overview import Channel, NodeSummary, channels, nodes

HERE: Final = Location("src/rover.cpp", 12)


def _end(role: Role, name: str, kind: str | None = None, *, implicit: bool = False) -> Interface:
    return Interface(role, name, kind, Resolution.LITERAL, HERE, resolved=f"/{name}", implicit=implicit)


BARE: Final = NodeType("bare", NodeKind.SCRIPT, "python", 1, Location("bin/bare.py", 0))
ROVER: Final = NodeType(
    "rover",
    NodeKind.EXECUTABLE,
    "cpp",
    2,
    HERE,
    interfaces=(
        _end(Role.PUBLISHES, "odom", "nav_msgs/Odometry"),
        _end(Role.PUBLISHES, "odom", "nav_msgs/Odometry"),
        _end(Role.PUBLISHES, "rosout", "rosgraph_msgs/Log", implicit=True),
        _end(Role.SUBSCRIBES, "scan"),
        _end(Role.ACTION_SERVERS, "dock", "rover_msgs/Dock"),
        _end(Role.ACTION_CLIENTS, "drive", "rover_msgs/Drive"),
    ),
    parameters=(
        Parameter("rate", "double", "10.0", Access.DECLARE, HERE),
        Parameter("rate", "double", None, Access.READ, HERE),
        Parameter(None, None, None, Access.READ, HERE, Resolution.UNRESOLVED),
        Parameter("use_sim_time", "bool", "false", Access.DECLARE, HERE, implicit=True, origin="rclcpp"),
    ),
)


def test_a_node_has_the_numbers_of_what_it_declares_itself() -> None:
    """Each declared interface counts, each parameter name once, and implicit interfaces do not."""
    assert nodes(stored(("base", (ROVER, BARE)))) == [
        NodeSummary("github.com/acme/rover", "base", "bare", NodeKind.SCRIPT, 1, BARE.location, 0, 0, 0, 0, 0, 0),
        NodeSummary("github.com/acme/rover", "base", "rover", NodeKind.EXECUTABLE, 2, HERE, 2, 1, 0, 0, 2, 2),
    ]


def test_nodes_of_one_package_are_listed() -> None:
    """A package may have its repository as prefix."""
    store = stored(("a", (ROVER,)), ("b", (ROVER, BARE)))
    assert [one.package for one in nodes(store, "a")] == ["a"]
    assert [one.node for one in nodes(store, "github.com/acme/rover:b")] == ["bare", "rover"]


def test_channels_have_their_types_and_the_nodes_at_their_ends() -> None:
    """Ends without a type are listed; names that only frameworks use are listed on request."""
    store = stored(("a", (ROVER,)), ("b", (replace(ROVER, interfaces=ROVER.interfaces[3:]),)))
    odom = Channel("/odom", ("nav_msgs/Odometry",), ("a/rover",), (), 0)
    scan = Channel("/scan", (), (), ("a/rover", "b/rover"), 0)
    assert channels(store, "topic") == [odom, scan]
    assert [one.name for one in channels(store, "topic", implicit=True)] == ["/odom", "/rosout", "/scan"]
    assert [one.name for one in channels(store, "action")] == ["/dock", "/drive"]
    assert channels(store, "service") == []


def test_ends_that_frameworks_create_count_where_a_node_has_the_other() -> None:
    """A client of a service that a framework offers has that server, and a subscriber of a log its publishers."""
    log = replace(ROVER, interfaces=(*ROVER.interfaces, _end(Role.SUBSCRIBES, "rosout", "rosgraph_msgs/Log")))
    listed = channels(stored(("a", (ROVER,)), ("b", (log,))), "topic")
    assert listed[1] == Channel("/rosout", ("rosgraph_msgs/Log",), ("a/rover", "b/rover"), ("b/rover",), 0)
