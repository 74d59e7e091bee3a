from __future__ import annotations

from dataclasses import replace

from render.systems import CAMERA, end, instance, system

from kg.facts import Role
from kg.render.system_graph import bundles, system_graph
from kg.render.system_notations import system_lines, system_object, system_rows
from kg.render.system_views import around, collapsed, near_changes, overlaid

GRAPH = system_graph(system(CAMERA))


def test_framework_ends_are_left_out_and_counted() -> None:
    """Implicit ends are hidden by default."""
    assert all(channel.name != "/rosout" for channel in GRAPH.channels)
    assert GRAPH.hidden == ("1 end that frameworks make",)
    assert any(channel.name == "/rosout" for channel in system_graph(system(CAMERA), every=True).channels)


def test_channels_between_the_same_nodes_are_one_bundle() -> None:
    """`/rect` and `/rect/info` connect the same two nodes."""
    names = [[channel.name for channel in bundle.channels] for bundle in bundles(GRAPH)]
    assert ["/rect", "/rect/info"] in names


def test_a_name_that_is_not_known_joins_nothing() -> None:
    """Two ends without names are two channels, each open."""
    two = [instance("/a", end(Role.PUBLISHES, "/{}/x")), instance("/b", end(Role.SUBSCRIBES, "/{}/x"))]
    channels = system_graph(system(two)).channels
    assert [channel.open for channel in channels] == [True, True]


def test_two_nodes_of_one_name_are_two_boxes() -> None:
    """The second has a number after its name."""
    graph = system_graph(system([instance("/a"), instance("/a")]))
    assert [member.key for member in graph.members] == ["/a", "/a#2"]


def test_a_host_that_is_not_started_is_there_all_the_same() -> None:
    """A nodelet in a manager of another launch file is in a box with that note."""
    graph = system_graph(system([instance("/a", host="/far")]))
    assert [(member.key, member.kind) for member in graph.members] == [("/a", "node"), ("/far", "host")]


def test_focus_keeps_what_is_near() -> None:
    """The detector is one channel away from the base, the rectifier and its host two."""
    assert [one.key for one in around(GRAPH, ["/base"]).members] == ["/base", "/detector"]
    assert [one.key for one in around(GRAPH, ["/base"], 2).members] == ["/base", "/detector", "/manager", "/rectify"]
    assert around(GRAPH, ["/base"]).hidden[-1] == "3 nodes farther away"


def test_namespaces_become_boxes_where_there_are_many_nodes() -> None:
    """The deepest namespaces are collapsed first; expanded ones remain; the content of one is counted."""
    robots = [
        instance(f"/{robot}/arm/{part}", end(Role.PUBLISHES, f"/{robot}/arm/joints"), end(Role.SUBSCRIBES, "/stop"))
        for robot in ("one", "two")
        for part in ("left", "right")
    ]
    graph = system_graph(system([*robots, instance("/boss", end(Role.PUBLISHES, "/stop"))]))
    small = collapsed(graph, most=3)
    assert [(one.key, one.count) for one in small.members] == [("/boss", 1), ("/one/arm/*", 2), ("/two/arm/*", 2)]
    assert [channel.name for channel in small.channels] == ["/stop"]
    assert small.hidden == ("2 channels inside of namespaces",)
    expanded = collapsed(graph, ["/one"], most=3)
    assert [one.key for one in expanded.members] == ["/boss", "/one/arm/left", "/one/arm/right", "/two/arm/*"]
    assert collapsed(graph, most=5) == graph


def test_two_systems_laid_over_each_other_tell_what_came_and_went() -> None:
    """Nodes, channels and ends are marked as added or removed; those named as changed are marked so."""
    before = system_graph(system([instance("/a", end(Role.PUBLISHES, "/x")), instance("/b")]))
    after = system_graph(system([instance("/a", end(Role.PUBLISHES, "/y")), instance("/c")]))
    both = overlaid(before, after, {"/a"})
    assert {one.key: one.state for one in both.members} == {"/a": "changed", "/b": "gone", "/c": "new"}
    assert {one.name: one.state for one in both.channels} == {"/x": "gone", "/y": "new"}
    assert {one.channel: one.state for one in both.links} == {"topic /x": "gone", "topic /y": "new"}
    assert overlaid(before, before).states() == frozenset()


def test_what_is_far_from_changes_can_be_left_out() -> None:
    """An added node is shown with its neighbours; a system without changes is shown completely."""
    after = system_graph(system([*CAMERA, instance("/undock", end(Role.ACTION_CLIENTS, "/dock"))]))
    assert [one.key for one in near_changes(overlaid(GRAPH, after)).members] == ["/base", "/detector", "/undock"]
    assert near_changes(GRAPH) == GRAPH


def test_an_end_that_a_node_might_not_have_keeps_its_condition() -> None:
    """Two ends of one name under different conditions have none in common."""
    odom, stamped, plain = (end(Role.SUBSCRIBES, name) for name in ("/odom", "/cmd", "/cmd"))
    doubtful = [
        replace(odom, switches=("use_odom",)),
        replace(stamped, switches=("stamped",)),
        replace(plain, switches=("!stamped",)),
    ]
    graph = system_graph(system([instance("/base", *doubtful)]))
    assert {row.name: row.condition for row in system_rows(graph)} == {"/odom": "if use_odom", "/cmd": ""}
    assert [line for line in system_lines(graph) if line.endswith("(nobody publishes), if use_odom")]
    assert [edge["condition"] for edge in system_object(graph)["edges"] if "condition" in edge] == ["if use_odom"]
