"""The interface of ROS 2 middlewares: encoded messages of topics and services, and discovery."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, TypeAlias

from kg.facts import Qos

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Iterable

    from kg.robot.connection import GraphProblem, LiveEnd, LiveNode
    from kg.robot.messages import Types
    from kg.robot.ros2.graph import Watch

OFFERED = Qos("reliable", "volatile", "keep_last", 10)
"""QoS offered to subscribers: compatible with all that do not require earlier messages."""
LATCHED = Qos("reliable", "transient_local", "keep_last", 1)
ANSWERS = Qos("reliable", "volatile", "keep_last", 10)
"""QoS of services (rmw_qos_profile_services_default)."""

Deliver: TypeAlias = "Callable[[bytes, str | None], None]"
"""Receives a message in CDR with its four bytes of encapsulation, and the name of its sender, if known."""


@dataclass(frozen=True, slots=True)
class Neighbourhood:
    """The other nodes and ends as the middleware reports them, before actions are folded."""

    nodes: tuple[LiveNode, ...] = ()
    ends: tuple[LiveEnd, ...] = ()
    problems: tuple[GraphProblem, ...] = ()


class Handle(Protocol):
    """An open end."""

    def close(self) -> None:
        """Close it; may be repeated."""


class End(Handle, Protocol):
    """A subscriber or publisher of a topic."""

    async def ready(self) -> None:
        """Return when an end of another node is connected, so no message is lost from then on."""


class Writer(End, Protocol):
    """A publisher of a topic."""

    @property
    def peers(self) -> int:
        """Number of connected subscribers."""

    @property
    def confirmed(self) -> bool:
        """Whether every connected reader has confirmed all messages; False if the middleware does not report it."""

    def write(self, content: bytes) -> None:
        """Send a message in CDR with its encapsulation; RobotError KG803 if that fails."""


class Caller(Handle, Protocol):
    """A client of a service."""

    async def call(self, content: bytes) -> bytes:
        """Return the response to a request; RobotError KG808 if the server reports a failure."""


class Middleware(Protocol):
    """A ROS 2 middleware; all calls and callbacks are in the event loop."""

    types: Types

    def begin(self, watch: Watch) -> None:
        """Join as a node, and notify the watch of changes."""

    def neighbourhood(self) -> Neighbourhood:
        """Return the other nodes and ends."""

    def reader(self, topic: str, kind: str, qos: Qos, deliver: Deliver) -> End:
        """Open a reader of a topic."""

    def writer(self, topic: str, kind: str, qos: Qos) -> Writer:
        """Open a writer of a topic."""

    def caller(self, service: str, kind: str) -> Caller:
        """Open a client of a service; `kind` is without `_Request`."""

    def server(self, service: str, kind: str, answer: Callable[[bytes], Awaitable[bytes]]) -> Handle:
        """Serve a service; an exception of `answer` is reported to the client if the middleware supports it."""

    def hashes(self, name: str) -> Iterable[tuple[str, str]]:
        """Return the nodes with an end of a topic or service, each with the hash of its type (RIHS01)."""

    async def learn(self, kind: str, name: str) -> bool:
        """Request the type of a topic or service from its nodes; return whether it is known now."""

    def close(self) -> None:
        """Leave, and close everything."""
