"""The one interface over all middlewares: a robot's computation graph, its topics, services and actions.

Names are absolute (`/cmd_vel`), types are `package/Type` in ROS 1 and ROS 2 alike. Messages are plain values: a dict of
fields by name, lists, numbers, texts, and bytes for arrays of bytes; times are `{"sec": ..., "nanosec": ...}`. A
`Connection` is one node of the graph. Everything runs in one event loop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, Protocol, TypeAlias

from kg.errors import KgError, RobotError
from kg.facts import Qos, Role  # noqa: TC001 - read when the classes are made

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.clock import Clock
    from kg.robot.messages import Types

Level: TypeAlias = Literal["info", "warning", "error"]
"""The severity of a line of the log."""
Value: TypeAlias = dict[str, Any]
"""A message as plain values."""
Cancel: TypeAlias = "Callable[[str], Awaitable[None]]"
"""Requests the cancellation of a goal by its identity; RobotError KG803 if the server does not answer."""
FAILURES: Final = (KgError, ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError)
"""Exceptions of service and action callbacks that are reported to the client as failures."""


@dataclass(frozen=True, slots=True, order=True)
class LiveNode:
    """A running node; `problem` is the reason for missing information, such as a dead node.

    `state` is that of a managed node of ROS 2 (`kg.robot.lifecycle`); None for others, or while it is unknown.
    """

    name: str
    address: str | None = None
    problem: str | None = None
    state: str | None = None


@dataclass(frozen=True, slots=True)
class LiveEnd:
    """An end of a topic, service or action; the type is None if it is unknown."""

    node: str
    role: Role
    name: str
    type: str | None = None
    qos: Qos | None = None


@dataclass(frozen=True, slots=True, order=True)
class GraphProblem:
    """An error of a peer: its code (KG8xx), the peer, and a description."""

    code: str
    subject: str
    message: str


@dataclass(frozen=True, slots=True)
class RecordedTopic:
    """The number of messages of a topic in a recording, and the duration of the recording in seconds."""

    name: str
    count: int
    seconds: float


@dataclass(frozen=True, slots=True)
class ComputationGraph:
    """Nodes and their communication, sorted; actions are folded, without their hidden topics and services.

    `complete` is whether the graph was watched long enough to be complete; `recorded` has data of recordings only.
    """

    ros: int
    nodes: tuple[LiveNode, ...] = ()
    ends: tuple[LiveEnd, ...] = ()
    problems: tuple[GraphProblem, ...] = ()
    complete: bool = True
    recorded: tuple[RecordedTopic, ...] = ()


@dataclass(frozen=True, slots=True)
class Received:
    """A received message, with the time on the connection's clock and the node that sent it, if it is known.

    `latched` is whether a publisher of ROS 1 keeps its last message; in ROS 2 the QoS of the end has it.
    """

    value: Value
    at: float
    node: str | None = None
    latched: bool = False


class Subscription(Protocol):
    """The messages of a topic, oldest first; when the queue is full, the oldest are dropped and counted."""

    @property
    def dropped(self) -> int:
        """Number of dropped messages."""

    def __aiter__(self) -> AsyncIterator[Received]:
        """Iterate over messages until the subscription is closed or the connection is lost."""

    async def aclose(self) -> None:
        """Close the subscription."""


class Publication(Protocol):
    """A topic that this node publishes."""

    @property
    def peers(self) -> int:
        """Number of connected subscribers."""

    @property
    def confirmed(self) -> bool:
        """Whether every connected subscriber has confirmed all messages; False if the connection cannot report it."""

    async def publish(self, value: Value) -> None:
        """Publish a message; RobotError KG805 if the value does not fit the type, KG803 if the robot is lost."""

    async def aclose(self) -> None:
        """Stop publishing the topic."""


class Goal(Protocol):
    """A goal sent to an action server."""

    def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback until the goal has ended."""

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status if the goal was aborted, rejected or cancelled."""

    async def cancel(self) -> None:
        """Request cancellation of the goal; `result` returns when it has ended."""


class Connection(Protocol):
    """Our node in the system of a robot."""

    @property
    def ros(self) -> int:
        """The version of ROS: 1 or 2."""

    @property
    def address(self) -> str:
        """Its address: `ros1://host:port`, `dds://DOMAIN`, `zenoh://host:port`, `bag://FILE`, `memory://NAME`."""

    @property
    def name(self) -> str:
        """The absolute name of our node."""

    @property
    def clock(self) -> Clock:
        """The clock of the robot."""

    @property
    def types(self) -> Types:
        """The known message types, including those learned from peers."""

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node; RobotError KG802 if the robot does not answer."""

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the current graph, and again within a second of each change."""

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Subscription:
        """Subscribe to a topic; without `kind` its type is looked up.

        Raises:
            RobotError: KG804 the type is unknown to us and all peers, KG806 the topic has another type.
        """

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> Publication:
        """Advertise a topic; `latch` keeps the last message for later subscribers (ROS 2: transient local)."""

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response; RobotError KG807 no server, KG808 a failure, KG803 a timeout."""

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> Goal:
        """Send a goal to an action; KG807 if there is no server within some seconds, KG809 if it rejects the goal.

        `identity` is the identity of the goal, 32 hexadecimal digits, by which other nodes can cancel it; by default a
        random one.
        """

    async def canceller(self, action: str) -> Cancel:
        """Return the function that cancels goals of an action, whoever sent them."""

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> None:
        """Serve a service while connected; an exception of `answer` is reported to the client as a failure."""

    async def serve_action(self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]) -> None:
        """Serve an action while connected, one goal at a time: a new goal cancels the previous one.

        `carry_out` returns the result.
        """

    def log(self, level: Level, message: str) -> None:
        """Write a line to the log of the robot (`/rosout`), if the connection supports that."""

    async def wait_lost(self) -> str:
        """Return the reason when the connection is lost; never before."""

    async def aclose(self) -> None:
        """Leave the graph, and close everything."""


class Accepted(Protocol):
    """A goal that our own action server executes."""

    @property
    def goal(self) -> Value:
        """The message of the goal."""

    @property
    def cancelled(self) -> bool:
        """Whether the client, or a newer goal, requests cancellation; `carry_out` then returns its result so far."""

    async def feedback(self, value: Value) -> None:
        """Send feedback to the client."""

    def abort(self, reason: str) -> None:
        """Record that the goal was aborted; the result is sent as that of an aborted goal."""


def goal_lost(action: str, what: str) -> RobotError:
    """Return the error of a goal of `action` whose server, or the robot, was lost during execution (KG803)."""
    message = f"{what} was lost while executing `{action}`; the robot may still be moving"
    return RobotError("KG803", message, hint="Check whether the robot is moving, then restart the node.")


def reason(error: BaseException) -> str:
    """Return a description of the failure of a service or action callback."""
    return error.message if isinstance(error, KgError) else str(error)
