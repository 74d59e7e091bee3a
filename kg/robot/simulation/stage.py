"""Shared parts of the nodes of a simulated robot: the world, joining the graph, and periodic work."""

from __future__ import annotations

import asyncio
import time
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

from kg.errors import RobotError
from kg.robot.clock import stamp
from kg.robot.simulation.robots import Pose, quaternion_of
from kg.robot.tasks import ended, outcome, report, spawn

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from kg.robot.connection import Connection, Publication, Value
    from kg.robot.simulation.world import World

Join: TypeAlias = "Callable[[str], Awaitable[Connection]]"


@dataclass(slots=True)
class _Work:
    every: float
    job: Callable[[], Awaitable[None]]
    next: float


class Stage:
    """The nodes of a robot in a world.

    Args:
        world: the world.
        join: adds a node to the graph, by name.
        ros: the version of ROS.
        simulated: whether messages are stamped with the time of the world instead of the wall clock.
    """

    def __init__(self, world: World, join: Join, *, ros: int, simulated: bool) -> None:
        self.world = world
        self.ros = ros
        self.simulated = simulated
        self._join = join
        self._work: list[_Work] = []
        self._nodes: list[Node] = []

    async def node(self, name: str) -> Node:
        """Let a node join the graph."""
        node = Node(self, await self._join(name))
        self._nodes.append(node)
        return node

    def every(self, seconds: float, job: Callable[[], Awaitable[None]]) -> None:
        """Schedule periodic work in the time of the world; jobs are spread over the steps."""
        self._work.append(_Work(seconds, job, len(self._work) * self.world.step))

    async def work(self) -> None:
        """Run the work that is due."""
        for one in self._work:
            if one.next <= self.world.time:
                one.next += one.every
                await one.job()

    def header(self, frame: str) -> Value:
        """Return a `std_msgs/Header` of now."""
        now = self.world.time if self.simulated else time.time()
        return {"stamp": stamp(now), "frame_id": frame}

    async def wait_lost(self) -> str:
        """Return the reason when the first node has lost the robot's system."""
        return await self._nodes[0].connection.wait_lost()

    async def aclose(self) -> None:
        """Let all nodes leave the graph."""
        for node in self._nodes:
            await node.aclose()
        self._nodes.clear()


class Node:
    """A node of the simulated robot: its connection and its callbacks."""

    def __init__(self, stage: Stage, connection: Connection) -> None:
        self.stage = stage
        self.connection = connection
        self._hearing: list[asyncio.Task[None]] = []

    async def hear(self, topic: str, kind: str, callback: Callable[[Value], Any], *, queue: int = 10) -> None:
        """Call something with each message of a topic; an awaitable result is awaited.

        A failure on a message is reported, and the next message is processed.
        """
        subscription = await self.connection.subscribe(topic, kind, queue=queue)

        async def take(value: Value) -> None:
            answer = callback(value)
            if asyncio.iscoroutine(answer):
                await answer

        async def listen() -> None:
            async for received in subscription:
                error = await outcome(take(received.value))
                if isinstance(error, Exception):
                    report(f"hearing {topic}", error)

        self._hearing.append(spawn(listen(), f"hearing {topic}"))

    async def advertise(self, topic: str, kind: str, *, latch: bool = False) -> Publication:
        """Advertise a topic."""
        return await self.connection.advertise(topic, kind, latch=latch)

    async def publish_every(self, topic: str, kind: str, every: float, message: Callable[[], Value]) -> None:
        """Publish on a topic periodically, in the time of the world; nothing is computed without subscribers."""
        publication = await self.advertise(topic, kind)

        async def publish() -> None:
            if publication.peers:
                with suppress(RobotError):  # a lost one is reported by the connection
                    await publication.publish(message())

        self.stage.every(every, publish)

    async def aclose(self) -> None:
        """Leave the graph."""
        await ended(*self._hearing)
        await self.connection.aclose()


def point(x: float, y: float, z: float = 0.0) -> Value:
    """Return a `geometry_msgs/Point`, or a `Vector3`."""
    return {"x": float(x), "y": float(y), "z": float(z)}


def posed(pose: Pose) -> Value:
    """Return a `geometry_msgs/Pose`."""
    return {"position": point(pose.x, pose.y, pose.z), "orientation": quaternion_of(pose.heading)}
