"""The computation graph of ROS 2, from the ends that a middleware reports, and its changes.

Actions are folded, mismatches are reported. A watch knows whether the graph is complete, what changed, and whether all
nodes have left.
"""

from __future__ import annotations

import asyncio
import re
from collections import defaultdict
from contextlib import aclosing
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.facts import Qos, Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.inbox import Changes

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Callable, Iterable

    from kg.robot.ros2.middleware import Neighbourhood

_HIDDEN: Final = re.compile(r"(.+)/_action/(send_goal|get_result|cancel_goal|feedback|status)")
_ROLES: Final = {Role.SERVICES: Role.ACTION_SERVERS, Role.CLIENTS: Role.ACTION_CLIENTS}
_MOST: Final = 1000  # maximum number of reported mismatches


def computation_graph(reported: Neighbourhood, *, complete: bool) -> ComputationGraph:
    """Return the graph of the ends of others."""
    ends = {one for end in reported.ends if (one := _folded(end)) is not None}
    ordered = sorted(ends, key=lambda one: (one.name, one.role, one.node, one.type or "", str(one.qos)))
    problems = {*reported.problems, *_misfits(ordered)}
    return ComputationGraph(2, tuple(_nodes(reported.nodes)), tuple(ordered), tuple(sorted(problems)), complete)


def is_hidden(topic: str) -> bool:
    """Return whether a topic belongs to an action, and is therefore not in the graph."""
    return _HIDDEN.fullmatch(topic) is not None


def _folded(end: LiveEnd) -> LiveEnd | None:
    match = _HIDDEN.fullmatch(end.name)
    if match is None:
        return end
    if match[2] != "send_goal" or end.role not in _ROLES:
        return None
    kind = end.type.removesuffix("_SendGoal") if end.type else None
    return replace(end, role=_ROLES[end.role], name=match[1], type=kind, qos=None)


def _nodes(nodes: Iterable[LiveNode]) -> list[LiveNode]:
    named: dict[str, list[LiveNode]] = defaultdict(list)
    for node in nodes:
        named[node.name].append(node)
    return [
        each[0]
        if len(each) == 1
        else replace(min(each, key=lambda one: one.address or ""), problem=f"{len(each)} nodes have this name")
        for _, each in sorted(named.items())
    ]


def _misfits(ends: list[LiveEnd]) -> list[GraphProblem]:
    topics: dict[str, dict[Role, list[LiveEnd]]] = defaultdict(lambda: defaultdict(list))
    for end in ends:
        if end.role.channel == "topic":
            topics[end.name][end.role].append(end)
    problems: list[GraphProblem] = []
    for name, sides in topics.items():
        problems += _misfits_of(name, sides[Role.PUBLISHES], sides[Role.SUBSCRIBES])
        if len(problems) > _MOST:
            break
    return problems[:_MOST]


def _misfits_of(name: str, publishers: list[LiveEnd], subscribers: list[LiveEnd]) -> list[GraphProblem]:
    """Compare distinct kinds of ends: `/rosout` has hundreds of identical ones."""
    offers, asks = _kinds(publishers), _kinds(subscribers)
    problems = []
    for (offered, offer), writer in offers.items():
        for (requested, ask), reader in asks.items():
            if offered is not None and requested is not None and offered != requested:
                message = f"{writer.node} publishes {offered}, {reader.node} subscribes to {requested}"
                problems.append(GraphProblem("KG806", name, message))
            elif offer and ask and (why := misfit(offer, ask)):
                message = f"{reader.node} receives nothing from {writer.node}: {why}"
                problems.append(GraphProblem("KG815", name, message))
    return problems


def _kinds(ends: list[LiveEnd]) -> dict[tuple[str | None, Qos | None], LiveEnd]:
    return {(one.type, one.qos): one for one in reversed(ends)}


def misfit(offer: Qos, ask: Qos) -> str | None:
    """Return why an offered QoS does not satisfy a request, None if it does.

    Source: DDS 1.4, 2.2.3, "requested / offered" of reliability, durability, deadline and liveliness.
    """
    if offer.reliability == "best_effort" and ask.reliability == "reliable":
        return "it offers best effort, but reliable delivery is requested"
    if offer.durability == "volatile" and ask.durability == "transient_local":
        return "it does not keep messages for late subscribers (transient local), which the subscriber requires"
    if ask.deadline is not None and (offer.deadline is None or offer.deadline > ask.deadline):
        return f"a message every {ask.deadline:g} s is requested, which it does not offer"
    if offer.liveliness == "automatic" and ask.liveliness == "manual_by_topic":
        return "it does not assert its liveliness by topic, as requested"
    if ask.lease_duration is not None and (offer.lease_duration is None or offer.lease_duration > ask.lease_duration):
        return f"a sign of life every {ask.lease_duration:g} s is requested, which it does not offer"
    return None


NAMELESS: Final = "/_participant_"
"""Prefix of the names of participants of DDS whose nodes are not known, or not yet."""
_PAUSE: Final = 0.05  # seconds in which changes are batched: a starting node announces a dozen ends
_GONE: Final = 2.0  # seconds without any node after which a robot is lost; a restarted node is back sooner
_MOST_PROBLEMS: Final = 100


class Watch:
    """The graph as the middleware reports it, with notification of changes.

    Args:
        look: returns the current nodes and ends.
        settle: seconds until the graph is complete. Discovery depends on the network, so this is wall-clock time even
        if the robot is simulated.
        quiet: seconds without a change after which a graph with nodes is complete before that; None for never.

    `amend` may add what the middleware does not report; `on_problem` receives new problems.
    """

    def __init__(self, look: Callable[[], Neighbourhood], settle: float, quiet: float | None = None) -> None:
        self._look = look
        self.amend: Callable[[ComputationGraph], ComputationGraph] = lambda seen: seen
        self.on_problem: Callable[[GraphProblem], None] = lambda _: None
        self._loop = asyncio.get_running_loop()
        self._settles_at = self._latest = self._loop.time() + settle
        self._quiet = quiet
        self._changes = Changes()
        self._problems: dict[GraphProblem, None] = {}
        self._seen = False
        self._leaving: asyncio.TimerHandle | None = None
        self._gathering: asyncio.TimerHandle | None = None
        self._cached: ComputationGraph | None = None
        self.lost: asyncio.Future[str] = self._loop.create_future()
        self.closed = False
        self._settling = self._loop.call_at(self._settles_at, self.changed)

    @property
    def complete(self) -> bool:
        """Whether the graph was watched long enough."""
        return self._loop.time() >= self._settles_at

    def now(self) -> ComputationGraph:
        """Return the current graph."""
        if self._cached is None or self._cached.complete != self.complete:
            seen = self.amend(computation_graph(self._look(), complete=self.complete))
            self._seen = self._seen or bool(seen.nodes)
            self._cached = replace(seen, problems=tuple(sorted({*seen.problems, *self._problems})))
        return self._cached

    def report(self, problem: GraphProblem) -> None:
        """Add a problem; duplicates are dropped, and so are those after the first hundred."""
        if problem not in self._problems and len(self._problems) < _MOST_PROBLEMS:
            self._problems[problem] = None
            self.on_problem(problem)
            self.changed()

    def changed(self) -> None:
        """Notify watchers, after a short delay."""
        self._cached = None
        if self._gathering is None and not self.closed:
            self._gathering = self._loop.call_later(_PAUSE, self._publish)

    def _publish(self) -> None:
        self._gathering = None
        self._note_loss()
        if self._quiet is not None and self._seen and not self.complete:
            # Each change begins a new quiet period, which ends at the latest with the time of `settle`. Some
            # middlewares send the names of nodes long after their ends.
            nameless = any(one.name.startswith(NAMELESS) for one in self.now().nodes)
            self._settles_at = self._latest if nameless else min(self._latest, self._loop.time() + self._quiet)
            self._settling.cancel()
            self._settling = self._loop.call_at(self._settles_at, self.changed)
        self._changes.notify()

    def _note_loss(self) -> None:
        """Detect that all nodes have left."""
        if self.now().nodes:
            if self._leaving is not None:
                self._leaving.cancel()
                self._leaving = None
        elif self._seen and self._leaving is None and not self.lost.done():
            self._leaving = self._loop.call_later(
                _GONE, self.lost.set_result, "all nodes of the robot have left the domain"
            )

    async def wait_complete(self) -> None:
        """Return when the graph is complete, or the connection is closed."""
        await self.until(lambda graph: graph.complete)

    async def until(self, true: Callable[[ComputationGraph], bool]) -> bool:
        """Return True when a condition holds for the graph, False if the connection is closed first."""
        async with aclosing(self.changes()) as graphs:
            async for graph in graphs:
                if true(graph):
                    return True
        return False

    def changes(self) -> AsyncGenerator[ComputationGraph]:
        """Yield the current graph, and again after each change, until it is closed."""
        return self._changes.values(lambda: None if self.closed else self.now())

    def close(self) -> None:
        """End all watching."""
        self.closed = True
        for timer in (self._settling, self._leaving, self._gathering):
            if timer is not None:
                timer.cancel()
        self._changes.notify()
