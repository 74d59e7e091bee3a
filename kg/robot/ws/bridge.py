"""What a protocol of a bridge does for a connection."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.errors import RobotError
    from kg.robot.connection import ComputationGraph, Value
    from kg.robot.messages import Types

__all__ = ["Bridge", "Deliver", "Send"]

Send: TypeAlias = "Callable[[str | bytes], Awaitable[None]]"
"""Sends a text or bytes to the server."""
Deliver: TypeAlias = "Callable[[str, Value], None]"
"""Takes a message of a topic."""


class Bridge(Protocol):
    """One side of a protocol; all of it is called in the event loop."""

    deliver: Deliver
    """Gets the messages of topics that are listened to; set by the connection."""
    changed: Callable[[], None]
    """Is called when the graph has changed; set by the connection."""

    @property
    def types(self) -> Types:
        """The types of messages that are known; there once `begin` has returned."""

    async def begin(self) -> None:
        """Return when the version of ROS and the graph are known; RobotError KG802 for what bridges no ROS."""

    def take(self, message: str | bytes) -> None:
        """Take what the server has sent; RobotError KG810 where that breaks the protocol."""

    def graph(self) -> ComputationGraph:
        """Return the graph that was told last, the bridge's own node included."""

    async def know(self, topic: str, kind: str | None) -> str:
        """Return the type of a topic that is to be read, and learn it; RobotError KG804 or KG806."""

    async def listen(self, topic: str, kind: str) -> None:
        """Have the messages of a topic delivered, also of publishers that come later; until it is cancelled."""

    async def leave(self, topic: str) -> None:
        """Have them delivered no more."""

    async def offer(self, topic: str, kind: str, *, latch: bool) -> None:
        """Offer a topic; RobotError KG852 where the bridge takes no messages, KG804 for an unknown type."""

    async def send(self, topic: str, kind: str, value: Value) -> None:
        """Send a message to a topic that is offered; RobotError KG805 for a value that does not fit."""

    async def withdraw(self, topic: str) -> None:
        """Offer a topic no more."""

    async def call(self, service: str, kind: str | None, request: Value) -> Value:
        """Call a service; RobotError KG806, KG807, KG808."""

    def hears(self, topic: str) -> int:
        """Return how many nodes subscribe to a topic, as far as the bridge tells; 1 where it does not."""

    def lose(self, error: RobotError) -> None:
        """Let calls fail that wait for an answer."""
