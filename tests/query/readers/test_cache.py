"""Tests of cached responses, and of changing data."""

from __future__ import annotations

import asyncio
import fcntl
import os
import sys
from typing import TYPE_CHECKING

import pytest
from patience import patient
from pyoxigraph import NamedNode
from query.readers.asking import ALL, STREAM, outcome, question, until, whole

from kg.query.readers.cache import AnswerCache, CachedResponse
from kg.query.readers.messages import End, Head
from kg.query.readers.pool import Readers
from kg.store.embedded import EmbeddedStore
from kg.store.layout import create

if TYPE_CHECKING:
    from pathlib import Path

    from kg.store.layout import Layout

pytestmark = pytest.mark.usefixtures("forked")

ADDED = b"<https://example.org/new> <https://example.org/p> <https://example.org/0> .\n"


def kept(size: int, snapshot: str = "1", *, repeatable: bool = True) -> CachedResponse:
    """Return a response of this size."""
    return CachedResponse(Head("rows", "json", snapshot, repeatable=repeatable), b"x" * size, End(1, 0.1))


def add(store: EmbeddedStore) -> None:
    """Add a triple to a store."""
    with store.write("test") as transaction:
        transaction.append(NamedNode("https://example.org/g"), ADDED)


def test_answers_are_kept_within_bounds() -> None:
    """The cache retains recent responses up to its size, and nothing large or not repeatable."""
    cache = AnswerCache(40_000)
    for number in range(20):
        cache.put(str(number).encode(), kept(3000), "1")
        assert cache.stats().bytes <= 40_000
        assert cache.get(b"0", "1") is not None
    assert cache.get(b"1", "1") is None
    assert cache.stats().answers == 9
    cache.put(b"large", kept(5_001), "1")
    cache.put(b"other", kept(10, repeatable=False), "1")
    cache.put(b"old", kept(10, "0"), "1")
    assert all(cache.get(name, "1") is None for name in (b"large", b"other", b"old"))
    assert cache.get(b"0", "2") is None
    assert cache.stats().answers == 0
    assert AnswerCache(0).get(b"0", "1") is None


def test_the_same_answer_comes_from_the_cache(layout: Layout) -> None:
    """The same request on the same data is answered without a reader; hits and misses are counted."""

    async def ask() -> None:
        async with Readers(layout, processes=1, cache=8 << 20) as readers:
            first = await whole(readers, ALL)
            async with readers.ask(question(ALL)) as answer:
                assert answer.end is not None
                assert answer.size == len(first[1])
                assert (answer.head, b"".join([part async for part in answer.parts()]), answer.end) == first
            await whole(readers, ALL, rows=7)
            for _ in range(2):
                await whole(readers, "SELECT (RAND() AS ?x) {}")
            stats = readers.stats().cache
            assert (stats.hits, stats.misses, stats.answers) == (1, 4, 2)
            async with readers.ask(question(STREAM)) as answer:
                await anext(answer.parts())
            assert await outcome(readers, "SELECT") == "KG501"
            assert await outcome(readers, ALL, size=10) == "KG511"
            assert readers.stats().cache.answers == 2

    asyncio.run(ask())


def test_answers_follow_the_data(fresh: EmbeddedStore) -> None:
    """C31: each response is from the data that is current at the request, cached or not, and names it."""

    async def ask() -> None:
        async with Readers(fresh.layout, processes=2, cache=1 << 20) as readers:
            for expected in (12, 13, 13):
                for _ in range(3):
                    head, _, end = await whole(readers, ALL)
                    assert (end.rows, head.snapshot) == (expected, str(fresh.layout.current()))
                if end.rows == 12:
                    add(fresh)
            assert await outcome(readers, ALL, snapshot="1") == "KG512"

    asyncio.run(ask())


def test_what_runs_keeps_its_data(fresh: EmbeddedStore) -> None:
    """A running query keeps its original data and folder to its end, and the next query reads the new data."""

    async def ask() -> None:
        async with Readers(fresh.layout, processes=1) as readers:
            await whole(readers, "ASK {}")
            async with readers.ask(question(STREAM), seconds=patient(20)) as answer:
                parts = answer.parts()
                await anext(parts)
                add(fresh)
                readers.moved()
                assert await anext(parts)
                assert answer.head.snapshot == "1"
                assert fresh.layout.numbers() == [1, 2]
            assert (await whole(readers, ALL))[0].snapshot == "2"

    asyncio.run(ask())


@pytest.mark.skipif(sys.platform != "linux", reason="locks are looked for by removing what is free")
def test_idle_readers_let_go_of_old_data(fresh: EmbeddedStore) -> None:
    """Idle readers follow a change within a second, to free disk space."""

    async def ask() -> None:
        async with Readers(fresh.layout, processes=2) as readers:
            await whole(readers, "ASK {}")
            add(fresh)
            assert fresh.layout.numbers() == [1, 2]
            # A reader releases the old data before it holds the new one.
            await until(lambda: _is_free(fresh.layout.generation(1)) and not _is_free(fresh.layout.generation(2)))
            add(fresh)
            assert fresh.layout.numbers() == [2, 3]

    asyncio.run(ask())


def _is_free(folder: Path) -> bool:
    """Return whether no process holds a generation."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    finally:
        os.close(handle)
    return True


def test_errors_of_the_store_are_told_and_pass(tmp_path: Path) -> None:
    """A reader of a store without data, or with a broken pointer, reports that, and works after a repair."""

    async def ask() -> None:
        layout = create(tmp_path / ".kg")
        async with Readers(layout, processes=1, cache=1 << 20) as readers:
            assert await outcome(readers, ALL) == "KG301"
            layout.pointer.write_text("nonsense")
            assert await outcome(readers, ALL) == "KG303"
            layout.pointer.unlink()
            add(EmbeddedStore.create(layout.root))
            assert await outcome(readers, ALL) == "whole"
            assert set(readers.stats().ended) <= {"retired"}
            assert readers.stats().snapshot == "1"

    asyncio.run(ask())
