from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from render.systems import PLACE, end, instance, system

from kg.facts import (
    InstanceRemap,
    LaunchArgument,
    LaunchParameter,
    Location,
    Remap,
    Role,
)
from kg.facts.systems import InstanceParameter
from kg.launch.comparison import Finding, Kind, Level, Sources, compare

if TYPE_CHECKING:
    from kg.facts import InstanceInterface, NodeInstance, System

LINE = Location("a.launch", 2)


def told(before: System, after: System) -> list[tuple[str, str, str]]:
    """Return level, kind and name of each change between two systems."""
    found = compare(Sources(systems=[before]), Sources(systems=[after])).changes
    return [(one.level, one.kind, one.name) for one in found]


def robot(name: str, *more: NodeInstance) -> System:
    """Return a system with a laser and its user below a namespace."""
    scan = f"/{name}/scan"
    laser = instance(f"/{name}/laser", end(Role.PUBLISHES, scan))
    speed = InstanceParameter(f"/{name}/amcl/speed", LaunchParameter("speed", "1", LINE))
    written = Remap("map", "world", LINE)
    remap = InstanceRemap(f"/{name}/map", f"/{name}/world", written, used=False)
    amcl = replace(instance(f"/{name}/amcl", end(Role.SUBSCRIBES, scan)), parameters=(speed,), remaps=(remap,))
    ends = [replace(one, interfaces=tuple(_declared_alike(one))) for one in (laser, amcl, *more)]
    return system(ends)


def _declared_alike(one: NodeInstance) -> list[InstanceInterface]:
    """Return ends named `scan` in the code, whatever their names in the system."""
    return [replace(each, declared=replace(each.declared, name="scan")) for each in one.interfaces]


def test_a_renamed_namespace_is_one_change() -> None:
    """Implied changes of nodes, names, parameters, remappings and connections are counted, not listed."""
    (change,) = compare(Sources(systems=[robot("one")]), Sources(systems=[robot("two")])).changes
    assert (change.level, change.kind) == (Level.NAMESPACE, Kind.RENAMED)
    assert change.before
    assert change.after
    assert (change.before.name, change.after.name) == ("/one", "/two")
    assert change.after.value == "2 nodes and 2 names"


def test_what_else_changed_in_a_renamed_node_is_told() -> None:
    """The node has both of its names; the reverse comparison is the mirror image."""
    before, after = robot("one"), robot("two")
    laser, amcl = after.instances
    faster = replace(amcl.parameters[0], set=LaunchParameter("speed", "2", LINE))
    after = replace(after, instances=(laser, replace(amcl, parameters=(faster,))))
    assert told(before, after) == [("namespace", "renamed", "/two"), ("setting", "value", "/two/amcl/speed")]
    found = compare(Sources(systems=[before]), Sources(systems=[after]))
    (setting,) = found.at(Level.SETTING)
    assert (setting.owner_before, setting.owner) == ("/one/amcl", "/two/amcl")
    assert compare(Sources(systems=[after]), Sources(systems=[before])) == found.mirrored()


def test_a_node_of_another_name_is_renamed_where_the_same_line_starts_the_same() -> None:
    """A node without a common part of its name is reported as added and removed."""
    camera = replace(instance("/camera"), started=replace(instance("/camera").started, executable="driver"))
    eye = replace(camera, name="/eye")
    assert told(system([camera]), system([eye])) == [("instance", "renamed", "/eye")]
    other = replace(eye, started=replace(eye.started, executable="simulator"))
    assert told(system([camera]), system([other])) == [("instance", "gone", "/camera"), ("instance", "new", "/eye")]
    moved = replace(eye.started, location=replace(PLACE, line=90))
    pair = system([camera, replace(camera, name="/left")])
    assert told(pair, system([replace(eye, started=moved)])) == [
        ("instance", "gone", "/camera"),
        ("instance", "new", "/eye"),
        ("instance", "gone", "/left"),
    ]


def test_a_namespace_that_went_is_a_renamed_one() -> None:
    """Names that lost the namespace follow."""
    one, two = (instance("/one/a", end(Role.PUBLISHES, "/one/x")), instance("/one/b", end(Role.SUBSCRIBES, "/one/x")))
    before = system([one, two])
    after = system(
        [
            replace(one, name="/a", interfaces=(replace(one.interfaces[0], resolved="/x"),)),
            replace(two, name="/b", interfaces=(replace(two.interfaces[0], resolved="/x"),)),
        ]
    )
    assert told(before, after) == [("namespace", "renamed", "/")]


def test_findings_under_another_name_are_the_same() -> None:
    """The namespace in the message of a finding is that of the system."""
    name = robot("one").configuration.name
    both = [
        Sources(systems=[robot(one)], findings=[Finding(name, "KG402", f"/{one}/x", f"nobody hears /{one}/x")])
        for one in ("one", "two")
    ]
    assert [change.level for change in compare(*both).changes] == [Level.NAMESPACE]


def test_arguments_of_a_launch_file_are_compared() -> None:
    """Added, removed, and with another default."""

    def declaring(**defaults: str) -> System:
        arguments = tuple(LaunchArgument(name, value, value, LINE) for name, value in defaults.items())
        empty = system(())
        return replace(empty, configuration=replace(empty.configuration, arguments=arguments))

    assert told(declaring(name="a", old="1"), declaring(name="b", new="1")) == [
        ("argument", "default", "name"),
        ("argument", "new", "new"),
        ("argument", "gone", "old"),
    ]


def test_parameters_of_no_node_and_remappings_without_effect_are_compared() -> None:
    """They change the launch file, although without visible effect."""
    one = instance("/a")
    remap = InstanceRemap("/x", "/y", Remap("x", "y", LINE), used=False)
    before = replace(system([replace(one, remaps=(remap,))]), shared_parameters=(LaunchParameter("/rate", "1", LINE),))
    after = replace(
        system([replace(one, remaps=(replace(remap, target="/z"),))]),
        shared_parameters=(LaunchParameter("/rate", "2", LINE),),
    )
    assert told(before, after) == [("setting", "value", "/rate"), ("remap", "value", "/x")]


def test_an_end_that_the_code_renames_is_one_change_of_each_node() -> None:
    """Both ends have the other name and are still joined."""
    laser, amcl = instance("/laser", end(Role.PUBLISHES, "/scan")), instance("/amcl", end(Role.SUBSCRIBES, "/scan"))
    after = [instance("/laser", end(Role.PUBLISHES, "/front")), instance("/amcl", end(Role.SUBSCRIBES, "/front"))]
    assert told(system([laser, amcl]), system(after)) == [
        ("end", "renamed", "/front"),
        ("end", "renamed", "/front"),
    ]
