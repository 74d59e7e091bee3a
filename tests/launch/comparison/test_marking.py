from __future__ import annotations

from dataclasses import replace

from render.systems import end, instance, system

from kg.facts import Role
from kg.launch.comparison import Sources, compare
from kg.launch.comparison.report import changed_keys, changed_systems
from kg.render.system_graph import system_graph

ONE = instance("/a", end(Role.PUBLISHES, "/x", "a/A"))
BEFORE = system([ONE, instance("/b"), instance("/c")])
RETYPED = replace(ONE, interfaces=(end(Role.PUBLISHES, "/x", "b/B"),))
AFTER = system([RETYPED, instance("/b", condition="$(arg b)"), instance("/d")])
FOUND = compare(Sources(systems=[BEFORE]), Sources(systems=[AFTER]))


def test_the_keys_are_those_of_the_graph() -> None:
    """Changed nodes and channels have the keys of the graph; added and removed ones are excluded."""
    keys = changed_keys(FOUND, BEFORE.configuration.name)
    assert keys == {"/a", "/b", "topic /x"}
    graph = system_graph(AFTER)
    assert keys <= {one.key for one in graph.members} | {one.key for one in graph.channels}
    assert not changed_keys(FOUND, "another.launch")


def test_the_launch_files_whose_wiring_differs_are_named() -> None:
    """Equal sides have no differences."""
    assert changed_systems(FOUND) == (BEFORE.configuration.name,)
    assert not changed_systems(compare(Sources(systems=[AFTER]), Sources(systems=[AFTER])))
