"""States of managed nodes, and capabilities unavailable because of them."""

from __future__ import annotations

import asyncio
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient

from kg.facts import Role
from kg.robot.capability import Capabilities, Capability, Way
from kg.robot.connection import ComputationGraph, LiveEnd, LiveNode
from kg.robot.driving.ways import choose, doubts_of
from kg.robot.lifecycle import States, available
from kg.robot.memory import Bus

if TYPE_CHECKING:
    from kg.robot.connection import Connection, Publication, Value

_TWIST = "geometry_msgs/Twist"
_EVENT = "lifecycle_msgs/TransitionEvent"


def _capability(name: str, *nodes: str, **more: Any) -> Capability:
    ways = tuple(Way(kind="topic", name=f"/{name}", type=_TWIST, node=node) for node in nodes)
    return Capability(iri=f"#{name}", name=name, label=name, modality="write", ways=ways, **more)


def _graph(**states: str | None) -> ComputationGraph:
    """Return a graph of nodes in states, each of which subscribes to the topic `/moving`."""
    nodes = tuple(LiveNode(f"/{name}", state=state) for name, state in states.items())
    ends = tuple(LiveEnd(node.name, Role.SUBSCRIBES, "/moving", _TWIST) for node in nodes)
    return ComputationGraph(2, nodes, ends)


@pytest.mark.parametrize(
    ("graph", "why"),
    [
        (_graph(base="inactive"), "/base is inactive"),
        (_graph(base="inactive", arm="unconfigured"), "/base is inactive, /arm is unconfigured"),
        (_graph(base="inactive", arm="active"), None),
        (_graph(base="inactive", arm=None), None),
    ],
)
def test_one_node_that_works_is_enough(graph: ComputationGraph, why: str | None) -> None:
    """A capability is unavailable if all its nodes are managed and inactive, and so is any implied one."""
    general = _capability("acting", implied_by=("moving",))
    found = available(Capabilities(of="robot", capabilities=(_capability("moving", "/base"), general)), graph)
    assert [one.unavailable for one in found.capabilities] == [why, why]


def test_doubts_name_the_state() -> None:
    """A command to only an inactive node has the warning KG819."""
    way = _capability("moving", "/base").ways[0]
    (doubt,) = doubts_of(way, _graph(base="inactive"), reads=False)
    assert (doubt.code, doubt.subject) == ("KG819", "/base")
    assert not list(doubts_of(way, _graph(base="inactive", arm="active"), reads=False))


def test_a_way_to_an_active_node_is_taken_first() -> None:
    """Of two ways, the one with an active node is chosen, although the other is more specific."""
    specific = Way(kind="action", name="/going", type="m/Go", node="/idle", fields={"x": "x"})
    plain = _capability("moving", "/base").ways[0]
    graph = _graph(base="active")
    idle = LiveNode("/idle", state="inactive")
    graph = replace(
        graph, nodes=(*graph.nodes, idle), ends=(*graph.ends, LiveEnd("/idle", Role.ACTION_SERVERS, "/going", "m/Go"))
    )
    assert choose([specific, plain], (), graph, reads=False) is plain


class _Managed:
    """A managed node in memory."""

    def __init__(self, node: Connection, event: Publication) -> None:
        self.node = node
        self.state = 1
        self.asked = 0
        self._event = event

    @classmethod
    async def begun(cls, bus: Bus) -> _Managed:
        node = bus.join("/base")
        made = cls(node, await node.advertise("/base/transition_event", _EVENT))
        await node.serve("/base/get_state", "lifecycle_msgs/GetState", made._answer)
        return made

    async def _answer(self, _: Value) -> Value:
        self.asked += 1
        return {"current_state": {"id": self.state}}

    async def become(self, state: int, *, told: bool = True) -> None:
        self.state = state
        if told:
            await self._event.publish({"goal_state": {"id": state}})


async def _until(states: States, connection: Connection, state: str | None) -> None:
    async with asyncio.timeout(patient(10)):
        while states.of(await connection.graph()).nodes[0].state != state:  # noqa: ASYNC110 - the test sees no event
            await asyncio.sleep(0.01)


def test_events_and_questions_tell_the_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """A state arrives by an event; after a missed event it is requested, until the node is active."""
    monkeypatch.setattr("kg.robot.lifecycle._AGAIN", 0.02)

    async def scene() -> None:
        with Bus("managed", ros=2) as bus:
            robot, face = await _Managed.begun(bus), bus.join("/face")
            news: list[None] = []
            states = States(face, lambda: news.append(None))
            states.of(await face.graph())
            await states.wait_polled()
            assert states.of(await face.graph()).nodes[0].state == "unconfigured"
            await robot.become(13)
            await _until(states, face, "activating")
            await robot.become(3, told=False)
            await _until(states, face, "active")
            await robot.become(2)
            await _until(states, face, "inactive")
            assert len(news) == len(("unconfigured", "activating", "active", "inactive"))
            await robot.node.aclose()
            assert states.of(await face.graph()).nodes == ()
            states.close()

    asyncio.run(scene())


def test_a_node_that_starts_anew_is_asked_again() -> None:
    """A new process with the name of a node has a state of its own."""

    async def scene() -> None:
        with Bus("managed", ros=2) as bus:
            robot, face = await _Managed.begun(bus), bus.join("/face")
            states = States(face, lambda: None)
            graph = await face.graph()
            await robot.become(3, told=False)
            states.of(graph)
            await states.wait_polled()
            assert states.of(graph).nodes[0].state == "active"
            robot.state = 1
            other = replace(graph, nodes=(replace(graph.nodes[0], address="another process"),))
            states.of(other)
            await states.wait_polled()
            assert states.of(other).nodes[0].state == "unconfigured"
            states.close()

    asyncio.run(scene())
