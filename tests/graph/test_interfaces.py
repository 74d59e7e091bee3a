from __future__ import annotations

from dataclasses import replace

import pytest
from graph.samples import IRIS, REPOSITORY, ROVER, end, loaded, rows, sample, source_triples, true

from kg.facts import Location, NodeKind, NodeType, Package, PackageFacts, Qos, Resolution, Role

NODE = f"<node/{ROVER}/rover_base/driver>"


ROLES = {
    "publisher": "odom ros:Publisher ros:Topic ros:hasMessage message/nav_msgs/Odometry",
    "subscriber": "cmd_vel ros:Subscriber ros:Topic ros:hasMessage message/geometry_msgs/Twist",
    "service-server": "reset ros:ServiceServer ros:Service rnkg:hasServiceType service-type/std_srvs/Empty",
    "service-client": "static_map ros:ServiceClient ros:Service rnkg:hasServiceType service-type/nav_msgs/GetMap",
    "action-server": "dock rnkg:ActionServer rnkg:Action rnkg:hasActionType action-type/rover_msgs/Dock",
    "action-client": "move_base rnkg:ActionClient rnkg:Action rnkg:hasActionType action-type/move_base_msgs/MoveBase",
}
"""For each kind of component: name, class, its channel, and its link to a type."""


@pytest.mark.parametrize("part", ROLES)
def test_each_role_has_its_component_and_type(part: str) -> None:
    """A role is a component of onto-ros that connects to a topic, service or action with its type."""
    name, component_class, mode, has_type, of_type = ROLES[part].split()
    component, channel = f"<node/{ROVER}/rover_base/driver#{part}/{name}>", f"<{mode.split(':')[1].lower()}/{name}>"
    assert true(
        sample(),
        f"""{NODE} ros:hasComponent {component} .
        {component} a {component_class} ; rnkg:connectsTo {channel} ; {has_type} <{of_type}> .
        {channel} a {mode} ; rnkg:hasMessage|rnkg:hasServiceType|rnkg:hasActionType <{of_type}> .""",
    )


def test_names_of_topics_and_types_are_labels() -> None:
    """Topics are labelled by their absolute name, types by package/Type."""
    store = sample()
    assert rows(store, "SELECT ?l { ?t a ros:Topic ; rdfs:label ?l }") == [("/cmd_vel",), ("/odom",), ("/tf",)]
    assert ("nav_msgs/GetMap",) in rows(store, "SELECT ?l { ?t a rnkg:ServiceType ; rdfs:label ?l }")


def test_a_name_that_is_not_known_makes_no_topic() -> None:
    """Unresolved and partial interfaces have type and reason, and no connection."""
    query = """SELECT ?part ?name ?type ?reason {
      ?part rnkg:resolution ?how ; ros:hasMessage/rdfs:label ?type . FILTER(?how IN (rnkg:partial, rnkg:unresolved))
      OPTIONAL { ?part rnkg:name ?name } OPTIONAL { ?part rnkg:reason ?reason }
      FILTER NOT EXISTS { ?part rnkg:connectsTo ?topic } }"""
    node = f"node/{ROVER}/rover_base/driver#publisher/"
    assert rows(sample(), query) == [
        (f"{node}@unresolved", None, "std_msgs/Bool", "it is read from a file"),
        (f"{node}wheel/%7B%7D", "wheel/{}", "std_msgs/Int32", None),
    ]


def test_what_a_framework_makes_can_be_told_from_what_code_declares() -> None:
    """Implicit interfaces connect to their topics like others, and have their origin."""
    store = sample()
    part = f"<node/{ROVER}/rover_base/driver#publisher/tf>"
    assert true(store, f'{part} rnkg:connectsTo <topic/tf> ; rnkg:implicit true ; rnkg:origin "tf2"')
    assert rows(store, "SELECT ?o { ?c rnkg:implicit true ; rnkg:name ?o }") == [("tf",)]


def test_quality_of_service_is_shared_by_value() -> None:
    """Two ends with the same policies share one quality of service, whose IRI spells it."""
    query = """SELECT ?q ?r ?d ?h ?n { ?q a rnkg:Qos ; rnkg:reliability ?r ; rnkg:history ?h ; rnkg:depth ?n
      OPTIONAL { ?q rnkg:durability ?d } }"""
    assert rows(sample(), query) == [("qos/reliable/-/keep_last/10", "reliable", None, "keep_last", "10")]


def test_types_of_services_and_actions_have_their_messages() -> None:
    """Request and response, goal, result and feedback are messages of their own."""
    assert true(
        sample(),
        """<service-type/nav_msgs/GetMap> rnkg:hasRequest/a ros:RequestMessage ;
          rnkg:hasResponse/a ros:ResponseMessage .
        <action-type/rover_msgs/Dock> rnkg:hasGoal/a rnkg:GoalMessage ; rnkg:hasResult/a rnkg:ResultMessage ;
          rnkg:hasFeedback/a rnkg:FeedbackMessage .""",
    )


def test_the_same_interface_twice_is_two_components() -> None:
    """Two places in the code that open the same topic are two components of it."""
    twice = tuple(end(Role.PUBLISHES, "odom", "nav_msgs/Odometry", location=Location("a.cpp", line)) for line in (3, 9))
    node = NodeType("driver", NodeKind.EXECUTABLE, "cpp", 1, Location("a.cpp", 1), interfaces=twice)
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), (node,))
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    part = f"node/{ROVER}/p/driver#publisher/odom"
    assert rows(store, "SELECT ?c ?l { ?n ros:hasComponent ?c . ?c rnkg:line ?l }") == [(part, "3"), (f"{part}@2", "9")]


def test_evidence_in_another_source_names_it() -> None:
    """A line of a base class in another repository is distinguished from one of the same path here."""
    there = end(Role.PUBLISHES, "x", location=Location("include/base.hpp", 4, "github.com/acme/base"))
    here = end(Role.PUBLISHES, "y", location=Location("include/base.hpp", 5))
    node = NodeType("n", NodeKind.EXECUTABLE, "cpp", 1, Location("a.cpp", 1), interfaces=(there, here))
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), (node,))
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    query = """SELECT ?name ?f ?r { ?c rnkg:name ?name ; rnkg:resolution ?x ; rnkg:declaredIn ?f
      OPTIONAL { ?c rnkg:repository ?r } }"""
    assert rows(store, query) == [
        ("x", "file/github.com/acme/base/-/include/base.hpp", "github.com/acme/base"),
        ("y", f"file/{ROVER}/-/include/base.hpp", None),
    ]


@pytest.mark.parametrize("resolution", Resolution)
def test_every_resolution_is_an_individual_of_the_ontology(resolution: Resolution) -> None:
    """The word in `kg nodes --json` is the local name of the individual."""
    node = NodeType(
        "n",
        NodeKind.CLASS,
        "cpp",
        1,
        Location("a.cpp", 1),
        interfaces=(end(Role.PUBLISHES, "x", resolution=resolution),),
    )
    facts = PackageFacts(ROVER, Package("p", "p", 1, Location("p/package.xml", 1)), (node,))
    assert true(loaded(source_triples(REPOSITORY, [facts], IRIS)), f"?c rnkg:resolution rnkg:{resolution}")


def test_rarer_policies_have_a_resource_of_their_own() -> None:
    """Deadlines, lifespans and liveliness set by code are in seconds, and distinguish two qualities."""
    usual = Qos("reliable", "volatile", "keep_last", 1)
    rarer = replace(usual, deadline=0.000001, lifespan=2.0, liveliness="manual_by_topic", lease_duration=1.5)
    ends = tuple(end(Role.PUBLISHES, name, qos=qos) for name, qos in (("a", usual), ("b", rarer)))
    node = NodeType("n", NodeKind.EXECUTABLE, "cpp", 2, Location("a.cpp", 1), interfaces=ends)
    facts = PackageFacts(ROVER, Package("p", "p", 2, Location("p/package.xml", 1)), (node,))
    store = loaded(source_triples(REPOSITORY, [facts], IRIS))
    query = """SELECT ?q ?deadline ?lifespan ?liveliness ?lease WHERE { ?q a rnkg:Qos
      OPTIONAL { ?q rnkg:deadline ?deadline ; rnkg:lifespan ?lifespan ; rnkg:liveliness ?liveliness ;
                    rnkg:leaseDuration ?lease } }"""
    spelled = "qos/reliable/volatile/keep_last/1"
    more = "/deadline:0.000001/lifespan:2/liveliness:manual_by_topic/lease:1.5"
    assert rows(store, query) == [
        (spelled, None, None, None, None),
        (spelled + more, "0.000001", "2", "manual_by_topic", "1.5"),
    ]
