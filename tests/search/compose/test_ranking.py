from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from search.compose.chaining import answer_of, interface, node, store_of

from kg.facts import NodeKind, Role

if TYPE_CHECKING:
    from pathlib import Path

    from kg.facts import NodeType

SCAN, GRID, TWIST = "sensor_msgs/LaserScan", "nav_msgs/OccupancyGrid", "geometry_msgs/Twist"


def drive(name: str, **more: object) -> NodeType:
    """Return a node that converts scans into velocities."""
    return node(name, {"scan": SCAN}, {"cmd_vel": TWIST}, **more)  # type: ignore[arg-type]  # of several types


def order(folder: Path, *nodes: NodeType, **more: object) -> list[str]:
    """Return the chains from scans to velocities, the best first, as the names of their nodes."""
    found = answer_of(store_of(folder / "store", *nodes), SCAN, TWIST, **more).chains
    return [" ".join(one.part.name for one in chain.nodes) for chain in found]


def test_fewer_nodes_come_first(tmp_path: Path) -> None:
    """A chain of one node comes before one of two, whatever else it needs."""
    alone = node("alone", {"scan": SCAN, "a": "m/A", "b": "m/B", "c": "m/C", "d": "m/D"}, {"cmd_vel": TWIST})
    pair = node("mapper", {"scan": SCAN}, {"map": GRID}), node("planner", {"map": GRID}, {"cmd_vel": TWIST})
    assert order(tmp_path, *pair, alone) == ["alone", "mapper planner"]


@pytest.mark.parametrize(
    "worse",
    [
        drive("test_driver"),
        drive("driver", path="robots/examples/driver.cpp"),
        drive("scan_relay"),
        drive("bagrecorder_record"),
    ],
    ids=lambda one: one.name,
)
def test_tests_demos_and_tools_come_behind_longer_chains(worse: NodeType, tmp_path: Path) -> None:
    """Tests, demos and tools that pass on any message rank low, because they are rarely reused."""
    pair = node("mapper", {"scan": SCAN}, {"map": GRID}), node("planner", {"map": GRID}, {"cmd_vel": TWIST})
    assert order(tmp_path, worse, *pair) == ["mapper planner", worse.name]


def test_fewer_inputs_that_nobody_gives_come_first(tmp_path: Path) -> None:
    """Of two nodes, the one without other needs is better; the needs of the other are listed."""
    needy = node("aaa", {"scan": SCAN, "map": GRID}, {"cmd_vel": TWIST})
    answer = answer_of(store_of(tmp_path / "store", needy, drive("bbb")), SCAN, TWIST)
    assert [chain.nodes[0].part.name for chain in answer.chains] == ["bbb", "aaa"]
    assert [port.type for port in answer.chains[1].nodes[0].needs] == [GRID]


def test_a_node_that_changes_what_it_gives_comes_behind_one_that_makes_it(tmp_path: Path) -> None:
    """A node that also takes the target type is probably a filter of it."""
    guard = node("aaa", {"scan": SCAN, "raw_cmd_vel": TWIST}, {"cmd_vel": TWIST})
    follower = node("bbb", {"scan": SCAN, "map": GRID}, {"cmd_vel": TWIST})
    assert order(tmp_path, guard, follower) == ["bbb", "aaa"]


def test_messages_without_meaning_are_hardly_a_link(tmp_path: Path) -> None:
    """A chain over a plain string comes after a longer one over specific types."""
    text = node("a", {"scan": SCAN}, {"x": "std_msgs/String"}), node("b", {"x": "std_msgs/String"}, {"cmd_vel": TWIST})
    long = (
        node("c", {"scan": SCAN}, {"map": GRID}),
        node("d", {"map": GRID}, {"path": "nav_msgs/Path"}),
        node("e", {"path": "nav_msgs/Path"}, {"cmd_vel": TWIST}),
    )
    assert order(tmp_path, *text, *long) == ["c d e", "a b"]


def test_versions_of_ros_are_never_mixed(tmp_path: Path) -> None:
    """Nodes of ROS 1 and ROS 2 are never linked; each version has its own chains."""
    old = node("mapper", {"scan": SCAN}, {"map": GRID}), node("planner", {"map": GRID}, {"cmd_vel": TWIST})
    new = (
        node("mapper2", {"scan": SCAN}, {"map": GRID}, ros=2),
        node("planner2", {"map": GRID}, {"cmd_vel": TWIST}, ros=2),
    )
    assert order(tmp_path, *old, *new) == ["mapper planner", "mapper2 planner2"]
    assert order(tmp_path / "again", *old, *new, ros=2) == ["mapper2 planner2"]


def test_variants_and_copies_are_one_chain(tmp_path: Path) -> None:
    """The program and the nodelet of a node, and its copy in another repository, are in one result."""
    store = store_of(
        tmp_path / "store", drive("Driver", kind="nodelet"), drive("driver_node"), robots=[drive("driver_node")]
    )
    (chain,) = answer_of(store, SCAN, TWIST).chains
    assert chain.nodes[0].part.kind == NodeKind.EXECUTABLE
    assert {one.name for one in chain.nodes[0].others} == {"Driver", "driver_node"}


def test_only_what_a_launch_file_can_start_is_used(tmp_path: Path) -> None:
    """Classes and plugins are not used in chains; neither are ends that a launch file cannot name."""
    unknown = node("blind", {}, {"cmd_vel": TWIST}, more=[interface(Role.SUBSCRIBES, None, SCAN)])
    partial = node("half", {"{}/scan": SCAN}, {"cmd_vel": TWIST})
    found = order(tmp_path, drive("base", kind="class"), drive("layer", kind="plugin"), unknown, partial, drive("real"))
    assert found == ["real"]


def test_an_end_for_debugging_is_not_the_one(tmp_path: Path) -> None:
    """Of two outputs of a type, the one for debugging is not used."""
    two = node("driver", {"scan": SCAN}, {"a_debug": TWIST, "cmd_vel": TWIST})
    (chain,) = answer_of(store_of(tmp_path / "store", two), SCAN, TWIST).chains
    assert chain.nodes[0].start.given.name == "cmd_vel"


def test_a_topic_that_a_node_publishes_and_subscribes_is_its_own_need(tmp_path: Path) -> None:
    """A node's topic to itself is not an unmet input, and may be its output."""
    mapper = node("mapper", {"scan": SCAN, "/map": GRID}, {"/map": GRID})
    (chain,) = answer_of(store_of(tmp_path / "store", mapper), SCAN, GRID).chains
    assert not chain.nodes[0].needs


def test_chains_much_longer_than_the_best_are_left_out_unless_asked_for(tmp_path: Path) -> None:
    """If one node is enough, a chain of three is left out, unless the length is given."""
    way = (
        node("c", {"scan": SCAN}, {"map": GRID}),
        node("d", {"map": GRID}, {"path": "nav_msgs/Path"}),
        node("e", {"path": "nav_msgs/Path"}, {"cmd_vel": TWIST}),
    )
    assert order(tmp_path, drive("one"), *way) == ["one"]
    assert order(tmp_path / "again", drive("one"), *way, length=3) == ["one", "c d e"]


def test_reading_twice_gives_the_same(tmp_path: Path) -> None:
    """The network is cached with the store; a damaged file is replaced."""
    store = store_of(tmp_path / "store", drive("one"), node("two", {"scan": SCAN}, {"map": GRID}))
    first = answer_of(store, SCAN, TWIST).chains
    (kept,) = (store.layout.cache / "compose").iterdir()
    assert answer_of(store, SCAN, TWIST).chains == first
    kept.write_bytes(kept.read_bytes()[:-9])
    assert answer_of(store, SCAN, TWIST).chains == first
