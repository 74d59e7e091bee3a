from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from search.compose.chaining import answer_of, interface, node, store_of

from kg.errors import UnknownNameError
from kg.facts import Role
from kg.search.compose import Question, compose
from kg.search.compose.asking import matching_types

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.embedded import EmbeddedStore

KNOWN = {"sensor_msgs/Image", "nav_msgs/Path", "demo_msgs/Path", "sensor_msgs/LaserScan"}
SCAN, CLOUD, GRID, TWIST = (
    "sensor_msgs/LaserScan",
    "sensor_msgs/PointCloud2",
    "nav_msgs/OccupancyGrid",
    "geometry_msgs/Twist",
)


@pytest.fixture
def store(tmp_path: Path) -> EmbeddedStore:
    """Return a store with two ways from scans to velocities, and a filter of scans."""
    return store_of(
        tmp_path / "store",
        node("mapper", {"scan": SCAN}, {"map": GRID}),
        node("planner", {"map": GRID}, {"cmd_vel": TWIST}),
        node("projector", {"scan": SCAN}, {"cloud": CLOUD}),
        node("follower", {"cloud": CLOUD}, {"cmd_vel": TWIST}),
        node("scan_filter", {"scan": SCAN}, {"filtered": SCAN}),
    )


def nodes(store: EmbeddedStore, source: str, target: str, *using: str, **more: int) -> list[list[str]]:
    """Return the names of the nodes of each chain."""
    answer = answer_of(store, source, target, using=using, **more)
    return [[one.part.name for one in chain.nodes] for chain in answer.chains]


@pytest.mark.parametrize(
    ("name", "types"),
    [
        ("sensor_msgs/Image", ["sensor_msgs/Image"]),
        ("sensor_msgs/msg/Image", ["sensor_msgs/Image"]),
        ("sensor_msgs::msg::Image", ["sensor_msgs/Image"]),
        ("Image", ["sensor_msgs/Image"]),
        ("laserscan", ["sensor_msgs/LaserScan"]),
        ("Path", ["demo_msgs/Path", "nav_msgs/Path"]),
    ],
)
def test_types_are_meant_in_several_spellings(name: str, types: list[str]) -> None:
    """A type is written in full, in the syntax of ROS 2 or C++, or by its last part, which may match several."""
    assert matching_types(name, KNOWN) == tuple(types)


def test_a_type_that_is_not_there_gets_near_names() -> None:
    """KG705 contains similar names."""
    with pytest.raises(UnknownNameError, match="LazerScan") as caught:
        matching_types("LazerScan", KNOWN)
    assert caught.value.code == "KG705"
    assert "LaserScan" in (caught.value.hint or "")


def test_a_chain_goes_through_what_is_asked_for(store: EmbeddedStore) -> None:
    """A node, a type and a word select among chains; without them all are found."""
    both = [["mapper", "planner"], ["projector", "follower"]]
    assert sorted(nodes(store, "LaserScan", "Twist")) == both
    assert nodes(store, "LaserScan", "Twist", "robots/planner") == both[:1]
    assert nodes(store, "LaserScan", "Twist", "PointCloud2") == both[1:]
    assert nodes(store, "LaserScan", "Twist", "projector", "follower") == both[1:]


def test_a_node_that_keeps_the_type_is_used_only_by_name(store: EmbeddedStore) -> None:
    """A filter is only a step of a chain if requested, or if its type is both source and target."""
    assert nodes(store, "LaserScan", "OccupancyGrid") == [["mapper"]]
    assert nodes(store, "LaserScan", "OccupancyGrid", "scan_filter") == [["scan_filter", "mapper"]]
    assert nodes(store, "LaserScan", "LaserScan") == [["scan_filter"]]


def test_what_to_go_through_has_to_mean_something(store: EmbeddedStore) -> None:
    """KG707 contains similar names."""
    with pytest.raises(UnknownNameError) as caught:
        nodes(store, "LaserScan", "Twist", "planer")
    assert caught.value.code == "KG707"
    assert "`planner`" in (caught.value.hint or "")


def test_several_types_may_be_there_and_wanted(tmp_path: Path) -> None:
    """The first node takes one of several types; needing the others does not add to its cost."""
    image, info = "sensor_msgs/Image", "demo_msgs/Model"
    found = node("cloud", {"image": image, "model": info}, {"points": CLOUD})
    store = store_of(tmp_path / "store", found)
    with store.read() as snapshot:
        (chain,) = compose(snapshot, Question((image, info), ("PointCloud2",))).chains
        (other,) = compose(snapshot, Question((image,), ("PointCloud2",))).chains
    assert chain.cost < other.cost
    assert [port.type for port in chain.nodes[0].needs] == [info]


def test_frameworks_make_no_links(tmp_path: Path) -> None:
    """Transforms, clocks and topics of frameworks connect all nodes, so they are not links."""
    transforms = "tf2_msgs/TFMessage"
    hidden = [interface(Role.PUBLISHES, "out", "demo_msgs/Out", implicit=True)]
    store = store_of(
        tmp_path / "store",
        node("localizer", {"scan": SCAN}, {"/tf": transforms}, more=hidden),
        node("tracker", {"tf": transforms, "in": "demo_msgs/Out"}, {"cmd_vel": TWIST}),
    )
    with pytest.raises(UnknownNameError) as caught:
        nodes(store, "LaserScan", "Twist")
    assert caught.value.code == "KG706"
