"""Services of ROS 2 above the wire: requests and responses as values."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from kg.errors import RobotError
from kg.robot.connection import GraphProblem
from kg.robot.tasks import outcome

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.connection import Value
    from kg.robot.messages import Types
    from kg.robot.ros2.connection import Ros2Connection
    from kg.robot.ros2.middleware import Caller

__all__ = ["Client", "Service"]

Result = TypeVar("Result")


class Client:
    """Our client of a service."""

    def __init__(self, types: Types, kind: str, caller: Caller) -> None:
        self._types = types
        self._kind = kind
        self._caller = caller

    async def call(self, request: Value) -> Value:
        """Return the response; RobotError KG805, KG808, or KG816 for one that does not decode."""
        content = self._types.encode(f"{self._kind}_Request", request)
        response = await self._caller.call(content)
        try:
            return self._types.decode(f"{self._kind}_Response", response)
        except RobotError as error:
            raise RobotError("KG816", f"the response of a {self._kind} does not decode: {error.message}") from None

    def end(self) -> None:
        """Stop being a client."""
        self._caller.close()


class Service:
    """A service that our node answers."""

    def __init__(
        self, owner: Ros2Connection, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]
    ) -> None:
        self._owner = owner
        self._name = name
        self._kind = kind
        self._answer = answer
        self._handle = owner.wire.server(name, kind, self._respond)

    async def _respond(self, content: bytes) -> bytes:
        try:
            request = self._owner.types.decode(f"{self._kind}_Request", content)
        except RobotError as error:
            self._owner.watch.report(GraphProblem("KG816", self._name, f"a request does not decode: {error.message}"))
            raise
        found = await outcome(self._answer(request))
        if isinstance(found, BaseException):
            message = found.message if isinstance(found, RobotError) else str(found)
            self._owner.watch.report(GraphProblem("KG808", self._name, f"our own answer failed: {message}"))
            raise RobotError("KG808", message)
        return self._owner.types.encode(f"{self._kind}_Response", found)

    def end(self) -> None:
        """Stop answering."""
        self._handle.close()
        self._owner.forget(self)

    async def aclose(self) -> None:
        """Stop answering."""
        self.end()
