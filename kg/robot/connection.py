"""The one interface over all middlewares: a robot's computation graph, its topics, services and actions.

Names are absolute (`/cmd_vel`), types are `package/Type` in ROS 1 and ROS 2 alike. Messages are plain values: a dict of
fields by name, lists, numbers, texts, and bytes for arrays of bytes; times are `{"sec": ..., "nanosec": ...}`.
A `Connection` is one node of the graph that it looks at. Everything runs in one event loop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias

from kg.errors import KgError, RobotError
from kg.facts import Qos, Role  # noqa: TC001 - read when the classes are made

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.clock import Clock
    from kg.robot.messages import Types

Value: TypeAlias = dict[str, Any]
"""A message as plain values."""
FAILURES: Final = (KgError, ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError)
"""What the code that answers may raise: to the client it is the failure of the service or goal."""


@dataclass(frozen=True, slots=True, order=True)
class LiveNode:
    """A node that runs; `problem` says in words why less is known of it than of others, as for one that is dead.

    `state` is that of a managed node of ROS 2 (`kg.robot.lifecycle`); None for others, or while it is not known.
    """

    name: str
    address: str | None = None
    problem: str | None = None
    state: str | None = None


@dataclass(frozen=True, slots=True)
class LiveEnd:
    """One end of a topic, service or action; the type is None where nobody tells it."""

    node: str
    role: Role
    name: str
    type: str | None = None
    qos: Qos | None = None


@dataclass(frozen=True, slots=True, order=True)
class GraphProblem:
    """Something that a peer did wrong: a code (KG8xx), whose it is, and what happened."""

    code: str
    subject: str
    message: str


@dataclass(frozen=True, slots=True)
class RecordedTopic:
    """How many messages of a topic a recording has, and how many seconds the recording lasts."""

    name: str
    count: int
    seconds: float


@dataclass(frozen=True, slots=True)
class ComputationGraph:
    """What runs and how it communicates, sorted; actions are folded: their hidden topics and services are left out.

    `complete` tells whether the graph was watched long enough to be called the whole one; `recorded` is what only a
    recording tells.
    """

    ros: int
    nodes: tuple[LiveNode, ...] = ()
    ends: tuple[LiveEnd, ...] = ()
    problems: tuple[GraphProblem, ...] = ()
    complete: bool = True
    recorded: tuple[RecordedTopic, ...] = ()


@dataclass(frozen=True, slots=True)
class Received:
    """A message that came, with the time on the connection's clock and the node that sent it, if it is known."""

    value: Value
    at: float
    node: str | None = None


class Subscription(Protocol):
    """Messages of a topic as they come, oldest first; when too many wait, the oldest are dropped and counted."""

    @property
    def dropped(self) -> int:
        """How many messages were dropped."""

    def __aiter__(self) -> AsyncIterator[Received]:
        """Return the messages; the iteration ends when the subscription is closed or the connection is lost."""

    async def aclose(self) -> None:
        """Stop receiving."""


class Publication(Protocol):
    """A topic that this node writes to."""

    @property
    def peers(self) -> int:
        """How many subscribers are connected."""

    async def publish(self, value: Value) -> None:
        """Send a message; RobotError KG805 when the value does not fit the type, KG803 when the robot is lost."""

    async def aclose(self) -> None:
        """Stop offering the topic."""


class Goal(Protocol):
    """A goal that an action server was given."""

    def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback as it comes, until the goal has ended."""

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status when the goal was aborted, rejected or cancelled."""

    async def cancel(self) -> None:
        """Ask the server to end the goal; `result` tells when it has."""


class Canceller(Protocol):
    """Cancels goals of one action, whoever gave them."""

    async def cancel(self, identity: str) -> None:
        """Ask the server to end a goal; RobotError KG803 when it does not answer."""


class Serving(Protocol):
    """A service or action that this node answers."""

    async def aclose(self) -> None:
        """Stop answering."""


class Connection(Protocol):
    """A node of ours in the system of a robot."""

    @property
    def ros(self) -> int:
        """The version of ROS that is spoken: 1 or 2."""

    @property
    def address(self) -> str:
        """Where it is connected to: `ros1://host:port`, `dds://DOMAIN`, `zenoh://host:port`, `bag://FILE`, `memory://NAME`."""

    @property
    def name(self) -> str:
        """The name of our node, absolute."""

    @property
    def clock(self) -> Clock:
        """The time of the robot."""

    @property
    def types(self) -> Types:
        """The types of messages that are known; it learns those that peers tell."""

    async def graph(self) -> ComputationGraph:
        """Return the computation graph without our own node; RobotError KG802 when the robot does not answer."""

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the graph as it is, and again each time that it has changed, within a second of the change."""

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Subscription:
        """Receive the messages of a topic; without `kind` its type is asked for.

        Raises:
            RobotError: KG804 when the type is not known and nobody tells it, KG806 when the topic has another type.
        """

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> Publication:
        """Offer a topic; `latch` keeps the last message for those that come later (ROS 2: transient local)."""

    async def call(self, service: str, kind: str | None, request: Value, *, seconds: float) -> Value:
        """Call a service and return the response.

        Raises:
            RobotError: KG807 when nobody serves it, KG808 when it failed, KG803 when the time was over.
        """

    async def send_goal(
        self, action: str, kind: str, goal: Value, *, seconds: float, identity: str | None = None
    ) -> Goal:
        """Give an action a goal; KG807 when nobody serves it within so many seconds, KG809 when it is rejected.

        `identity` is the identity of the goal, 32 hexadecimal digits, by which other nodes can cancel it; by default a
        random one.
        """

    async def canceller(self, action: str, kind: str) -> Canceller:
        """Return what cancels goals of an action by their identities; RobotError KG804 for an unknown type."""

    async def serve(self, service: str, kind: str, answer: Callable[[Value], Awaitable[Value]]) -> Serving:
        """Answer a service; an exception of `answer` is the failure that the client sees."""

    async def serve_action(self, action: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]) -> Serving:
        """Carry out goals, one at a time: a new one cancels the one before; what `carry_out` returns is the result."""

    async def wait_lost(self) -> str:
        """Return, when the connection is lost, why; never before."""

    async def aclose(self) -> None:
        """Leave the graph; everything that was opened is closed."""


class Accepted(Protocol):
    """A goal that our own action server carries out."""

    @property
    def goal(self) -> Value:
        """What is to be done."""

    @property
    def cancelled(self) -> bool:
        """Whether the client, or a newer goal, asks to stop; `carry_out` then returns what it has."""

    async def feedback(self, value: Value) -> None:
        """Tell the client how far it is."""

    def abort(self, reason: str) -> None:
        """Note that the goal could not be reached; the result is sent as that of an aborted goal."""


def goal_lost(action: str, what: str) -> RobotError:
    """Return the error of a goal of `action` whose server, or the robot, was lost while it was carried out (KG803)."""
    message = f"{what} was lost while executing `{action}`; the robot may still be moving"
    return RobotError("KG803", message, hint="Check whether the robot is moving, then restart the node.")


def reason(error: BaseException) -> str:
    """Return in words why code failed that answers a service or carries out a goal."""
    return error.message if isinstance(error, KgError) else str(error)
