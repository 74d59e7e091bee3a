from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from robot.live.seen import ADDRESS, ROVER

from kg.facts import LaunchDialect, Role, StartKind
from kg.graph.iris import Iris
from kg.graph.reading.systems import system_names, systems
from kg.graph.systems import system_triples
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.live.systems import Seen, is_implicit, name_of, system_of

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore

_SEEN = Seen(ADDRESS, "localhost:11311", "2026-05-01T12:00:00Z")


def test_a_running_system_is_read_back_as_it_was_written(settings: Settings, store: EmbeddedStore) -> None:
    """The facts read from the graph of a running system equal those written."""
    from pyoxigraph import NamedNode  # noqa: PLC0415 - of this test alone

    iris, seen = Iris(settings.base), system_of(ROVER, _SEEN)
    with store.write("test") as transaction:
        content = system_triples(seen, {}, iris, whole=True)
        transaction.load(NamedNode(iris.robot_graph("localhost:11311")), [content])
    with store.read() as snapshot:
        names = system_names(snapshot)
        (found,) = systems(snapshot, names, settings.base)
    assert [one.name for one in names] == ["robot/localhost:11311"]
    assert found.configuration.dialect is LaunchDialect.RUNNING
    assert found.sighting == seen.sighting
    assert [(one.name, one.since, one.started.kind) for one in found.instances] == [
        (node.name, _SEEN.since, StartKind.RUNNING) for node in ROVER.nodes
    ]
    ends = {
        LiveEnd(one.name, end.declared.role, str(end.resolved), end.declared.type)
        for one in found.instances
        for end in one.interfaces
    }
    assert ends == set(ROVER.ends)
    peers = {str(end.declared.location) for one in found.instances for end in one.interfaces}
    assert "/base at http://127.0.0.1:40001/" in peers


def test_a_node_with_a_problem_is_not_complete() -> None:
    """A dead node is present, with its problem, and its missing interfaces allow no conclusion."""
    graph = ComputationGraph(1, (LiveNode("/dead", None, "it does not answer"),))
    (instance,) = system_of(graph, _SEEN).instances
    assert (instance.complete, instance.reason) == (False, "it does not answer")
    assert str(instance.started.location) == f"/dead at {ADDRESS}"


@pytest.mark.parametrize(
    ("role", "name", "node", "ros", "implicit"),
    [
        (Role.PUBLISHES, "/rosout", "/base", 1, True),
        (Role.SERVICES, "/robot/base/get_loggers", "/robot/base", 1, True),
        (Role.SERVICES, "/robot/other/get_loggers", "/robot/base", 1, False),
        (Role.SUBSCRIBES, "/rosout", "/rosout", 1, False),
        (Role.SERVICES, "/base/list_parameters", "/base", 2, True),
        (Role.PUBLISHES, "/cmd_vel", "/base", 1, False),
    ],
)
def test_what_ros_makes_of_every_node_is_implicit(
    role: Role,
    name: str,
    node: str,
    ros: int,
    implicit: bool,  # noqa: FBT001 - as above
) -> None:
    """Ends that ROS creates for every node are distinguished from those of the node's code."""
    assert is_implicit(role, name, node, ros) is implicit


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("ros1://localhost:11311", "localhost:11311"),
        ("dds://0", "dds/0"),
        ("zenoh://router:7447", "zenoh/router:7447"),
        ("memory://office", "memory/office"),
    ],
)
def test_a_system_is_named_by_its_address(address: str, name: str) -> None:
    """The name of a system is its address, without the scheme for ROS 1."""
    assert name_of(address) == name
