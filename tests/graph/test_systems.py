from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import pytest
from graph.samples import BASE, DRIVER, FACTS, IRIS, REPOSITORY, ROVER, source_triples
from pyoxigraph import NamedNode, RdfFormat, Store

from kg.facts import (
    InstanceInterface,
    InstanceParameter,
    InstanceRemap,
    Interface,
    LaunchArgument,
    LaunchConfiguration,
    LaunchDialect,
    LaunchInclude,
    LaunchParameter,
    LaunchProblem,
    LaunchProblemKind,
    Location,
    MissingType,
    NodeInstance,
    NodeReference,
    Remap,
    Resolution,
    Role,
    StartedNode,
    StartKind,
    System,
)
from kg.graph import vocabulary as v
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.reading.systems import system_names, systems
from kg.graph.systems import system_triples

PREFIXES: Final = {"ros": v.ROS, "rnkg": v.RNKG, "rdfs": v.RDFS}
LAUNCH: Final = "rover_base/launch/rover.launch"
OTHER: Final = "rover_base/launch/x.launch"
LINE: Final = Location(LAUNCH, 7)
CHAIN: Final = (
    Location("rover_base/launch/all.launch", 3),
    Location("launch/other.launch", 4, "github.com/other/base"),
)
REFERENCE: Final = NodeReference(ROVER, "rover_base", "driver")
REMAP: Final = Remap("/rover/cmd_vel", "/rover/cmd", LINE, CHAIN)
PORT: Final = LaunchParameter("/rover/driver/port", "/dev/ttyACM0", LINE, CHAIN, "string")


CAMERA: Final = InstanceInterface(
    Interface(
        Role.PUBLISHES,
        "camera/image_raw",
        "sensor_msgs/Image",
        Resolution.LITERAL,
        Location("urdf/rover.xacro", 12, "github.com/other/base"),
        written="image_raw",
        origin="gazebo plugin",
    ),
    NodeReference("github.com/other/base", "gazebo_plugins", "libgazebo_ros_camera.so"),
    "/rover/camera/image_raw",
    Resolution.LITERAL,
)
"""An end of a simulator plugin, whose code is outside the build."""
CALIBRATION: Final = InstanceInterface(
    Interface(
        Role.SERVICES,
        "camera/set_camera_info",
        "sensor_msgs/SetCameraInfo",
        Resolution.PARAMETER_DEFAULT,
        Location("urdf/rover.xacro", 9),
        origin="gazebo plugin",
        reason="the plugin is there only if $(arg camera)",
    ),
    NodeReference(ROVER, "gazebo_plugins", "libgazebo_ros_camera.so"),
    "/rover/camera/set_camera_info",
    Resolution.PARAMETER_DEFAULT,
    reason="the plugin is there only if $(arg camera)",
)


def ends() -> tuple[InstanceInterface, ...]:
    """Return the driver's ends in the system."""
    found = []
    for end in DRIVER.interfaces:
        name = None if end.name is None else f"/rover/{end.name}"
        remapped = end.name == "cmd_vel"
        found.append(
            InstanceInterface(
                end,
                REFERENCE,
                "/rover/cmd" if remapped else name,
                end.resolution,
                REMAP if remapped else None,
                PORT if end.name == "odom" else None,
                replace(end.qos, deadline=0.5) if end.qos else None,
                end.reason,
            )
        )
    return tuple(found)


SYSTEM: Final = System(
    LaunchConfiguration(
        ROVER,
        "rover_base",
        LAUNCH,
        1,
        LaunchDialect.ROSLAUNCH,
        arguments=(LaunchArgument("map", None, "{}", LINE, "Where it drives.", choices=("hall", "yard")),),
        includes=(LaunchInclude(OTHER, Location(LAUNCH, 0), (), ROVER, OTHER),),
        problems=(LaunchProblem(LaunchProblemKind.MISSING_FILE, "there is no y.launch", LINE, CHAIN, "y.launch"),),
        folder="rover_base",
    ),
    instances=(
        NodeInstance(
            "/rover/driver",
            "/rover",
            StartedNode(
                "driver",
                "/rover",
                StartKind.NODE,
                LINE,
                CHAIN,
                "rover_base",
                "driver",
                remaps=(REMAP,),
                arguments=("--slow",),
                condition="$(arg drive)",
                settings=(("respawn", "true"),),
            ),
            REFERENCE,
            interfaces=ends(),
            parameters=(
                InstanceParameter(PORT.name, PORT, DRIVER.parameters[0], REFERENCE),
                InstanceParameter("/rover/driver/prot", replace(PORT, name="/rover/driver/prot"), similar=("~/port",)),
            ),
            remaps=(InstanceRemap(REMAP.source, REMAP.target, REMAP, used=True),),
            complete=False,
        ),
        NodeInstance(
            "/rover/camera",
            "/rover",
            StartedNode(
                "camera", "/rover", StartKind.NODELET, LINE, package="nodelet", executable="nodelet", plugin="x/Y"
            ),
            missing=MissingType.UNKNOWN_PACKAGE,
            similar=("xy",),
            reason="the build has no package x",
            host="/rover/driver",
            interfaces=(CALIBRATION, CAMERA),
        ),
    ),
    similar=(("topic", "/rover/cmd", "/rover/odom"),),
    shared_parameters=(LaunchParameter("/use_sim_time", "true", LINE, type="bool"),),
)


@pytest.fixture(name="store")
def _store() -> Store:
    """Return a store with the source of the driver and the system that starts it."""
    store = Store()
    store.load(
        source_triples(REPOSITORY, [FACTS], IRIS), RdfFormat.N_TRIPLES, to_graph=NamedNode(IRIS.source_graph(ROVER))
    )
    content = system_triples(SYSTEM, records(store), IRIS)
    store.load(content, RdfFormat.N_TRIPLES, to_graph=NamedNode(IRIS.launch_graph(ROVER, LAUNCH)))
    return store


class Union:
    """A store with the query method of snapshots."""

    def __init__(self, store: Store) -> None:
        self._store = store

    def query(self, text: str, /, *, prefixes: dict[str, str] | None = None) -> Any:
        """Run a query over the union of all graphs."""
        return self._store.query(text, prefixes=prefixes, use_default_graph_as_union=True)


def records(store: Store) -> dict[NodeReference, NodeRecord]:
    """Return the node types of the store by their IRIs."""
    return {record.reference: record for record in node_records(Union(store))}


def test_a_system_comes_back_as_it_was_written(store: Store) -> None:
    """Every fact about instances survives writing and reading."""
    names = system_names(Union(store))
    assert [(one.repository, one.path, one.name, one.ros) for one in names] == [
        (ROVER, LAUNCH, "rover_base/launch/rover.launch", 1)
    ]
    (found,) = systems(Union(store), names, BASE)

    order = [end.declared for end in found.instances[0].interfaces]
    ordered = sorted(SYSTEM.instances[0].interfaces, key=lambda end: order.index(end.declared))
    driver = replace(SYSTEM.instances[0], interfaces=tuple(ordered))
    assert found.configuration == SYSTEM.configuration
    assert found.instances[0] == driver
    assert found.instances[1] == SYSTEM.instances[1]
    assert found.similar == SYSTEM.similar
    assert found.shared_parameters == SYSTEM.shared_parameters


def test_ends_lead_to_the_line_of_code(store: Store) -> None:
    """A name in a system is one step from its declaration in code."""
    rows = Union(store).query(
        """SELECT ?path ?line {
             ?instance a rnkg:NodeInstance ; ros:hasComponent ?end .
             ?end rnkg:connectsTo/rdfs:label "/rover/cmd" ; rnkg:declaredBy|rnkg:overrides ?code .
             ?code rnkg:path ?path ; rnkg:line ?line }""",
        prefixes=PREFIXES,
    )
    assert [(row["path"].value, row["line"].value) for row in rows] == [("rover_base/src/main.cpp", "10")]


def test_what_is_shared_is_not_said_again(store: Store) -> None:
    """A message type is described once, by systems only if no node type uses it; changed qualities are added."""
    quads = store.quads_for_pattern(None, None, None, NamedNode(IRIS.launch_graph(ROVER, LAUNCH)))
    own = {str(quad.subject)[1:-1] for quad in quads}
    assert [iri for iri in own if iri.startswith(f"{BASE}message/")] == [f"{BASE}message/sensor_msgs/Image"]
    assert [iri for iri in own if iri.startswith(f"{BASE}qos/")]


def test_the_same_facts_make_the_same_bytes(store: Store) -> None:
    """Writing a system again gives the same bytes."""
    assert system_triples(SYSTEM, records(store), IRIS) == system_triples(SYSTEM, records(store), IRIS)


def test_an_end_without_its_node_type_is_left_out() -> None:
    """A system can be read without its removed node types; plugins' ends have their own evidence."""
    store = Store()
    content = system_triples(SYSTEM, {}, IRIS)
    for facts in ([], [replace(FACTS, nodes=())]):
        source = source_triples(REPOSITORY, facts, IRIS)
        store.load(source, RdfFormat.N_TRIPLES, to_graph=NamedNode(IRIS.source_graph(ROVER)))
    store.load(content, RdfFormat.N_TRIPLES, to_graph=NamedNode(IRIS.launch_graph(ROVER, LAUNCH)))
    (found,) = systems(Union(store), system_names(Union(store)), BASE)
    assert [len(one.interfaces) for one in found.instances] == [0, 2]
