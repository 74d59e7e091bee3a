"""Action client and server of ROS 1: five topics and the states of a goal.

The protocol is that of wiki.ros.org/actionlib/DetailedDescription. Our server executes one goal at a time; a new one
cancels the previous ones.
"""

from __future__ import annotations

import asyncio
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.clock import stamp
from kg.robot.connection import FAILURES, Accepted, Cancel, Publication, Value, goal_lost, reason
from kg.robot.inbox import GoalProgress

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.ros1.connection import Ros1Connection
    from kg.robot.ros1.topics import Ros1Subscription


class Status(IntEnum):
    """The states of a goal: constants of actionlib_msgs/GoalStatus."""

    PENDING = 0
    ACTIVE = 1
    PREEMPTED = 2
    SUCCEEDED = 3
    ABORTED = 4
    REJECTED = 5
    PREEMPTING = 6
    RECALLING = 7
    RECALLED = 8
    LOST = 9


ENDED = frozenset({Status.PREEMPTED, Status.SUCCEEDED, Status.ABORTED, Status.REJECTED, Status.RECALLED, Status.LOST})
"""The final states of a goal."""


@dataclass(frozen=True, slots=True)
class Part:
    """A topic of an action: its last name, its type, and whether the server publishes it."""

    name: str
    type: str
    of_server: bool


def topics(kind: str) -> tuple[Part, ...]:
    """Return the topics of an action of a type `package/Type`."""
    return (
        Part("goal", f"{kind}ActionGoal", of_server=False),
        Part("cancel", "actionlib_msgs/GoalID", of_server=False),
        Part("status", "actionlib_msgs/GoalStatusArray", of_server=True),
        Part("feedback", f"{kind}ActionFeedback", of_server=True),
        Part("result", f"{kind}ActionResult", of_server=True),
    )


_QUEUE: Final = 50
_POLL: Final = 0.02
_GONE: Final = 2.0  # wall-clock seconds of a server's absence after which its goals are lost
_TURNS: Final = 10
"""Turns of the event loop that a result is delayed: earlier feedback arrives over another connection."""
_LOOKS: Final = 4  # checks within that time


class Ros1Goal(GoalProgress):
    """A goal sent to an action server."""

    def __init__(self, client: ActionClient, identity: str) -> None:
        super().__init__()
        self.status = Status.PENDING
        self.accepted = asyncio.Event()
        self._client = client
        self._identity = identity

    async def cancel(self) -> None:
        """Request cancellation of the goal."""
        await self._client.cancel(self._identity)

    def take_status(self, status: int) -> None:
        """Set the state reported by the server."""
        self.status = Status(status) if status in set(Status) else Status.LOST
        self.accepted.set()

    def end(self, outcome: Value | BaseException) -> None:
        """Set the result, or the reason for its absence; the first one counts."""
        super().end(outcome)
        self.accepted.set()


async def canceller(connection: Ros1Connection, action: str) -> Cancel:
    """Return the function that cancels goals of an action, once the server is connected."""
    publication = await connection.advertise(f"{action}/cancel", "actionlib_msgs/GoalID")

    async def cancel(identity: str) -> None:
        while publication.peers == 0:  # noqa: ASYNC110 - no event reports a new peer
            await asyncio.sleep(_POLL)
        await publication.publish({"id": identity})

    return cancel


class ActionClient:
    """The client of one action, created for its first goal and reused for later ones."""

    def __init__(self, connection: Ros1Connection, name: str, kind: str) -> None:
        self.kind = kind
        self._connection = connection
        self._name = name
        self._goals: dict[str, Ros1Goal] = {}
        self._writing: dict[str, Publication] = {}
        self._reading: dict[str, Ros1Subscription] = {}

    async def open(self) -> None:
        """Connect to the topics of the action."""
        for part in topics(self.kind):
            topic = f"{self._name}/{part.name}"
            if part.of_server:
                self._reading[part.name] = await self._connection.subscribe(topic, part.type, queue=_QUEUE)
            else:
                self._writing[part.name] = await self._connection.advertise(topic, part.type)
        ways = {"status": (self._on_status, 0), "feedback": (self._on_feedback, 0), "result": (self._on_result, _TURNS)}
        for name, (take, turns) in ways.items():
            following = self._follow(self._reading[name], take, turns)
            self._connection.node.spawn(following, f"following {self._name}/{name}")
        self._connection.node.spawn(self._look_for_server(), f"looking for {self._name}")

    async def ready(self) -> None:
        """Return when a server is connected to the topics of goals."""
        while not self._is_ready():  # noqa: ASYNC110 - no event reports new peers of the five topics
            await asyncio.sleep(_POLL)

    async def send(self, value: Value, identity: str) -> Ros1Goal:
        """Send a goal, and return it when the server has acknowledged it; cancelled with its caller."""
        now = stamp(self._connection.clock.now())
        goal = self._goals[identity] = Ros1Goal(self, identity)
        message = {"header": {"stamp": now}, "goal_id": {"stamp": now, "id": identity}, "goal": value}
        try:
            await self._writing["goal"].publish(message)
            await goal.accepted.wait()
        finally:
            if not goal.accepted.is_set():  # the server may have received it
                del self._goals[identity]
                with suppress(RobotError):
                    await self.cancel(identity)
        if goal.status is Status.REJECTED:
            await goal.result()
        return goal

    async def cancel(self, identity: str) -> None:
        """Request cancellation of a goal."""
        await self._writing["cancel"].publish({"id": identity})

    async def _follow(self, subscription: Ros1Subscription, take: Any, turns: int) -> None:
        async for received in subscription:
            for _ in range(turns):
                await asyncio.sleep(0)
            take(received.value)
        self._lose("the robot")

    async def _look_for_server(self) -> None:
        """End goals whose server is gone: a dying node sends nothing."""
        missed = 0
        while True:
            await asyncio.sleep(_GONE / _LOOKS)
            missed = 0 if self._is_ready() else missed + 1
            if missed >= _LOOKS:
                self._lose("the server")

    def _lose(self, what: str) -> None:
        for goal in self._goals.values():
            goal.end(goal_lost(self._name, what))
        self._goals.clear()

    def _is_ready(self) -> bool:
        # The server is the node that publishes states, feedback and results: others may publish one of these, too.
        servers = set.intersection(*(set(one.connected.values()) for one in self._reading.values()))
        return bool(servers) and all(one.peers for one in self._writing.values())

    def _on_status(self, value: Value) -> None:
        for each in value["status_list"]:
            if goal := self._goals.get(each["goal_id"]["id"]):
                goal.take_status(each["status"])

    def _on_feedback(self, value: Value) -> None:
        if goal := self._goals.get(value["status"]["goal_id"]["id"]):
            goal.take_status(value["status"]["status"])
            goal.take_feedback(value["feedback"])

    def _on_result(self, value: Value) -> None:
        status = value["status"]
        goal = self._goals.pop(status["goal_id"]["id"], None)
        if goal is None:
            return
        goal.take_status(status["status"])
        if goal.status is Status.SUCCEEDED:
            goal.end(value["result"])
        else:
            state = goal.status.name.lower() if goal.status in ENDED else f"ended as {goal.status.name.lower()}"
            words = f": {status['text']}" if status["text"] else ""
            goal.end(RobotError("KG809", f"the goal of `{self._name}` was {state}{words}"))


_WAITING: Final = 50
_STATUS_EVERY: Final = 0.2
_KEPT: Final = 5.0


class _Work:
    """A goal that our server executes: `Accepted`."""

    def __init__(self, server: ActionServer, identity: Value, goal: Value) -> None:
        self.identity = identity
        self.goal = goal
        self.status = Status.PENDING
        self.text = ""
        self.failure: str | None = None
        self.ended_at: float | None = None
        self._server = server

    @property
    def cancelled(self) -> bool:
        """Whether the client, or a newer goal, requests cancellation."""
        return self.status in {Status.PREEMPTING, Status.RECALLING}

    def cancel(self) -> None:
        """Request cancellation."""
        self.status = {Status.PENDING: Status.RECALLING, Status.ACTIVE: Status.PREEMPTING}.get(self.status, self.status)

    async def feedback(self, value: Value) -> None:
        """Send feedback to the client."""
        await self._server.publish("feedback", self, value)

    def abort(self, reason: str) -> None:
        """Record that the goal was aborted."""
        self.failure = reason

    def status_message(self) -> Value:
        """Return the state as a value of actionlib_msgs/GoalStatus."""
        return {"goal_id": self.identity, "status": int(self.status), "text": self.text}


class ActionServer:
    """An action server of our node."""

    def __init__(
        self, connection: Ros1Connection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self._connection = connection
        self._name = name
        self._kind = kind
        self._carry_out = carry_out
        self._goals: dict[str, _Work] = {}
        self._recalled: deque[str] = deque(maxlen=_WAITING)
        """Goals cancelled before they arrived: goals and cancellations have connections of their own."""
        self._writing: dict[str, Publication] = {}
        self._due = asyncio.Event()

    async def open(self) -> None:
        """Publish and subscribe to the topics of the action, its outputs first."""
        spawn = self._connection.node.spawn
        for part in sorted(topics(self._kind), key=lambda part: not part.of_server):
            topic = f"{self._name}/{part.name}"
            if part.of_server:
                latch = part.name == "status"
                self._writing[part.name] = await self._connection.advertise(topic, part.type, latch=latch)
            else:
                subscription = await self._connection.subscribe(topic, part.type, queue=_WAITING)
                take = self._on_goal if part.name == "goal" else self._on_cancel
                spawn(self._follow(subscription, take), f"following {topic}")
        spawn(self._repeat_status(), f"telling the status of {self._name}")
        spawn(self._work(), f"carrying out {self._name}")

    async def publish(self, name: str, work: _Work, value: Value) -> None:
        """Publish feedback or the result of a goal."""
        header = {"stamp": stamp(self._connection.clock.now())}
        await self._writing[name].publish({"header": header, "status": work.status_message(), name: value})

    async def _follow(self, subscription: Ros1Subscription, take: Any) -> None:
        async for received in subscription:
            take(received.value)
            await self._publish_status()

    def _on_goal(self, value: Value) -> None:
        identity, now = dict(value["goal_id"]), stamp(self._connection.clock.now())
        if not identity["id"]:
            identity["id"] = f"{self._connection.name}-{len(self._goals)}-{now['sec']}.{now['nanosec']:09}"
        if identity["stamp"] == {"sec": 0, "nanosec": 0}:
            identity["stamp"] = now
        if identity["id"] in self._goals:
            return
        for earlier in self._goals.values():
            earlier.cancel()
        work = self._goals[identity["id"]] = _Work(self, identity, value["goal"])
        if identity["id"] in self._recalled:
            work.cancel()
        self._due.set()

    def _on_cancel(self, value: Value) -> None:
        """Cancel one goal, those up to a time, or, if neither is given, all."""
        if value["id"] and value["id"] not in self._goals:
            self._recalled.append(value["id"])
        until = (value["stamp"]["sec"], value["stamp"]["nanosec"])
        every = not value["id"] and until == (0, 0)
        for identity, work in self._goals.items():
            at = (work.identity["stamp"]["sec"], work.identity["stamp"]["nanosec"])
            if every or identity == value["id"] or (until != (0, 0) and at <= until):
                work.cancel()

    async def _work(self) -> None:
        while True:
            waiting = [one for one in self._goals.values() if one.status in {Status.PENDING, Status.RECALLING}]
            if not waiting:
                self._due.clear()
                await self._due.wait()
                continue
            result = await self._outcome(waiting[0])
            waiting[0].ended_at = asyncio.get_running_loop().time()
            await self._publish_status()
            if not self._connection.node.lost.done():
                await self.publish("result", waiting[0], result)

    async def _outcome(self, work: _Work) -> Value:
        if work.cancelled:
            work.status = Status.RECALLED
            return {}
        work.status = Status.ACTIVE
        await self._publish_status()
        result: Value = {}
        try:
            result = await self._carry_out(work)
            self._connection.types.complete(f"{self._kind}_Result", result)
        except FAILURES as error:
            work.failure, result = reason(error), {}
        preempted = work.status is Status.PREEMPTING
        work.text = work.failure or ""
        work.status = Status.PREEMPTED if preempted else Status.SUCCEEDED
        if work.failure is not None:
            work.status = Status.ABORTED
        return result

    async def _repeat_status(self) -> None:
        while True:
            await self._publish_status()
            await asyncio.sleep(_STATUS_EVERY)
            now = asyncio.get_running_loop().time()
            for identity, work in list(self._goals.items()):
                if work.status in ENDED and work.ended_at is not None and now - work.ended_at > _KEPT:
                    del self._goals[identity]

    async def _publish_status(self) -> None:
        if self._connection.node.lost.done():
            return  # no client is left to receive it
        states = [work.status_message() for work in self._goals.values()]
        header = {"stamp": stamp(self._connection.clock.now())}
        await self._writing["status"].publish({"header": header, "status_list": states})
