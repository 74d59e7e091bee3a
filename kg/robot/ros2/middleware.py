"""What a middleware of ROS 2 gives: bytes of messages to and from topics and services, and who else is there."""

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
"""What is offered to subscribers: every one that does not ask for earlier messages can read it."""
LATCHED = Qos("reliable", "transient_local", "keep_last", 1)
ANSWERS = Qos("reliable", "volatile", "keep_last", 10)
"""That of services (rmw_qos_profile_services_default)."""

Deliver: TypeAlias = "Callable[[bytes, str | None], None]"
"""Takes a message in CDR with its four bytes of encapsulation, and the name of the node that sent it, if known."""


@dataclass(frozen=True, slots=True)
class Neighbourhood:
    """The others, as the middleware sees them: actions are not folded yet."""

    nodes: tuple[LiveNode, ...] = ()
    ends: tuple[LiveEnd, ...] = ()
    problems: tuple[GraphProblem, ...] = ()


class Handle(Protocol):
    """Something that was opened."""

    @property
    def peers(self) -> int:
        """How many ends of others are connected to it."""

    async def ready(self) -> None:
        """Return when an end of another node is connected, so that nothing is lost that is sent from now on."""

    def close(self) -> None:
        """Close it; closing again is nothing."""


class Writer(Handle, Protocol):
    """An end that writes to a topic."""

    def write(self, content: bytes) -> None:
        """Send a message in CDR with its encapsulation; RobotError KG803 when it cannot be sent."""


class Caller(Handle, Protocol):
    """A client of a service."""

    async def call(self, content: bytes) -> bytes:
        """Return the response to a request; RobotError KG808 when the server says that it failed."""


class Middleware(Protocol):
    """A wire of ROS 2; all of it is called in the event loop, and calls back in it."""

    types: Types

    def begin(self, watch: Watch) -> None:
        """Be there as a node, and tell the watch when something has changed."""

    def neighbourhood(self) -> Neighbourhood:
        """Return who else is there now."""

    def reader(self, topic: str, kind: str, qos: Qos, deliver: Deliver) -> Handle:
        """Read a topic."""

    def writer(self, topic: str, kind: str, qos: Qos) -> Writer:
        """Write to a topic."""

    def caller(self, service: str, kind: str) -> Caller:
        """Become a client of a service; `kind` is without `_Request`."""

    def server(self, service: str, kind: str, answer: Callable[[bytes], Awaitable[bytes]]) -> Handle:
        """Serve a service; an exception of `answer` is told to the client where the middleware has a way to."""

    def hashes(self, name: str) -> Iterable[tuple[str, str]]:
        """Return the nodes that have an end of a topic or service, each with the hash of its type (RIHS01)."""

    async def learn(self, kind: str, name: str) -> bool:
        """Ask those that have an end of that topic or service for its type; tell whether it is known now."""

    def close(self) -> None:
        """Leave; everything that was opened is closed."""
