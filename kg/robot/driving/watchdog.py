"""The watchdog: another process that stops a robot when the one that drives it dies, hangs or is suspended.

The driving process, the controller, sends it heartbeats from the event loop that drives. Without one for a while the
watchdog sends zero velocity to every topic that moves and cancels every goal, and reports so. The controller then ends
its commands (KG828): when it runs again nothing moves before a new command.

A connection that is lost while the robot moves takes the zero with it. A third process, which needs neither of the
others, then sends it as soon as the robot can be reached again.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from asyncio.subprocess import PIPE, Process
from contextlib import suppress
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.errors import RobotError
from kg.robot.clock import stamp
from kg.robot.connecting import SCHEMES, connect, scheme_of
from kg.robot.tasks import Tasks, ended, spawn

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Cancel, Connection, Publication, Value

NODES: Final = "/kg_watchdog_"
"""Prefix of the names of watchdogs."""
_SILENCE: Final = 0.5  # default seconds without a heartbeat after which the robot is stopped
_BEATS: Final = 5  # heartbeats within that time
_IDLE: Final = 5.0  # seconds that the controller may be blocked without movement before its commands end
_TIMES: Final = 5  # how often zero is sent: the controller's last command may still be in transit
_PAUSE: Final = 0.1
_PEERS: Final = 3.0  # seconds to wait for the subscriber of a topic, or server of a goal, that was just in use
_ENDS: Final = 5.0  # seconds for the watchdog to leave the graph
_AGAIN: Final = 60.0  # seconds for which a robot that was lost while it moved is looked for
_LOOK: Final = 1.0  # seconds between attempts to reach it
_CLOCK: Final = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)
"""A clock that includes the machine's sleep, if there is one."""

_Order: TypeAlias = list[Any]
"""What the controller sends: a word, and what it is about."""
_Owed: TypeAlias = list[tuple[_Order, int]]
"""Topics to stop later: the order that has their zero, and the number of their subscribers."""


class Watchdog:
    """The controller's side: heartbeats while it is open, and the process, started with the first movement or goal.

    A robot in memory ends with the controller and needs no watchdog.

    Args:
        address: the robot.
        silence: seconds without a heartbeat after which the robot is stopped.
    """

    def __init__(self, address: str, silence: float = _SILENCE) -> None:
        self.silence = silence
        self._command = (sys.executable, "-P", "-c", f"from {__name__} import main; main()", address, str(silence))
        self._needed = scheme_of(address) != "memory"
        self._process: asyncio.Task[Process] | None = None
        self._watched: set[str] = set()
        self._beaten = 0.0
        self._on_silence: Callable[[RobotError], None] = lambda _: None
        self._tasks: list[asyncio.Task[None]] = []

    def open(self, on_silence: Callable[[RobotError], None]) -> None:
        """Start the heartbeats; `on_silence` receives the error KG828 if they paused for too long."""
        self._on_silence = on_silence
        self._beaten = time.clock_gettime(_CLOCK)
        self._tasks.append(spawn(self._beat(), "sending heartbeats to the watchdog"))

    async def watch_topic(self, topic: str, kind: str, zero: Value) -> None:
        """Stop a topic with a message if this process is silent or dies, until `forget`."""
        await self._watch(topic, ["topic", topic, kind, zero])

    async def watch_goal(self, action: str, identity: str) -> None:
        """Cancel a goal if this process is silent or dies, until `forget`."""
        await self._watch(identity, ["goal", identity, action])

    async def _watch(self, key: str, order: list[Any]) -> None:
        self._watched.add(key)
        if self._process is None and self._needed:
            # In a session of its own, it gets no signal for the group of this process: Ctrl-C, Ctrl-Z, a hang-up.
            started = asyncio.create_subprocess_exec(*self._command, stdin=PIPE, stdout=PIPE, start_new_session=True)
            self._process = asyncio.ensure_future(started)
            self._tasks.append(spawn(self._listen(self._process), "listening to the watchdog"))
        await self._send(order)

    async def forget(self, key: str) -> None:
        """Stop watching a topic or goal that was stopped, or has ended."""
        self._watched.discard(key)
        await self._send(["forget", key])

    async def withdraw(self, topic: str) -> None:
        """Stop publishing a topic that has stopped; a later movement publishes it again."""
        await self._send(["withdraw", topic])

    async def owe(self, topic: str, peers: int) -> None:
        """Have zero sent to a topic when the robot can be reached again: it was lost before it could be stopped.

        That is when the topic has as many subscribers as before.
        """
        self._watched.discard(topic)
        await self._send(["owe", topic, peers])

    def late(self) -> RobotError | None:
        """Return the error KG828 if this process has sent no heartbeat for too long, None otherwise.

        Checked before each velocity: after a pause, the heartbeat need not be the first to run.
        """
        paused = time.clock_gettime(_CLOCK) - self._beaten
        if paused <= (self.silence if self._watched else max(self.silence, _IDLE)):
            return None
        return RobotError("KG828", f"the process that drives the robot was stuck for {paused:.1f} s")

    async def _beat(self) -> None:
        while True:
            if (error := self.late()) is not None:
                self._on_silence(error)
            self._beaten = time.clock_gettime(_CLOCK)
            if self._watched:
                await self._send(["beat"])
            await asyncio.sleep(self.silence / _BEATS)

    async def _listen(self, starting: asyncio.Task[Process]) -> None:
        """End commands when the watchdog has stopped the robot; the watchdog decides what is too late."""
        with suppress(OSError):  # it did not start
            process = await asyncio.shield(starting)
            assert process.stdout is not None  # noqa: S101 - it was asked for
            async for line in process.stdout:
                message = f"the watchdog stopped the robot: no heartbeat for {float(line):.1f} s"
                self._on_silence(RobotError("KG828", message))

    async def release(self) -> None:
        """End the heartbeats and the process; all movements have been stopped."""
        process = await self._send(["end"])
        await ended(*self._tasks)
        if process is not None:
            with suppress(ProcessLookupError):
                process.terminate()  # while it is starting and does not read yet; later it ignores this
            try:
                async with asyncio.timeout(_ENDS):
                    await process.wait()
            except TimeoutError:
                process.kill()
                await process.wait()

    async def _send(self, order: list[Any]) -> Process | None:
        if self._process is None:
            return None
        try:
            process = await asyncio.shield(self._process)
        except OSError:  # it did not start: the robot is moved without it
            return None
        if process.stdin is None or process.returncode is not None:
            return None
        # Not drained, since no robot should wait for a hanging watchdog, which gets no heartbeats either.
        if order != ["beat"] or not process.stdin.transport.get_write_buffer_size():
            process.stdin.write(f"{json.dumps(order)}\n".encode())
        return process


def main() -> None:
    """Run the watchdog process; arguments are the robot's address and the seconds of silence."""
    address, silence = sys.argv[1], float(sys.argv[2])
    try:
        import_module(SCHEMES[scheme_of(address)])  # most of the start; until here, a signal ends the process at once
        # From here on only the pipe does: the node must leave the graph properly, and survive the signals
        # that a service manager sends to all processes of the robot.
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        asyncio.run(_watch(address, silence))
    except RobotError as error:
        _report(error.code, f"the watchdog of this process does not work: {error.message}")


async def _watch(address: str, silence: float) -> None:
    connection = await connect(address, name=f"{NODES}{os.getpid()}")
    try:
        watching = _Watching(connection, silence)
        await watching.run()
        if owed := watching.owed:  # before this connection is closed, which may take longer than the controller waits
            _leave_to_another(address, owed)
    finally:
        await connection.aclose()


def _leave_to_another(address: str, owed: _Owed) -> None:
    """Start the process that stops the robot later; who waits for the output of the controller need not wait for it."""
    topics = ", ".join(f"`{order[1]}`" for order, _ in owed)
    _report("KG828", f"the robot was lost while it moved; for {_AGAIN:.0f} s, kg tries to send zero to {topics}")
    command = (sys.executable, "-P", "-c", f"from {__name__} import stop_later; stop_later()", address)
    stderr = None if sys.stderr.isatty() else subprocess.DEVNULL
    process = subprocess.Popen(  # noqa: S603 - this program itself
        command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=stderr, start_new_session=True
    )
    if process.stdin is not None:
        process.stdin.write(json.dumps(owed).encode())
        process.stdin.close()


def stop_later() -> None:
    """Be the process that stops a robot when it is back; the address is the argument, what to stop is the input."""
    asyncio.run(_stop_later(sys.argv[1], json.load(sys.stdin)))


async def _stop_later(address: str, owed: _Owed) -> None:
    with suppress(TimeoutError):
        async with asyncio.timeout(_AGAIN):
            while owed := await _stop_reached(address, owed):  # noqa: ASYNC110 - no event reports that a robot is back
                await asyncio.sleep(_LOOK)


async def _stop_reached(address: str, owed: _Owed) -> _Owed:
    """Try to stop topics once, as a new node, which others discover at once; return those that are left."""
    try:
        connection = await connect(address, name=f"{NODES}{os.getpid()}")
    except (RobotError, OSError):  # a TimeoutError is an OSError
        return owed
    try:
        return await _Watching(connection, _SILENCE).stop_reached(owed)
    finally:
        await connection.aclose()


class _Watching:
    """The watchdog's state: topics and goals to stop, and the time of the last heartbeat."""

    def __init__(self, connection: Connection, silence: float) -> None:
        self._connection = connection
        self._silence = silence
        self._last_beat = 0.0
        self._released = False
        self._owed: dict[str, tuple[_Order, int]] = {}
        self._moving: dict[str, _Order] = {}
        self._zeros: dict[str, Value] = {}
        self._goals: dict[str, str] = {}
        self._publications: dict[str, asyncio.Task[Publication]] = {}
        self._stopping: set[str] = set()
        self._tasks = Tasks()
        self._cancellers: dict[str, asyncio.Task[Cancel]] = {}

    @property
    def owed(self) -> _Owed:
        """The topics that are to be stopped when the robot can be reached again."""
        return list(self._owed.values())

    async def run(self) -> None:
        """Watch until the controller releases this process, or closes its end of the pipe by dying."""
        loop = asyncio.get_running_loop()
        reading = asyncio.ensure_future(self._read())
        while not reading.done():
            await asyncio.wait((reading,), timeout=self._silence / (2 * _BEATS))
            silent = loop.time() - self._last_beat
            if (self._zeros or self._goals) and silent > self._silence and not reading.done():
                with suppress(OSError):
                    os.write(sys.stdout.fileno(), f"{silent}\n".encode())
                await self._stop(f"the process that drives the robot was silent for {silent:.1f} s")
        if not self._released:
            await self._stop("the process that drives the robot ended without stopping it")

    async def _read(self) -> None:
        loop = asyncio.get_running_loop()
        reader = asyncio.StreamReader(limit=1 << 24)
        await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
        while (line := await reader.readline()).endswith(b"\n"):  # ignore a truncated order
            self._last_beat = loop.time()
            self._take(json.loads(line))
            if self._released:
                return

    def _take(self, order: _Order) -> None:
        match order:
            case ["topic", topic, kind, zero]:
                if topic not in self._publications:
                    # Latched like the controller's: a subscriber that adapts to its publishers is not disturbed.
                    offering = self._connection.advertise(topic, kind, latch=True)
                    self._publications[topic] = asyncio.ensure_future(offering)
                    self._publications[topic].add_done_callback(partial(_check, f"stop `{topic}`"))
                self._zeros[topic], self._moving[topic] = zero, order
                self._owed.pop(topic, None)
            case ["goal", identity, action]:
                if action not in self._cancellers:
                    self._cancellers[action] = asyncio.ensure_future(self._connection.canceller(action))
                    self._cancellers[action].add_done_callback(partial(_check, f"cancel goals of `{action}`"))
                self._goals[identity] = action
            case ["forget", key]:
                self._zeros.pop(key, None)
                self._goals.pop(key, None)
            case ["withdraw", topic]:
                if topic not in self._zeros and topic not in self._stopping and topic in self._publications:
                    self._tasks.spawn(_closed(self._publications.pop(topic)), f"closing `{topic}`")
            case ["owe", topic, peers]:  # the zero of a topic that is stopped when the robot is back
                self._zeros.pop(topic, None)
                if topic in self._moving:
                    self._owed[topic] = self._moving[topic], peers
            case ["end"]:
                self._released = True

    async def stop_reached(self, owed: _Owed) -> _Owed:
        """Stop the topics that soon have as many subscribers as before; return the others, for another attempt."""
        for order, _ in owed:
            self._take(order)
        waiting = (self._is_back(order[1], peers) for order, peers in owed)
        back = await asyncio.gather(*waiting, return_exceptions=True)  # an unknown type may be learned later
        left = [one for one, is_back in zip(owed, back, strict=True) if is_back is not True]
        for order, _ in left:
            self._take(["forget", order[1]])
        return left if await self._stop("the robot was lost while it moved, and is back") else owed

    async def _is_back(self, topic: str, peers: int) -> bool:
        """Return whether a topic has so many subscribers within some seconds."""
        with suppress(TimeoutError):
            async with asyncio.timeout(_PEERS):
                while (await self._publications[topic]).peers < peers:  # noqa: ASYNC110 - no event reports new peers
                    await asyncio.sleep(_PAUSE)
                return True
        return False

    async def _stop(self, why: str) -> bool:
        """Stop everything in parallel, so one unreachable peer delays no other; return whether all was sent."""
        zeros, self._zeros = self._zeros, {}
        self._stopping |= zeros.keys()
        goals, self._goals = self._goals, {}
        if zeros or goals:
            done = [f"zero velocity was sent to `{topic}`" for topic in zeros]
            done += [f"a goal of `{action}` was cancelled" for action in goals.values()]
            _report("KG828", f"{why}: {', '.join(done)}")
            self._connection.log("error", f"[KG828] {why}: {', '.join(done)}")
        work = [self._still(topic, zero) for topic, zero in zeros.items()]
        work += [self._cancelled(identity, action) for identity, action in goals.items()]
        results = await asyncio.gather(*work, return_exceptions=True)
        self._stopping -= zeros.keys()
        return not any(isinstance(one, BaseException) for one in results)  # they were reported, or do not subscribe

    async def _still(self, topic: str, zero: Value) -> None:
        publication = await self._publications[topic]
        await self._is_back(topic, 1)
        for _ in range(_TIMES):
            if topic in self._zeros:  # the controller is back and moves it with a new command
                return
            if "header" in zero:
                zero["header"]["stamp"] = stamp(self._connection.clock.now())
            await publication.publish(zero)
            await asyncio.sleep(_PAUSE)

    async def _cancelled(self, identity: str, action: str) -> None:
        async with asyncio.timeout(_PEERS):
            await (await self._cancellers[action])(identity)
            await asyncio.sleep(_PAUSE)  # messages leave before the node does


async def _closed(publication: asyncio.Task[Publication]) -> None:
    with suppress(RobotError):  # it could not be opened, which was reported
        await (await publication).aclose()


def _check(what: str, task: asyncio.Task[Any]) -> None:
    if not task.cancelled() and (error := task.exception()) is not None:
        _report(error.code if isinstance(error, RobotError) else "KG803", f"the watchdog could not {what}: {error}")


def _report(code: str, message: str) -> None:
    with suppress(OSError):
        os.write(sys.stderr.fileno(), f"warning[{code}]: {message}\n".encode())
