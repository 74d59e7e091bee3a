"""Tests of the views of one node and of the tree."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UnknownNameError, UsageError
from kg.facts import Location, NodeKind, NodeReference, NodeType, PluginDefault, PluginSlot
from kg.graph.reading.nodes import NodeRecord
from kg.views.evidence import places
from kg.views.node import node
from kg.views.node_rows import slot_rows
from kg.views.tree import tree

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_a_node_has_all_that_its_page_shows(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A node is found by name and by IRI, and each interface has its line and its inferred fact."""
    found = node(snapshot, settings, name="scan_filter")
    assert node(snapshot, settings, iri=found["iri"]) == found
    assert (found["kind"], found["language"], found["ros"]) == ("nodelet", "C++", 1)
    assert found["package"]["name"] == "rover_robot"
    published = next(one for one in found["interfaces"] if one["role"] == "publishes" and not one["implicit"])
    assert published["evidence"]["path"].endswith("scan_filter_nodelet.cpp")
    assert published["fact"]["predicate"].endswith("#publishes")
    assert published["fact"]["object"] == published["channel_iri"]


def test_what_is_inferred_is_marked(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Functions, hardware and capabilities have the fact proven by `why`."""
    found = node(snapshot, settings, name="base_controller")["capabilities"]
    speed = next(one for one in found if one["iri"].endswith("#sensingVelocity"))
    assert speed["inferred"]
    assert speed["fact"]["predicate"].endswith("#hasCapability")


def test_the_package_is_described_by_its_manifest(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The description of a package is that of its manifest."""
    found = node(snapshot, settings, name="scan_filter")["package_description"]
    assert found["text"].startswith("Drives a wheeled robot")
    assert found["evidence"]["path"].endswith("rover_robot/package.xml")


def test_a_parameter_is_one_row(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Each parameter has a unique name, and all lines that mention it."""
    found = node(snapshot, settings, name="patrol")["parameters"]
    names = [one["name"] for one in found if one["name"]]
    assert names
    assert len(names) == len(set(names))
    assert all(one["places"][0]["line"] == one["evidence"]["line"] for one in found)


def test_a_plugin_says_what_registers_it(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """The line of a plugin's description is its evidence; other nodes have none."""
    found = node(snapshot, settings, name="scan_filter")
    assert found["exported"]["path"].endswith("nodelet_plugins.xml")
    assert found["exported"]["line"] == 2
    assert node(snapshot, settings, name="base_controller")["exported"] is None


def test_a_slot_leads_to_its_default_plugins(snapshot: EmbeddedSnapshot) -> None:
    """A default has the IRI of its record, or none; the row has the origin of the class, and its line."""
    defaults = (PluginDefault("nav::Fast", "fast"), PluginDefault("nav::Slow", "slow"))
    slot = PluginSlot("nav::Planner", Location("src/server.cpp", 12), "planners", "{id}.plugin", defaults)
    server = NodeType("server", NodeKind.EXECUTABLE, "cpp", 2, Location("src/main.cpp", 3), slots=(slot,))
    known = {"nav::Fast": (NodeReference("local/ws", "plans", "Fast"), "urn:fast")}
    (row,) = slot_rows(NodeRecord("local/ws", None, "nav", server, plugins=known), places(snapshot))
    assert [(one["class"], one["iri"]) for one in row["defaults"]] == [("nav::Fast", "urn:fast"), ("nav::Slow", None)]
    assert (row["how"], row["evidence"]["line"]) == ("parameters planners, {id}.plugin", 12)


def test_launch_lines_and_neighbours(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A node has its launch lines, and the nodes at the other end of its channels."""
    found = node(snapshot, settings, name="base_controller")
    assert found["used_in"]["count"] == 1
    (used,) = found["used_in"]["instances"]
    assert used["system"] == "rover_robot/launch/rover.launch"
    assert used["evidence"]["path"].endswith(".launch")
    assert all(near["count"] >= len(near["nodes"]) >= 1 for near in found["neighbours"])
    assert all(other["iri"] != found["iri"] for near in found["neighbours"] for other in near["nodes"])


def test_names_that_mean_nothing(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A misspelt name gets suggestions; unknown and invalid IRIs have different errors."""
    with pytest.raises(UnknownNameError) as caught:
        node(snapshot, settings, name="scan_fliter")
    assert "`scan_filter`" in (caught.value.hint or "")
    with pytest.raises(UnknownNameError):
        node(snapshot, settings, iri="https://w3id.org/rnkg/topic/scan")
    with pytest.raises(UsageError, match="is not an IRI"):
        node(snapshot, settings, iri="no iri at all")


def test_the_tree_opens_down_to_interfaces(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Packages contain nodes, nodes the groups of their interfaces, groups the interfaces, and counts agree."""
    roots = {one["label"]: one for one in tree(snapshot, settings)["children"]}
    assert list(roots) == ["packages", "systems", "topics", "services", "actions"]
    packages = tree(snapshot, settings, **roots["packages"]["open"])["children"]
    assert len(packages) == roots["packages"]["count"]
    package = next(one for one in packages if one["label"] == "rover_robot")
    nodes = tree(snapshot, settings, **package["open"])["children"]
    assert len(nodes) == package["count"]
    patrol = next(one for one in nodes if one["label"] == "patrol")
    groups = tree(snapshot, settings, **patrol["open"])["children"]
    names = {}
    for group in groups:
        leaves = tree(snapshot, settings, **group["open"])["children"]
        assert len(leaves) == group["count"]
        assert all(leaf["open"] is None for leaf in leaves)
        names[group["label"]] = {leaf["label"] for leaf in leaves}
    assert "scan_filtered" in names["subscribes"] - names["publishes"]
    assert "/emergency_stop" in names["publishes"] - names["subscribes"]


def test_systems_and_topics_in_the_tree(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Systems contain their instances, topics their nodes; a level may be requested in parts."""
    systems = tree(snapshot, settings, parent="systems")["children"]
    rover = next(one for one in systems if one["label"].endswith("rover.launch"))
    instances = tree(snapshot, settings, **rover["open"])["children"]
    assert len(instances) == rover["count"] == 7
    topics = tree(snapshot, settings, parent="topics", offset="1", limit="2")
    assert len(topics["children"]) == 2
    assert topics["total"] > 2
    some = next(one for one in tree(snapshot, settings, parent="topics")["children"] if one["count"])
    assert tree(snapshot, settings, **some["open"])["children"][0]["kind"] == "node"


def test_a_node_counts_the_same_wherever_it_stands(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A node has the same number of interfaces below a topic as below its package."""
    topics = tree(snapshot, settings, parent="topics")["children"]
    scans = next(one for one in topics if one["label"] == "/scan_filtered")
    at_topic = tree(snapshot, settings, **scans["open"])["children"]
    assert {one["label"]: one["detail"] for one in at_topic}["rover_robot/scan_filter"] == "publishes"
    below = {one["iri"]: one["count"] for one in at_topic}
    packages = tree(snapshot, settings, parent="packages")["children"]
    package = next(one for one in packages if one["label"] == "rover_robot")
    counts = {one["iri"]: one["count"] for one in tree(snapshot, settings, **package["open"])["children"]}
    assert below == {iri: counts[iri] for iri in below}
    assert all(below.values())


def test_no_such_branch(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An unknown branch is an error with instructions."""
    with pytest.raises(UnknownNameError, match="no branch"):
        tree(snapshot, settings, parent="https://example.org/x")


def test_a_capability_is_listed_once(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """One that the node has is not also one that it may have."""
    found = [one["label"] for one in node(snapshot, settings, name="flight_controller")["capabilities"]]
    assert "know where its parts are" in found
    assert len(found) == len(set(found))


def test_lines_and_general_capabilities(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """An interface has the text of its statement; capabilities with a channel are not general."""
    found = node(snapshot, settings, name="flight_controller")
    (state,) = (one for one in found["interfaces"] if one["name"] == "state")
    assert "names::kState" in state["line_text"]
    (home,) = (one for one in found["interfaces"] if one["name"] == "set_home")
    assert '"set_home"' in home["line_text"]
    general = {one["label"]: one["general"] for one in found["capabilities"]}
    assert set(general.values()) == {True, False}
    assert general["know"]
