from __future__ import annotations

from dataclasses import replace
from typing import Final

from hypothesis import given
from hypothesis import strategies as st

from kg.facts import Role
from kg.graph.iris import Iris
from kg.graph.shared import split
from kg.graph.systems import system_triples
from kg.launch.wiring.similar_names import near_misses
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.live.keeping import Parts
from kg.robot.live.systems import Instances, Seen, system_of
from kg.settings import load

_IRIS: Final = Iris(load({}, environment={}).base)
_EMPTY: Final = b"<" + _IRIS.interface_type("message", "std_msgs/Empty").encode() + b">"
_SEEN: Final = Seen("ros1://localhost:11311", "rover", "2026-05-01T12:00:00+00:00")
_NODES: Final = st.builds(
    LiveNode,
    st.sampled_from(["/a", "/a/b", "/a/publisher/scan", "/c", "c"]),
    st.sampled_from([None, "http://127.0.0.1:40001/", "http://127.0.0.1:40002/"]),
    st.sampled_from([None, "it does not answer"]),
)
_ENDS: Final = st.builds(
    LiveEnd,
    st.sampled_from(["/a", "/a/b", "/a/publisher/scan", "/c"]),
    st.sampled_from(list(Role)),
    st.sampled_from(["/scan", "/scans", "/publisher/scan", "/a/b"]),
    st.sampled_from(["sensor_msgs/LaserScan", "std_msgs/Empty", None]),
)
_GRAPHS: Final = st.builds(
    ComputationGraph,
    st.sampled_from([1, 2]),
    st.lists(_NODES, max_size=4).map(tuple),
    st.lists(_ENDS, max_size=6).map(tuple),
    st.sampled_from([(), (GraphProblem("KG803", "/a", "it is gone"),)]),
    st.booleans(),
)
_TIMES: Final = st.dictionaries(
    st.sampled_from(["/a", "/c"]), st.sampled_from(["2026-05-01T12:01:00+00:00", "2026-05-01T12:02:00+00:00"])
)


@given(st.lists(st.tuples(_GRAPHS, _TIMES), min_size=1, max_size=4), st.sets(st.just(_EMPTY)))
def test_what_came_and_went_adds_up_to_the_whole(
    sequence: list[tuple[ComputationGraph, dict[str, str]]], left_out: set[bytes]
) -> None:
    """After any changes the lines are those of the last graph; removed lines existed before, added ones did not."""
    parts, instances = Parts(_IRIS, left_out), Instances()
    lines = set[bytes]()
    for graph, times in sequence:
        seen = replace(_SEEN, nodes=times)
        system = system_of(graph, seen, similar=near_misses, previous=instances)
        assert system == system_of(graph, seen, similar=near_misses)
        gone, new = (text.splitlines(keepends=True) for text in parts.change(system, {}))
        assert lines >= set(gone)
        assert lines.isdisjoint(new)
        assert sorted(gone) == gone
        assert sorted(new) == new
        lines = lines.difference(gone).union(new)
        own, shared = split(system_triples(system, {}, _IRIS, whole=True), _IRIS)
        assert lines == {*own, *(line for line in shared if line.partition(b" ")[0] not in left_out)}


def test_a_change_says_nothing_of_nodes_that_stay() -> None:
    """When the first of many nodes leaves, only the lines it alone caused are removed."""
    names = [f"/node{number}" for number in range(9)]
    ends = tuple(LiveEnd(name, Role.PUBLISHES, "/rosout", "rosgraph_msgs/Log") for name in names)
    graph = ComputationGraph(1, tuple(map(LiveNode, names)), ends)
    parts, instances = Parts(_IRIS, set()), Instances()
    parts.change(system_of(graph, _SEEN, previous=instances), {})
    less = replace(graph, nodes=graph.nodes[1:], ends=ends[1:])
    gone, new = parts.change(system_of(less, _SEEN, previous=instances), {})
    assert not new
    assert gone
    assert all(b"#instance/node0" in line for line in gone.splitlines())
