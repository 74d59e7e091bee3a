"""Action client and server of ROS 2: three services and two topics under a hidden name.

Source: design.ros2.org/articles/actions.html; action_msgs/GoalStatus and CancelGoal for the numbers. Our server
executes one goal at a time.
"""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import stamp, within
from kg.robot.connection import Accepted, Cancel, GraphProblem, Value, goal_lost
from kg.robot.inbox import GoalProgress
from kg.robot.ros2.ends import Client, Ros2Publication, Service
from kg.robot.ros2.middleware import LATCHED, OFFERED
from kg.robot.tasks import first, outcome, spawn

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.ros2.connection import Ros2Connection

_ACCEPTED, _EXECUTING, _CANCELLING, _SUCCEEDED, _CANCELLED, _ABORTED = range(1, 7)
_STATUS: Final = {0: "is not known to the server", _CANCELLED: "was cancelled", _ABORTED: "was aborted"}
_GIVING_UP: Final = 1.0  # wall-clock seconds for the cancellation of an abandoned goal
_CONFIRMING: Final = 5.0  # seconds for a server to acknowledge a cancellation


async def send_goal(  # noqa: PLR0913 - what a goal consists of
    owner: Ros2Connection, action: str, kind: str, goal: Value, *, seconds: float, identity: str
) -> Ros2Goal:
    """Send a goal; RobotError KG805, KG806, KG807 or KG809. It is cancelled with its caller."""
    await owner.ensure_type(kind, f"{kind}_Goal", f"{action}/_action/send_goal")
    owner.types.complete(f"{kind}_Goal", goal)
    sent = Ros2Goal(owner, action, kind, identity)
    try:
        await within(owner.clock, seconds, sent.send(goal))
    except TimeoutError:
        await sent.give_up()
        if owner.ends(Role.ACTION_SERVERS, action):
            raise RobotError("KG803", f"`{action}` took no goal within {seconds:g} s") from None
        raise RobotError("KG807", f"no action server for `{action}`") from None
    except asyncio.CancelledError:
        await sent.give_up()
        raise
    except RobotError as error:
        sent.end(error)
        raise
    return sent


async def canceller(owner: Ros2Connection, action: str) -> Cancel:
    """Return the function that cancels goals of an action."""
    client = await owner.client(f"{action}/_action/cancel_goal", "action_msgs/CancelGoal")

    async def cancel(identity: str) -> None:
        request = {"goal_info": {"goal_id": {"uuid": bytes.fromhex(identity)}}}
        try:
            await within(owner.clock, _CONFIRMING, client.call(request))
        except TimeoutError:
            raise RobotError("KG803", f"`{action}` did not confirm that the goal is cancelled") from None

    return cancel


class Ros2Goal(GoalProgress):
    """A goal sent to an action server."""

    def __init__(self, owner: Ros2Connection, action: str, kind: str, identity: str) -> None:
        super().__init__()
        self._owner = owner
        self._action = action
        self._kind = kind
        self._id = bytes.fromhex(identity)
        self._listening = owner.wire.reader(
            f"{action}/_action/feedback", f"{kind}_FeedbackMessage", OFFERED, self._take
        )
        self._offered = False
        self._following: asyncio.Task[None] | None = None

    async def send(self, goal: Value) -> None:
        """Send the goal once there is a server; RobotError KG809 if it is rejected."""
        if not await self._owner.watch.until(lambda _: self._served()):
            raise RobotError("KG803", f"the connection was closed before anybody served `{self._action}`")
        (server, *_) = self._owner.ends(Role.ACTION_SERVERS, self._action)
        if server.type is not None and server.type != self._kind:
            raise RobotError("KG806", f"`{self._action}` is of the type {server.type}, not {self._kind}")
        # All ends are connected before the goal is sent: the server may begin, and even end, at once.
        results = await self._client("get_result", f"{self._kind}_GetResult")
        await self._listening.ready()
        sender = await self._client("send_goal", f"{self._kind}_SendGoal")
        self._offered = True
        response = await sender.call({"goal_id": {"uuid": self._id}, "goal": goal})
        if not response["accepted"]:
            raise RobotError("KG809", f"`{self._action}` rejected the goal")
        self._following = spawn(self._follow(results), f"waiting for the result of {self._action}")

    async def _client(self, part: str, kind: str) -> Client:
        return await self._owner.client(f"{self._action}/_action/{part}", kind)

    async def _follow(self, results: Client) -> None:
        self.end(await outcome(self._result(results)))

    async def _result(self, results: Client) -> Value:
        asking = results.call({"goal_id": {"uuid": self._id}})
        answered = await first(asking, self._owner.watch.until(lambda _: not self._served()))
        if answered is None:
            raise goal_lost(self._action, "the server")
        (response,) = answered
        if response["status"] != _SUCCEEDED:
            status = _STATUS.get(response["status"], f"ended with the status {response['status']}")
            raise RobotError("KG809", f"the goal of `{self._action}` {status}")
        result: Value = response["result"]
        if not result and self._owner.types.fields(f"{self._kind}_Result"):
            message = (
                "its result does not decode, because this robot has another version of the type; the status counts"
            )
            self._owner.watch.report(GraphProblem("KG816", self._action, message))
        return result

    def _served(self) -> bool:
        return bool(self._owner.ends(Role.ACTION_SERVERS, self._action))

    def _take(self, content: bytes, node: str | None) -> None:
        try:
            value = self._owner.types.decode(f"{self._kind}_FeedbackMessage", content)
        except RobotError as error:
            message = f"feedback of {self._action} does not decode: {error.message}"
            self._owner.watch.report(GraphProblem("KG816", node or self._action, message))
            return
        if bytes(value["goal_id"]["uuid"]) == self._id:
            self.take_feedback(value["feedback"])

    async def give_up(self) -> None:
        """Cancel a goal without an acknowledgement: the server may have received it."""
        self.end(RobotError("KG803", f"`{self._action}` has taken no goal"))
        if self._offered:
            with suppress(RobotError, TimeoutError):
                async with asyncio.timeout(_GIVING_UP):
                    await self.cancel()

    def end(self, outcome: Value | BaseException) -> None:
        """Set the result, or the reason for its absence, and unsubscribe from feedback."""
        super().end(outcome)
        self._listening.close()

    async def cancel(self) -> None:
        """Request cancellation of the goal; `result` returns when it has ended."""
        cancel = await canceller(self._owner, self._action)
        await cancel(self._id.hex())


_UNKNOWN_GOAL, _TERMINATED = 2, 3
_KEPT: Final = 64  # number of finished goals kept for clients that request their result late
_NOBODY: Final = bytes(16)


class _Work:
    """The server's side of a goal: `Accepted`."""

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
        """Send feedback to the client."""
        await self._server.publish_feedback(self.identity, value)

    def abort(self, reason: str) -> None:
        """Record that the goal was aborted; ROS 2 cannot send the reason."""
        self.failure = reason


class ActionServer:
    """An action server of our node."""

    def __init__(
        self, owner: Ros2Connection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self._owner = owner
        self._name = name
        self._kind = kind
        self._carry_out = carry_out
        self._goals: OrderedDict[bytes, _Work] = OrderedDict()
        self._working: asyncio.Task[None] | None = None
        self._feedback = Ros2Publication(owner, f"{name}/_action/feedback", f"{kind}_FeedbackMessage", OFFERED)
        self._status = Ros2Publication(owner, f"{name}/_action/status", "action_msgs/GoalStatusArray", LATCHED)
        self._services = [
            Service(owner, f"{name}/_action/get_result", f"{kind}_GetResult", self._get_result),
            Service(owner, f"{name}/_action/cancel_goal", "action_msgs/CancelGoal", self._cancel_goal),
            Service(owner, f"{name}/_action/send_goal", f"{kind}_SendGoal", self._send_goal),
        ]

    def stamp(self) -> Value:
        """Return the time of the robot as builtin_interfaces/Time."""
        return stamp(self._owner.clock.now())

    async def publish_feedback(self, identity: bytes, value: Value) -> None:
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
        while work := next((one for one in self._goals.values() if not one.ended), None):
            await self._execute(work)

    async def _execute(self, work: _Work) -> None:
        result: Value | BaseException = {}
        if not work.cancelled:
            await self._become(work, _EXECUTING)
            result = await outcome(self._carry_out(work))
        if isinstance(result, BaseException):
            message = f"our own goal failed: {result}"
            self._owner.watch.report(GraphProblem("KG809", self._name, message))
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
        statuses = [{"goal_info": one.info, "status": one.status} for one in self._goals.values()]
        await self._status.publish({"status_list": statuses})

    async def _get_result(self, request: Value) -> Value:
        work = self._goals.get(bytes(request["goal_id"]["uuid"]))
        if work is None:
            return {"status": 0}
        result = await asyncio.shield(work.done)
        return {"status": work.status, "result": result}

    async def _cancel_goal(self, request: Value) -> Value:
        """Cancel a goal, or all of them if none is named."""
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
        """Stop executing goals."""
        if self._working is not None:
            self._working.cancel()
        for work in self._goals.values():
            work.done.cancel()
        for service in self._services:
            service.end()
        self._feedback.end()
        self._status.end()
