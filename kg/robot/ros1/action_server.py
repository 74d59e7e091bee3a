"""Actions that our node carries out for clients of ROS 1: one goal at a time, a newer one cancels those before it."""

from __future__ import annotations

import asyncio
from collections import deque
from typing import TYPE_CHECKING, Any, Final

from kg.errors import KgError
from kg.robot.connection import FAILURES
from kg.robot.ros1.actions import ENDED, Status, stamp, topics

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine

    from kg.robot.connection import Accepted, Publication, Value
    from kg.robot.ros1.connection import Ros1Connection
    from kg.robot.ros1.subscribing import Ros1Subscription

__all__ = ["ActionServer"]

_QUEUE: Final = 50
_STATUS_EVERY: Final = 0.2
_KEPT: Final = 5.0


class _Work:
    """A goal that we carry out: `Accepted`."""

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
        """Whether the client, or a newer goal, asks to stop."""
        return self.status in {Status.PREEMPTING, Status.RECALLING}

    def cancel(self) -> None:
        """Ask to stop."""
        self.status = {Status.PENDING: Status.RECALLING, Status.ACTIVE: Status.PREEMPTING}.get(self.status, self.status)

    async def feedback(self, value: Value) -> None:
        """Tell the client how far it is."""
        await self._server.tell("feedback", self, value)

    def abort(self, reason: str) -> None:
        """Note that the goal could not be reached."""
        self.failure = reason

    def told(self) -> Value:
        """Return the state as a value of actionlib_msgs/GoalStatus."""
        return {"goal_id": self.identity, "status": int(self.status), "text": self.text}


class ActionServer:
    """An action that our node carries out."""

    def __init__(
        self, connection: Ros1Connection, name: str, kind: str, carry_out: Callable[[Accepted], Awaitable[Value]]
    ) -> None:
        self._connection = connection
        self._name = name
        self._kind = kind
        self._carry_out = carry_out
        self._goals: dict[str, _Work] = {}
        self._recalled: deque[str] = deque(maxlen=_QUEUE)
        """Goals that were cancelled before they came: each has a connection of its own."""
        self._writing: dict[str, Publication] = {}
        self._reading: list[Ros1Subscription] = []
        self._tasks: list[asyncio.Task[Any]] = []
        self._due = asyncio.Event()

    async def open(self) -> None:
        """Offer the topics of the action, those that answer first."""
        for part in sorted(topics(self._kind), key=lambda part: not part.of_server):
            topic = f"{self._name}/{part.name}"
            if part.of_server:
                latch = part.name == "status"
                self._writing[part.name] = await self._connection.advertise(topic, part.type, latch=latch)
            else:
                subscription = await self._connection.subscribe(topic, part.type, queue=_QUEUE)
                self._reading.append(subscription)
                take = self._on_goal if part.name == "goal" else self._on_cancel
                self._spawn(self._follow(subscription, take), f"following {topic}")
        self._spawn(self._tell_status(), f"telling the status of {self._name}")
        self._spawn(self._work(), f"carrying out {self._name}")

    async def tell(self, name: str, work: _Work, value: Value) -> None:
        """Publish feedback or the result of a goal."""
        header = {"stamp": stamp(self._connection.clock)}
        await self._writing[name].publish({"header": header, "status": work.told(), name: value})

    async def aclose(self) -> None:
        """Stop answering."""
        for task in self._tasks:
            task.cancel()
        for subscription in self._reading:
            await subscription.aclose()
        for publication in self._writing.values():
            await publication.aclose()

    def _spawn(self, work: Coroutine[Any, Any, None], what: str) -> None:
        self._tasks.append(self._connection.node.spawn(work, what))

    async def _follow(self, subscription: Ros1Subscription, take: Any) -> None:
        async for received in subscription:
            take(received.value)
            await self._publish_status()

    def _on_goal(self, value: Value) -> None:
        identity, now = dict(value["goal_id"]), stamp(self._connection.clock)
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
        """Cancel what is asked for: one goal, those up to a time, or, where neither is told, all."""
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
                await self.tell("result", waiting[0], result)

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
        except KgError as error:
            work.failure, result = error.message, {}
        except FAILURES as error:
            work.failure, result = str(error), {}
        preempted = work.status is Status.PREEMPTING
        work.text = work.failure or ""
        work.status = Status.PREEMPTED if preempted else Status.SUCCEEDED
        if work.failure is not None:
            work.status = Status.ABORTED
        return result

    async def _tell_status(self) -> None:
        while True:
            await self._publish_status()
            await asyncio.sleep(_STATUS_EVERY)
            now = asyncio.get_running_loop().time()
            for identity, work in list(self._goals.items()):
                if work.status in ENDED and work.ended_at is not None and now - work.ended_at > _KEPT:
                    del self._goals[identity]

    async def _publish_status(self) -> None:
        if self._connection.node.lost.done():
            return  # nobody is there whom it could be told
        states = [work.told() for work in self._goals.values()]
        header = {"stamp": stamp(self._connection.clock)}
        await self._writing["status"].publish({"header": header, "status_list": states})
