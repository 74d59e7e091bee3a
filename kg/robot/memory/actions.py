"""Actions of a bus: one goal at a time; a newer one cancels those before it."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Final

from kg.errors import KgError, RobotError
from kg.robot.connection import FAILURES, goal_lost
from kg.robot.tasks import spawn

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Awaitable, Callable

    from kg.robot.connection import Accepted, Value
    from kg.robot.memory.bus import Bus
    from kg.robot.memory.node import MemoryConnection

__all__ = ["ActionServer", "MemoryCanceller", "MemoryGoal"]

_MOST_FEEDBACK: Final = 1000
"""So much feedback waits for who may not read it."""


class MemoryGoal:
    """A goal as its client sees it."""

    def __init__(self, client: MemoryConnection, work: _Work) -> None:
        self._client = client
        self._work = work

    async def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback as it comes, until the goal has ended."""
        while True:
            while self._work.told:
                yield self._work.told.popleft()
            if self._work.done.done():
                return
            self._work.news.clear()
            await self._work.news.wait()

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status when the goal was aborted or cancelled."""
        return await asyncio.shield(self._work.done)

    async def cancel(self) -> None:
        """Ask the server to end the goal."""
        self._client.present()
        self._work.cancelled = True
        await asyncio.sleep(0)


class MemoryCanceller:
    """Cancels goals of an action whoever gave them, by their identities."""

    def __init__(self, bus: Bus, action: str) -> None:
        self._bus = bus
        self._action = action

    async def cancel(self, identity: str) -> None:
        """Ask the server to end a goal."""
        if server := self._bus.actions.get(self._action):
            server.cancel(identity)
        await asyncio.sleep(0)


class _Work:
    """A goal as its server sees it: `Accepted`."""

    def __init__(self, server: ActionServer, goal: Value, identity: str | None) -> None:
        self.identity = identity
        self.goal = goal
        self.cancelled = False
        self.failure: str | None = None
        self.told: deque[Value] = deque(maxlen=_MOST_FEEDBACK)
        self.news = asyncio.Event()
        self.done: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
        self.done.add_done_callback(lambda done: done.exception())  # nobody has to wait for a result
        self._server = server

    async def feedback(self, value: Value) -> None:
        """Tell the client how far it is."""
        self.told.append(self._server.complete("Feedback", value))
        self.news.set()
        await asyncio.sleep(0)

    def abort(self, reason: str) -> None:
        """Note that the goal could not be reached."""
        self.failure = reason

    def settle(self, result: Value | RobotError) -> None:
        """Give the client the result, or why there is none; the first one counts."""
        if not self.done.done():
            if isinstance(result, RobotError):
                self.done.set_exception(result)
            else:
                self.done.set_result(result)
        self.news.set()


class ActionServer:
    """An action that a node carries out."""

    def __init__(
        self, owner: MemoryConnection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self.kind = kind
        self.clients: set[str] = set()
        self._owner = owner
        self._name = name
        self._carry_out = carry_out
        self._goals: deque[_Work] = deque()
        self._worker: asyncio.Task[None] | None = None

    @property
    def node(self) -> str:
        """The name of the node that carries goals out."""
        return self._owner.name

    def complete(self, name: str, value: Value) -> Value:
        """Return a value of one of the messages of the action, checked and completed."""
        return self._owner.types.complete(f"{self.kind}_{name}", value)

    def accept(self, client: MemoryConnection, goal: Value, identity: str | None) -> MemoryGoal:
        """Take a goal; those before it are cancelled."""
        work = _Work(self, goal, identity)
        for earlier in self._goals:
            earlier.cancelled = True
        self._goals.append(work)
        if client.name not in self.clients:
            self.clients.add(client.name)
            self._owner.bus.changed()
        if self._worker is None or self._worker.done():
            self._worker = spawn(self._work(), f"carrying out {self._name}")
        return MemoryGoal(client, work)

    def cancel(self, identity: str) -> None:
        """Cancel the goal of an identity."""
        for work in self._goals:
            work.cancelled = work.cancelled or work.identity == identity

    async def _work(self) -> None:
        while self._goals:
            work = self._goals[0]
            work.settle(await self._outcome(work))
            self._goals.popleft()

    async def _outcome(self, work: _Work) -> Value | RobotError:
        try:
            result = None if work.cancelled else self.complete("Result", await self._carry_out(work))
        except KgError as error:
            return RobotError("KG809", f"the goal of `{self._name}` was aborted: {error.message}")
        except FAILURES as error:
            return RobotError("KG809", f"the goal of `{self._name}` was aborted: {error}")
        if work.failure is not None:
            return RobotError("KG809", f"the goal of `{self._name}` was aborted: {work.failure}")
        if result is None or work.cancelled:
            return RobotError("KG809", f"the goal of `{self._name}` was cancelled")
        return result

    def end(self) -> None:
        """Carry out nothing more; who waits learns that the node is lost."""
        if self._worker is not None:
            self._worker.cancel()
        for work in self._goals:
            work.settle(goal_lost(self._name, f"`{self.node}`"))
        self._goals.clear()
        if self._owner.bus.actions.get(self._name) is self:
            del self._owner.bus.actions[self._name]

    async def aclose(self) -> None:
        """Stop answering."""
        self.end()
        self._owner.bus.changed()
