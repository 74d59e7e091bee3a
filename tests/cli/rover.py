"""A small store of facts: two sources, nodes of several kinds, two with the same name, and their direct relations."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from graph.samples import source_triples
from pyoxigraph import NamedNode, RdfFormat, parse

from kg.facts import (
    Access,
    Interface,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    Qos,
    Repository,
    Resolution,
    Role,
)
from kg.graph.builds import BuildRecord, build_triples, count
from kg.graph.iris import Iris
from kg.resources import folder
from kg.rules.authoring.runs import infer
from kg.rules.engine.evaluate import Program
from kg.rules.reading import discover
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

__all__ = ["DRIVER", "PLANNER", "build"]

NOON: Final = datetime(2026, 5, 1, 12, tzinfo=UTC)


def at(line: int) -> Location:
    """Return a line of the driver."""
    return Location("rover_base/src/driver.cpp", line)


DRIVER: Final = NodeType(
    name="driver",
    kind=NodeKind.EXECUTABLE,
    language="cpp",
    ros=2,
    location=at(1),
    executable="driver_node",
    node_name="rover_driver",
    sources=("rover_base/src/driver.cpp", "rover_base/src/motor.cpp"),
    interfaces=(
        Interface(
            Role.PUBLISHES,
            "odom",
            "nav_msgs/Odometry",
            Resolution.LITERAL,
            at(20),
            "/odom",
            qos=Qos("reliable", "volatile", "keep_last", 10),
        ),
        Interface(
            Role.PUBLISHES,
            "/rosout",
            "rcl_interfaces/Log",
            Resolution.LITERAL,
            at(1),
            "/rosout",
            None,
            None,
            True,
            "rclcpp",
        ),
        Interface(
            Role.SUBSCRIBES,
            "cmd_vel",
            "geometry_msgs/Twist",
            Resolution.PARAMETER_DEFAULT,
            at(21),
            "/cmd_vel",
            parameter="input_topic",
        ),
        Interface(
            Role.SUBSCRIBES,
            "{}/scan",
            "sensor_msgs/LaserScan",
            Resolution.PARTIAL,
            at(22),
            reason="`side` is not known",
        ),
        Interface(Role.SERVICES, "~/reset", "std_srvs/Trigger", Resolution.CONSTANT, at(23), "/driver/reset"),
        Interface(Role.CLIENTS, "map", "nav_msgs/GetMap", Resolution.LITERAL, at(24), "/map"),
        Interface(Role.ACTION_SERVERS, "dock", "rover_msgs/Dock", Resolution.LITERAL, at(25), "/dock"),
        Interface(Role.ACTION_CLIENTS, None, None, Resolution.UNRESOLVED, at(26), reason="it comes from a caller"),
    ),
    parameters=(
        Parameter("wheel_radius", "double", "0.1", Access.DECLARE, at(30)),
        Parameter("wheel_radius", None, None, Access.READ, at(31)),
        Parameter("use_sim_time", "bool", "false", Access.DECLARE, at(1), implicit=True, origin="rclcpp"),
    ),
)
PLANNER: Final = NodeType(
    name="planner",
    kind=NodeKind.NODELET,
    language="cpp",
    ros=1,
    location=Location("src/planner.cpp", 5),
    plugin="nav/Planner",
    base_class="nodelet::Nodelet",
    interfaces=(
        Interface(
            Role.PUBLISHES,
            "cmd_vel",
            "geometry_msgs/Twist",
            Resolution.LITERAL,
            Location("src/planner.cpp", 9),
            "/cmd_vel",
        ),
    ),
)


def package(name: str, repository: str, *nodes: NodeType) -> PackageFacts:
    """Return a package of a source."""
    manifest = Package(name, name, nodes[0].ros, Location(f"{name}/package.xml", 1), version="1.2.0")
    return PackageFacts(repository, manifest, nodes)


def direct_relations(graphs: Iterable[bytes]) -> bytes:
    """Return the inferred relations of the form of `rnkg:publishes`."""
    triples = [quad.triple for content in graphs for quad in parse(content, RdfFormat.N_TRIPLES)]
    named = {f"communication/{name}" for name in ("publishes", "subscribes", "provides", "calls")}
    named |= {"communication/serves-action", "communication/calls-action"}
    rules = discover([folder("rules")], families=["communication"]).rules
    inferred, _ = infer(Program(rule for rule in rules if rule.name in named), triples)
    return "".join(f"{triple} .\n" for triple in inferred).encode()


def build(root: Path) -> None:
    """Write the store into `root` (the `.kg` folder)."""
    rover = Repository("github.com/acme/rover", "/nowhere/rover", "0123456789abcdef0123", "git@github.com:acme/rover")
    local = Repository("local/ws", "/nowhere/ws")
    sources = {
        rover: [
            package("rover_base", rover.name, DRIVER),
            package("rover_sim", rover.name, replace(DRIVER, kind=NodeKind.SCRIPT, language="python")),
        ],
        local: [package("nav", local.name, PLANNER)],
    }
    iris = Iris()
    graphs = {
        NamedNode(iris.source_graph(source.name)): [source_triples(source, packages, iris)]
        for source, packages in sources.items()
    }
    graphs[NamedNode(iris.graph("inferred"))] = [direct_relations(content for (content,) in graphs.values())]
    with EmbeddedStore.create(root).write("test") as transaction:
        transaction.replace_graphs(graphs)
        for source, packages in sources.items():
            record = BuildRecord(source, NOON, NOON, "0.1.0", count(packages))
            transaction.append(NamedNode(iris.graph("builds")), build_triples(record, iris))
