from __future__ import annotations

import re
from dataclasses import replace

from render.systems import CAMERA, end, instance, system

from kg.facts import Role, StartKind
from kg.render.system_graph import system_graph
from kg.render.system_notations import system_dot, system_lines, system_mermaid, system_object, system_rows
from kg.render.system_views import overlaid

GRAPH = system_graph(system(CAMERA))
SLY = system_graph(
    system([instance('/a"]; x --> y', end(Role.PUBLISHES, '/t"\n}\\')), instance("/b", end(Role.SUBSCRIBES, "/t"))])
)


def test_dot_has_hosts_as_clusters_and_every_end_as_an_edge() -> None:
    """A manager and its nodelets share a cluster; services are dashed, actions thick."""
    text = system_dot(GRAPH)
    assert text.count("subgraph cluster_") == 1
    assert text.count(" -> ") == len(GRAPH.links)
    assert "shape=hexagon" in text
    assert "style=dashed" in text


def test_mermaid_has_hosts_as_subgraphs_and_every_end_as_an_edge() -> None:
    """Shapes and lines distinguish topics, services and actions."""
    text = system_mermaid(GRAPH)
    assert text.startswith("flowchart LR\n")
    assert 'subgraph n3_host["/manager"]' in text
    assert len(re.findall(r"^  \w+ (?:-->|-\.->|==>) \w+$", text, re.MULTILINE)) == len(GRAPH.links)


def test_an_end_that_a_node_might_not_have_has_its_condition_at_the_edge() -> None:
    """Its line is dotted in DOT; Mermaid, whose dotted lines are services, has the label alone."""
    listener = replace(end(Role.SUBSCRIBES, "/x"), switches=("!src/a.cpp:7 holds",))
    graph = system_graph(system([instance("/a", end(Role.PUBLISHES, "/x")), instance("/b", listener)]))
    assert system_dot(graph).count('[style=dotted, label="unless a.cpp:7 holds"]') == 1
    assert system_mermaid(graph).count('-->|"unless a.cpp:7 holds"|') == 1


def test_names_cannot_leave_their_place() -> None:
    """Quotes, brackets, backslashes and line breaks of names are escaped in both notations."""
    quoted = r'"(?:[^"\\\n]|\\.)*"'
    for line in system_dot(SLY).splitlines():
        assert '"' not in re.sub(quoted, "", line)
    for line in system_mermaid(SLY).splitlines():
        assert line.count('"') in {0, 2}
    assert "#34;#93;#59; x --#62; y" in system_mermaid(SLY)


def test_json_says_what_dangles_and_what_is_not_known() -> None:
    """An end without a peer dangles, one without a name is unknown."""
    channels = {one["name"]: one for one in system_object(GRAPH)["channels"]}
    assert channels["/mode"]["dangling"]
    assert not channels["/raw"]["dangling"]
    assert not channels["topic_"]["known"]
    assert {"source": "/driver", "target": "topic /raw"} in system_object(GRAPH)["edges"]


def test_lines_name_further_nodes_of_a_program() -> None:
    """A node that another one creates in its process is described in words."""
    graph = system_graph(system([instance("/base"), instance("/odometry", kind=StartKind.INNER)]))
    heads = [line for line in system_lines(graph) if line.startswith("/")]
    assert ["further node of its program" in head for head in heads] == [False, True]


def test_json_and_notations_tell_states() -> None:
    """Added and removed parts are marked in all notations."""
    both = overlaid(GRAPH, system_graph(system([*CAMERA, instance("/extra")])))
    assert [one["id"] for one in system_object(both)["nodes"] if one.get("state") == "new"] == ["/extra"]
    assert "class n3 new" in system_mermaid(both)
    assert '"+ /extra' in system_dot(both)


def test_words_tell_who_is_at_the_other_side() -> None:
    """Each end names the nodes at the other side, or the missing one."""
    rows = {(row.node, row.name): row for row in system_rows(GRAPH)}
    assert rows["/detector", "/clear"].others == ("/base",)
    assert rows["/detector", "/mode"].nobody == "nobody publishes"
    assert rows["/detector", "? topic_"].nobody == "name not known"
    lines = system_lines(GRAPH)
    assert "/driver  pkg/driver, nodelet, in /manager, bringup/launch/robot.launch:7" in lines
    assert lines[-1] == "not shown: 1 end that frameworks make"
