"""Tests of the views of launch configurations and their findings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UnknownNameError
from kg.graph.reading.systems import system_names
from kg.graph.reading.systems import systems as read_systems
from kg.rules.selecting import Columns, columns_of
from kg.views.system import lint, system
from kg.views.systems import systems

if TYPE_CHECKING:
    from kg.facts import System
    from kg.graph.reading.systems import SystemName
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot


def test_the_list_agrees_with_each_system(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Every configuration is listed with its numbers of nodes, topics, services and actions."""
    found = systems(snapshot, settings)
    assert found["total"] == len(found["systems"]) == 4
    for one in found["systems"]:
        counts = system(snapshot, settings, name=one["iri"])["counts"]
        assert {kind: one[kind] for kind in ("nodes", "topics", "services", "actions")} == {
            kind: counts[kind] for kind in ("nodes", "topics", "services", "actions")
        }


def test_systems_of_columns_are_those_of_the_store(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """`kg instances` reads all systems from the columns of the last run of rules."""
    columns, names = columns_of(snapshot), system_names(snapshot)
    assert isinstance(columns, Columns)
    assert read_systems(columns, names, settings.base) == read_systems(snapshot, names, settings.base)


def test_the_list_is_searched_and_paged(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """All words must occur in the name or the source; invalid numbers count as missing."""
    assert [one["package"] for one in systems(snapshot, settings, text="ROVER arm")["systems"]] == ["rover_robot"]
    assert len(systems(snapshot, settings, offset="1", limit="2")["systems"]) == 2
    assert len(systems(snapshot, settings, offset="x", limit="-1")["systems"]) == 4


def test_a_system_as_a_table(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Ends have the nodes at the other end, and the line that gave them their name."""
    found = system(snapshot, settings, name="rover.launch")
    instances = {one["key"]: one for one in found["instances"]}
    arm = instances["/rover1/arm_server"]
    assert arm["node"]["name"] == "rover_robot/arm_server"
    ends = {end["resolved"]: end for end in arm["ends"]}
    gripper = ends["/rover1/gripper_position/command"]
    assert gripper["set_at"]["words"] == "remapped from /rover1/gripper/command"
    assert gripper["set_at"]["evidence"]["path"].endswith(".launch")
    assert gripper["nobody"] == "nobody subscribes"
    assert ends["/rover1/arm_server/set_gripper"]["others"] == ["/rover1/patrol"]
    assert arm["left_out"] > 0
    every = system(snapshot, settings, name="rover.launch", every="all")["instances"]
    assert sum(len(one["ends"]) for one in every) == sum(
        len(one["ends"]) + one["left_out"] for one in found["instances"]
    )


def test_a_system_as_a_graph(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Instances are grouped by namespace, and so are channels used only within one; edges lead to nodes."""
    found = system(snapshot, settings, name="rover.launch")["picture"]
    assert [one["id"] for one in found["groups"]] == ["/rover1"]
    nodes = {one["id"]: one for one in found["nodes"]}
    assert nodes["/rover1/patrol"]["group"] == "/rover1"
    assert nodes["/rover1/patrol"]["label"] == "patrol"
    for edge in found["edges"]:
        assert {edge["source"], edge["target"]} <= nodes.keys()
    assert any(one["debug"] for one in found["nodes"])
    named = [name for one in found["nodes"] if one["kind"] == "topic" for name in one["names"]]
    assert len(named) == len(set(named))


def test_names_that_are_not_known_are_one_node_for_each_instance(
    snapshot: EmbeddedSnapshot, settings: Settings
) -> None:
    """All ends of an instance with unknown names are drawn once, with the known parts of the names."""
    for name in ("arm.launch", "mission.launch.xml", "rover.launch"):
        found = system(snapshot, settings, name=name)
        nodes = {one["id"]: one for one in found["picture"]["nodes"] if one["kind"] == "unknown"}
        assert sum(len(one["names"]) for one in nodes.values()) <= found["counts"]["unresolved"]
        edges = [(one["source"], one["target"]) for one in found["picture"]["edges"] if one["kind"] == "unknown"]
        assert sorted(edges) == [(key.removeprefix("unknown "), key) for key in sorted(nodes)]
        assert bool(nodes) == bool(found["counts"]["unresolved"])


def test_findings_are_in_the_system_and_mark_what_they_are_about(
    snapshot: EmbeddedSnapshot, settings: Settings
) -> None:
    """The finding has its line with the text and its causes, and marks elements of the graph."""
    found = system(snapshot, settings, name="mission.launch.xml")
    (finding,) = found["findings"]
    assert (finding["code"], finding["severity"]) == ("KG401", "note")
    assert finding["place"]["line_text"] or finding["evidence"][0]["line_text"]
    assert finding["way_out"]
    assert any(0 in one["findings"] for one in found["picture"]["nodes"])
    assert lint(snapshot, settings, system="mission.launch.xml")["findings"] == found["findings"]


@pytest.mark.parametrize(
    ("name", "command"),
    [
        ("rover.launch", "roslaunch rover_robot rover.launch"),
        ("drone.launch.py", "ros2 launch drone_control drone.launch.py"),
    ],
)
def test_a_system_has_the_command_that_starts_it(
    snapshot: EmbeddedSnapshot, settings: Settings, name: str, command: str
) -> None:
    """The command is that of its version of ROS, with the package."""
    assert system(snapshot, settings, name=name)["start"] == command


def test_findings_of_all_and_of_a_package(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """Without a system all are checked; a level and a package filter the findings."""
    assert [one["code"] for one in lint(snapshot, settings)["findings"]] == ["KG401"]
    assert lint(snapshot, settings, level="error") == {"findings": [], "allowed": 0, "systems": 4}
    assert lint(snapshot, settings, package="rover_robot")["systems"] == 2
    with pytest.raises(UnknownNameError):
        lint(snapshot, settings, package="rover_robto")


def test_a_system_is_read_once_for_all_its_parts(
    snapshot: EmbeddedSnapshot, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A repeated request uses the same system without reading it; of several the last is cached."""
    read: list[str] = []

    def reading(graph: EmbeddedSnapshot, names: list[SystemName], base: str) -> list[System]:
        read.extend(name.name for name in names)
        return read_systems(graph, names, base)

    system(snapshot, settings, name="drone.launch.py")
    monkeypatch.setattr("kg.views.system.read_systems", reading)
    first, second = (system(snapshot, settings, name="rover.launch") for _ in range(2))
    assert first == second
    system(snapshot, settings, name="rover.launch", every="all")
    assert len(read) == 1
    system(snapshot, settings, name="drone.launch.py")
    assert system(snapshot, settings, name="rover.launch") == first
    assert len(read) == 3


def test_a_system_that_is_not_there(snapshot: EmbeddedSnapshot, settings: Settings) -> None:
    """A misspelt name gets suggestions; an empty one is an error."""
    with pytest.raises(UnknownNameError) as caught:
        system(snapshot, settings, name="rovr.launch")
    assert "rover.launch" in (caught.value.hint or "")
    with pytest.raises(UnknownNameError):
        system(snapshot, settings, name="")
