"""Services of a bus."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

from kg.errors import KgError, RobotError
from kg.robot.connection import FAILURES

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.connection import Value
    from kg.robot.memory.node import MemoryConnection

__all__ = ["Service"]


class Service:
    """A service that a node answers."""

    def __init__(
        self, owner: MemoryConnection, name: str, kind: str, answer: Callable[[Value], Awaitable[Value]]
    ) -> None:
        self.kind = kind
        self._owner = owner
        self._name = name
        self._answer = answer
        self._running: set[asyncio.Future[Value]] = set()

    @property
    def node(self) -> str:
        """The name of the node that answers."""
        return self._owner.name

    async def call(self, request: Value) -> Value:
        """Return the response; RobotError KG808 when the node that answers failed, KG803 when it was lost."""
        work = asyncio.ensure_future(self._respond(request))
        self._running.add(work)
        try:
            return await asyncio.shield(work)
        except asyncio.CancelledError:
            if not work.cancelled():
                raise  # the client gave up; the node still answers
            raise RobotError("KG803", f"`{self.node}` was lost while it answered `{self._name}`") from None
        finally:
            work.add_done_callback(self._running.discard)

    async def _respond(self, request: Value) -> Value:
        types = self._owner.types
        try:
            return types.complete(f"{self.kind}_Response", await self._answer(request))
        except KgError as error:
            raise RobotError("KG808", f"`{self._name}` failed: {error.message}") from None
        except FAILURES as error:
            raise RobotError("KG808", f"`{self._name}` failed: {error}") from None

    def end(self) -> None:
        """Answer nothing more; who waits learns that the node is lost."""
        for work in self._running:
            work.cancel()
        if self._owner.bus.services.get(self._name) is self:
            del self._owner.bus.services[self._name]

    async def aclose(self) -> None:
        """Stop answering."""
        self.end()
        self._owner.bus.changed()
