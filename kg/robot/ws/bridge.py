"""Shared parts of both bridge protocols: the version of ROS, pending calls, the reported graph."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Awaitable, Callable, Iterable
from itertools import count
from typing import Any, TypeAlias

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import of_robot
from kg.robot.connection import ComputationGraph, GraphProblem, LiveEnd, LiveNode, Value
from kg.robot.messages import Types
from kg.robot.ros1.graph import fold
from kg.robot.ros2.graph import computation_graph
from kg.robot.ros2.middleware import Neighbourhood
from kg.robot.ros2.names import full_type

Send: TypeAlias = "Callable[[str | bytes], Awaitable[None]]"
"""Sends a text or bytes to the server."""


class Bridge:
    """The client side of a protocol; all calls are in the event loop.

    `deliver` receives messages of subscribed topics, `changed` is called when the graph has changed; the connection
    sets both.
    """

    def __init__(self, send: Send, types: Types | None) -> None:
        self.deliver: Callable[[str, Value], None] = lambda _topic, _value: None
        self.changed: Callable[[], None] = lambda: None
        self._send = send
        self._given = types
        self._types: Types | None = None
        self._listening: dict[str, str] = {}
        self._calls: dict[str, asyncio.Future[Any]] = {}
        self._problems: dict[GraphProblem, None] = {}
        self._numbers = count(1)

    @property
    def types(self) -> Types:
        """The known message types; available after `begin`."""
        assert self._types is not None  # noqa: S101 - `begin` has come to its end
        return self._types

    def _bridges(self, ros: int) -> None:
        self._types = self._given if self._given and self._given.ros == ros else Types(ros)

    def _full(self, kind: str) -> str:
        """Return the full name of a type in the version of ROS: `package/msg/Type` in ROS 2."""
        return kind if self.types.ros == 1 else full_type(kind)

    async def _send_op(self, op: str, **fields: Any) -> None:
        await self._send(json.dumps({"op": op, **fields}))

    async def _answered(self, number: object, asking: Awaitable[None]) -> Any:
        """Send a request with a number, and return the response; raises the error that it failed with."""
        waiting = self._calls[str(number)] = asyncio.get_running_loop().create_future()
        try:
            await asking
            return await waiting
        finally:
            del self._calls[str(number)]

    def _answer(self, number: object, answer: Any) -> None:
        """Complete a pending request with a response or an error, if it is still awaited."""
        waiting = self._calls.get(str(number))
        if waiting is not None and not waiting.done():
            if isinstance(answer, RobotError):
                waiting.set_exception(answer)
            else:
                waiting.set_result(answer)

    def lose(self, error: RobotError) -> None:
        """Fail all pending requests."""
        for number in self._calls:
            self._answer(number, error)

    def take(self, message: str | bytes) -> None:
        """Process a message of the server; RobotError KG810 if it violates the protocol."""
        try:
            self._take(message)
        except (AttributeError, KeyError, TypeError, ValueError, struct.error) as error:
            raise RobotError("KG810", f"a message cannot be read: {error!r}") from None

    def _take(self, message: str | bytes) -> None:
        raise NotImplementedError

    def _report(self, problem: GraphProblem) -> None:
        if problem not in self._problems:
            self._problems[problem] = None
            self.changed()

    def graph(self) -> ComputationGraph:
        """Return the last reported graph, including the bridge's own node."""
        raise NotImplementedError

    def _graph_of(self, nodes: Iterable[LiveNode], ends: Iterable[LiveEnd]) -> ComputationGraph:
        """Return the graph of these nodes and ends, with actions folded."""
        reported = Neighbourhood(tuple(nodes), tuple(ends), tuple(self._problems))
        if self.types.ros == 2:  # noqa: PLR2004 - the version
            return computation_graph(reported, complete=True)
        return ComputationGraph(1, reported.nodes, fold(reported.ends), tuple(sorted(reported.problems)))

    def count_subscribers(self, topic: str) -> int:
        """Return the number of subscribers of a topic, as far as the bridge reports it."""
        return sum(one.name == topic and one.role is Role.SUBSCRIBES for one in of_robot(self.graph()).ends)
