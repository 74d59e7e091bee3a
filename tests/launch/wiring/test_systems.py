"""Invariants of every system, for any launch file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import given, settings
from hypothesis import strategies as st
from wiring.systems_of import configuration, node_type, reference, started

from kg.facts import Resolution
from kg.launch.wiring.systems import wire
from kg.launch.wiring.types import NodeTypes

if TYPE_CHECKING:
    from typing import Any

_ODD = st.text(alphabet="ab/~{}:_. é\n", max_size=10)
_END = st.fixed_dictionaries({"name": st.none() | _ODD, "parameter": st.none() | _ODD, "written": st.none() | _ODD})
_TYPE = st.fixed_dictionaries(
    {
        "package": st.just("p"),
        "name": st.sampled_from(["n", "m", "p/C"]),
        "kind": st.sampled_from(["executable", "plugin", "nodelet"]),
        "publishes": st.lists(_END, max_size=3),
        "action_servers": st.lists(_END, max_size=2),
        "parameters": st.lists(
            st.fixed_dictionaries({"name": st.none() | _ODD, "default": st.none() | _ODD}), max_size=3
        ),
    }
)
_VALUE = st.none() | _ODD | st.integers() | st.lists(_ODD | st.dictionaries(_ODD, _ODD, max_size=2), max_size=2)
_NODE = st.fixed_dictionaries(
    {
        "name": st.none() | _ODD,
        "namespace": _ODD,
        "package": st.none() | st.just("p") | _ODD,
        "executable": st.none() | st.sampled_from(["n", "m"]),
        "plugin": st.none() | st.just("p/C") | _ODD,
        "kind": st.sampled_from(["node", "nodelet", "component"]),
        "host": st.none() | st.just("/n"),
        "remaps": st.lists(st.tuples(_ODD, _ODD), max_size=3),
        "parameters": st.dictionaries(_ODD, _VALUE, max_size=3),
    }
)


@settings(max_examples=30, deadline=None)
@given(st.lists(_TYPE, max_size=3), st.lists(_NODE, max_size=3), st.dictionaries(_ODD, _VALUE), st.sampled_from([1, 2]))
def test_names_are_absolute_and_what_is_not_known_says_why(
    types: list[dict[str, Any]], nodes: list[dict[str, Any]], parameters: dict[str, object], ros: int
) -> None:
    """Any content is accepted; each instance has its node, in order; a second evaluation gives the same."""
    known = NodeTypes([(reference(row), node_type(row, ros)) for row in types])
    given_nodes = [started(row) for row in nodes]
    written = configuration(given_nodes, ros, parameters)
    system = wire(written, known)
    assert [instance.started for instance in system.instances] == given_nodes
    for instance in system.instances:
        assert instance.name.startswith("/")
        assert (instance.type is None) == (instance.reason is not None) == (instance.missing is not None)
        for end in instance.interfaces:
            assert end.resolved is None or end.resolved.startswith("/")
            assert (end.resolved is None) == (end.resolution is Resolution.UNRESOLVED)
            assert end.resolved is None or "{}" not in end.resolved or end.resolution is Resolution.PARTIAL
    assert wire(written, known) == system
