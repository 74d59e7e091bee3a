"""Execution of commands: topics once or repeatedly, services, and actions.

One command at a time owns a topic, and every movement is stopped. One command at a time moves a part of a robot,
through any of its topics and actions.
"""

from __future__ import annotations

import asyncio
from contextlib import contextmanager, suppress
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias, TypeVar
from uuid import uuid4

from kg.errors import RobotError
from kg.robot.clock import Clock, within
from kg.robot.connecting import is_discovered
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import Callable, Coroutine, Iterable, Iterator

    from kg.robot.capability import Capabilities
    from kg.robot.connection import Connection, Goal, Publication, Value
    from kg.robot.driving.routes import Plan, Route
    from kg.robot.driving.watchdog import Watchdog

Ending: TypeAlias = Literal["taken over", "stopped"] | RobotError
"""Why a command was ended early: by a later command, by `stop`, or by an error."""

Result = TypeVar("Result")

_LOOK: Final = 0.02  # wall-clock seconds between checks whether a subscriber is connected
_SEEN: Final = 0.5  # wall-clock seconds between checks whether a subscriber is back
_AGAIN: Final = 60.0  # wall-clock seconds for which one that is back gets zero
_CONFIRM: Final = 0.3  # wall-clock seconds in which the subscribers of a robot that was lost may confirm zero
_CONFIRM_LATE: Final = 1.0  # the same where nothing else points to a loss
_SILENCE: Final = 2.0  # wall-clock seconds without a confirmation after which a subscriber that leaves was out of reach
_NOTICED: Final = 30.0  # wall-clock seconds within which a lost connection is noticed, and closed


class Command:
    """A running command; `sent` counts its messages."""

    def __init__(self) -> None:
        self.sent = 0
        self.ending: Ending | None = None
        """Why it was ended early."""
        self._work: asyncio.Future[Any] | None = None

    async def begin(self, work: Coroutine[Any, Any, Result]) -> Result:
        """Run the work and return its result; CancelledError if the command is ended, or already was."""
        task = asyncio.ensure_future(work)
        self._work = task
        if self.ending is not None:
            task.cancel()
        return await task

    def end(self, why: Ending) -> None:
        """End the command; the first reason counts."""
        self.ending = self.ending or why
        if self._work is not None:
            self._work.cancel()

    async def ended(self) -> None:
        """Return when no more work runs for it."""
        if self._work is not None:
            await asyncio.wait((self._work,))


class Channel:
    """A topic that is published to.

    Messages are sent in order, at most `limit` per second, and each is sent whole even if its command is cancelled.
    `zero` creates the message that ends the current movement; None without one.
    """

    def __init__(self, topic: str, kind: str, publication: Publication, clock: Clock, limit: float) -> None:
        self.topic = topic
        self.kind = kind
        self.zero: Callable[[], Value] | None = None
        self.last_zero: Callable[[], Value] | None = None
        self.lost = False
        """Whether the message that was to end the last movement could not be sent."""
        self.repeats = False
        """Whether zero is sent again to subscribers that come back."""
        self.needed = 1
        """Number of subscribers that have to confirm zero: more than there are if some went out of reach."""
        self.discovered = False
        """Whether a subscriber that is out of reach disappears like one that leaves."""
        self._publication = publication
        self._clock = clock
        self._gap = 1 / limit
        self._holder: Command | None = None
        self._free = float("-inf")
        self._order = asyncio.Lock()
        self._sending = Tasks()
        self._peers = 0
        self._left = False
        self._vanished = False
        self._confirmed_at: float | None = None
        self._asked = 0.0
        self._used = 0.0

    @property
    def taken(self) -> bool:
        """Whether a command owns it."""
        return self._holder is not None

    def unused(self, seconds: float) -> bool:
        """Return whether it stopped some seconds ago, and every subscriber has confirmed that.

        If a subscriber left or a message was not sent, the topic must keep its zero command for a robot that comes
        back.
        """
        if self.taken or self.zero is not None or self.lost or self._sending:
            return False
        self._count_peers()
        idle = asyncio.get_running_loop().time() - self._used
        return not self._left and idle >= seconds and (self._peers == 0 or self._publication.confirmed)

    @property
    def recent(self) -> bool:
        """Whether its last movement ended so recently that a loss of the robot since then was noticed only now."""
        return asyncio.get_running_loop().time() - self._used < _NOTICED

    @property
    def doubtful(self) -> bool:
        """Whether subscribers went out of reach during the last movement, or have not confirmed its end yet."""
        confirms = self._confirmed_at is not None and self._publication.peers > 0
        return self.last_zero is not None and (self.lost or self._vanished or confirms)

    async def arrived(self, seconds: float = _CONFIRM) -> bool:
        """Return whether all subscribers are there and confirm the last zero command within some seconds."""
        end = asyncio.get_running_loop().time() + seconds
        while not self.lost and self._publication.peers >= self.needed:
            if self._publication.confirmed or asyncio.get_running_loop().time() > end:
                return self._publication.confirmed
            await asyncio.sleep(_LOOK)
        return False

    async def repeat(self) -> None:
        """Send zero again to subscribers that come back, until all have confirmed it or a command owns the channel.

        While a network is cut, what was sent might be lost, and the subscribers with it. Ends after a minute at last.
        """
        loop = asyncio.get_running_loop()
        self.repeats = True
        while not self.taken and loop.time() - self._used < _AGAIN and (self._left or not self._publication.confirmed):
            await asyncio.sleep(_SEEN)
            before = self._peers
            if self._count_peers() > before and not self.taken:
                await self.still(again=True)
        self.repeats = False

    def _count_peers(self) -> int:
        """Return the number of subscribers, and record whether one has left, or went out of reach in a movement."""
        peers = self._publication.peers
        if peers < self._peers:
            self._left = True
            if self.zero is not None and self._is_silent(peers):
                self._vanished, self.needed = True, max(self.needed, self._peers)
        self._peers = peers
        return peers

    def _is_silent(self, others: int) -> bool:
        """Return whether the subscriber that just disappeared was out of reach: it confirmed nothing for some time.

        Where nothing is ever confirmed, the last subscriber to disappear might have been out of reach.
        """
        if self._confirmed_at is None:
            return self.discovered and not others
        return asyncio.get_running_loop().time() - self._confirmed_at > _SILENCE

    def _note_confirmation(self) -> None:
        """Record at times that subscribers confirm what they get."""
        now = asyncio.get_running_loop().time()
        if now - self._asked >= _SEEN:
            self._asked = now
            if self._publication.confirmed and self._publication.peers:  # without subscribers, all have confirmed
                self._confirmed_at = now

    def take(self, command: Command) -> None:
        """Give the channel to a command; the previous one ends, and the new one takes over its movement."""
        earlier, self._holder = self._holder, command
        self._used = asyncio.get_running_loop().time()
        if self.zero is None:
            self._vanished, self.needed = False, 1
        if earlier is not None:
            earlier.end("taken over")

    async def wait_subscriber(self, seconds: float) -> None:
        """Return when a subscriber is connected; RobotError KG824 if there is none within some seconds.

        The seconds are wall-clock time: connecting takes as long however fast a simulation runs.
        """
        try:
            async with asyncio.timeout(seconds):
                while self._publication.peers == 0:  # noqa: ASYNC110 - no event reports a new peer
                    await asyncio.sleep(_LOOK)
        except TimeoutError:
            raise RobotError("KG824", f"no node listens to `{self.topic}`") from None

    async def send(self, message: Value, command: Command) -> None:
        """Send a message of the command that owns the channel; KG824 if the subscriber is gone."""
        wait = min(self._free - self._clock.now(), self._gap)  # a clock that was set back causes no long wait
        if wait > 0:
            await self._clock.sleep(wait)
        self._note_confirmation()
        if self._count_peers() == 0:
            raise self._unheard()
        self._free = self._clock.now() + self._gap
        await self._send(message)
        command.sent += 1

    def _unheard(self) -> RobotError:
        if not self._vanished:
            return RobotError("KG824", f"no node listens to `{self.topic}` any more")
        message = f"the subscriber of `{self.topic}` is out of reach: it disappeared, and confirmed no message before"
        return RobotError("KG824", message, hint="Check the network, and whether the robot is moving.")

    async def release(self, command: Command) -> None:
        """Give the channel back; a current movement is stopped."""
        self._used = asyncio.get_running_loop().time()
        if self._holder is command:
            await self.still()

    async def still(self, *, again: bool = False) -> None:
        """Stop the current movement, whoever owns the channel; with `again`, also send zero if it has ended before."""
        self._holder = None
        zero = self.zero or (self.last_zero if again else None)
        if zero is not None:
            self._count_peers()
            self.zero, self.last_zero = None, zero
            try:
                await self._send(zero())
                self.lost = False
            except RobotError:  # a lost robot cannot receive it; the running command has its own error
                self.lost = True

    async def _send(self, message: Value) -> None:
        task = asyncio.ensure_future(self._publish(message))  # its error is raised here, or not needed any more
        self._sending.hold(task)
        await asyncio.shield(task)

    async def _publish(self, message: Value) -> None:
        async with self._order:
            await self._publication.publish(message)

    async def aclose(self) -> None:
        """Stop publishing the topic, after sending all messages."""
        await self._sending.done()
        await self._publication.aclose()


class Parts:
    """Owners of the parts of robots: `Capability.moves` names the part, the namespace of the node the robot."""

    def __init__(self, capabilities: Capabilities) -> None:
        self._holders: dict[Command, Route] = {}
        self._robots: frozenset[str] = frozenset()
        self.know(capabilities)

    def know(self, capabilities: Capabilities) -> None:
        """Set the robots' current capabilities; owners keep their parts."""
        self._robots = robots_of(way.node for one in capabilities.capabilities if one.moves for way in one.ways)

    @contextmanager
    def reserved(self, command: Command, route: Route) -> Iterator[None]:
        """Reserve the part that a command moves, if it moves one.

        On the same topic or action the later command takes over, so a movement can be redirected. Over another
        interface, two commands would conflict, so the later one is refused.

        Raises:
            RobotError: KG827 another command moves the part.
        """
        for other in self._holders.values():
            if self._same(route, other):
                doing, way = other.capability.name, other.way
                message = f"`{route.capability.name}` would move what `{doing}` moves (by the {way.kind} {way.name})"
                raise RobotError("KG827", message, hint=f"Stop `{doing}` first, or wait until it has ended.")
        self._holders[command] = route
        try:
            yield
        finally:
            del self._holders[command]

    def _same(self, one: Route, other: Route) -> bool:
        if one.capability.moves is None or one.capability.moves != other.capability.moves:
            return False
        different = (one.way.kind, one.way.name) != (other.way.kind, other.way.name)
        return different and self.may_be_one_robot(one.way.node, other.way.node)

    def may_be_one_robot(self, one: str, other: str) -> bool:
        """Return whether two nodes might belong to one robot."""
        return len({self._robot(one), self._robot(other)} - {None}) <= 1

    def _robot(self, node: str) -> str | None:
        namespace = _split(node)[1]
        return namespace if namespace in self._robots else None


def robots_of(nodes: Iterable[str]) -> frozenset[str]:
    """Return the namespaces that are robots of their own: those with nodes that another namespace has too."""
    named = groupby(sorted({_split(node) for node in nodes}), key=lambda one: one[0])
    spaces = ([namespace for _, namespace in each if namespace] for _, each in named)
    return frozenset(namespace for each in spaces if len(each) > 1 for namespace in each)


def _split(node: str) -> tuple[str, str]:
    """Return the name of a node within its outermost namespace, and that namespace."""
    namespace, _, name = node.strip("/").partition("/")
    return (name, namespace) if name else (namespace, "")


Feedback: TypeAlias = "Callable[[dict[str, Any]], None]"
"""Receives the progress of an action: its feedback by parameter, or unchanged if no parameter is known."""

_SERVICE: Final = 10.0  # default timeout of a service in seconds
_SERVED: Final = 5.0  # seconds to wait for an action server
_PATIENCE: Final = 2.0  # wall-clock seconds for an action server to accept a cancellation
_SLACK: Final = 1e-9


class Doing:
    """All commands over one connection."""

    def __init__(
        self, connection: Connection, parts: Parts, watchdog: Watchdog | None, *, limit: float, listen: float
    ) -> None:
        self.channels: dict[str, Channel] = {}
        self.lost = False
        """Whether the connection is lost, so that what was sent last might not have arrived."""
        self._released: dict[str, Channel] = {}
        self._connection = connection
        self._parts = parts
        self._watchdog = watchdog
        self._limit = limit
        self._listen = listen
        self._opening = asyncio.Lock()
        self._goals: dict[str, Command] = {}
        self._cancelling = Tasks()
        self._repeating = Tasks()

    async def carry_out(
        self, command: Command, route: Route, plan: Plan, on_feedback: Feedback | None
    ) -> dict[str, Any]:
        """Execute a plan and return its outcome; in any case, movements are stopped and goals cancelled at the end.

        Raises:
            RobotError: KG827 another command moves the same part of the robot, and those of `Driver.do`.
        """
        with self._parts.reserved(command, route):
            if plan.kind == "service":
                seconds = _SERVICE if plan.seconds is None else plan.seconds
                command.sent = 1
                return route.answer(await self._connection.call(plan.name, plan.type, plan.message, seconds=seconds))
            if plan.kind == "action":
                return await self._goal(command, route, plan, on_feedback)
            await self._publish(command, route, plan)
            return {}

    async def _publish(self, command: Command, route: Route, plan: Plan) -> None:
        async with self._opening:
            channel = await self._open(plan.name, plan.type, latch=route.moves)
        channel.take(command)
        try:
            await channel.wait_subscriber(self._listen)
            await (self._move if route.moves else self._once)(command, channel, route, plan)
        finally:
            try:
                await channel.release(command)
                if route.moves and not (channel.taken or channel.repeats):
                    self._repeating.spawn(channel.repeat(), f"stopping `{plan.name}`")
            finally:
                if self._watchdog is not None and channel.zero is None:
                    owed = channel.lost or (route.moves and self.lost and not await channel.arrived())
                    if owed:
                        await self._watchdog.owe(plan.name, channel.needed)
                    else:
                        await self._watchdog.forget(plan.name)

    async def _open(self, topic: str, kind: str, *, latch: bool) -> Channel:
        if topic not in self.channels:
            # Latched, the final zero command also reaches subscribers that reconnect later.
            publication = await self._connection.advertise(topic, kind, latch=latch)
            self.channels[topic] = Channel(topic, kind, publication, self._connection.clock, self._limit)
            self.channels[topic].discovered = is_discovered(self._connection.address)
            if (before := self._released.pop(topic, None)) is not None:
                self.channels[topic].last_zero = before.last_zero
        return self.channels[topic]

    async def release(self, seconds: float) -> None:
        """Stop publishing the topics that were not used for some seconds and whose subscribers confirmed all messages.

        Another client may then drive the robot exclusively.
        """
        unused = [one for one in self.channels.values() if one.unused(seconds)]
        for one in unused:
            self._released[one.topic] = self.channels.pop(one.topic)
        for one in unused:
            if self._watchdog is not None:
                await self._watchdog.withdraw(one.topic)
            await one.aclose()

    async def _once(self, command: Command, channel: Channel, route: Route, plan: Plan) -> None:
        if channel.zero is not None:
            await channel.send(channel.zero(), command)
            channel.zero = None
        await channel.send(route.restamped(plan.message, self._connection.clock.now()), command)

    async def _move(self, command: Command, channel: Channel, route: Route, plan: Plan) -> None:
        """Repeat a command until its time is over, or until the robot's clock is set back."""
        clock, period = self._connection.clock, 1 / min(plan.rate, self._limit)
        stood, channel.zero = channel.zero is None, lambda: route.zero(clock.now())
        # Before the first velocity: whatever moves must be stopped if this process dies.
        if stood and self._watchdog is not None and plan.afterwards is not None:
            await self._watchdog.watch_topic(plan.name, plan.type, plan.afterwards)
        begun = now = clock.now()
        end = float("inf") if plan.seconds is None else begun + plan.seconds
        while begun <= now < end - _SLACK:
            if self._watchdog is not None and (late := self._watchdog.late()) is not None:
                raise late
            await channel.send(route.restamped(plan.message, now), command)
            now = clock.now()
            # The next multiple of the period since the beginning, so delays do not add up.
            due = begun + (int((now - begun) / period + _SLACK) + 1) * period
            await clock.sleep(min(due, end) - now)
            before, now = now, clock.now()
            begun = begun if now >= before else float("inf")  # a clock that was set back ends the loop

    async def _goal(self, command: Command, route: Route, plan: Plan, on_feedback: Feedback | None) -> dict[str, Any]:
        earlier, self._goals[plan.name] = self._goals.get(plan.name), command
        if earlier is not None:
            earlier.end("taken over")
        identity = uuid4().hex
        if self._watchdog is not None:
            await self._watchdog.watch_goal(plan.name, identity)
        sending = asyncio.ensure_future(
            self._connection.send_goal(plan.name, plan.type, plan.message, seconds=_SERVED, identity=identity)
        )
        command.sent = 1
        done = False
        try:
            goal = await asyncio.shield(sending)
            result = await self._reached(goal, route, plan, on_feedback)
            done = True
            return route.answer(result)
        except RobotError as error:
            done = error.code == "KG809"
            raise
        finally:
            if self._goals.get(plan.name) is command:
                del self._goals[plan.name]
            try:
                if not done:  # even if it is still being sent, and whatever happens to its command
                    await asyncio.shield(self._cancelling.spawn(_cancel(sending), "cancelling a goal"))
            finally:
                if self._watchdog is not None:
                    await self._watchdog.forget(identity)

    async def _reached(self, goal: Goal, route: Route, plan: Plan, on_feedback: Feedback | None) -> dict[str, Any]:
        async def result() -> dict[str, Any]:
            if on_feedback is not None:
                async for feedback in goal.feedback():
                    on_feedback(route.answer(feedback))
            return await goal.result()

        if plan.seconds is None:
            return await result()
        try:
            return await within(self._connection.clock, plan.seconds, result(), pauses=True)
        except TimeoutError:
            raise RobotError(
                "KG825", f"`{plan.capability}` was not done within {plan.seconds:g} s; the goal was cancelled"
            ) from None

    async def still(self, *, released: bool) -> None:
        """Send zero to all topics that moved; with `released`, also to those that are not published any more."""
        again = [self._again(one) for one in self._released.values() if one.last_zero] if released else []
        await asyncio.gather(*(one.still(again=True) for one in self.channels.values()), *again)

    async def _again(self, released: Channel) -> None:
        with suppress(RobotError):  # nobody listens, or the robot is lost
            async with self._opening:
                channel = await self._open(released.topic, released.kind, latch=True)
            await channel.wait_subscriber(self._listen)
            if not channel.taken:
                await channel.still(again=True)

    async def aclose(self) -> None:
        """Stop publishing all topics; the watchdog is left with those that might still move."""
        self._repeating.cancel()
        moved = [one for one in self.channels.values() if one.recent and (self.lost or one.doubtful)]
        owed = [one for one in moved if not await one.arrived(_CONFIRM if self.lost else _CONFIRM_LATE)]
        try:
            await asyncio.gather(self._cancelling.done(), *(one.aclose() for one in self.channels.values()))
        finally:
            if self._watchdog is not None:
                for one in owed:
                    await self._watchdog.owe(one.topic, one.needed)
                await self._watchdog.release()


async def _cancel(sending: asyncio.Future[Goal]) -> None:
    with suppress(RobotError, TimeoutError):
        async with asyncio.timeout(_PATIENCE):
            await (await sending).cancel()
