"""Tests of the pool of readers: ready after the client left, killed unnoticed, or impossible to start."""

from __future__ import annotations

import asyncio
import errno
import logging
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import pytest
from query.readers.asking import descendants, outcome, program, until, whole

from kg.query.readers.messages import Configuration, Ready
from kg.query.readers.pool import Readers
from kg.query.readers.processes import Fleet, Spawner

if TYPE_CHECKING:
    from kg.query.readers.processes import Process
    from kg.store.layout import Layout

linux = pytest.mark.skipif(sys.platform != "linux", reason="other systems tell the end of a connection otherwise")


class _Starting:
    """A reader that becomes ready on demand."""

    def __init__(self) -> None:
        self.ready: asyncio.Future[Ready] = asyncio.get_running_loop().create_future()
        self.pid = 0
        self.nice = self.ended = self.closed = False

    async def receive(self) -> Ready:
        return await self.ready

    def send(self, _data: bytes) -> None:
        pass

    def close(self) -> None:
        self.closed = True


class _Spawner:
    """Starts one reader."""

    def __init__(self, process: _Starting) -> None:
        self._process = process

    async def spawn(self) -> _Starting:
        return self._process

    async def close(self) -> None:
        pass


class _Spawners:
    """Starts readers that are ready immediately."""

    async def spawn(self) -> _Starting:
        process = _Starting()
        process.ready.set_result(Ready(7))
        return process

    async def close(self) -> None:
        pass


def test_readers_stay_where_requests_come_and_go() -> None:
    """Repeated pairs of requests start no reader once there are enough, and stop none."""

    async def run() -> None:
        fleet = Fleet(cast("Any", _Spawners()), 3)
        for _ in range(20):
            taken = [await fleet.take(lambda _: None) for _ in range(2)]
            await until(lambda: fleet.idle >= 3)
            for process in taken:
                fleet.put(process)
        assert (fleet.spawned <= 6, dict(fleet.ended)) == (True, {})
        await fleet.close()

    asyncio.run(run())


@pytest.mark.parametrize("told", [False, True])
def test_a_reader_that_is_ready_as_its_asker_leaves_is_kept(told: bool) -> None:  # noqa: FBT001 - a case of the table
    """Cancelling a request at the moment when its reader is ready does not lose the reader."""

    async def run() -> None:
        process = _Starting()
        fleet = Fleet(cast("Any", _Spawner(process)), 1)
        places: list[asyncio.Future[None]] = []
        asking = asyncio.create_task(fleet.take(places.append))
        await until(lambda: places)
        await asyncio.sleep(0)
        process.ready.set_result(Ready(7))
        await asyncio.sleep(0)
        if told:
            places[0].set_exception(asyncio.InvalidStateError())
        asking.cancel()
        with pytest.raises(asyncio.InvalidStateError if told else asyncio.CancelledError):
            await asking
        assert (fleet.idle, fleet.spawned, process.closed) == (1, 1, False)
        await fleet.close()
        assert process.closed

    asyncio.run(run())


@linux
def test_readers_that_were_killed_unnoticed_cost_nobody_an_answer(layout: Layout) -> None:
    """A request moves to another reader if its reader had exited before reading it."""

    async def ask() -> None:
        async with Readers(layout, processes=2) as readers:
            await whole(readers, "ASK {}")
            waiting = readers._fleet._idle
            # There may be one more: started while none was busy, and ready when the busy one is back.
            await until(lambda: len(waiting) >= 3)
            killed = [process.pid for process in waiting]
            for pid in killed:
                os.kill(pid, signal.SIGKILL)
            # Nothing was awaited since, so the exits are still unnoticed.
            assert await outcome(readers, "ASK {}") == "whole"
            assert readers.stats().ended == {"crashed": len(killed)}

    asyncio.run(ask())


@linux
def test_a_reader_that_was_killed_before_the_data_changed_is_replaced(layout: Layout) -> None:
    """The exit of a reader is detected even if it never read that the data has changed."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            # Others may still be starting, and do not exit.
            killed = list(readers._fleet._idle)
            for process in killed:
                os.kill(process.pid, signal.SIGKILL)
            readers.moved()
            await until(lambda: all(process.ended for process in killed))
            assert await outcome(readers, "ASK {}") == "whole"

    asyncio.run(ask())


@linux
def test_what_readers_are_forked_from_is_replaced_at_once(layout: Layout) -> None:
    """A reader requested at the moment when the fork server is killed is started by another one."""

    async def run() -> None:
        spawner = Spawner(Configuration(str(layout.root)))
        fleet = Fleet(spawner, 1)

        async def taken() -> Process:
            return await fleet.take(lambda _: None)

        for _ in range(3):
            await taken()
            assert spawner._server is not None
            spawner._server.kill()
        assert not (await taken()).ended
        await fleet.close()

    before = descendants().keys()
    asyncio.run(run())
    assert descendants().keys() <= before


def test_without_files_each_request_is_told_and_nothing_is_lost(
    layout: Layout, monkeypatch: pytest.MonkeyPatch
) -> None:
    """If the system is out of file descriptors, a request is KG508, and its files are closed."""
    pipe = os.pipe
    none_left = OSError(errno.EMFILE, os.strerror(errno.EMFILE))

    def no_pipe() -> tuple[int, int]:
        raise none_left

    def opened() -> set[str]:
        return {link for link in map(_target, Path("/proc/self/fd").iterdir()) if link.startswith(("socket", "pipe"))}

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            before = opened()
            monkeypatch.setattr(os, "pipe", no_pipe)
            for _ in range(3):
                assert await outcome(readers, "ASK {}") == "KG508"
            assert opened() <= before
            monkeypatch.setattr(os, "pipe", pipe)
            assert await outcome(readers, "ASK {}") == "whole"

    asyncio.run(ask())


def _target(link: Path) -> str:
    try:
        return str(link.readlink())
    except OSError:
        return ""


def test_readers_that_are_closed_take_nothing_and_start_nothing(layout: Layout) -> None:
    """Requests to a closed pool fail, and start no process."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            assert await outcome(readers, "ASK {}") == "whole"
        assert await outcome(readers, "ASK {}") == "KG510"

    before = descendants().keys()
    asyncio.run(ask())
    assert descendants().keys() <= before


def test_why_a_reader_cannot_start_is_in_the_log(layout: Layout, caplog: pytest.LogCaptureFixture) -> None:
    """A reader that fails before it is ready is KG508, and the log contains the reason."""
    caplog.set_level(logging.INFO, "kg.query.readers.processes")

    async def ask() -> None:
        async with Readers(layout, processes=1, program=program("threadless.py")) as readers:
            assert await outcome(readers, "ASK {}") == "KG508"

    asyncio.run(ask())
    assert "no room for a thread" in caplog.text
