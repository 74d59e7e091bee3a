"""Tests of requests that are ended, and of what remains of them."""

from __future__ import annotations

import asyncio
import itertools
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from patience import patient
from query.readers.asking import (
    ALL,
    ENDLESS,
    FORMATS,
    STREAM,
    descendants,
    outcome,
    program,
    question,
    until,
    whole,
)

from kg.errors import Exit, KgError
from kg.query.formats import BOOLEAN_FORMATS, GRAPH_FORMATS, SOLUTION_FORMATS
from kg.query.readers.pool import Readers

if TYPE_CHECKING:
    from kg.store.layout import Layout

linux = pytest.mark.skipif(sys.platform != "linux", reason="processes are looked up in /proc")

NASTY = [
    ENDLESS,
    # With few of the rows: if all were retained, a fast machine would reach the memory limit first.
    """SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(STRLEN(CONCAT(STR(?c), STR(?f), STR(?i))) < 4) }
         ORDER BY ?i ?a""",
    # As in Apache Jena's issue 3044, where the deadline was not checked inside OPTIONAL and NOT EXISTS.
    """SELECT * { ?a ?b ?c OPTIONAL { ?d ?e ?f FILTER NOT EXISTS {
         ?g ?h ?i . ?j ?k ?l . ?m ?n ?o FILTER(?i = ?a && ?l = ?zz) } } FILTER(?e = ?nothing) }""",
    "PREFIX ex: <https://example.org/> SELECT (COUNT(*) AS ?n) { ?a (ex:p/ex:q)* ?b . ?c (ex:p|ex:q)* ?d }",
    'SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(REGEX(CONCAT(STR(?a), STR(?f), STR(?i)), "(a+)+$")) }',
    "SELECT DISTINCT ?a ?f ?i { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(?a = ?i) }",
    "SELECT ?a (GROUP_CONCAT(?f) AS ?x) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } GROUP BY ?a HAVING(COUNT(*) < 0)",
    "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f MINUS { ?a ?h ?i . ?j ?k ?f . ?l ?m ?n } }",
    "SELECT * { { SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } OFFSET 900000000 } ?x ?y ?z }",
    "CONSTRUCT { ?a ?b ?c } { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(?a = ?zz) }",
    "ASK { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i FILTER(STRLEN(CONCAT(STR(?a), STR(?f), STR(?i))) < 0) }",
]


async def working() -> float:
    """Return the processor seconds that descendants of this process use within half a second."""
    before = descendants()
    await asyncio.sleep(0.5)
    spent = sum(ticks - before.get(pid, ticks) for pid, ticks in descendants().items())
    return spent / os.sysconf("SC_CLK_TCK")


def test_deadline_holds(layout: Layout) -> None:
    """C8: each of eleven expensive queries ends at its deadline, with the exit code of timeouts, and its work stops."""
    seconds = 1.0

    async def ended(readers: Readers, text: str) -> float:
        began = time.monotonic()
        with pytest.raises(KgError) as caught:
            await whole(readers, text, seconds=seconds)
        assert (caught.value.code, caught.value.exit_code) == ("KG503", Exit.TIMEOUT), text
        return time.monotonic() - began

    async def ask() -> None:
        async with Readers(layout, processes=6) as readers:
            await whole(readers, "ASK {}")
            taken = await asyncio.gather(*(ended(readers, text) for text in NASTY))
            assert max(taken) < seconds + patient(0.5)
            assert await outcome(readers, "ASK {}") == "whole"
            if sys.platform == "linux":
                # Killed processes may not have exited yet, and new readers may still be opening the store.
                async with asyncio.timeout(patient(10)):
                    while await working() >= 0.4:
                        pass

    asyncio.run(ask())


def test_deadline_counts_waiting(layout: Layout) -> None:
    """C8: a request that waits for a reader until the deadline gets its error then."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            tasks = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", seconds=8)) for n in range(3)]
            await asyncio.sleep(0.8)
            began = time.monotonic()
            assert await outcome(readers, f"{ENDLESS} # late", seconds=1) == "KG503"
            assert time.monotonic() - began < 1 + patient(0.5)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            assert readers.jobs == {}

    asyncio.run(ask())


BODIES = [
    *(("SELECT * { ?s ?p ?o }", "rows", name) for name in SOLUTION_FORMATS),
    *(("CONSTRUCT WHERE { ?s ?p ?o }", "graph", name) for name in GRAPH_FORMATS),
    *(("ASK { ?s ?p ?o }", "boolean", name) for name in BOOLEAN_FORMATS),
]


async def broken(readers: Readers, how: str, row: int, body: tuple[str, str, str], seconds: float) -> str:
    """Return the code of the error of a sabotaged request, `END` if it seemed complete."""
    text, kind, name = body
    told = {"cancel": "hang", "deadline": "hang"}.get(how, how)
    job = f"{how}-{row}-{name}-{kind}"
    asked = question(f"{text} # {told}@{row}", {kind: name}, size=2000 if how == "size" else None)
    try:
        async with readers.ask(asked, seconds=seconds if how == "deadline" else patient(20), job=job) as answer:
            if how == "cancel":
                asyncio.get_running_loop().call_later(0.1, readers.cancel, job)
            async for _ in answer.parts():
                pass
            return "END" if answer.end is not None else "nothing"
    except KgError as error:
        return error.code


@pytest.mark.parametrize(
    ("how", "code"),
    [
        ("crash", "KG508"),
        ("abort", "KG507"),
        ("memory", "KG507"),
        ("engine", "KG506"),
        ("disk", "KG303"),
        ("deadline", "KG503"),
        ("cancel", "KG510"),
        ("size", "KG511"),
    ],
)
def test_no_end_behind_a_broken_body(layout: Layout, how: str, code: str) -> None:
    """C7: in every format, an error at row 0, 1 or n ends the response with the error and never with an end."""

    async def ask() -> None:
        async with Readers(layout, processes=8, queue=100, program=program("sabotaged.py")) as readers:
            rows = (0, 1, 600)
            asked = [(row, body) for row, body in itertools.product(rows, BODIES) if body[1] != "boolean" or row == 0]
            if how == "size":
                asked = [(row, body) for row, body in asked if row == 0 and body[1] != "boolean"]
            if how == "cancel":
                asyncio.get_running_loop().call_later(1.5, lambda: [readers.cancel(job) for job in tuple(readers.jobs)])
            found = await asyncio.gather(*(broken(readers, how, row, body, 1.5) for row, body in asked))
            assert {(one, row, body) for one, (row, body) in zip(found, asked, strict=True) if one != code} == set()
            assert await outcome(readers, ALL) == "whole"

    asyncio.run(ask())


def test_cancel(layout: Layout) -> None:
    """C15: a job is cancelled by its identity, waiting or running, repeatedly; identities cannot be guessed."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            tasks = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}", job=str(n))) for n in range(4)]
            await asyncio.sleep(0.7)
            assert sorted(readers.jobs) == ["0", "1", "2", "3"]
            assert all(readers.cancel(identity) for identity in tuple(readers.jobs))
            assert await asyncio.wait_for(asyncio.gather(*tasks), patient(1)) == ["KG510"] * 4
            assert not readers.cancel("0")
            async with readers.ask(question("ASK {}")) as answer:
                assert len(answer.job.identity) >= 20
            async with readers.ask(question(STREAM), job="twice"):
                assert await outcome(readers, "ASK {}", job="twice") == "KG505"

    asyncio.run(ask())


def test_who_leaves_frees_the_reader(layout: Layout) -> None:
    """C14: if the client's task is cancelled, waiting or running, or leaves early, its reader is free at once."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            tasks = [asyncio.create_task(whole(readers, f"{ENDLESS} # {n}", seconds=60)) for n in range(5)]
            await asyncio.sleep(0.5)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            async with readers.ask(question(STREAM)):
                pass
            stats = readers.stats()
            assert (stats.quick, stats.long, stats.waiting, readers.jobs) == (0, 0, 0, {})
            began = time.monotonic()
            assert await outcome(readers, "ASK {}") == "whole"
            assert time.monotonic() - began < patient(1)
            assert readers.stats().ended["left"] >= 1

    asyncio.run(ask())


def test_cancelled_at_any_moment(layout: Layout) -> None:
    """C14: whenever the client's task is cancelled, its slot and its reader are free afterwards."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            for step in range(14):
                task = asyncio.create_task(whole(readers, ENDLESS if step % 2 else STREAM))
                await asyncio.sleep(step * 0.03)
                task.cancel()
                await asyncio.gather(task, return_exceptions=True)
                stats = readers.stats()
                assert (stats.quick, stats.long, stats.waiting) == (0, 0, 0)
            assert await outcome(readers, "ASK {}") == "whole"

    asyncio.run(ask())


@linux
def test_nothing_is_left(layout: Layout) -> None:
    """No process and no task outlives the pool, whatever ran when it was closed."""

    async def ask() -> None:
        tasks = []
        async with Readers(layout, processes=2) as readers:
            await whole(readers, "ASK {}")
            tasks = [asyncio.create_task(outcome(readers, f"{ENDLESS} # {n}")) for n in range(6)]
            await until(lambda: len(descendants()) >= 4)
        assert await asyncio.wait_for(asyncio.gather(*tasks), patient(1)) == ["KG510"] * 6
        assert asyncio.all_tasks() == {asyncio.current_task()}

    before = set(descendants())
    files = len(list(Path("/proc/self/fd").iterdir()))
    asyncio.run(ask())
    assert set(descendants()) <= before
    assert len(list(Path("/proc/self/fd").iterdir())) <= files


OWNER = """
import asyncio, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from query.readers.asking import ENDLESS, whole
from kg.query.readers.pool import Readers
from kg.store.layout import Layout

async def main():
    async with Readers(Layout(Path(sys.argv[1]))) as readers:
        await whole(readers, "ASK {}")
        task = asyncio.create_task(whole(readers, ENDLESS))
        await asyncio.sleep(0.5)
        print("running", flush=True)
        await task

asyncio.run(main())
"""


@linux
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT])
def test_readers_end_with_their_owner(layout: Layout, number: signal.Signals) -> None:
    """However the owner of readers exits, they exit too, without output on the terminal."""
    tests = str(next(path for path in sys.path if path.endswith("tests")))
    with subprocess.Popen(
        [sys.executable, "-c", OWNER, str(layout.root), tests],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as owner:
        assert owner.stdout is not None
        assert owner.stdout.readline() == "running\n"
        asyncio.run(until(lambda: len(descendants(owner.pid)) >= 3))
        left = set(descendants(owner.pid))
        owner.send_signal(number)
        owner.wait(patient(5))
        asyncio.run(until(lambda: not left & set(descendants(1))))
        assert owner.stderr is not None
        assert "forkserver" not in owner.stderr.read()


@linux
def test_readers_come_back(layout: Layout) -> None:
    """A killed reader or fork server is replaced; other clients do not notice."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            assert await outcome(readers, "ASK {}") == "whole"
            for _ in range(2):
                killed = descendants().keys() - before
                for pid in killed:
                    with suppress(ProcessLookupError):  # an earlier one in the list may have taken it along
                        os.kill(pid, signal.SIGKILL)
                await until(lambda: not killed & descendants().keys())  # noqa: B023 - awaited here
                assert await outcome(readers, "ASK {}") == "whole"

    before = descendants().keys()
    asyncio.run(ask())


def test_readers_that_cannot_start(layout: Layout) -> None:
    """If no reader can be started, each request fails at once, and closing works."""

    async def ask() -> None:
        for command in ((sys.executable, "-c", "raise SystemExit(3)"), ("/no/such/program",)):
            async with Readers(layout, program=command) as readers:
                for _ in range(3):
                    assert await outcome(readers, "ASK {}", formats=FORMATS) == "KG508"

    asyncio.run(asyncio.wait_for(ask(), patient(10)))


SILENT = """
import socket

orders, held = socket.socket(fileno=0), []
while (order := socket.recv_fds(orders, 64, 2))[0]:
    held += order[1]
"""
"""Fork server that accepts orders, but starts no readers."""


def test_readers_that_never_start(layout: Layout) -> None:
    """Deadlines and cancellation work while a reader starts; nothing is left running."""

    async def ask() -> None:
        async with Readers(layout, processes=2, program=(sys.executable, "-c", SILENT)) as readers:
            began = time.monotonic()
            assert await outcome(readers, "ASK {}", seconds=0.5) == "KG503"
            asking = asyncio.create_task(outcome(readers, "ASK {}", seconds=60, job="cancelled"))
            await asyncio.sleep(0.2)
            assert readers.cancel("cancelled")
            assert await asking == "KG510"
            leaving = asyncio.create_task(outcome(readers, "ASK {}", seconds=60))
            await asyncio.sleep(0.2)
            leaving.cancel()
            await asyncio.wait([leaving])
            assert leaving.cancelled()
            assert time.monotonic() - began < patient(5)
            assert not readers.jobs

    asyncio.run(asyncio.wait_for(ask(), patient(10)))
