"""Content of recordings, read by `rosbags`: topics, their types, and their publishers if the file names them.

A bag of ROS 1 names the publisher of each message (wiki.ros.org/Bags/Format/2.0, `callerid`). A bag of ROS 2 does not;
it only has the nodes that name themselves on the topics `/parameter_events` and `/rosout`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

from rosbags.interfaces import Connection as Channel
from rosbags.interfaces import MessageDefinitionFormat, QosTime
from rosbags.rosbag1 import Reader as Reader1
from rosbags.rosbag2 import Reader as Reader2

from kg.errors import RobotError
from kg.facts import Qos
from kg.robot.connection import GraphProblem
from kg.robot.messages import Types
from kg.robot.messages.types import learn, short
from kg.robot.ros2.names import is_name

_TELLING: Final = {
    "/parameter_events": ("rcl_interfaces/ParameterEvent", "node"),
    "/rosout": ("rcl_interfaces/Log", "name"),
}
"""Topics of ROS 2 whose messages name their sender, with their types and fields."""
_ENOUGH: Final = 1000  # maximum number of messages read of such a topic: nodes name themselves when they start
_LATCHED: Final = "transient_local"
_FOREVER: Final = 2**31 - 1
"""Seconds from which a duration counts as infinite (`RMW_DURATION_INFINITE`, and the maximum of 32 bits)."""


@dataclass(frozen=True, slots=True)
class Source:
    """One publisher of a topic, or all of them if the file does not distinguish them."""

    topic: str
    type: str
    node: str | None
    count: int
    qos: tuple[Qos, ...]
    latched: bool
    channel: Channel


class Bag:
    """An opened file: `sources`, `start` and `end` (seconds since 1970), `ros` (1 or 2).

    `unreadable` has the errors of topics whose messages cannot be decoded. The definitions of the file are added to
    `types`.

    Raises:
        RobotError: KG850 the file is missing, broken, or not a recording.
    """

    def __init__(self, path: Path, types: Types | None = None) -> None:
        self.path = path
        self.ros = 1 if path.suffix == ".bag" else 2
        self.types = types or Types(self.ros)
        self.unreadable: dict[str, RobotError] = {}
        with self._opened() as reader:
            self.count: int = reader.message_count
            self.start = reader.start_time / 1e9 if self.count else 0.0
            self.end = max(reader.end_time - 1, reader.start_time) / 1e9 if self.count else 0.0
            self.sources = tuple(self._source(one) for one in reader.connections)
            for one in self.sources:
                self._define(one)
            self.nodes = self._nodes(reader) if self.ros == 2 else frozenset()  # noqa: PLR2004 - the version

    @contextmanager
    def _opened(self) -> Iterator[Any]:
        """Yield a reader; any exception caused by broken bytes becomes KG850."""
        try:
            with Reader1(self.path) if self.ros == 1 else Reader2(self.path) as reader:
                yield reader
        except FileNotFoundError as error:
            message = (
                f"`{self.path}` cannot be read: {error}" if self.path.exists() else f"`{self.path}` does not exist"
            )
            raise RobotError("KG850", message) from None
        except RobotError:
            raise
        except Exception as error:  # noqa: BLE001 - the readers raise whatever broken bytes lead them to
            hint = None
            if "index" in str(error).lower():
                hint = "The recording was not finished. `rosbag reindex` or `ros2 bag reindex` may repair it."
            message = f"{error}" or type(error).__name__
            raise RobotError("KG850", f"`{self.path}` cannot be read: {message}", hint=hint) from None

    def messages(
        self, sources: Sequence[Source], start: float | None = None, stop: float | None = None
    ) -> Iterator[tuple[Source, float, bytes]]:
        """Yield messages in the order of time, each with its time in seconds, from `start` on and before `stop`.

        Each call opens the file again, since readers keep a position in it. RobotError KG850 for a broken file.
        """
        limits = [None if one is None else round(one * 1e9) for one in (start, stop)]
        own = {(one.topic, one.type, one.node): one for one in sources}
        with self._opened() as reader:
            pairs = [(channel, self._key(channel)) for channel in reader.connections]
            wanted = [channel for channel, key in pairs if key in own]
            for channel, at, content in reader.messages(wanted, *limits) if wanted else ():
                yield own[self._key(channel)], at / 1e9, content

    def _key(self, channel: Channel) -> tuple[str, str, str | None]:
        node = getattr(channel.ext, "callerid", None) or None
        return channel.topic, short(channel.msgtype), node

    def _source(self, channel: Channel) -> Source:
        topic, kind, node = self._key(channel)
        ext: Any = channel.ext
        if self.ros == 1:
            return Source(topic, kind, node, channel.msgcount, (), bool(ext.latching), channel)
        qos = tuple(dict.fromkeys(map(_qos, ext.offered_qos_profiles)))
        latched = bool(qos) and all(one.durability == _LATCHED for one in qos)
        return Source(topic, kind, None, channel.msgcount, qos, latched, channel)

    def _define(self, source: Source) -> None:
        """Learn the recorded type of a topic; a failure is recorded as the error of the topic."""
        text = source.channel.msgdef
        try:
            if text.format is not MessageDefinitionFormat.NONE:
                learn(self.types, source.type, text.data, idl=text.format is MessageDefinitionFormat.IDL)
            self.types.fields(source.type)
        except RobotError as error:
            self.unreadable[source.topic] = error

    def _nodes(self, reader: Any) -> frozenset[str]:
        """Return the names of ROS 2 nodes that name themselves.

        Logger names have dots instead of slashes, and also for child loggers: only names without dots are certain.
        """
        names = set()
        for one in self.sources:
            kind, field = _TELLING.get(one.topic, ("", ""))
            if one.type != kind or one.topic in self.unreadable:
                continue
            with closing(reader.messages([one.channel])) as messages:
                for _, _, content in islice(messages, _ENOUGH):
                    names.add(self.types.decode(kind, content)[field])
        named = (one if one.startswith("/") else f"/{one}" for one in names)
        return frozenset(one for one in named if is_name(one))

    @property
    def problems(self) -> tuple[GraphProblem, ...]:
        """Decoding problems by topic."""
        return tuple(GraphProblem(one.code, topic, one.message) for topic, one in sorted(self.unreadable.items()))


def _qos(profile: Any) -> Qos:
    def word(value: Any) -> str | None:
        name: str = value.name.lower()
        return None if name in {"unknown", "system_default", "best_available"} else name

    return Qos(
        word(profile.reliability),
        word(profile.durability),
        word(profile.history),
        profile.depth or None,
        _seconds(profile.deadline),
        _seconds(profile.lifespan),
        word(profile.liveliness),
        _seconds(profile.liveliness_lease_duration),
    )


def _seconds(duration: QosTime) -> float | None:
    seconds = duration.sec + duration.nsec / 1e9
    return seconds if 0 < seconds < _FOREVER else None
