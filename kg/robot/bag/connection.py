"""Playback of a recording as a read-only `Connection`, with its address and clock."""

from __future__ import annotations

import asyncio
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NoReturn
from urllib.parse import unquote

from kg.errors import RobotError
from kg.facts import Role
from kg.robot.connecting import lost, not_commanded, number, options
from kg.robot.connection import ComputationGraph, GraphProblem, Level, LiveEnd, LiveNode, Received, RecordedTopic
from kg.robot.inbox import Changes, Inbox
from kg.robot.ros1.graph import fold
from kg.robot.ros2.graph import computation_graph
from kg.robot.ros2.middleware import Neighbourhood
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.bag.files import Bag, Source
    from kg.robot.messages import Types

_OPTIONS: Final = {"speed": "as a multiple of the recorded one", "start": "seconds from the beginning"}


@dataclass(frozen=True, slots=True)
class BagAddress:
    """A parsed address: the file or folder, the speed (1: as recorded), and the first second."""

    text: str
    path: Path
    speed: float = 1.0
    start: float = 0.0

    @classmethod
    def read(cls, text: str) -> BagAddress:
        """Return a parsed address; RobotError KG801 for an unknown option or invalid value."""
        place, _, query = text.removeprefix("bag://").partition("?")
        given = options(text, query, _OPTIONS)
        if not place:
            raise RobotError("KG801", f"`{text}` names no file", hint="Write bag://FILE, as in bag://drive.mcap.")
        speed = number(text, given.get("speed", "1"), f"speed is {_OPTIONS['speed']}.")
        start = number(text, given.get("start", "0"), f"start is {_OPTIONS['start']}.")
        if speed == 0:
            raise RobotError("KG801", f"`{text}`: the speed is 0", hint="Write speed=2 or speed=0.5.")
        return cls(text, Path(unquote(place)).expanduser(), speed, start)


_LEAD: Final = 0.2
"""Wall-clock seconds between the first subscription and the first message, for further subscriptions."""


class BagClock:
    """A clock that stops at the first moment until it is started, then runs `speed` times as fast as the wall clock."""

    def __init__(self, start: float, speed: float) -> None:
        self._start = start
        self._speed = speed
        self._begun: float | None = None

    def begin(self) -> bool:
        """Start the clock after a short delay; return whether it stood until now."""
        stood = self._begun is None
        if stood:
            self._begun = asyncio.get_running_loop().time() + _LEAD
        return stood

    def now(self) -> float:
        """Return the time of the recording in seconds since 1970."""
        if self._begun is None:
            return self._start
        return self._start + max(asyncio.get_running_loop().time() - self._begun, 0.0) * self._speed

    async def sleep(self, seconds: float) -> None:
        """Sleep for some seconds of the recording."""
        await asyncio.sleep(max(seconds, 0) / self._speed)

    async def until(self, moment: float) -> None:
        """Return at a moment of the recording; yields to other tasks even if it has passed."""
        loop = asyncio.get_running_loop()
        due = (loop.time() if self._begun is None else self._begun) + (moment - self._start) / self._speed
        await asyncio.sleep(max(due - loop.time(), 0))


UNKNOWN: Final = "/_recorded"
"""Placeholder for publishers that a recording does not name."""
_UNNAMED: Final = "the recording does not name the publishers"
_PARTLY: Final = "a recording contains only published messages"
_OVER: Final = "the recording has ended"


class BagConnection:
    """A recording, opened by `connect`."""

    def __init__(self, bag: Bag, address: BagAddress, name: str) -> None:
        self.ros = bag.ros
        self.address = address.text
        self.name = name if name.startswith("/") else f"/{name}"
        self.types: Types = bag.types
        self._bag = bag
        self.clock = BagClock(bag.start + address.start, address.speed)
        self._playing: dict[Inbox[Received], asyncio.Task[None]] = {}
        self._tasks = Tasks()
        self._problems: dict[GraphProblem, None] = dict.fromkeys(bag.problems)
        self._changes = Changes()
        self._lost: asyncio.Future[str] = asyncio.get_running_loop().create_future()
        self._closed = False

    async def graph(self) -> ComputationGraph:
        """Return the recorded topics and their publishers; RobotError KG802 if the recording is closed."""
        if self._closed:
            raise RobotError("KG802", f"the recording {self.address} is closed")
        return self._graph()

    def _graph(self) -> ComputationGraph:
        sources = self._bag.sources
        names = {one.node or UNKNOWN for one in sources} | self._bag.nodes
        nodes = tuple(LiveNode(one, None, _UNNAMED if one == UNKNOWN else _PARTLY) for one in sorted(names))
        ends = {
            LiveEnd(one.node or UNKNOWN, Role.PUBLISHES, one.topic, one.type, qos)
            for one in sources
            for qos in one.qos or (None,)
        }
        counts: Counter[str] = Counter()
        for one in sources:
            counts[one.topic] += one.count
        seconds = self._bag.end - self._bag.start
        recorded = tuple(RecordedTopic(topic, count, seconds) for topic, count in sorted(counts.items()))
        problems = tuple(sorted(self._problems))
        if self.ros == 1:
            return ComputationGraph(1, nodes, fold(ends), problems, recorded=recorded)
        return replace(computation_graph(Neighbourhood(nodes, tuple(ends), problems), complete=True), recorded=recorded)

    def changes(self) -> AsyncIterator[ComputationGraph]:
        """Yield the graph, and again after each message that could not be decoded."""
        return self._changes.values(lambda: None if self._closed else self._graph())

    async def subscribe(self, topic: str, kind: str | None = None, *, queue: int = 10) -> Inbox[Received]:
        """Subscribe to a topic from the current time on; the first subscription starts playback.

        Raises:
            RobotError: KG804 a topic that was not recorded or whose type is unusable, KG806 a type other than `kind`,
                KG803 the recording is closed or has ended.
        """
        if self._closed or self._lost.done():
            raise lost(self.address, _OVER if self._lost.done() else "the recording is closed")
        sources = [one for one in self._bag.sources if one.topic == topic]
        if not sources and kind is None:
            hint = f"List the recorded topics with `kg robot topics --robot {self.address}`."
            raise RobotError("KG804", f"`{topic}` was not recorded", hint=hint)
        if topic in self._bag.unreadable:
            raise self._bag.unreadable[topic]
        if kind is not None and (other := {one.type for one in sources} - {kind}):
            raise RobotError("KG806", f"`{topic}` is of the type {min(other)}, not {kind}")
        inbox: Inbox[Received] = Inbox(queue, lambda: self._leave(inbox))
        since = self.clock.now()
        if self.clock.begin():
            self._tasks.spawn(self._end(), "playing a recording")
        self._playing[inbox] = self._tasks.spawn(self._play(inbox, sources, since), f"playing `{topic}`")
        return inbox

    async def _play(self, inbox: Inbox[Received], sources: list[Source], since: float) -> None:
        try:
            # A subscriber also gets the last message that each publisher latched before.
            latched = [one for one in sources if one.latched] if since > self._bag.start else []
            last = {message[0].node: message for message in self._bag.messages(latched, stop=since)} if latched else {}
            for source, at, content in last.values():
                self._put(inbox, source, at, content)
            for source, at, content in self._bag.messages(sources, since):
                await self.clock.until(at)
                self._put(inbox, source, at, content)
            await self.clock.until(self._bag.end)
        except RobotError as error:  # the file was broken or removed while it was played
            self._report(GraphProblem(error.code, sources[0].topic, error.message))
        finally:
            inbox.end()

    def _put(self, inbox: Inbox[Received], source: Source, at: float, content: bytes) -> None:
        try:
            value = self.types.decode(source.type, content)
        except RobotError as error:
            self._report(GraphProblem(error.code, source.topic, error.message))
            return
        inbox.put(Received(value, at, source.node, source.latched))

    def _report(self, problem: GraphProblem) -> None:
        self._problems[problem] = None
        self._changes.notify()

    async def _end(self) -> None:
        """Lose the connection at the end of the recording."""
        await self.clock.until(self._bag.end)
        await asyncio.gather(*self._playing.values(), return_exceptions=True)
        self._lost.set_result(_OVER)

    def _leave(self, inbox: Inbox[Received]) -> None:
        if task := self._playing.pop(inbox, None):
            task.cancel()

    async def _refused(self, *_given: Any, **_options: Any) -> NoReturn:
        """Raise RobotError KG851: recordings cannot be commanded."""
        raise not_commanded(self.address)

    advertise = call = send_goal = canceller = serve = serve_action = _refused

    def log(self, level: Level, message: str) -> None:
        """Do nothing: recordings have no log."""
        del level, message

    async def wait_lost(self) -> str:
        """Return at the end of the recording; never before."""
        return await asyncio.shield(self._lost)

    async def aclose(self) -> None:
        """Stop playback, and close all subscriptions."""
        self._closed = True
        self._changes.notify()
        for inbox in list(self._playing):
            inbox.end()
        self._tasks.cancel()
        await self._tasks.done()
