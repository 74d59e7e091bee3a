"""The computation graph of a ROS 1 system: the validated state of its master, and reports of its nodes.

Invalid names are reported and left out; the five topics of an action are one end.
"""

from __future__ import annotations

import asyncio
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.ros1.names import is_name, is_type, shown
from kg.robot.ros1.services import probe
from kg.robot.ros1.xmlrpc import ask, call, exchange, value

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable, Iterable, Iterator

    from kg.robot.ros1.node import Node

_GOAL: Final = "ActionGoal"
_TOPICS: Final = frozenset({"goal", "cancel", "status", "feedback", "result"})
_SERVER: Final = {(Role.PUBLISHES, "result"), (Role.PUBLISHES, "status"), (Role.SUBSCRIBES, "goal")}
_CLIENT: Final = (Role.PUBLISHES, "goal")


def fold(ends: Iterable[LiveEnd]) -> tuple[LiveEnd, ...]:
    """Return ends, sorted, with actions instead of their topics.

    A node is a server if it subscribes to goals and publishes states and results; it is a client if it publishes goals.
    A node that only subscribes to the state, feedback or result stays a subscriber.
    """
    ends = list(ends)
    kinds = {
        one.name.removesuffix("/goal"): one.type.removesuffix(_GOAL)
        for one in ends
        if one.name.endswith("/goal") and one.type is not None and one.type.endswith(_GOAL)
    }
    folded: list[LiveEnd] = []
    parts: dict[tuple[str, str], list[LiveEnd]] = {}
    for one in ends:
        action, _, part = one.name.rpartition("/")
        if action in kinds and part in _TOPICS and one.role.channel == "topic":
            parts.setdefault((action, one.node), []).append(one)
        else:
            folded.append(one)
    for (action, node), topics in parts.items():
        having = {(one.role, one.name.rpartition("/")[2]) for one in topics}
        if having >= _SERVER:
            folded.append(LiveEnd(node, Role.ACTION_SERVERS, action, kinds[action]))
        elif _CLIENT in having:
            folded.append(LiveEnd(node, Role.ACTION_CLIENTS, action, kinds[action]))
        else:
            folded += topics
    return tuple(sorted(folded, key=lambda one: (one.name, one.role, one.node, one.type or "")))


_ROLES = (Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES)
_CALLS_AT_ONCE = 200


@dataclass(frozen=True)
class SystemState:
    """Publishers, subscribers and servers: names of nodes by role and name; and the problems of invalid entries."""

    ends: dict[tuple[Role, str], tuple[str, ...]] = field(default_factory=dict)
    problems: tuple[GraphProblem, ...] = ()

    @property
    def nodes(self) -> set[str]:
        """The names of all nodes."""
        return {node for nodes in self.ends.values() for node in nodes}


async def system_state(master: str, caller: str) -> SystemState:
    """Request the state of a master; RobotError KG810 for an invalid answer, and those of `ask`."""
    return _state(master, await ask(master, "getSystemState", caller))


class StateReader:
    """Polls the state of a master; an unchanged answer is not parsed again."""

    def __init__(self, master: str, caller: str) -> None:
        self._master = master
        self._caller = caller
        self._content = b""
        self._state = SystemState()

    async def read(self) -> SystemState:
        """Return the state, the same object as before if it is unchanged; errors as `system_state`."""
        content = await exchange(self._master, "getSystemState", self._caller)
        if content != self._content:
            state = _state(self._master, value(self._master, "getSystemState", content))
            self._content = content
            self._state = self._state if state == self._state else state
        return self._state


def _state(master: str, reply: Any) -> SystemState:
    ends: dict[tuple[Role, str], tuple[str, ...]] = {}
    problems: dict[GraphProblem, None] = {}
    try:
        for role, rows in zip(_ROLES, reply, strict=True):
            for name, nodes in rows:
                for bad in (one for one in (name, *nodes) if not is_name(one)):
                    problems[
                        GraphProblem("KG812", shown(bad), f"it is listed as {role.value}, but is not a ROS name")
                    ] = None
                if is_name(name):
                    ends[role, name] = tuple(sorted({node for node in nodes if is_name(node)}))
    except (TypeError, ValueError):
        raise RobotError("KG810", f"{master} did not report the system state") from None
    return SystemState(ends, tuple(problems))


async def topic_types(master: str, caller: str) -> tuple[dict[str, str], tuple[GraphProblem, ...]]:
    """Request the types of topics from a master, and return the valid ones; errors as `system_state`."""
    reply = await ask(master, "getTopicTypes", caller)
    try:
        rows = {name: kind for name, kind in reply if is_name(name)}
    except (TypeError, ValueError):
        raise RobotError("KG810", f"{master} did not report topic types") from None
    odd = tuple(
        GraphProblem("KG812", name, f"its type `{shown(kind)}` is not a type")
        for name, kind in rows.items()
        if kind != "*" and not is_type(kind)
    )
    return {name: kind for name, kind in rows.items() if is_type(kind)}, odd


async def multicall(master: str, method: str, caller: str, names: list[str]) -> dict[str, Any]:
    """Send the same request for many names to a master, and return the values of known names.

    The calls are batched by `system.multicall` of XML-RPC, which rosmaster supports; without it, each is sent alone.
    """
    values: dict[str, Any] = {}
    for start in range(0, len(names), _CALLS_AT_ONCE):
        part = names[start : start + _CALLS_AT_ONCE]
        calls = [{"methodName": method, "params": [caller, name]} for name in part]
        try:
            values |= _values(part, await call(master, "system.multicall", calls))
        except RobotError:
            for name in part:
                try:
                    values[name] = await ask(master, method, caller, name)
                except RobotError as error:
                    if error.code != "KG813":
                        raise
    return values


def _values(names: list[str], reply: Any) -> Iterator[tuple[str, Any]]:
    if not isinstance(reply, list) or len(reply) != len(names):
        raise RobotError("KG810", "a master answers many calls with as many answers")
    for name, answer in zip(names, reply, strict=True):
        match answer:
            case [[1, _, value]]:
                yield name, value
            case _:
                continue


_AT_ONCE: Final = 64
_AT_ONCE_BESIDE: Final = 8
_PATIENCE: Final = 1.0
_SHARE: Final = 9.0
_SOONEST: Final = 0.05
_LATEST: Final = 0.2
_FRESH: Final = 3.0
_ASKING: Final = "asking nodes whether they live"
_OF_EVERY_NODE: Final = {"get_loggers": "roscpp/GetLoggers", "set_logger_level": "roscpp/SetLoggerLevel"}
"""Services that client libraries create in each node; their types are known."""


@dataclass(slots=True)
class _Report:
    uri: str | None
    problem: GraphProblem | None
    at: float


@dataclass(slots=True, eq=False)
class _Picture:
    """The state of the master, with the reports of nodes."""

    state: SystemState
    names: set[str]
    services: list[tuple[str, str]]
    ends: tuple[LiveEnd, ...]
    odd: tuple[GraphProblem, ...]


class Analyzer:
    """Reads the graph for our node, and caches what does not change."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._reader = StateReader(node.master, node.name)
        self._nodes: dict[str, _Report] = {}
        self._types: dict[tuple[str, str], str | GraphProblem] = {}
        self._polls = 0
        self._took = 0.0

    async def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, and again after each change; it ends when the master is lost.

        Nodes are probed concurrently, less often than the master. A fast master is polled more often: while nothing
        changes, it is idle nine tenths of the time, unless a poll takes longer than `_LATEST` seconds.
        """
        loop = asyncio.get_running_loop()
        picture: _Picture | None = None
        last: ComputationGraph | None = None
        seen: object = None
        asking = self._node.spawn(asyncio.sleep(0), _ASKING)
        try:
            while not self._node.lost.done():
                began = loop.time()
                took = _LATEST
                try:
                    state = await self._reader.read()
                    took = loop.time() - began
                    if picture is None or state is not picture.state:
                        picture = await self._picture(state, fresh=math.inf)
                except RobotError as error:
                    self._node.note(error.code, self._node.master, error.message)
                now = (picture, self._polls, len(self._node.problems))
                if picture is not None and now != seen:
                    seen, graph = now, self._graph(picture)
                    if graph != last:
                        last = graph
                        yield graph
                if picture is not None and asking.done():
                    asking = self._node.spawn(self._ask_again(picture.names), _ASKING)
                await asyncio.sleep(pause(took))
        finally:
            asking.cancel()

    async def read(self) -> ComputationGraph:
        """Return the graph without our own node; RobotError as `system_state` if the master does not answer."""
        return self._graph(await self._picture(await self._reader.read(), fresh=_FRESH))

    async def _picture(self, state: SystemState, fresh: float) -> _Picture:
        """Return the graph of a state, after probing new nodes and services."""
        kinds, odd = await topic_types(self._node.master, self._node.name)
        names = state.nodes - {self._node.name}
        self._nodes = {name: report for name, report in self._nodes.items() if name in names}
        self._types = {key: kind for key, kind in self._types.items() if key[0] in names}
        await self._ask_nodes(names, fresh)
        services = [
            (node, name)
            for (role, name), nodes in state.ends.items()
            for node in nodes
            if role is Role.SERVICES and node in names
        ]
        await self._ask_services(services)
        of_services = {key: kind for key, kind in self._types.items() if isinstance(kind, str)}
        ends = fold(
            LiveEnd(node, role, name, of_services.get((node, name)) if role is Role.SERVICES else kinds.get(name))
            for (role, name), nodes in state.ends.items()
            for node in nodes
            if node in names
        )
        return _Picture(state, names, services, ends, odd)

    def _graph(self, picture: _Picture) -> ComputationGraph:
        reports = {name: self._nodes[name] for name in picture.names if name in self._nodes}
        of_nodes = [one.problem for one in reports.values()]
        of_services = [self._types.get(key) for key in picture.services]
        own = [one for one in (*of_nodes, *of_services) if isinstance(one, GraphProblem)]
        problems = {*picture.state.problems, *picture.odd, *self._node.problems, *own}
        live = sorted(
            LiveNode(name, one.uri, one.problem.message if one.problem else None) for name, one in reports.items()
        )
        return ComputationGraph(1, tuple(live), picture.ends, tuple(sorted(problems)))

    async def _ask_nodes(self, names: set[str], fresh: float, at_once: int = _AT_ONCE) -> None:
        now = asyncio.get_running_loop().time()
        stale = sorted(name for name in names if name not in self._nodes or now - self._nodes[name].at > fresh)
        uris = await multicall(self._node.master, "lookupNode", self._node.name, stale)
        await _bounded(lambda name: self._ask_node(name, uris.get(name)), stale, at_once)

    async def _ask_again(self, names: set[str]) -> None:
        """Probe nodes again later, a few at once, using at most a tenth of the time."""
        loop = asyncio.get_running_loop()
        await asyncio.sleep(max(_FRESH, 10 * self._took))
        began = loop.time()
        try:
            await self._ask_nodes(names, _FRESH, at_once=_AT_ONCE_BESIDE)
        except RobotError as error:
            self._node.note(error.code, self._node.master, error.message)
        self._polls += 1
        self._took = loop.time() - began

    async def _ask_node(self, name: str, uri: Any) -> None:
        problem: GraphProblem | None = None
        if uri is None:
            problem = GraphProblem("KG811", name, "the master no longer has its address")
        else:
            try:
                await ask(uri, "getPid", self._node.name, seconds=_PATIENCE)
            except RobotError as error:
                code = "KG811" if error.code == "KG803" else error.code
                problem = GraphProblem(code, name, error.message)
        earlier = self._nodes.get(name)
        if earlier is not None and earlier.uri != uri:
            self._types = {key: kind for key, kind in self._types.items() if key[0] != name}
        address = shown(uri) if uri is not None else None
        self._nodes[name] = _Report(address, problem, asyncio.get_running_loop().time())

    async def _ask_services(self, services: list[tuple[str, str]]) -> None:
        """Request the types of new services of live nodes; the port of a node is requested once."""
        for node, service in services:
            own, _, last = service.rpartition("/")
            if own == node and last in _OF_EVERY_NODE:
                self._types[node, service] = _OF_EVERY_NODE[last]
        live = {name for name, report in self._nodes.items() if report.problem is None}
        new = [key for key in services if not isinstance(self._types.get(key), str) and key[0] in live]
        one_of = dict(new)
        uris = await multicall(self._node.master, "lookupService", self._node.name, sorted(set(one_of.values())))
        await _bounded(lambda key: self._ask_service(key, uris.get(one_of[key[0]])), new)

    async def _ask_service(self, key: tuple[str, str], uri: Any) -> None:
        node, service = key
        try:
            if uri is None:
                uri = await self._node.ask("lookupService", service)
            self._types[key] = await probe(self._node.name, uri, service, seconds=_PATIENCE)
        except RobotError as error:
            self._types[key] = GraphProblem(error.code, node, f"`{service}`: {error.message}")


def pause(took: float) -> float:
    """Return the pause after an answer of a duration; both in seconds."""
    return min(max(_SHARE * took, _SOONEST), _LATEST)


async def _bounded(work: Callable[[Any], Awaitable[None]], items: list[Any], at_once: int = _AT_ONCE) -> None:
    """Do some work for each item, with limited concurrency."""
    gate = asyncio.Semaphore(at_once)

    async def one(item: Any) -> None:
        async with gate:
            await work(item)

    await asyncio.gather(*map(one, items))
