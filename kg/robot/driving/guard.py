"""What stops a robot when the process that moves it is killed: another process, which lives a moment longer.

It is a node of its own that says nothing until the pipe to it breaks, and then sends zero commands.
"""

from __future__ import annotations

import asyncio
import json
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, PIPE
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.connecting import SCHEMES, connect, scheme_of
from kg.robot.driving.routes import stamp

if TYPE_CHECKING:
    from asyncio.subprocess import Process

    from kg.robot.clock import Clock
    from kg.robot.connection import Publication, Value

__all__ = ["Guard", "main"]

_TIMES: Final = 5
"""How often zero is sent: what the killed process sent last may still be on its way."""
_PAUSE: Final = 0.1
_ENDS: Final = 5.0
"""Seconds that the other process may take to leave the graph."""
_HEARD: Final = 3.0
"""Seconds to wait for a subscriber of a topic that was moved only just."""


class Guard:
    """The other process, begun with the first movement; a robot in memory ends with this one, and needs none."""

    def __init__(self, address: str) -> None:
        self._command = (sys.executable, "-P", "-c", f"from {__name__} import main; main()", address)
        self._needed = scheme_of(address) != "memory"
        self._process: asyncio.Task[Process] | None = None

    async def watch(self, topic: str, kind: str, zero: Value) -> None:
        """Let a topic get a message when this process ends without `forget` or `release`."""
        if self._process is None and self._needed:
            # In a session of its own Ctrl-C does not reach it, nor a terminal that is closed.
            started = asyncio.create_subprocess_exec(
                *self._command, stdin=PIPE, stdout=DEVNULL, stderr=DEVNULL, start_new_session=True
            )
            self._process = asyncio.ensure_future(started)
        await self._tell([topic, kind, zero])

    async def forget(self, topic: str) -> None:
        """Let a topic alone, which others may move by now: what was moved has got its zero command."""
        await self._tell([topic, "", None])

    async def release(self) -> None:
        """End the other process: all that was moved stands still, or was told to."""
        process = await self._tell(None)
        if process is not None:
            with suppress(ProcessLookupError):
                process.terminate()  # where it is only just beginning, and reads nothing yet; else it does not mind
            try:
                async with asyncio.timeout(_ENDS):
                    await process.wait()
            except TimeoutError:
                process.kill()
                await process.wait()

    async def _tell(self, order: list[Any] | None) -> Process | None:
        if self._process is None:
            return None
        try:
            process = await asyncio.shield(self._process)
        except OSError:  # nothing can be begun: a robot is moved without it
            return None
        if process.stdin is None or process.returncode is not None:
            return None
        process.stdin.write(f"{json.dumps(order)}\n".encode())  # not drained: no robot waits for a guard that hangs
        return process


def main() -> None:
    """Be the other process; the address of the robot is its argument."""
    address = sys.argv[1]
    import_module(SCHEMES[scheme_of(address)])  # most of its beginning; until then a signal ends it at once
    # From here on the pipe alone does: it is to leave the graph as a node should, and to outlive a service manager's
    # request to all processes of the robot.
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with suppress(RobotError):  # nobody would read it
        asyncio.run(_guard(address))


async def _guard(address: str) -> None:
    connection = await connect(address, name=f"/kg_{os.getpid()}")
    offered: dict[str, Publication] = {}
    moved: dict[str, Value] = {}
    try:
        while (line := await asyncio.to_thread(sys.stdin.readline)).endswith("\n"):  # half an order is none
            if (order := json.loads(line)) is None:
                return
            topic, kind, zero = order
            moved.pop(topic, None)
            if zero is not None:
                with suppress(RobotError):  # a type that it does not know: the other topics are guarded all the same
                    offered[topic] = offered.get(topic) or await connection.advertise(topic, kind)
                    moved[topic] = zero
        await _stop([(offered[topic], zero) for topic, zero in moved.items()], connection.clock)
    finally:
        await connection.aclose()


async def _stop(moved: list[tuple[Publication, Value]], clock: Clock) -> None:
    with suppress(TimeoutError):
        async with asyncio.timeout(_HEARD):
            while not all(publication.peers for publication, _ in moved):  # noqa: ASYNC110 - nothing tells of peers
                await asyncio.sleep(_PAUSE)
    for _ in range(_TIMES if moved else 0):
        for publication, zero in moved:
            if "header" in zero:
                zero["header"]["stamp"] = stamp(clock.now())
            await publication.publish(zero)
        await asyncio.sleep(_PAUSE)
