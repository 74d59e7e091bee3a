"""Goals that we give to action servers of ROS 1."""

from __future__ import annotations

import asyncio
from collections import deque
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.connection import goal_lost
from kg.robot.ros1.actions import ENDED, Status, stamp, topics

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.connection import Publication, Value
    from kg.robot.ros1.connection import Ros1Connection
    from kg.robot.ros1.subscribing import Ros1Subscription

__all__ = ["ActionClient", "Ros1Canceller", "Ros1Goal"]

_MOST_FEEDBACK: Final = 1000
_QUEUE: Final = 50
_POLL: Final = 0.02
_GONE: Final = 2.0
"""Seconds of the wall that a server may be away before its goals are lost."""
_TURNS: Final = 10
"""Turns of the loop that a result waits: feedback was sent before it, but has a connection of its own."""
_LOOKS: Final = 4
"""How often it is looked for in that time."""


class Ros1Goal:
    """A goal that an action server was given."""

    def __init__(self, client: ActionClient, identity: str) -> None:
        self.status = Status.PENDING
        self.accepted = asyncio.Event()
        self._client = client
        self._identity = identity
        self._told: deque[Value] = deque(maxlen=_MOST_FEEDBACK)
        self._news = asyncio.Event()
        self._done: asyncio.Future[Value] = asyncio.get_running_loop().create_future()
        self._done.add_done_callback(lambda done: done.cancelled() or done.exception())  # nobody has to wait for it

    async def feedback(self) -> AsyncIterator[Value]:
        """Yield feedback as it comes, until the goal has ended."""
        while True:
            while self._told:
                yield self._told.popleft()
            if self._done.done():
                return
            self._news.clear()
            await self._news.wait()

    async def result(self) -> Value:
        """Return the result; RobotError KG809 with the status when the goal was aborted, rejected or cancelled."""
        return await asyncio.shield(self._done)

    async def cancel(self) -> None:
        """Ask the server to end the goal."""
        await self._client.cancel(self._identity)

    def take_feedback(self, value: Value) -> None:
        """Take feedback of the server."""
        self._told.append(value)
        self._news.set()

    def take_status(self, status: int) -> None:
        """Take the state that the server tells."""
        self.status = Status(status) if status in set(Status) else Status.LOST
        self.accepted.set()

    def end(self, outcome: Value | RobotError) -> None:
        """Take the result, or why there is none; the first one counts."""
        if not self._done.done():
            if isinstance(outcome, RobotError):
                self._done.set_exception(outcome)
            else:
                self._done.set_result(outcome)
        self.accepted.set()
        self._news.set()


class Ros1Canceller:
    """Cancels goals of an action whoever gave them, by their identities."""

    def __init__(self, publication: Publication) -> None:
        self._publication = publication

    async def cancel(self, identity: str) -> None:
        """Ask the server to end a goal; it hears of that once it is connected."""
        while self._publication.peers == 0:  # noqa: ASYNC110 - nothing tells when a peer comes
            await asyncio.sleep(_POLL)
        await self._publication.publish({"id": identity})


class ActionClient:
    """The client of one action, made for its first goal and kept for those after it."""

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
        """Return when a server is connected to what a goal needs."""
        while not self._is_ready():  # noqa: ASYNC110 - five topics have their peers, and none tells when they come
            await asyncio.sleep(_POLL)

    async def send(self, value: Value, identity: str) -> Ros1Goal:
        """Give a goal, and return it when the server has said a word of it; one that nobody waits for is cancelled."""
        now = stamp(self._connection.clock)
        goal = self._goals[identity] = Ros1Goal(self, identity)
        message = {"header": {"stamp": now}, "goal_id": {"stamp": now, "id": identity}, "goal": value}
        try:
            await self._writing["goal"].publish(message)
            await goal.accepted.wait()
        finally:
            if not goal.accepted.is_set():  # the server may have it all the same
                del self._goals[identity]
                with suppress(RobotError):
                    await self.cancel(identity)
        if goal.status is Status.REJECTED:
            await goal.result()
        return goal

    async def cancel(self, identity: str) -> None:
        """Ask the server to end a goal."""
        await self._writing["cancel"].publish({"id": identity})

    async def _follow(self, subscription: Ros1Subscription, take: Any, turns: int) -> None:
        async for received in subscription:
            for _ in range(turns):
                await asyncio.sleep(0)
            take(received.value)
        self._lose("the robot")

    async def _look_for_server(self) -> None:
        """Let goals be lost with their server: a node that dies tells nobody."""
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
        heard = set.intersection(*(set(one.connected.values()) for one in self._reading.values()))
        return bool(heard) and all(one.peers for one in self._writing.values())

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
