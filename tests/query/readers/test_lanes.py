"""Tests of who runs when."""

from __future__ import annotations

import asyncio
import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from query.readers.asking import ENDLESS, outcome, until, whole

from kg.errors import QueryError
from kg.query.readers.course import Lanes
from kg.query.readers.fleet import Fleet
from kg.query.readers.known import Marks
from kg.query.readers.lanes import Lane
from kg.query.readers.messages import Configuration
from kg.query.readers.pool import Readers
from kg.query.readers.processes import Spawner

if TYPE_CHECKING:
    from kg.query.readers.processes import Process
    from kg.store.layout import Layout

_NICE_FIELD = 16
"""Of /proc/PID/stat, counted behind the name (proc(5))."""


def test_slots_go_round() -> None:
    """As many as there are slots hold one; who waits gets the next that is given back, in turn while few wait."""

    async def run() -> None:
        lane = Lane(2, 3)
        order: list[int] = []

        async def one(number: int) -> None:
            await lane.take(lambda _: None)
            order.append(number)

        tasks = [asyncio.create_task(one(number)) for number in range(4)]
        await asyncio.sleep(0)
        assert (order, lane.held, lane.waiting) == ([0, 1], 2, 2)
        assert not lane.try_take()
        for _ in range(2):
            lane.give_back()
        await asyncio.gather(*tasks)
        assert (order, lane.held, lane.waiting) == ([0, 1, 2, 3], 2, 0)
        for _ in range(2):
            lane.give_back()
        assert lane.held == 0
        assert lane.try_take()

    asyncio.run(run())


def test_a_full_queue_refuses() -> None:
    """C13: who would wait behind as many as may is told to come again."""

    async def run() -> None:
        lane = Lane(1, 1)
        await lane.take(lambda _: None)
        task = asyncio.create_task(lane.take(lambda _: None))
        await asyncio.sleep(0)
        with pytest.raises(QueryError, match="KG509"):
            await lane.take(lambda _: None)
        lane.give_back()
        await task

    asyncio.run(run())


def test_where_many_wait_the_newest_and_the_oldest_have_their_turn() -> None:
    """C13: in a long queue three of four slots go to the newest, one to the oldest."""

    async def run() -> None:
        lane = Lane(1, 100)
        await lane.take(lambda _: None)
        order: list[int] = []

        async def one(number: int) -> None:
            await lane.take(lambda _: None)
            order.append(number)
            lane.give_back()

        tasks = [asyncio.create_task(one(number)) for number in range(8)]
        await asyncio.sleep(0)
        lane.give_back()
        await asyncio.gather(*tasks)
        assert order == [7, 6, 5, 0, 4, 3, 2, 1]

    asyncio.run(run())


def test_waiting_that_ends_gives_its_slot_on() -> None:
    """Who is cancelled in the moment that a slot is given does not take it along."""

    async def run() -> None:
        lane = Lane(1, 10)
        await lane.take(lambda _: None)
        first = asyncio.create_task(lane.take(lambda _: None))
        second = asyncio.create_task(lane.take(lambda _: None))
        await asyncio.sleep(0)
        lane.give_back()
        first.cancel()
        await asyncio.wait_for(second, patient(1))
        lane.give_back()
        assert (lane.held, lane.waiting) == (0, 0)
        places: list[asyncio.Future[None]] = []
        await lane.take(places.append)
        waiting = asyncio.create_task(lane.take(places.append))
        await asyncio.sleep(0)
        places[0].set_exception(QueryError("KG510", "ended"))
        with pytest.raises(QueryError, match="KG510"):
            await waiting
        lane.give_back()
        assert (lane.held, lane.waiting) == (0, 0)

    asyncio.run(run())


def test_a_flood_of_slow_queries_does_not_delay_quick_ones(layout: Layout) -> None:
    """C13: while forty queries without end run, wait and are ended, each ASK is answered as if there were few."""

    async def ask() -> None:
        async with Readers(layout, processes=2) as readers:
            await whole(readers, "ASK {}")
            flood = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", seconds=6)) for n in range(40)]
            await asyncio.sleep(0)
            taken = []
            while not all(task.done() for task in flood):
                began = time.monotonic()
                assert await outcome(readers, "ASK { ?s ?p ?o }") == "whole"
                taken.append(time.monotonic() - began)
                await asyncio.sleep(0.1)
            assert {await task for task in flood} <= {"KG503", "KG509"}
            assert sorted(taken)[len(taken) // 2] < patient(0.5), taken
            assert max(taken) < patient(1.5), taken

    asyncio.run(ask())


def test_in_a_flood_a_look_tells_where_new_queries_begin(layout: Layout) -> None:
    """C13: new queries that look bounded have trials of their own; those like known ones are not looked at."""
    lanes = Lanes.of(1, 8, 4, Fleet(Spawner(Configuration(str(layout.root))), 2))
    bounded, product = "ASK { ?s a <x:Node> }", "ASK { ?s a <x:Node> . ?o ?p ?x }"
    assert _first(lanes, bounded) is _first(lanes, product) is lanes.quick
    for text in ("ASK { ?a ?b ?c }", "ASK { ?s a <x:Slow> }"):
        lanes.known.note(_marks(text), quick=False)
    assert (_first(lanes, bounded), _first(lanes, product)) == (lanes.trial, lanes.doubt)
    assert _first(lanes, "ASK { ?s a <x:Slow> }") is lanes.doubt
    lanes.known.note(_marks(product), quick=True)
    assert _first(lanes, product) is lanes.quick


def _marks(text: str) -> Marks:
    return Marks.of(text.encode(), text)


def _first(lanes: Lanes, text: str) -> Lane:
    return lanes.first(_marks(text), text)


def test_a_trial_is_short_when_others_wait_for_theirs(layout: Layout) -> None:
    """C13: what had its share of a processor goes on at once where others wait; alone, or without a share, it stays."""

    async def run() -> None:
        lanes = Lanes.of(1, 8, 4, Fleet(Spawner(Configuration(str(layout.root))), 2))
        for lane in (lanes.trial, lanes.doubt):
            await lane.take(lambda _: None)
            assert not lanes.is_over(lane, 0.05, 0.05)
            assert lanes.is_over(lane, 0.11, 0.05)
            assert not lanes.is_over(lane, 0.11, 0.001)
            assert lanes.is_over(lane, 0.5, 0.001)
            waiting = asyncio.create_task(lane.take(lambda _: None))
            await asyncio.sleep(0)
            assert lanes.is_over(lane, 0.05, 0.05)
            assert not lanes.is_over(lane, 0.05, 0.001)
            assert not lanes.is_over(lane, 0.05, None)
            lane.give_back()
            await waiting
        assert not lanes.is_over(lanes.quick, 0.2, 0.2)
        assert lanes.is_over(lanes.quick, 0.26, 0.2)

    asyncio.run(run())


def test_too_many_are_refused_at_once(layout: Layout) -> None:
    """C13: beyond the processes and the queue the answer is KG509, without waiting."""

    async def ask() -> None:
        async with Readers(layout, processes=1, queue=2) as readers:
            await whole(readers, "ASK {}")
            tasks = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", seconds=1.5)) for n in range(3)]
            await asyncio.sleep(0)
            began = time.monotonic()
            assert await outcome(readers, "ASK {}") == "KG509"
            assert time.monotonic() - began < patient(0.1)
            assert set(await asyncio.gather(*tasks)) <= {"KG503", "KG509"}
            assert await outcome(readers, "ASK {}") == "whole"

    asyncio.run(ask())


def test_slow_requests_are_known_again(layout: Layout) -> None:
    """A request that was slow begins in the lane of the slow when it comes again."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            for found_slow in (False, True):
                task = asyncio.create_task(outcome(readers, ENDLESS, job="slow"))
                await asyncio.sleep(0)
                assert readers.stats().quick == (not found_slow)
                await until(lambda: readers.stats().slow == 1)
                assert readers.cancel("slow")
                assert await task == "KG510"

    asyncio.run(ask())


def test_a_flood_of_new_queries_delays_neither_known_nor_new_quick_ones(layout: Layout) -> None:
    """C13: while ever new queries without end come, known quick ones and new quick ones are answered at once."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            flood = [asyncio.create_task(outcome(readers, _endless(n), seconds=patient(1))) for n in range(8)]
            await asyncio.sleep(patient(0.3))
            taken, anew = [], []
            while not all(task.done() for task in flood):
                began = time.monotonic()
                assert await outcome(readers, f"ASK {{}} # {began}") == "whole"
                taken.append(time.monotonic() - began)
                began = time.monotonic()
                assert await outcome(readers, f"ASK {{ ?s <x:{began}> ?o }}") == "whole"
                anew.append(time.monotonic() - began)
                await asyncio.sleep(0.05)
            assert {await task for task in flood} == {"KG503"}
            assert sorted(taken)[len(taken) // 2] < patient(0.1), taken
            assert sorted(anew)[len(anew) // 2] < patient(0.2), anew

    asyncio.run(ask())


@pytest.mark.skipif(sys.platform != "linux", reason="the threads of a process are listed by Linux alone")
def test_slow_readers_give_way_with_all_their_threads(layout: Layout) -> None:
    """A reader that runs a slow query gives way to others, with each of its threads."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            task = asyncio.create_task(outcome(readers, ENDLESS, job="slow"))
            await until(lambda: readers.stats().slow == 1)
            process = readers.jobs["slow"].process
            assert process is not None
            assert len(_nicenesses(process)) > 1
            # What readers are forked from is told, and does it.
            await until(lambda: set(_nicenesses(process)) == {"10"})
            readers.cancel("slow")
            assert await task == "KG510"

    asyncio.run(ask())


def _nicenesses(process: Process) -> list[str]:
    """Return how nice each thread of a process is."""
    folder = Path(f"/proc/{process.pid}/task")
    return [(thread / "stat").read_text().rpartition(")")[2].split()[_NICE_FIELD] for thread in folder.iterdir()]


def _endless(number: int) -> str:
    """Return a query without end that is like no other."""
    return ENDLESS.replace("?", f"?{'x' * (number + 1)}")


def test_views_neither_give_way_nor_begin_anew(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> None:
    """A view that works for longer than a quick query may goes on as it is, however many queries are slow."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))

    async def ask() -> None:
        async with Readers(layout, processes=1, calls="query.readers.views") as readers:
            own = json.loads(await readers.call("work", {"seconds": 0.0}))
            flood = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", seconds=3)) for n in range(4)]
            found = json.loads(await readers.call("work", {"seconds": 0.6}))
            assert found["niceness"] == own["niceness"]
            assert await asyncio.gather(*flood) == ["KG503"] * 4

    asyncio.run(ask())
