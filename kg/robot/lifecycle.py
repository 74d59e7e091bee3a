"""Lifecycle of ROS 2 nodes: states of managed nodes, and the capabilities that are unavailable because of them.

Source: design.ros2.org/articles/node_lifecycle.html. A managed node reports its state by the service `~/get_state`, and
changes by the topic `~/transition_event`. It works only in the state `active`.
"""

from __future__ import annotations

import asyncio
from collections import defaultdict
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.capability import Capabilities, Capability, Way, role_of
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.robot.connection import ComputationGraph, Connection, LiveNode

ACTIVE: Final = "active"
_STATES: Final = {
    1: "unconfigured",
    2: "inactive",
    3: ACTIVE,
    4: "finalized",
    10: "configuring",
    11: "cleaning up",
    12: "shutting down",
    13: "activating",
    14: "deactivating",
    15: "processing an error",
}
"""The states of lifecycle_msgs/State; 0 is unknown."""
_GET_STATE: Final = "lifecycle_msgs/GetState"
_EVENT: Final = "lifecycle_msgs/TransitionEvent"
_PATIENCE: Final = 1.0  # seconds to wait for a node to report its state
_AGAIN: Final = 2.0  # seconds after which an inactive node is polled again, in case an event was missed


@dataclass(slots=True)
class _Followed:
    """A managed node; `restless` is set while it is not known to be active, `polled` after the first poll."""

    node: LiveNode
    state: str | None = None
    polled: asyncio.Event = field(default_factory=asyncio.Event)
    restless: asyncio.Event = field(default_factory=asyncio.Event)
    tasks: Tasks = field(default_factory=Tasks)


class States:
    """The states of the managed nodes of a robot, followed from their first appearance until `close`.

    `changed` is called when a state has changed.
    """

    def __init__(self, connection: Connection, changed: Callable[[], None]) -> None:
        self._connection = connection
        self._changed = changed
        self._followed: dict[str, _Followed] = {}
        self._closed = False

    def of(self, graph: ComputationGraph) -> ComputationGraph:
        """Return a graph with the known states of its managed nodes, and follow new ones."""
        managed = {
            end.node
            for end in graph.ends
            if end.type == _GET_STATE and end.role is Role.SERVICES and end.name == f"{end.node}/get_state"
        }
        nodes = {node.name: node for node in graph.nodes if node.name in managed}
        for name, followed in list(self._followed.items()):
            if nodes.get(name) != followed.node:  # it is gone, or another process has its name now
                self._followed.pop(name).tasks.cancel()
        for name in nodes.keys() - self._followed.keys() if not self._closed else ():
            one = self._followed[name] = _Followed(nodes[name])
            one.restless.set()
            one.tasks.spawn(self._ask(one), f"asking {name} for its state")
            one.tasks.spawn(self._listen(one), f"following the state of {name}")
        states = {name: one.state for name, one in self._followed.items() if one.state is not None}
        if not states:
            return graph
        return replace(graph, nodes=tuple(replace(one, state=states.get(one.name)) for one in graph.nodes))

    async def wait_polled(self) -> None:
        """Return when each followed node has reported its state, or timed out."""
        waiting = [one.polled.wait() for one in self._followed.values()]
        with suppress(TimeoutError):
            await asyncio.wait_for(asyncio.gather(*waiting), _PATIENCE)

    def close(self) -> None:
        """Stop following nodes."""
        self._closed = True
        for one in self._followed.values():
            one.tasks.cancel()

    async def _ask(self, one: _Followed) -> None:
        while True:
            with suppress(RobotError):
                service = f"{one.node.name}/get_state"
                answer = await self._connection.call(service, _GET_STATE, {}, seconds=_PATIENCE)
                self._take(one, answer["current_state"])
            one.polled.set()
            await asyncio.sleep(_AGAIN)
            await one.restless.wait()  # an active node reports its changes

    async def _listen(self, one: _Followed) -> None:
        with suppress(RobotError):  # without the topic, polling is enough
            events = await self._connection.subscribe(f"{one.node.name}/transition_event", _EVENT)
            try:
                async for event in events:
                    self._take(one, event.value["goal_state"])
            finally:
                await events.aclose()

    def _take(self, one: _Followed, reported: dict[str, Any]) -> None:
        state = _STATES.get(reported["id"])
        if state == ACTIVE:
            one.restless.clear()
        else:
            one.restless.set()
        if state != one.state:
            one.state = state
            self._changed()


def idle(graph: ComputationGraph, name: str, role: Role) -> tuple[LiveNode, ...]:
    """Return the nodes with an end if all of them are managed and none is active; empty if one works."""
    return _idle(graph, {end.node for end in graph.ends if end.name == name and end.role is role})


def _idle(graph: ComputationGraph, names: set[str]) -> tuple[LiveNode, ...]:
    inactive = tuple(node for node in graph.nodes if node.name in names and node.state not in {None, ACTIVE})
    return inactive if len(inactive) == len(names) else ()


def in_words(nodes: Iterable[LiveNode]) -> str:
    """Describe the states of nodes: `/map_server is inactive`."""
    return ", ".join(f"{node.name} is {node.state}" for node in nodes)


def available(capabilities: Capabilities, graph: ComputationGraph) -> Capabilities:
    """Return capabilities, marked as unavailable if no node with an interface to them is active.

    A general one is marked if all capabilities that imply it are.
    """
    if all(node.state in {None, ACTIVE} for node in graph.nodes):
        return capabilities
    names: defaultdict[tuple[str, Role], set[str]] = defaultdict(set)
    for end in graph.ends:
        names[end.name, end.role].add(end.node)

    def nodes(way: Way, one: Capability) -> tuple[LiveNode, ...]:
        return _idle(graph, names[way.name, role_of(way, reads=one.modality == "read")])

    by_name = {one.name: one for one in capabilities.capabilities}
    why: dict[str, str | None] = {}

    def reason(name: str) -> str | None:
        if name not in why:
            why[name] = None  # a capability that implies itself is no evidence
            one = by_name[name]
            reasons = [in_words(nodes(way, one)) for way in one.ways]
            reasons = reasons or [reason(specific) or "" for specific in one.implied_by if specific in by_name]
            why[name] = "; ".join(dict.fromkeys(reasons)) if reasons and all(reasons) else None
        return why[name]

    marked = (msgspec.structs.replace(one, unavailable=reason(one.name)) for one in capabilities.capabilities)
    return msgspec.structs.replace(capabilities, capabilities=tuple(marked))
