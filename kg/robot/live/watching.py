"""Watching of a running system: each change of its graph is written to the store, and reported as events.

    async for event in watch(store, settings, address="ros1://localhost:11311"):
        ...

A lost robot is reported and reconnected to. When watching ends, the graph keeps its last state, with the time.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from kg.errors import RobotError, StoreError
from kg.facts import Role
from kg.robot.clock import WallClock
from kg.robot.connecting import connected, of_robot
from kg.robot.connection import ComputationGraph, Connection
from kg.robot.live.inference import now
from kg.robot.live.keeping import Keeper, StoredState
from kg.robot.live.systems import is_implicit, name_of
from kg.robot.tasks import first

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, AsyncIterator, Iterator, Mapping

    from kg.settings import Settings
    from kg.store.embedded import EmbeddedStore

_AGAIN: Final = 1.0
"""Seconds between attempts to reconnect to a lost robot, or to write a store that another process is writing."""

_VERBS: Final = {
    Role.PUBLISHES: "publishes",
    Role.SUBSCRIBES: "subscribes",
    Role.SERVICES: "offers",
    Role.CLIENTS: "calls",
    Role.ACTION_SERVERS: "offers action",
    Role.ACTION_CLIENTS: "calls action",
}
_Kind = Literal["watching", "node", "state", "end", "capability", "problem", "lost", "back", "busy", "kept", "ended"]


class Event(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """An event.

    `event` is `watching` (started), `node`, `end` or `capability` (`change` is whether it was added or removed),
    `state` (a managed node changed its state: `detail`), `problem` (of a peer or a rule), `lost` and `back` (the
    robot), `busy` (another process is writing the store), `kept` (the store is up to date: its `generation`, and the
    `seconds` it took) or `ended`. `name` is the subject; `detail` has the address or node type of a node, or role and
    type of an end.
    """

    event: _Kind
    at: str
    change: Literal["came", "went"] | None = None
    name: str = ""
    detail: str = ""
    generation: int | None = None
    seconds: float | None = None


class Watching:
    """A running system whose graph is kept in a store.

    `name` is the name of the system in the store, by default derived from its address.
    """

    def __init__(self, store: EmbeddedStore, settings: Settings, *, address: str, name: str = "") -> None:
        self.address = address
        self.name = name or name_of(address)
        self._keeper = Keeper(store, settings, address=address, name=self.name)
        self._graph: ComputationGraph | None = None
        self._stored: StoredState | None = None
        self._keeping: asyncio.Future[StoredState] | None = None
        self._clock = WallClock()

    async def once(self) -> list[Event]:
        """Store the current graph once and return its content; raises as `events`."""
        async with connected(self.address) as connection:
            return [one async for one in self._step(of_robot(await connection.graph()))]

    async def events(self) -> AsyncGenerator[Event, None]:
        """Yield events without end; callers that stop early must call `end`.

        Raises:
            RobotError: KG801, KG802 no robot at the start.
            StoreError: KG304 the disk is full, KG303, KG305, KG306 the store is not writable.
        """
        begun = False
        while True:
            why = ""
            try:
                async with connected(self.address) as connection:
                    yield _event("back" if begun else "watching", name=self.name, detail=self.address)
                    begun = True
                    async for event in self._connected(connection):
                        yield event
                    why = await connection.wait_lost()
            except RobotError as error:
                if not begun:
                    raise
                why = "" if error.code == "KG802" else error.message
            if why:
                yield _event("lost", name=self.name, detail=why)
            await self._clock.sleep(_AGAIN)

    async def end(self) -> None:
        """Mark the graph as last seen now, and save state for the next process."""
        if self._keeping is not None:
            await asyncio.wait((self._keeping,))
        if self._graph is not None:
            with suppress(StoreError):
                await asyncio.to_thread(self._keeper.keep, self._graph, until=now())
            await asyncio.to_thread(self._keeper.save)

    async def _keep(self, graph: ComputationGraph) -> StoredState:
        """Store a graph completely: a caller that stops early does not interrupt the write."""
        state = await asyncio.to_thread(self._keeper.keep, graph)
        self._graph, self._stored = graph, state
        return state

    async def _connected(self, connection: Connection) -> AsyncIterator[Event]:
        """Yield events until the robot is lost."""
        changes = aiter(connection.changes())
        while True:
            try:
                changed = await first(anext(changes), connection.wait_lost())
            except StopAsyncIteration:
                return
            if changed is None:
                return
            async for event in self._step(of_robot(changed[0])):
                yield event

    async def _step(self, graph: ComputationGraph) -> AsyncIterator[Event]:
        """Yield what was added and removed, and store a graph; the ends come first, since writing can take seconds."""
        began = self._clock.now()
        before, previous = self._graph or ComputationGraph(graph.ros), self._stored
        for event in _changed("end", _explicit(before), _explicit(graph)):
            yield event
        busy = False
        while True:
            try:
                self._keeping = asyncio.ensure_future(self._keep(graph))
                state = await asyncio.shield(self._keeping)
                break
            except StoreError as error:
                if error.code != "KG302":
                    raise
                if not busy:
                    yield _event("busy", detail=error.message)
                busy = True
                await self._clock.sleep(_AGAIN)
        for event in _differences(before, graph, previous, state):
            yield event
        for problem in state.problems if previous is None else ():
            yield _event("problem", name=problem.code, detail=problem.message)
        if state.generation is not None:
            yield _event("kept", generation=state.generation, seconds=round(self._clock.now() - began, 3))


def _event(event: _Kind, **more: Any) -> Event:
    return Event(event=event, at=now(), **more)


def _differences(
    before: ComputationGraph, graph: ComputationGraph, previous: StoredState | None, state: StoredState
) -> Iterator[Event]:
    types = {name: str(match.type) for name, match in state.matches.items()}
    nodes = {one.name: types.get(one.name, one.problem or one.address or "") for one in graph.nodes}
    yield from _changed("node", {one.name: "" for one in before.nodes}, nodes)
    yield from _changed("capability", _names(previous.capabilities if previous else {}), _names(state.capabilities))
    states = {one.name: one.state for one in before.nodes}
    for node in graph.nodes:
        if node.state is not None and node.state != states.get(node.name):
            yield _event("state", name=node.name, detail=node.state)
    for problem in graph.problems:
        if problem not in before.problems:
            yield _event("problem", name=problem.subject, detail=f"{problem.code}: {problem.message}")


def _changed(kind: _Kind, before: Mapping[str, str], after: Mapping[str, str]) -> Iterator[Event]:
    for name in sorted(before.keys() - after.keys()):
        yield _event(kind, change="went", name=name, detail=before[name])
    for name in sorted(after.keys() - before.keys()):
        yield _event(kind, change="came", name=name, detail=after[name])


def _explicit(graph: ComputationGraph) -> dict[str, str]:
    """Return the ends that ROS does not create by itself, as `/base subscribes /cmd_vel`, each with its type."""
    ends = (end for end in graph.ends if not is_implicit(end.role, end.name, end.node, graph.ros))
    return {f"{end.node} {_VERBS[end.role]} {end.name}": end.type or "" for end in ends}


def _names(labels: Mapping[str, str]) -> dict[str, str]:
    return {iri.rpartition("#")[2]: label for iri, label in labels.items()}
