from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from render.systems import end, instance, system

from kg.facts import (
    Access,
    Interface,
    LaunchParameter,
    Location,
    NodeKind,
    NodeType,
    Parameter,
    Qos,
    Remap,
    Resolution,
    Role,
)
from kg.facts.systems import InstanceParameter
from kg.launch.comparison import Change, Difference, Finding, Kind, Level, Side, Sources, compare

if TYPE_CHECKING:
    from kg.facts import NodeInstance

PLACE = Location("src/a.cpp", 4)
TYPES = ("std_msgs/Int8", "std_msgs/Bool")


@dataclass(frozen=True)
class Typed:
    """A node type in its package."""

    repository: str
    package: str
    node: NodeType


def interface(role: Role, name: str | None, kind: str | None = TYPES[0], qos: Qos | None = None) -> Interface:
    """Return an interface of the code."""
    return Interface(role, name, kind, Resolution.LITERAL, PLACE, written="given", qos=qos)


def node(name: str, *interfaces: Interface, parameters: tuple[Parameter, ...] = ()) -> Typed:
    """Return a node type of the package `pkg`."""
    kind = NodeKind.EXECUTABLE
    return Typed("r", "pkg", NodeType(name, kind, "cpp", 1, PLACE, interfaces=interfaces, parameters=parameters))


def parameter(name: str, default: str | None) -> Parameter:
    """Return a parameter that is read."""
    return Parameter(name, "int", default, Access.READ, PLACE)


def told(before: Sources, after: Sources) -> list[tuple[str, str, str, str]]:
    """Return level, kind, owner and the name of each change."""
    return [(one.level, one.kind, one.owner, one.name) for one in compare(before, after).changes]


def code(*interfaces: Interface, parameters: tuple[Parameter, ...] = ()) -> Sources:
    """Return sources with one node type."""
    return Sources(nodes=[node("n", *interfaces, parameters=parameters)])


def wired(*instances: NodeInstance) -> Sources:
    """Return sources with one launch file."""
    return Sources(systems=[system(instances)])


def test_equal_values_are_compared_without_reading_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Values equal as texts are not parsed; these are nearly all values of two commits."""

    def refuse(text: str) -> str:
        raise AssertionError(text)

    monkeypatch.setattr("kg.launch.comparison.states.canonical", refuse)
    rates = InstanceParameter("/a/rates", LaunchParameter("rates", "[1, 2]", PLACE))
    same = wired(replace(instance("/a"), parameters=(rates,)))
    assert told(same, same) == []


def test_a_node_type_that_came_or_went_is_one_change() -> None:
    """Its content is not reported again."""
    full = Sources(nodes=[node("n", interface(Role.PUBLISHES, "a"))])
    assert told(Sources(), full) == [("node", "new", "pkg/n", "pkg/n")]
    assert told(full, Sources()) == [("node", "gone", "pkg/n", "pkg/n")]


def test_an_interface_is_renamed_only_where_that_is_sure() -> None:
    """A single interface of a role and type can be renamed; with two of them the assignment is ambiguous."""
    one, two = interface(Role.PUBLISHES, "a"), interface(Role.PUBLISHES, "b")
    assert told(code(one), code(two)) == [("interface", "renamed", "pkg/n", "b")]
    third = interface(Role.PUBLISHES, "c")
    assert {kind for _, kind, _, _ in told(code(one, two), code(third))} == {"new", "gone"}
    other = interface(Role.SUBSCRIBES, "b")
    assert {kind for _, kind, _, _ in told(code(one), code(other))} == {"new", "gone"}


def test_another_label_of_an_unknown_part_is_no_change() -> None:
    """A renamed variable changes no topic or parameter; other changes of them are reported."""
    names = "~/{name}/plan", "~/{planner}/plan"
    one, other = (
        code(interface(Role.PUBLISHES, name), parameters=(parameter(name, "1"), parameter("{a}.x", default)))
        for name, default in zip(names, "12", strict=True)
    )
    assert told(one, other) == [("parameter", "default", "pkg/n", "{a}.x")]
    before, after = (wired(instance("/a", end(Role.PUBLISHES, f"/a{name[1:]}"))) for name in names)
    assert told(before, after) == []


def test_names_with_holes_at_other_places_are_two_names() -> None:
    """Only labels are ignored."""
    one, other = (interface(Role.PUBLISHES, name, kind) for name, kind in zip(("{a}/x", "x/{a}"), TYPES, strict=True))
    assert {kind for _, kind, _, _ in told(code(one), code(other))} == {"new", "gone"}


def test_types_and_quality_of_service_of_an_interface_are_compared() -> None:
    """Both sides have the old and the new value."""
    one = interface(Role.PUBLISHES, "a", TYPES[0], Qos("reliable"))
    other = interface(Role.PUBLISHES, "a", TYPES[1], Qos("best_effort", depth=3))
    retyped, requalified = compare(code(one), code(other)).changes
    assert (retyped.kind, requalified.kind) == (Kind.TYPE, Kind.QOS)
    assert requalified.before
    assert requalified.after
    assert (requalified.before.value, requalified.after.value) == ("reliable", "best_effort, depth 3")


def test_parameters_come_go_and_get_other_defaults() -> None:
    """Several lines that read one parameter are one parameter."""
    before = code(parameters=(parameter("a", "1"), parameter("a", None), parameter("b", None)))
    after = code(parameters=(parameter("a", "2"), parameter("c", None)))
    assert told(before, after) == [
        ("parameter", "default", "pkg/n", "a"),
        ("parameter", "gone", "pkg/n", "b"),
        ("parameter", "new", "pkg/n", "c"),
    ]


def test_a_remapping_renames_an_end_and_moves_its_connection() -> None:
    """The change has the line of the remapping."""
    laser, amcl = instance("/laser", end(Role.PUBLISHES, "/scan")), instance("/amcl", end(Role.SUBSCRIBES, "/scan"))
    line = Location("a.launch", 9)
    moved = replace(laser.interfaces[0], resolved="/front/scan", remap=Remap("scan", "/front/scan", line))
    after = wired(replace(laser, interfaces=(replace(moved, declared=laser.interfaces[0].declared),)), amcl)
    found = compare(wired(laser, amcl), after).changes
    assert [(one.level, one.kind, one.owner) for one in found] == [
        (Level.END, Kind.RENAMED, "/laser"),
        (Level.CONNECTION, Kind.GONE, "/laser"),
    ]
    assert found[0].after
    assert found[0].after.location == line


def test_instances_and_what_they_are_set_to_are_compared() -> None:
    """An added node, a changed condition, and a changed parameter."""
    one = instance("/a")
    speed = LaunchParameter("speed", "1", PLACE)
    before = replace(one, parameters=(InstanceParameter("/a/speed", speed),))
    after = replace(
        instance("/a", condition="$(arg x)"),
        parameters=(InstanceParameter("/a/speed", replace(speed, value="2")),),
    )
    assert told(wired(before), wired(after, instance("/b"))) == [
        ("instance", "condition", "/a", "/a"),
        ("instance", "new", "/b", "/b"),
        ("setting", "value", "/a", "/a/speed"),
    ]


SPELLINGS = [
    ("30.", "30.0"),
    ("1e-3", "0.001"),
    ("+5", "5"),
    ("True", "true"),
    ("'a'", '"a"'),
    ("[1., 'x']", "[1.0, x]"),
]


@pytest.mark.parametrize(("one", "other"), SPELLINGS)
def test_another_spelling_of_a_value_is_no_change(one: str, other: str) -> None:
    """Settings of launch files and defaults of code are compared as values."""
    speeds = [InstanceParameter("/a/speed", LaunchParameter("speed", text, PLACE)) for text in (one, other)]
    assert told(*(wired(replace(instance("/a"), parameters=(speed,))) for speed in speeds)) == []
    assert told(*(code(parameters=(parameter("a", text),)) for text in (one, other))) == []


@pytest.mark.parametrize(("one", "other"), [("30", "30.0"), ("'30'", "30"), ("true", "'true'"), ("1.0", "1.5")])
def test_a_value_of_another_type_is_a_change(one: str, other: str) -> None:
    """A node of ROS 2 rejects an integer for a floating point number."""
    assert told(*(code(parameters=(parameter("a", text),)) for text in (one, other))) == [
        ("parameter", "default", "pkg/n", "a")
    ]


def test_a_launch_file_that_came_is_one_change() -> None:
    """Its nodes are counted, not listed."""
    (change,) = compare(Sources(), wired(instance("/a"))).changes
    assert (change.level, change.kind, change.after and change.after.value) == (Level.SYSTEM, Kind.NEW, "1 node")


def test_findings_come_and_go() -> None:
    """A finding is identified by code, system, subject and message."""
    one = Finding("s", "KG401", "/scan", "nobody publishes /scan", PLACE)
    moved = replace(one, location=Location("src/a.cpp", 99))
    assert not compare(Sources(findings=[one]), Sources(findings=[moved]))
    assert told(Sources(findings=[one]), Sources()) == [("finding", "gone", "KG401", "/scan")]


@pytest.mark.parametrize("every", [False, True])
def test_what_frameworks_make_is_compared_where_asked(every: bool) -> None:  # noqa: FBT001 - a parameter of a test
    """An implicit interface is compared with `every` only."""
    implicit = replace(interface(Role.PUBLISHES, "/rosout"), implicit=True)
    assert bool(compare(code(), code(implicit), every=every)) is every


@pytest.mark.parametrize("changed", ["name", "repository"])
def test_changes_have_one_order(changed: str) -> None:
    """Changes that differ only in the former name of their instance, or in their source, are sorted by it."""
    names = [f"/n{number}" for number in range(9)]
    first = Change(Level.END, Kind.GONE, "/x", Side("/scan"), None)
    if changed == "name":
        changes = [replace(first, owner_before=name) for name in names]
    else:
        changes = [replace(first, before=Side("/scan", repository=name)) for name in names]
    assert Difference.of(reversed(changes)).changes == tuple(changes)


NAMES = st.sampled_from(["a", "b", "c", None])
INTERFACES = st.builds(
    interface, st.sampled_from(Role), NAMES, st.sampled_from([*TYPES, None]), st.sampled_from([None, Qos("reliable")])
)
PARAMETERS = st.builds(parameter, st.sampled_from(["p", "q"]), st.sampled_from([None, "1", "2"]))
NODES = st.builds(
    lambda name, ends, parameters: node(name, *ends, parameters=tuple(parameters)),
    st.sampled_from(["n", "m"]),
    st.lists(INTERFACES, max_size=5),
    st.lists(PARAMETERS, max_size=3),
)
ENDS = st.builds(
    end, st.sampled_from(Role), st.sampled_from(["/a", "/b", "/a/c", "/b/c", "/{}", None]), st.sampled_from(TYPES)
)
INSTANCES = st.builds(
    lambda name, ends, condition: instance(name, *ends, condition=condition),
    st.sampled_from(["/x", "/y", "/z", "/a/x", "/b/x", "/b/y", "/a/b/x"]),
    st.lists(ENDS, max_size=4),
    st.sampled_from([None, "maybe"]),
)
FINDINGS = st.builds(
    Finding, st.just("s"), st.sampled_from(["KG401", "KG402"]), st.sampled_from(["/a", "/b"]), NAMES.map(str)
)
SOURCES = st.builds(
    lambda nodes, instances, findings: Sources(nodes, [system(instances)] if instances else [], findings),
    st.lists(NODES, max_size=3),
    st.lists(INSTANCES, max_size=4),
    st.lists(FINDINGS, max_size=3),
)


@settings(max_examples=25, deadline=None)
@given(SOURCES)
def test_nothing_differs_from_itself(sources: Sources) -> None:
    """The order of parts does not matter."""
    turned = Sources(sources.nodes[::-1], sources.systems[::-1], sources.findings[::-1])
    assert not compare(sources, sources)
    assert not compare(sources, turned)


@settings(max_examples=40, deadline=None)
@given(SOURCES, SOURCES)
def test_the_way_back_is_the_mirror(one: Sources, other: Sources) -> None:
    """Additions in one direction are removals in the other."""
    assert compare(other, one) == compare(one, other).mirrored()


@settings(max_examples=25, deadline=None)
@given(SOURCES, SOURCES)
def test_every_change_has_the_sides_of_its_kind(one: Sources, other: Sources) -> None:
    """An addition has no side before, a removal none after, all others both."""
    for change in compare(one, other).changes:
        assert _sides(change) == {Kind.NEW: (False, True), Kind.GONE: (True, False)}.get(change.kind, (True, True))


def _sides(change: Change) -> tuple[bool, bool]:
    return change.before is not None, change.after is not None
