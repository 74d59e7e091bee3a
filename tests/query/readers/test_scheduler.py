"""Tests of the scheduler with real readers."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from query.readers.asking import ENDLESS, STREAM, outcome, question, until

from kg.query.readers import scheduler
from kg.query.readers.pool import Readers

if TYPE_CHECKING:
    from kg.query.readers.processes import Process
    from kg.store.layout import Layout

pytestmark = pytest.mark.usefixtures("forked")

_STATE, _NICE = 0, 16
"""Fields of /proc/PID/stat, counted after the name (proc(5))."""

linux = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")


def _endless(readers: Readers, count: int) -> list[asyncio.Task[str]]:
    """Start endless queries, cancelled by their number; return their outcomes."""
    return [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", job=str(n), seconds=600)) for n in range(count)]


async def _cancelled(readers: Readers, tasks: list[asyncio.Task[str]]) -> list[str]:
    for number in range(len(tasks)):
        readers.cancel(str(number))
    return await asyncio.gather(*tasks)


def test_no_quick_query_is_refused_in_a_flood(layout: Layout) -> None:
    """C13: while seventy endless queries run and wait, each ASK is answered."""

    async def ask() -> None:
        async with Readers(layout, processes=2) as readers:
            flood = _endless(readers, 70)
            await asyncio.sleep(0)
            asked = 0
            # A quick query is answered while others still wait for their first turn, and after that.
            while readers.stats().waiting or not asked:
                assert await outcome(readers, f"ASK {{}} # {asked}") == "whole"
                asked += 1
            assert readers.stats().long >= 60
            assert await outcome(readers, "ASK {}") == "whole"
            # None of them was refused, and all of them ran until now.
            assert set(await _cancelled(readers, flood)) == {"KG510"}

    asyncio.run(ask())


def test_a_long_query_leaves_its_slot(layout: Layout) -> None:
    """C13: with one slot, a quick query is answered while a long one runs."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            tasks = _endless(readers, 1)
            await until(lambda: readers.stats().long == 1)
            assert (readers.stats().quick, readers.stats().waiting) == (0, 0)
            assert await outcome(readers, "ASK {}") == "whole"
            assert await _cancelled(readers, tasks) == ["KG510"]
            assert readers.stats().long == 0

    asyncio.run(ask())


def test_a_long_query_stays_in_its_reader(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> None:
    """No work is lost: a query longer than its first turn is answered by the same process."""
    monkeypatch.setattr(scheduler, "_CHECK_SECONDS", 0.0)
    monkeypatch.setattr(scheduler, "_TURN_ROUNDS", 0)

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            async with readers.ask(question("SELECT * { ?a ?b ?c . ?d ?e ?f } LIMIT 50000")) as answer:
                process = answer.job.process
                assert process is not None
                assert readers.stats().long == 1
                rows = b"".join([part async for part in answer.parts()])
                assert answer.job.process is process
            assert len(json.loads(rows)["results"]["bindings"]) == 50000
            assert set(readers.stats().ended) <= {"retired"}

    asyncio.run(ask())


def test_too_many_long_queries_are_refused(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> None:
    """C13: a long query beyond the limit is KG509, after its first turn; a quick one is answered all the same."""
    monkeypatch.setattr(scheduler, "_LONG_PER_SLOT", 2)

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            tasks = _endless(readers, 3)
            ended, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            assert [task.result() for task in ended] == ["KG509"]
            assert readers.stats().ended["busy"] == 1
            assert await outcome(readers, "ASK {}") == "whole"
            assert sorted(await _cancelled(readers, tasks)) == ["KG509", "KG510", "KG510"]

    asyncio.run(ask())


@linux
def test_paused_readers_stand_still_and_end(layout: Layout) -> None:
    """As many long queries run as there are slots; the others are stopped, and can be cancelled."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            tasks = _endless(readers, 3)
            await until(lambda: readers.stats().long == 3)
            pids = [job.process.pid for job in readers.jobs.values() if job.process is not None]
            await until(lambda: [_field(Path(f"/proc/{pid}"), _STATE) for pid in pids].count("T") == 2)
            assert await _cancelled(readers, tasks) == ["KG510"] * 3
            await until(lambda: not any(Path(f"/proc/{pid}").exists() for pid in pids))

    asyncio.run(ask())


@linux
def test_long_readers_give_way_with_all_their_threads(layout: Layout) -> None:
    """A reader with a long query has a low priority, in each of its threads."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            tasks = _endless(readers, 1)
            await until(lambda: readers.stats().long == 1)
            process = readers.jobs["0"].process
            assert process is not None
            assert len(_nicenesses(process)) > 1
            # The fork server lowers it on an order.
            await until(lambda: set(_nicenesses(process)) == {"10"})
            await _cancelled(readers, tasks)

    asyncio.run(ask())


@linux
def test_the_system_ends_readers_first(layout: Layout) -> None:
    """C11: if the machine runs out of memory, Linux kills readers before any other process."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers, readers.ask(question(STREAM)) as answer:
            assert answer.job.process is not None
            score = Path(f"/proc/{answer.job.process.pid}/oom_score_adj")
            assert await asyncio.to_thread(score.read_text) == "1000\n"

    asyncio.run(ask())


def test_views_have_slots_of_their_own(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> None:
    """A view that runs longer than a first turn keeps its priority, however many queries are long."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))

    async def ask() -> None:
        async with Readers(layout, processes=1, calls="query.readers.views") as readers:
            tasks = _endless(readers, 4)
            found = json.loads(await readers.call("work", {"seconds": 0.6}))
            assert found["niceness"] == os.nice(0)
            assert await _cancelled(readers, tasks) == ["KG510"] * 4

    asyncio.run(ask())


def _nicenesses(process: Process) -> list[str]:
    """Return the niceness of each thread of a process."""
    return [_field(thread, _NICE) for thread in Path(f"/proc/{process.pid}/task").iterdir()]


def _field(folder: Path, number: int) -> str:
    return (folder / "stat").read_text().rpartition(")")[2].split()[number]
