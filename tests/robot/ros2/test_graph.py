"""Graphs built from ends, and mismatches among them."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from dataclasses import replace

import pytest
from patience import patient

from kg.facts import Qos, Role
from kg.robot.connection import LiveEnd, LiveNode
from kg.robot.ros2.address import QUIET, Address
from kg.robot.ros2.graph import NAMELESS, Watch, computation_graph, misfit
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


def test_a_quiet_graph_is_complete() -> None:
    """A graph with nodes is complete some time after its last change, and one without nodes only at the end."""

    async def scene(*, empty: bool) -> tuple[bool, float]:
        loop = asyncio.get_running_loop()
        nodes: list[LiveNode] = []
        watch = Watch(lambda: Neighbourhood(tuple(nodes)), settle=3600, quiet=0.3)
        begun = loop.time()
        for number in range(4):
            await asyncio.sleep(0.2)
            assert not watch.complete
            nodes += [] if empty else [LiveNode(f"/node_{number}")]
            watch.changed()
        changed = loop.time()
        with suppress(TimeoutError):
            await asyncio.wait_for(watch.wait_complete(), 1 if empty else patient(20))
        watch.close()
        assert changed - begun >= 0.8
        return watch.complete, loop.time() - changed

    assert asyncio.run(scene(empty=True))[0] is False
    complete, seconds = asyncio.run(scene(empty=False))
    assert complete
    assert 0.3 <= seconds < patient(10)


def test_a_graph_without_the_names_of_nodes_is_not_complete() -> None:
    """Some middlewares report ends long before the nodes that own them; a quiet graph then waits for the names."""

    async def scene() -> bool:
        nodes = [LiveNode(f"{NAMELESS}01")]
        watch = Watch(lambda: Neighbourhood(tuple(nodes)), settle=3600, quiet=0.1)
        watch.changed()
        await asyncio.sleep(0.5)
        early = watch.complete
        nodes[:] = [LiveNode("/base")]
        watch.changed()
        await asyncio.wait_for(watch.wait_complete(), patient(20))
        watch.close()
        return early

    assert asyncio.run(scene()) is False


def test_a_graph_that_never_rests_is_complete_in_the_end() -> None:
    """Changes do not put off the end beyond the time to settle."""

    async def scene() -> float:
        loop = asyncio.get_running_loop()
        watch = Watch(lambda: Neighbourhood((LiveNode("/node"),)), settle=0.5, quiet=0.3)
        begun = loop.time()
        while not watch.complete:
            watch.changed()
            await asyncio.sleep(0.05)
        watch.close()
        return loop.time() - begun

    assert 0.5 <= asyncio.run(scene()) < patient(10)


def test_an_address_with_a_time_to_settle_has_no_shorter_one() -> None:
    """Who chooses the time gets it."""
    assert (Address.read("dds://0").quiet, Address.read("dds://0?settle=2").quiet) == (QUIET, None)
