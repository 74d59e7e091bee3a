from __future__ import annotations

from dataclasses import replace
from typing import Final

import pytest
from graph.samples import source_triples
from hypothesis import given, settings
from hypothesis import strategies as st
from pyoxigraph import RdfFormat, Store

from kg.facts import (
    Access,
    Bound,
    Import,
    Interface,
    Location,
    NodeKind,
    NodeType,
    Package,
    PackageFacts,
    Parameter,
    PluginDefault,
    PluginSlot,
    Qos,
    Repository,
    Resolution,
    Role,
)
from kg.graph.iris import Iris
from kg.graph.reading.nodes import NodeRecord, node_names, node_records
from kg.graph.records import node_object

HERE: Final = Location("src/rover.cpp", 12)
ROVER: Final = NodeType(
    name="rover",
    kind=NodeKind.EXECUTABLE,
    language="cpp",
    ros=2,
    location=HERE,
    executable="rover_node",
    plugin="rover::Rover",
    node_name="rover",
    base_class="rclcpp::Node",
    aliases=("driver_library", "driver_target"),
    sources=("src/a.cpp", "src/rover.cpp"),
    interfaces=(
        Interface(Role.ACTION_CLIENTS, "dock", "rover_msgs/Dock", Resolution.LITERAL, HERE, resolved="/dock"),
        Interface(
            Role.PUBLISHES,
            "~/odom",
            "nav_msgs/Odometry",
            Resolution.PARAMETER_DEFAULT,
            Location("include/base.hpp", 7, "github.com/other/base"),
            resolved="/rover/odom",
            written='node->get("odom")',
            parameter="odom_topic",
            qos=Qos("reliable", None, "keep_last", 10, 0.1, 2.0, "automatic", 3600.0),
            via=(Location("include/base.hpp", 9, "github.com/other/base"), Location("src/wrapper.hpp", 3)),
        ),
        Interface(Role.PUBLISHES, None, None, Resolution.UNRESOLVED, HERE, reason="the argument is not known"),
        Interface(Role.SERVICES, "x/{}", "std_srvs/Empty", Resolution.PARTIAL, HERE, implicit=True, origin="lifecycle"),
    ),
    parameters=(
        Parameter("rate", "double", "10.0", Access.DECLARE, HERE, description="How often, in Hz.", via=(HERE,)),
        Parameter(None, None, None, Access.READ, HERE, Resolution.UNRESOLVED, reason="built at run time"),
    ),
    slots=(
        PluginSlot("nav::Planner", HERE, defaults=(PluginDefault("nav::Fast"),), fixed=True),
        PluginSlot(None, replace(HERE, line=HERE.line + 1), reason="it is computed"),
        PluginSlot(
            "nav::Planner",
            Location("include/base.hpp", 8, "github.com/other/base"),
            "planners",
            "{id}.plugin",
            (PluginDefault("nav::Fast", "fast"), PluginDefault("nav::Slow", "slow")),
            via=(HERE,),
        ),
    ),
    exported=Location("plugins.xml", 3),
    imports=(Import("RPi.GPIO", HERE), Import("serial/serial.h", Location("include/base.hpp", 2))),
    bounds=(Bound("depth", HERE), Bound("steps", Location("include/base.hpp", 8, "github.com/other/base"))),
)


def stored(*packages: tuple[str, tuple[NodeType, ...]], commit: str | None = "abc") -> Store:
    """Return a store with packages of one source."""
    repository = Repository("github.com/acme/rover", "/src", commit)
    facts = [
        PackageFacts(repository.name, Package(name, name, 2, Location(f"{name}/package.xml", 1)), nodes)
        for name, nodes in packages
    ]
    store = Store()
    store.load(source_triples(repository, facts, Iris()), format=RdfFormat.N_TRIPLES)
    return store


def test_a_node_comes_back_as_it_was_written() -> None:
    """Every field of node, interfaces and parameters survives writing and reading."""
    store = stored(("rover_base", (ROVER,)))
    assert node_records(store) == [NodeRecord("github.com/acme/rover", "abc", "rover_base", ROVER)]


def test_nodes_are_chosen_by_package_and_name() -> None:
    """Filters compare whole names; a package may have its repository as prefix."""
    other = replace(ROVER, name="other", interfaces=(), parameters=())
    store = stored(("a", (ROVER, other)), ("b", (ROVER,)))
    assert [one.full_name for one in node_records(store, node="rover")] == [
        "github.com/acme/rover:a/rover",
        "github.com/acme/rover:b/rover",
    ]
    assert [one.node.name for one in node_records(store, package="a")] == ["other", "rover"]
    assert len(node_records(store, package="github.com/acme/rover:b")) == 1
    assert node_records(store, package="github.com/acme/none:b") == []
    assert node_names(store) == ["other", "rover"]


def test_a_source_without_commit_has_none() -> None:
    """A plain folder has no commit."""
    assert node_records(stored(("a", (ROVER,)), commit=None))[0].commit is None


@pytest.mark.parametrize("name", ['"', "\\", "a b", "} UNION {", "\n", ""])
def test_names_cannot_leave_the_query(name: str) -> None:
    """User input is compared, never executed."""
    assert node_records(stored(("a", (ROVER,))), package=name, node=name) == []


_NAMES: Final = st.text(st.characters(codec="utf-8"), min_size=1)
_INTERFACES: Final = st.builds(
    Interface,
    st.sampled_from(Role),
    st.none() | _NAMES,
    st.none() | st.just("std_msgs/String"),
    st.sampled_from(Resolution),
    st.builds(Location, _NAMES, st.integers(1, 9999)),
    written=st.none() | _NAMES,
    reason=st.none() | _NAMES,
    implicit=st.booleans(),
)


@settings(max_examples=50)
@given(st.lists(_INTERFACES, max_size=5))
def test_any_interface_comes_back(interfaces: list[Interface]) -> None:
    """Odd names, repeated names and missing parts survive; none is lost or merged."""
    store = stored(("p", (replace(ROVER, interfaces=tuple(interfaces)),)))
    back = node_records(store)[0].node.interfaces
    assert sorted(map(repr, back)) == sorted(map(repr, interfaces))


def test_nodes_of_one_name_keep_their_own_parts() -> None:
    """If a package declares a node twice, each has its own declarations."""
    bare = replace(ROVER, location=Location("src/other.cpp", 3), interfaces=ROVER.interfaces[:1], parameters=())
    found = node_records(stored(("a", (ROVER, bare))))
    assert [len(one.node.interfaces) for one in found] == [1, len(ROVER.interfaces)]
    assert [len(one.node.parameters) for one in found] == [0, len(ROVER.parameters)]


def test_default_plugins_lead_to_their_nodes() -> None:
    """A class with a slash equals one with colons."""
    slow = replace(ROVER, name="Slow", plugin="nav/Slow", interfaces=(), parameters=(), slots=())
    (record,) = node_records(stored(("rover_base", (ROVER,)), ("plans", (slow,))), node="rover")
    assert {kind: str(node) for kind, (node, _) in record.plugins.items()} == {
        "nav::Slow": "github.com/acme/rover:plans/Slow"
    }
    shown = [(one["class"], one["node"]) for one in node_object(record)["slots"][-1]["defaults"]]
    assert shown == [("nav::Fast", None), ("nav::Slow", "github.com/acme/rover:plans/Slow")]
