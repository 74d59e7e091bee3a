"""Recording of a robot's topics to a file: `.bag` for ROS 1, `.mcap` for ROS 2.

    recorder = Recorder(connection, Path("drive.mcap"), topics=None, begun=print)
    try:
        await recorder.run()               # until it is cancelled or the robot is lost
    finally:
        recorder.close()                   # writes the index

Every current and future topic is subscribed to; failures are reported once.
"""

from __future__ import annotations

import shutil
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from rosbags.interfaces import Qos as BagQos
from rosbags.interfaces import QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2

from kg.errors import Place, RobotError, UsageError
from kg.facts import Qos, Role
from kg.robot.connecting import is_recording
from kg.robot.connection import Connection, GraphProblem, LiveEnd, Received, Subscription
from kg.robot.ros2.names import full_type
from kg.robot.ros2.types import type_hash
from kg.robot.tasks import Tasks, ended

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kg.robot.messages import Types

SUFFIXES: Final = {1: ".bag", 2: ".mcap"}
"""Suffixes of recordings, by the version of ROS."""
_QUEUE: Final = 1000  # maximum number of queued messages of a topic
_VERSION: Final = 8  # version of the metadata of a ROS 2 bag: the newest that Iron reads


@dataclass(frozen=True, slots=True)
class Recorded:
    """A recorded topic: the numbers of messages written, and lost because they arrived too fast."""

    topic: str
    type: str
    messages: int
    dropped: int


class Recorder:
    """Records topics.

    Args:
        connection: the robot.
        path: the file, which must not exist; it is created with the first message.
        topics: names of topics, or None for all.
        begun: receives a topic and its type when its recording starts.
        on_problem: receives the reason why a topic is not recorded.

    Raises:
        UsageError: KG003 the file exists, or is for another version of ROS than the robot's.
    """

    def __init__(
        self,
        connection: Connection,
        path: Path,
        *,
        topics: frozenset[str] | None = None,
        begun: Callable[[str, str], None] = lambda _topic, _type: None,
        on_problem: Callable[[GraphProblem], None] = lambda _: None,
    ) -> None:
        suffix = SUFFIXES[connection.ros]
        if path.suffix != suffix:
            message = f"a robot of ROS {connection.ros} is recorded to a file `{suffix}`"
            raise UsageError("KG003", message, place=Place(str(path)), hint=f"Write {path.with_suffix(suffix)}.")
        if path.exists():
            raise UsageError("KG003", "the file exists", place=Place(str(path)), hint="Name another file.")
        self.first = self.last = 0.0
        self._connection = connection
        self._path = path
        self._topics = topics
        self._begun = begun
        self._on_problem = on_problem
        self._tasks = Tasks()
        self._subscribed: dict[str, Subscription | None] = {}
        self._types: dict[str, str] = {}
        self._counts: Counter[str] = Counter()
        self._file: _Bag1 | _Bag2 | None = None

    @property
    def written(self) -> int:
        """Number of messages in the file."""
        return self._counts.total()

    async def run(self) -> None:
        """Record until cancelled, or until the end of a played recording; RobotError KG803 when the robot is lost."""
        try:
            following = self._tasks.spawn(self._follow(), "following the topics of a robot")
            why = await self._connection.wait_lost()
            await ended(following)
            await self._tasks.done()
        finally:
            self._tasks.cancel()
            await self._tasks.done()
        if not is_recording(self._connection.address):
            raise RobotError("KG803", f"the robot at {self._connection.address} is lost: {why}")

    async def _follow(self) -> None:
        async for graph in self._connection.changes():
            publishers: dict[str, list[LiveEnd]] = {}
            for one in graph.ends:
                if one.role is Role.PUBLISHES and (self._topics is None or one.name in self._topics):
                    publishers.setdefault(one.name, []).append(one)
            for topic, ends in sorted(publishers.items()):
                if topic not in self._subscribed:
                    await self._subscribe(topic, ends)

    async def _subscribe(self, topic: str, ends: list[LiveEnd]) -> None:
        kind = next((one.type for one in ends if one.type is not None), None)
        self._subscribed[topic] = None
        try:
            subscription = await self._connection.subscribe(topic, kind, queue=_QUEUE)
        except RobotError as error:
            self._on_problem(GraphProblem(error.code, topic, f"it is not recorded: {error.message}"))
            return
        self._subscribed[topic] = subscription
        self._types[topic] = kind or ""
        self._tasks.spawn(self._write(topic, ends, subscription), f"recording `{topic}`")
        self._begun(topic, kind or "")

    async def _write(self, topic: str, ends: list[LiveEnd], subscription: Subscription) -> None:
        try:
            async for received in subscription:
                if self._file is None:
                    self._file = (_Bag1 if self._connection.ros == 1 else _Bag2)(self._path, self._connection.types)
                    self.first = received.at
                self._file.write(topic, self._types[topic], ends, received)
                self._counts[topic] += 1
                self.last = max(self.last, received.at)
        finally:
            await subscription.aclose()

    def close(self) -> tuple[Recorded, ...]:
        """Complete the file, and return its content; without messages there is no file."""
        if self._file is not None:
            self._file.close()
        self._file = None
        return tuple(
            Recorded(topic, self._types[topic], self._counts[topic], one.dropped)
            for topic, one in sorted(self._subscribed.items())
            if one is not None
        )


class _Bag1:
    """A ROS 1 bag being written; each publisher of a topic is a connection of its own."""

    def __init__(self, path: Path, types: Types) -> None:
        self._types = types
        self._writer = Writer1(path)
        self._writer.open()
        self._channels: dict[tuple[str, str | None], Any] = {}

    def write(self, topic: str, kind: str, _ends: list[LiveEnd], received: Received) -> None:
        """Write a message."""
        channel = self._channels.get((topic, received.node))
        if channel is None:
            text, md5 = self._types.definition(kind), self._types.md5(kind)
            full = kind.replace("/", "/msg/")
            channel = self._writer.add_connection(
                topic, full, msgdef=text, md5sum=md5, callerid=received.node, latching=int(received.latched)
            )
            self._channels[topic, received.node] = channel
        self._writer.write(channel, round(received.at * 1e9), self._types.encode(kind, received.value))

    def close(self) -> None:
        """Write the index."""
        self._writer.close()


class _Bag2:
    """A ROS 2 file being written, in a folder, as `rosbags` does; the file is moved out of it at the end."""

    def __init__(self, path: Path, types: Types) -> None:
        self._path = path
        self._folder = path.with_name(f"{path.name}.part")
        self._types = types
        self._writer = Writer2(self._folder, version=_VERSION, storage_plugin=StoragePlugin.MCAP)
        self._writer.open()
        self._channels: dict[str, Any] = {}

    def write(self, topic: str, kind: str, ends: list[LiveEnd], received: Received) -> None:
        """Write a message."""
        channel = self._channels.get(topic)
        if channel is None:
            offered = [_bag_qos(one) for one in dict.fromkeys(end.qos for end in ends) if one is not None]
            channel = self._channels[topic] = self._writer.add_connection(
                topic,
                full_type(kind),
                msgdef=self._types.definition(kind),
                rihs01=type_hash(self._types, kind),
                offered_qos_profiles=offered,
            )
        self._writer.write(channel, round(received.at * 1e9), self._types.encode(kind, received.value))

    def close(self) -> None:
        """Write the index, and rename the file."""
        self._writer.close()
        (self._folder / f"{self._folder.name}.mcap").replace(self._path)
        shutil.rmtree(self._folder)


def _bag_qos(qos: Qos) -> BagQos:
    def word(kind: Any, name: str | None) -> Any:
        return kind.__members__.get((name or "system_default").upper(), kind.SYSTEM_DEFAULT)

    return BagQos(
        word(QosHistory, qos.history),
        qos.depth or 0,
        word(QosReliability, qos.reliability),
        word(QosDurability, qos.durability),
        _time(qos.deadline),
        _time(qos.lifespan),
        word(QosLiveliness, qos.liveliness),
        _time(qos.lease_duration),
        False,
    )


def _time(seconds: float | None) -> QosTime:
    whole = int(seconds or 0)
    return QosTime(whole, round(((seconds or 0) - whole) * 1e9))
