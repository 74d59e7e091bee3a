"""The client of an action of ROS 2: three services and two topics under a hidden name.

Source: design.ros2.org/articles/actions.html; action_msgs/GoalStatus for the numbers of the states.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.clock import within
from kg.robot.connection import GraphProblem, goal_lost
from kg.robot.inbox import Inbox
from kg.robot.ros2.middleware import OFFERED

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.clock import Clock
    from kg.robot.connection import Value
    from kg.robot.ros2.connection import Ros2Connection
    from kg.robot.ros2.services import Client

__all__ = ["Ros2Canceller", "Ros2Goal", "canceller", "send_goal"]

_SUCCEEDED: Final = 4
_STATUS: Final = {0: "is not known to the server", 5: "was cancelled", 6: "was aborted"}
_MOST_FEEDBACK: Final = 1000
"""So much feedback waits for who may not read it."""
_GIVING_UP: Final = 1.0
"""Seconds of the wall that cancelling a goal may take that is given up."""
_CANCELLING: Final = 5.0
"""Seconds that a server may take to say that it has heard of a wish to cancel."""


async def send_goal(  # noqa: PLR0913 - what a goal consists of
    owner: Ros2Connection, action: str, kind: str, goal: Value, *, seconds: float, identity: str
) -> Ros2Goal:
    """Give an action a goal; RobotError KG805, KG806, KG807 or KG809. One that nobody waits for is cancelled."""
    await owner.known(kind, f"{kind}_Goal", f"{action}/_action/send_goal")
    owner.types.complete(f"{kind}_Goal", goal)
    made = Ros2Goal(owner, action, kind, identity)
    try:
        await within(owner.clock, seconds, made.send(goal))
    except TimeoutError:
        await made.give_up()
        raise _late(owner, action, seconds) from None
    except asyncio.CancelledError:
        await made.give_up()
        raise
    except RobotError:
        made.end()
        raise
    return made


async def canceller(owner: Ros2Connection, action: str) -> Ros2Canceller:
    """Return what cancels goals of an action."""
    client = await owner.client(f"{action}/_action/cancel_goal", "action_msgs/CancelGoal")
    return Ros2Canceller(client, owner.clock, action)


class Ros2Canceller:
    """Cancels goals of an action whoever gave them, by their identities."""

    def __init__(self, client: Client, clock: Clock, action: str) -> None:
        self._client = client
        self._clock = clock
        self._action = action

    async def cancel(self, identity: str) -> None:
        """Ask the server to end a goal; RobotError KG803 when it does not answer."""
        request = {"goal_info": {"goal_id": {"uuid": bytes.fromhex(identity)}}}
        try:
            await within(self._clock, _CANCELLING, self._client.call(request))
        except TimeoutError:
            raise RobotError("KG803", f"`{self._action}` did not confirm that the goal is cancelled") from None


def _late(owner: Ros2Connection, action: str, seconds: float) -> RobotError:
    if owner.ends(Role.ACTION_SERVERS, action):
        return RobotError("KG803", f"`{action}` took no goal within {seconds:g} s")
    return RobotError("KG807", f"no action server for `{action}`")


class Ros2Goal:
    """A goal that the server of an action was given."""

    def __init__(self, owner: Ros2Connection, action: str, kind: str, identity: str) -> None:
        self._owner = owner
        self._action = action
        self._kind = kind
        self._id = bytes.fromhex(identity)
        self._told: Inbox[Value] = Inbox(_MOST_FEEDBACK, lambda: None)
        self._listening = owner.wire.reader(
            f"{action}/_action/feedback", f"{kind}_FeedbackMessage", OFFERED, self._take
        )
        self._offered = False
        self._outcome: asyncio.Future[Value] | None = None

    async def send(self, goal: Value) -> None:
        """Offer the goal to the server, once there is one; RobotError KG809 when it is rejected."""
        if not await self._owner.watch.until(lambda _: self._served()):
            raise RobotError("KG803", f"the connection was closed before anybody served `{self._action}`")
        (server, *_) = self._owner.ends(Role.ACTION_SERVERS, self._action)
        if server.type is not None and server.type != self._kind:
            raise RobotError("KG806", f"`{self._action}` is of the type {server.type}, not {self._kind}")
        results = await self._client("get_result", f"{self._kind}_GetResult")
        await self._listening.ready()
        sender = await self._client("send_goal", f"{self._kind}_SendGoal")
        self._offered = True
        response = await sender.call({"goal_id": {"uuid": self._id}, "goal": goal})
        if not response["accepted"]:
            raise RobotError("KG809", f"`{self._action}` rejected the goal")
        self._outcome = asyncio.ensure_future(self._result(results))
        self._outcome.add_done_callback(self._ended)

    async def _client(self, part: str, kind: str) -> Client:
        return await self._owner.client(f"{self._action}/_action/{part}", kind)

    async def _result(self, results: Client) -> Value:
        asking = asyncio.ensure_future(results.call({"goal_id": {"uuid": self._id}}))
        leaving = asyncio.ensure_future(self._owner.watch.until(lambda _: not self._served()))
        await asyncio.wait({asking, leaving}, return_when=asyncio.FIRST_COMPLETED)
        leaving.cancel()
        if not asking.done():
            asking.cancel()
            raise goal_lost(self._action, "the server")
        response = asking.result()
        if response["status"] != _SUCCEEDED:
            status = _STATUS.get(response["status"], f"ended with the status {response['status']}")
            raise RobotError("KG809", f"the goal of `{self._action}` {status}")
        result: Value = response["result"]
        return result

    def _served(self) -> bool:
        return bool(self._owner.ends(Role.ACTION_SERVERS, self._action))

    def _take(self, content: bytes, node: str | None) -> None:
        try:
            value = self._owner.types.decode(f"{self._kind}_FeedbackMessage", content)
        except RobotError as error:
            told = f"feedback of {self._action} does not decode: {error.message}"
            self._owner.watch.report(GraphProblem("KG816", node or self._action, told))
            return
        if bytes(value["goal_id"]["uuid"]) == self._id:
            self._told.put(value["feedback"])

    def _ended(self, outcome: asyncio.Future[Value]) -> None:
        if not outcome.cancelled():
            outcome.exception()  # nobody has to wait for a result
        self.end()

    async def give_up(self) -> None:
        """Cancel a goal of which the server has said nothing: it may have it all the same."""
        self.end()
        if self._offered:
            with suppress(RobotError, TimeoutError):
                async with asyncio.timeout(_GIVING_UP):
                    await self.cancel()

    def end(self) -> None:
        """Listen to feedback no more."""
        self._told.end()
        self._listening.close()
        self._owner.forget(self)

    async def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback as it comes, until the goal has ended."""
        async for value in self._told:
            yield value

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status when the goal was aborted or cancelled."""
        if self._outcome is None:
            raise RobotError("KG803", f"`{self._action}` has taken no goal")
        return await asyncio.shield(self._outcome)

    async def cancel(self) -> None:
        """Ask the server to end the goal; `result` tells when it has."""
        await (await canceller(self._owner, self._action)).cancel(self._id.hex())
