"""Graphs built from ends, and mismatches among them."""

from __future__ import annotations

from dataclasses import replace

import pytest

from kg.facts import Qos, Role
from kg.robot.connection import LiveEnd, LiveNode
from kg.robot.ros2.graph import computation_graph, misfit
from kg.robot.ros2.middleware import LATCHED, OFFERED, Neighbourhood

_FULL = Qos("reliable", "transient_local", "keep_last", 1, 0.1, None, "manual_by_topic", 0.1)


@pytest.mark.parametrize(
    ("offer", "ask", "fits"),
    [
        (OFFERED, OFFERED, True),
        (LATCHED, OFFERED, True),
        (OFFERED, LATCHED, False),
        (replace(OFFERED, reliability="best_effort"), OFFERED, False),
        (OFFERED, replace(OFFERED, reliability="best_effort"), True),
        (replace(OFFERED, deadline=0.5), replace(OFFERED, deadline=1.0), True),
        (replace(OFFERED, deadline=1.0), replace(OFFERED, deadline=0.5), False),
        (OFFERED, replace(OFFERED, deadline=0.5), False),
        (replace(OFFERED, liveliness="automatic"), replace(OFFERED, liveliness="manual_by_topic"), False),
        (OFFERED, replace(OFFERED, lease_duration=1.0), False),
        (_FULL, _FULL, True),
    ],
)
def test_what_is_asked_for_has_to_be_offered(offer: Qos, ask: Qos, fits: bool) -> None:  # noqa: FBT001 - a case
    """An offer matches if it is at least as strong as the request."""
    assert (misfit(offer, ask) is None) is fits


def test_problems_of_a_topic_are_told_once() -> None:
    """A mismatch is one problem, however many similar ends have it."""
    ends = [LiveEnd(f"/a{one}", Role.PUBLISHES, "/rosout", "rcl_interfaces/Log", OFFERED) for one in range(300)]
    ends += [LiveEnd(f"/b{one}", Role.SUBSCRIBES, "/rosout", "rcl_interfaces/Log", LATCHED) for one in range(300)]
    ends.append(LiveEnd("/c", Role.SUBSCRIBES, "/rosout", "std_msgs/String", OFFERED))
    graph = computation_graph(Neighbourhood(ends=tuple(ends)), complete=True)
    assert [problem.code for problem in graph.problems] == ["KG806", "KG815"]


def test_nodes_of_one_name_are_one_with_a_problem() -> None:
    """Two nodes of the same name are one, with a problem."""
    told = Neighbourhood(nodes=(LiveNode("/a", "one"), LiveNode("/a", "two"), LiveNode("/b", "one")))
    first, second = computation_graph(told, complete=False).nodes
    assert (first.name, first.problem) == ("/a", "2 nodes have this name")
    assert second == LiveNode("/b", "one")


def test_actions_are_folded() -> None:
    """The services and topics of an action are one end; a mere subscription to feedback is not an action."""
    parts = {
        "send_goal": ("m/Spin_SendGoal", Role.SERVICES, Role.CLIENTS),
        "get_result": ("m/Spin_GetResult", Role.SERVICES, Role.CLIENTS),
        "cancel_goal": ("action_msgs/CancelGoal", Role.SERVICES, Role.CLIENTS),
        "feedback": ("m/Spin_FeedbackMessage", Role.PUBLISHES, Role.SUBSCRIBES),
        "status": ("action_msgs/GoalStatusArray", Role.PUBLISHES, Role.SUBSCRIBES),
    }
    ends = [
        LiveEnd(node, role, f"/ns/spin/_action/{part}", kind)
        for part, (kind, *roles) in parts.items()
        for node, role in zip(("/server", "/client"), roles, strict=True)
    ]
    ends.append(LiveEnd("/listener", Role.SUBSCRIBES, "/ns/spin/_action/feedback", "m/Spin_FeedbackMessage"))
    graph = computation_graph(Neighbourhood(ends=tuple(ends)), complete=True)
    assert [(end.node, end.role, end.name, end.type) for end in graph.ends] == [
        ("/client", Role.ACTION_CLIENTS, "/ns/spin", "m/Spin"),
        ("/server", Role.ACTION_SERVERS, "/ns/spin", "m/Spin"),
    ]
