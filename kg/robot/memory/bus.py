"""The bus: what nodes of one process share."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, ClassVar, Self

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import WallClock
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode
from kg.robot.memory.node import MemoryConnection
from kg.robot.messages import Types

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType

    from kg.robot.clock import Clock
    from kg.robot.memory.actions import ActionServer
    from kg.robot.memory.services import Service
    from kg.robot.memory.topics import Topic

__all__ = ["Bus"]


class Bus:
    """A system of nodes in this process, known by its name until it is closed.

    Args:
        name: what `memory://NAME` calls it.
        ros: the version of ROS whose messages are spoken.
        clock: the time of all its nodes; that of the wall when none is given.
        types: the types of messages that nodes know which bring none.
    """

    _known: ClassVar[dict[str, Bus]] = {}

    def __init__(self, name: str, *, ros: int = 1, clock: Clock | None = None, types: Types | None = None) -> None:
        """Raise RobotError KG801 when another bus of that name is open."""
        if name in self._known:
            raise RobotError("KG801", f"this process already has a robot `memory://{name}`")
        self.name = name
        self.ros = ros
        self.clock: Clock = clock or WallClock()
        self.types = types or Types(ros)
        self.nodes: dict[str, MemoryConnection] = {}
        self.topics: dict[str, Topic] = {}
        self.services: dict[str, Service] = {}
        self.actions: dict[str, ActionServer] = {}
        self.problems: list[GraphProblem] = []
        self._watchers: set[asyncio.Event] = set()
        self._known[name] = self

    @classmethod
    def named(cls, name: str) -> Bus | None:
        """Return the bus of that name, None when there is none."""
        return cls._known.get(name)

    @property
    def address(self) -> str:
        """What connects to it."""
        return f"memory://{self.name}"

    def join(self, name: str, types: Types | None = None) -> MemoryConnection:
        """Become a node of the bus; like ROS 1, a node of a name that is there already throws that one out."""
        absolute = name if name.startswith("/") else f"/{name}"
        self.cut(absolute, "another node with the same name joined")
        node = MemoryConnection(self, absolute, types or self.types)
        self.nodes[absolute] = node
        self.changed()
        return node

    def cut(self, name: str, why: str) -> None:
        """Take a node off without its doing, as a broken cable or a crash does; it learns that it is lost."""
        node = self.nodes.get(name)
        if node is not None:
            node.lose(why)

    def close(self) -> None:
        """End the system: all nodes are lost, and the name is free."""
        for name in list(self.nodes):
            self.cut(name, "the system ended")
        self._known.pop(self.name, None)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def changed(self) -> None:
        """Wake up who watches the graph."""
        for watcher in self._watchers:
            watcher.set()

    def watch(self) -> asyncio.Event:
        """Return an event that is set whenever the graph has changed, until `unwatch`."""
        event = asyncio.Event()
        self._watchers.add(event)
        return event

    def unwatch(self, event: asyncio.Event) -> None:
        """Tell an event nothing more."""
        self._watchers.discard(event)

    def graph(self, without: str | None = None) -> ComputationGraph:
        """Return the computation graph, without one node if one is named."""
        nodes = sorted(LiveNode(name, f"{self.address}{name}") for name in self.nodes if name != without)
        ends = {(one.name, one.role, one.node): one for one in self._ends() if one.node != without}
        return ComputationGraph(
            self.ros, tuple(nodes), tuple(ends[key] for key in sorted(ends)), tuple(sorted(self.problems))
        )

    def _ends(self) -> Iterable[LiveEnd]:
        for name, topic in self.topics.items():
            yield from (LiveEnd(one.node, Role.PUBLISHES, name, one.kind) for one in topic.publications)
            yield from (LiveEnd(one.node, Role.SUBSCRIBES, name, one.kind) for one in topic.subscriptions)
        for name, service in self.services.items():
            yield LiveEnd(service.node, Role.SERVICES, name, service.kind)
        for name, action in self.actions.items():
            yield LiveEnd(action.node, Role.ACTION_SERVERS, name, action.kind)
            yield from (LiveEnd(node, Role.ACTION_CLIENTS, name, action.kind) for node in action.clients)
