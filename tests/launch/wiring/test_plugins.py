"""The table of plugins, and the plugins loaded by a parameter value."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kg.errors import UsageError
from kg.facts import Location as Where
from kg.facts import NodeKind, NodeReference, NodeType, PluginDefault, PluginSlot
from kg.launch.wiring.inner_nodes import Inner
from kg.launch.wiring.place import Place
from kg.launch.wiring.plugin_table import load_rows, rows
from kg.launch.wiring.plugins import Framework, Loaded, loaded_plugins, table
from kg.launch.wiring.types import NodeTypes

if TYPE_CHECKING:
    from pathlib import Path

LAYER = NodeType(
    "StaticLayer",
    NodeKind.PLUGIN,
    "cpp",
    1,
    Where("x.cpp", 1),
    plugin="costmap_2d::StaticLayer",
    base_class="costmap_2d::Layer",
)
TYPES = NodeTypes([(NodeReference("local/here", "costmap_2d", "StaticLayer"), LAYER)])


def found(name: str, value: str, ros: int = 1, slots: tuple[PluginSlot, ...] = ()) -> list[tuple[str, str, bool]]:
    """Return id, private namespace in the node `/n`, and whether the build has the class."""
    plugins = loaded_plugins({name: value}, TYPES, "local/here", ros, None, slots)
    return [(one.id, one.place(Place("/", "n")).private or "", one.typed is not None) for one in plugins]


def test_the_table_can_be_used_and_says_where_it_is_from() -> None:
    """Each row of the shipped table has a base class and a source."""
    assert table()
    assert all(row.base and row.source and row.ros in {1, 2} for row in table().values())
    assert all(row.of and row.name and row.source and row.ros in {1, 2} for row in rows("inner", Inner))


@pytest.mark.parametrize(
    "text", ["plugin = 3", "[[plugin]]\nros = 1", "[[plugin]]\nbase = 'b'\nros = 1\nsource = 's'\nprivat = '~'", "["]
)
def test_a_table_that_cannot_be_used_is_named(tmp_path: Path, text: str) -> None:
    """The error has the file as its place."""
    path = tmp_path / "plugins.toml"
    path.write_text(text, "utf-8")
    with pytest.raises(UsageError) as caught:
        load_rows(path, "plugin", Framework)
    assert caught.value.code == "KG002"
    assert caught.value.place is not None
    assert caught.value.place.path == str(path)


@pytest.mark.parametrize("kind", ["costmap_2d::StaticLayer", "costmap_2d/StaticLayer"])
def test_a_class_is_known_by_both_of_its_spellings(kind: str) -> None:
    """Pluginlib accepts classes as `pkg/Class` and by their C++ names."""
    assert found("costmap/plugins", f"[{{name: s, type: '{kind}'}}]") == [("s", "/n/costmap/s", True)]
    assert found("layer", f'"{kind}"') == [("StaticLayer", "/n/StaticLayer", True)]


def test_other_values_load_nothing() -> None:
    """Types of messages, frames, numbers, broken YAML and unknown values are not plugins."""
    for value in ("sensor_msgs/Image", "odom/base", "[1, 2]", "[{a: b}]", "{x: y", "[[]]", "5"):
        assert found("x/type", value) == []
    assert list(loaded_plugins({"plugins": None}, TYPES, "local/here", 1, None)) == []


def test_slots_give_what_code_loads_by_default() -> None:
    """A class given by the code, and those of the names in a list whose parameters are not set."""
    place = Where("x.cpp", 1)
    fixed = PluginSlot("costmap_2d::Layer", place, defaults=(PluginDefault("costmap_2d::StaticLayer"),), fixed=True)
    assert [(one.id, one.typed is not None) for one in of_slot(fixed, {})] == [("StaticLayer", True)]
    named = PluginSlot(
        "costmap_2d::Layer",
        place,
        names="plugins",
        parameter="{id}.plugin",
        defaults=(PluginDefault("costmap_2d::StaticLayer", "one"), PluginDefault("costmap_2d::StaticLayer", "two")),
    )
    assert [one.id for one in of_slot(named, {})] == ["one", "two"]
    assert [one.id for one in of_slot(named, {"plugins": "[two]"})] == ["two"]
    assert [one.class_name for one in of_slot(named, {"plugins": "[two]", "two.plugin": "x::Y"})] == ["x::Y"]
    assert of_slot(PluginSlot("BT::TreeNode", place, defaults=(PluginDefault("x.xml"),)), {}) == []


def of_slot(slot: PluginSlot, values: dict[str, str | None]) -> list[Loaded]:
    """Return the plugins loaded by a node with a slot in ROS 2."""
    return list(loaded_plugins(values, TYPES, "local/here", 2, None, (slot,)))


def test_a_class_that_the_build_lacks_is_told_where_only_a_plugin_can_stand() -> None:
    """Lists with names, and parameters of slots, can only contain plugins."""
    assert found("a/plugins", "[{name: s, type: 'x::Y'}]") == [("s", "/n/s", False)]
    assert found("base_local_planner", "x/Y") == []
    slot = PluginSlot("nav_core::BaseLocalPlanner", Where("x.cpp", 1), parameter="~/base_local_planner")
    assert found("base_local_planner", "x/Y", slots=(slot,)) == [("Y", "/n/Y", False)]
    assert found("FollowPath.plugin", "x::Y", 2) == [("FollowPath", "/n/FollowPath", False)]
