"""Our own server of an action of ROS 2: it carries out one goal at a time.

Source: design.ros2.org/articles/actions.html; action_msgs/GoalStatus and CancelGoal for the numbers.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from functools import partial
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.connection import GraphProblem
from kg.robot.ros2.middleware import LATCHED, OFFERED
from kg.robot.ros2.services import Service
from kg.robot.ros2.topics import Ros2Publication
from kg.robot.tasks import outcome, spawn

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.facts import Qos
    from kg.robot.connection import Accepted, Value
    from kg.robot.ros2.connection import Ros2Connection

__all__ = ["ActionServer"]

_ACCEPTED, _EXECUTING, _CANCELLING, _SUCCEEDED, _CANCELLED, _ABORTED = range(1, 7)
_UNKNOWN_GOAL, _TERMINATED = 2, 3
_KEPT: Final = 64
"""So many goals that have ended are remembered, for clients that ask for a result late."""
_NOBODY: Final = bytes(16)


class _Work:
    """A goal as the code that carries it out sees it: `Accepted`."""

    def __init__(self, server: ActionServer, identity: bytes, goal: Value) -> None:
        self.goal = goal
        self.identity = identity
        self.stamp = server.stamp()
        self.status = _ACCEPTED
        self.cancelled = False
        self.failure: str | None = None
        self.done: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
        self._server = server

    @property
    def info(self) -> Value:
        """The goal as action_msgs/GoalInfo."""
        return {"goal_id": {"uuid": self.identity}, "stamp": self.stamp}

    @property
    def ended(self) -> bool:
        """Whether it has a result, or will never have one."""
        return self.status >= _SUCCEEDED

    async def feedback(self, value: Value) -> None:
        """Tell the client how far it is."""
        await self._server.tell(self.identity, value)

    def abort(self, reason: str) -> None:
        """Note that the goal could not be reached; ROS 2 has no words for why, so that they stay here."""
        self.failure = reason


class ActionServer:
    """An action that our node carries out."""

    def __init__(
        self, owner: Ros2Connection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self._owner = owner
        self._name = name
        self._kind = kind
        self._carry_out = carry_out
        self._goals: OrderedDict[bytes, _Work] = OrderedDict()
        self._working: asyncio.Task[None] | None = None
        self._feedback = self._topic("feedback", f"{kind}_FeedbackMessage", OFFERED)
        self._status = self._topic("status", "action_msgs/GoalStatusArray", LATCHED)
        self._services = [
            Service(owner, f"{name}/_action/get_result", f"{kind}_GetResult", self._get_result),
            Service(owner, f"{name}/_action/cancel_goal", "action_msgs/CancelGoal", self._cancel_goal),
            Service(owner, f"{name}/_action/send_goal", f"{kind}_SendGoal", self._send_goal),
        ]

    def _topic(self, part: str, kind: str, qos: Qos) -> Ros2Publication:
        name = f"{self._name}/_action/{part}"
        return Ros2Publication(name, partial(self._owner.types.encode, kind), self._owner.wire.writer(name, kind, qos))

    def stamp(self) -> Value:
        """Return the time of the robot as builtin_interfaces/Time."""
        now = self._owner.clock.now()
        return {"sec": int(now), "nanosec": int(now % 1 * 1e9)}

    async def tell(self, identity: bytes, value: Value) -> None:
        """Publish feedback on a goal."""
        await self._feedback.publish({"goal_id": {"uuid": identity}, "feedback": value})

    async def _send_goal(self, request: Value) -> Value:
        identity = bytes(request["goal_id"]["uuid"])
        if identity in self._goals:
            return {"accepted": False, "stamp": self.stamp()}
        work = _Work(self, identity, request["goal"])
        for earlier in self._goals.values():
            earlier.cancelled = earlier.cancelled or not earlier.ended
        self._goals[identity] = work
        while len(self._goals) > _KEPT and next(iter(self._goals.values())).ended:
            self._goals.popitem(last=False)
        if self._working is None or self._working.done():
            self._working = spawn(self._work(), f"carrying out {self._name}")
        return {"accepted": True, "stamp": work.stamp}

    async def _work(self) -> None:
        while open_ones := [one for one in self._goals.values() if not one.ended]:
            await self._carry(open_ones[0])

    async def _carry(self, work: _Work) -> None:
        result: Value | BaseException = {}
        if not work.cancelled:
            await self._become(work, _EXECUTING)
            result = await outcome(self._carry_out(work))
        if isinstance(result, BaseException):
            told = f"our own goal failed: {result}"
            self._owner.watch.report(GraphProblem("KG809", self._name, told))
            work.failure, result = str(result), {}
        try:
            result = self._owner.types.complete(f"{self._kind}_Result", result)
        except RobotError as error:
            work.failure, result = error.message, self._owner.types.complete(f"{self._kind}_Result", {})
        status = _CANCELLED if work.cancelled else _SUCCEEDED
        await self._become(work, status if work.failure is None else _ABORTED)
        work.done.set_result(result)

    async def _become(self, work: _Work, status: int) -> None:
        work.status = status
        told = [{"goal_info": one.info, "status": one.status} for one in self._goals.values()]
        await self._status.publish({"status_list": told})

    async def _get_result(self, request: Value) -> Value:
        work = self._goals.get(bytes(request["goal_id"]["uuid"]))
        if work is None:
            return {"status": 0}
        result = await asyncio.shield(work.done)
        return {"status": work.status, "result": result}

    async def _cancel_goal(self, request: Value) -> Value:
        """Cancel a goal, or all of them when none is named."""
        identity = bytes(request["goal_info"]["goal_id"]["uuid"])
        named = [one for one in self._goals.values() if identity in {_NOBODY, one.identity}]
        if not named and identity != _NOBODY:
            return {"return_code": _UNKNOWN_GOAL}
        open_ones = [one for one in named if not one.ended]
        for one in open_ones:
            one.cancelled = True
            await self._become(one, _CANCELLING)
        code = _TERMINATED if named and not open_ones and identity != _NOBODY else 0
        return {"return_code": code, "goals_canceling": [one.info for one in open_ones]}

    def end(self) -> None:
        """Carry out nothing more."""
        if self._working is not None:
            self._working.cancel()
        for work in self._goals.values():
            work.done.cancel()
        for service in self._services:
            service.end()
        self._feedback.end()
        self._status.end()
        self._owner.forget(self)

    async def aclose(self) -> None:
        """Stop answering."""
        self.end()
