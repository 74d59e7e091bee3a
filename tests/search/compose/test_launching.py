from __future__ import annotations

import re
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree as ET

from hypothesis import given, settings
from hypothesis import strategies as st
from repository import ROOT
from search.compose.chaining import HERE, answer_of, interface, node, read, read_back, store_of, unconnected

import kg
from kg.facts import NodeReference, Role
from kg.pipeline.build import build
from kg.search.compose.details import Details
from kg.search.compose.launching import launch_text
from kg.search.compose.network import Part, Port
from kg.search.compose.results import Composed, Node
from kg.search.compose.wiring import wire
from kg.settings import load
from kg.store import opening
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from kg.facts import Interface, NodeInstance, NodeType

TYPES = ["sensor_msgs/Image", "nav_msgs/Path", "demo_msgs/Thing"]
TOPICS = ["image", "~/image", "/image", "out", "~/out", "a/b", "input", "nodelet_manager", None]


CHAINS = [
    (1, "LaserScan", "PointStamped", ["scan_filter", "camera_monitor"], ["scan_filter", "camera_monitor", "patrol"]),
    (1, "sensor_msgs/LaserScan", "Image", [], ["camera_monitor"]),
    (2, "nav_msgs/Odometry", "PoseStamped", [], ["flight_controller", "mission"]),
    (2, "CameraInfo", "Vector3Stamped", [], ["gimbal"]),
]
"""Chains of the example workspace: the version of ROS, input, output, requirements, and the nodes."""


def test_the_launch_files_connect_the_example_workspace_as_the_chains_say(tmp_path: Path) -> None:
    """Written into the workspace and built, the instances share the topics of the chains, with their types."""
    workspace = tmp_path / "robots"
    shutil.copytree(ROOT / "examples" / "workspace", workspace)
    given_settings = load({"store": tmp_path / "store", "jobs": 1})
    with opening.writable(given_settings) as store:
        build([str(workspace)], store, given_settings, rules=False)
        chains = []
        for ros, source, target, using, nodes in CHAINS:
            (chain, *_) = kg.compose([source], [target], using=using, ros=ros, store=store.layout.root)
            assert [one["name"] for one in chain["nodes"]] == nodes
            folder = workspace / ("rover/rover_robot" if ros == 1 else "drone/drone_control") / "launch"
            (folder / chain["launch_file"]).write_text(chain["launch"])
            chains.append(chain)
        build([], store, given_settings, rules=False)
    for chain in chains:
        found = kg.instances(chain["launch_file"], store=store.layout.root)
        _assert_connected(chain, {one["name"]: one for one in found})


def _assert_connected(chain: dict[str, Any], instances: dict[str, Any]) -> None:
    for one in chain["nodes"]:
        found = instances[f"/{one['name']}"]
        assert found["missing"] is None
        for role, end in (("subscribes", one["takes"]), ("publishes", one["gives"])):
            assert (end["topic"], end["type"]) in {(other["resolved"], other["type"]) for other in found[role]}
    topics = [one["gives"]["topic"] for one in chain["nodes"]]
    assert topics[:-1] == [one["takes"]["topic"] for one in chain["nodes"][1:]]


@st.composite
def random_chains(draw: st.DrawFn) -> tuple[int, list[tuple[NodeType, Port, Port]]]:
    """Return a version of ROS and nodes with an input and an output each, of different types."""
    ros = draw(st.sampled_from([1, 2]))
    kinds = ["executable", "script", "nodelet" if ros == 1 else "component"]
    links = [draw(st.sampled_from(TYPES))]
    found = []
    for at in range(draw(st.integers(1, 4))):
        links.append(draw(st.sampled_from([one for one in TYPES if one != links[-1]])))
        names = draw(st.lists(st.sampled_from(TOPICS), min_size=2, max_size=6, unique_by=_topic))
        ends = [(Role.SUBSCRIBES, names[0], links[-2]), (Role.PUBLISHES, names[1], links[-1])]
        ends += [
            (draw(st.sampled_from([Role.SUBSCRIBES, Role.PUBLISHES])), name, draw(st.sampled_from(TYPES)))
            for name in names[2:]
            if name is not None
        ]
        private = "~/" if ros == 1 else ""
        interfaces = [
            interface(role, name, kind, line=at + 1, parameter=None if name else f"{private}topic_{role.value}")
            for role, name, kind in ends
        ]
        name = draw(st.sampled_from(["same", "scan-filter", f"n{at}", "3d"]))
        made = node(name, {}, {}, ros=ros, kind=draw(st.sampled_from(kinds)), more=interfaces)
        found.append((made, port_of(interfaces[0], at), port_of(interfaces[1], at)))
    return ros, found


def _topic(name: str | None) -> str | None:
    return name.removeprefix("/") if name is not None else None


def port_of(fact: Interface, at: int) -> Port:
    """Return the end of a network for an interface."""
    return Port(f"p:{at}/{fact.role}/{fact.name}", fact.name, fact.type or "", fact.parameter)


def chain_of(ros: int, ways: list[tuple[NodeType, Port, Port]]) -> Composed:
    """Return the chain of nodes, each in its own package."""
    parts = []
    for at, (made, taken, given_port) in enumerate(ways):
        ports = [(one.role, port_of(one, at)) for one in made.interfaces]
        part = Part(
            f"n:{at}", HERE, f"p{at}", made.name, str(made.kind), ros, "src/x.cpp", 1, made.executable,
            made.plugin and f"p{at}/{made.name}", inputs=tuple(port for role, port in ports if role is Role.SUBSCRIBES),
            outputs=tuple(port for role, port in ports if role is Role.PUBLISHES),
        )  # fmt: skip
        parts.append((part, taken, given_port))
    wiring = wire(parts)
    return Composed(tuple(Node(start.part, start) for start in wiring.starts), wiring, Details(), 0)


@given(random_chains())
@settings(max_examples=60, deadline=None)
def test_the_launch_file_of_any_chain_connects_it(drawn: tuple[int, list[tuple[NodeType, Port, Port]]]) -> None:
    """Whatever the names, each node is on the topic before it and on the one after it.

    The only other ends on a topic are later nodes that subscribe to its type. Names of nodes and topics are valid and
    unique.
    """
    ros, ways = drawn
    chain = chain_of(ros, ways)
    types = [
        (NodeReference(HERE, f"p{at}", made.name), _loaded_from(made, f"p{at}")) for at, (made, _, _) in enumerate(ways)
    ]
    with tempfile.TemporaryDirectory() as folder:
        system = read_back(chain, types, Path(folder))
    assert not unconnected(chain, system)
    names = [start.name for start in chain.wiring.starts]
    topics = [link.topic for link in chain.wiring.links]
    assert len({*names, chain.wiring.host}) == len(names) + 1
    assert len(set(topics)) == len(topics)
    assert all(re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII) for name in names)
    assert all(re.fullmatch(r"(/[A-Za-z_]\w*)+", topic, re.ASCII) for topic in topics)
    for place, topic in enumerate(topics[1:], 1):
        users = {
            (instance.name, end.declared.role)
            for instance in system.instances
            for end in instance.interfaces
            if end.resolved == topic and not end.declared.implicit
        }
        assert {one.type for instance in system.instances for one in _on(instance, topic)} == {chain.types[place]}
        ends = {(f"/{names[place - 1]}", Role.PUBLISHES)}
        ends |= {(f"/{names[place]}", Role.SUBSCRIBES)} if place < len(names) else set()
        assert ends <= users
        assert users - ends <= {(f"/{name}", Role.SUBSCRIBES) for name in names[place:]}


def _on(instance: NodeInstance, topic: str) -> list[Interface]:
    """Return the ends of an instance on a topic."""
    return [end.declared for end in instance.interfaces if end.resolved == topic]


def _loaded_from(made: NodeType, package: str) -> NodeType:
    return replace(made, plugin=f"{package}/{made.name}") if made.plugin else made


def test_a_launch_file_says_what_else_is_needed(tmp_path: Path) -> None:
    """Comments contain the lines of the ends, inputs without publisher, and parameters without a default."""
    planner = node(
        "planner", {"scan": "sensor_msgs/LaserScan", "map": "nav_msgs/OccupancyGrid"}, {"out": "geometry_msgs/Twist"},
        parameters=[read("~/frame -- id"), read("~/rate", "5.0"), read("~/robot")],
    )  # fmt: skip
    answer = answer_of(store_of(tmp_path / "s", planner), "LaserScan", "Twist")
    text = launch_text(answer.chains[0])
    ET.fromstring(text)  # noqa: S314 - written here; a comment with two hyphens would not parse
    assert "also needs nav_msgs/OccupancyGrid as map" in text
    assert "takes sensor_msgs/LaserScan as `scan`: src/x.cpp:10" in text
    assert '<!-- <param name="robot" value=""/> string, src/x.cpp:30 -->' in text
    assert '"rate"' not in text


def test_what_nodes_of_a_chain_give_besides_is_told(tmp_path: Path) -> None:
    """A second topic between two nodes is not a need; one with only the same type is."""
    gives = {"cloud": "sensor_msgs/PointCloud2", "pose": "geometry_msgs/PoseStamped"}
    takes = {**gives, "goal": "geometry_msgs/PoseStamped"}
    tracker = node("tracker", {"scan": "sensor_msgs/LaserScan"}, gives)
    store = store_of(tmp_path / "s", tracker, node("follower", takes, {"cmd_vel": "geometry_msgs/Twist"}))
    chain = answer_of(store, "LaserScan", "Twist", using=["PointCloud2"]).chains[0]
    assert [port.name for port in chain.nodes[1].fed] == ["pose"]
    assert [port.name for port in chain.nodes[1].needs] == ["goal"]
    assert "is also given geometry_msgs/PoseStamped as pose" in launch_text(chain)


def test_switches_and_parameters_that_name_topics_are_set(tmp_path: Path) -> None:
    """An input named by a parameter is wired by it, and one enabled by a parameter is enabled."""
    more = [
        interface(Role.SUBSCRIBES, None, "sensor_msgs/Image", parameter="~/picture"),
        interface(Role.PUBLISHES, "cloud", "sensor_msgs/PointCloud2", switches=("~/dense", "!~/quiet")),
    ]
    answer = answer_of(store_of(tmp_path / "s", node("depth", {}, {}, more=more)), "Image", "PointCloud2")
    text = launch_text(answer.chains[0])
    assert '<param name="picture" value="$(arg input)"/>' in text
    assert '<param name="dense" value="true"/>' in text
    assert '<param name="quiet" value="false"/>' in text


def test_nodelets_get_a_manager_and_components_a_container(tmp_path: Path) -> None:
    """Nodelets and components are loaded by a manager or container in the launch file."""
    scan, cloud = {"scan": "sensor_msgs/LaserScan"}, {"cloud": "sensor_msgs/PointCloud2"}
    store = store_of(
        tmp_path / "s", node("Old", scan, cloud, kind="nodelet"), node("New", scan, cloud, ros=2, kind="component")
    )
    old, new = (launch_text(answer_of(store, "LaserScan", "PointCloud2", ros=ros).chains[0]) for ros in (1, 2))
    assert 'type="nodelet" name="nodelet_manager" args="manager"' in old
    assert 'args="load robots/Old nodelet_manager"' in old
    assert "ComposableNodeContainer(" in new
    assert "plugin='robots::New'" in new


def test_a_file_name_follows_from_the_types(tmp_path: Path) -> None:
    """The name of the file comes from the types of input and output, with the suffix of its language."""
    store = EmbeddedStore(store_of(tmp_path / "s", node("x", {"a": "m/In"}, {"b": "m/Out"}, ros=2)).layout)
    assert answer_of(store, "In", "Out").chains[0].file_name == "in_to_out.launch.py"
