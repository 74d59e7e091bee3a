"""Tests of the limits of readers, and of crashes."""

from __future__ import annotations

import asyncio
import json
import os
import re
import resource
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest
from patience import patient
from query.readers.asking import ALL, descendants, outcome, program, until, whole

from kg.errors import KgError
from kg.pipeline.updating import child as updating
from kg.query.readers import forkserver
from kg.query.readers.pool import Readers

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

    from kg.store.layout import Layout

PRODUCT = "SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i } ORDER BY ?i ?a"


@pytest.mark.parametrize("module", [forkserver, updating])
def test_readers_run_where_memory_cannot_be_bounded(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """MacOS refuses a limit on address space: processes then run without one instead of failing."""

    def refuse(*_: object) -> None:
        raise ValueError("current limit exceeds maximum limit")

    monkeypatch.setattr(resource, "setrlimit", refuse)
    monkeypatch.setattr(sys, "platform", "darwin")
    module._cap_memory(300 << 20)
    monkeypatch.setattr(sys, "platform", "linux")
    with pytest.raises(ValueError, match="exceeds"):
        module._cap_memory(300 << 20)


@pytest.mark.skipif(sys.platform != "linux", reason="the address space is bounded on Linux")
def test_memory_cap(
    layout: Layout, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """C11: a query that needs too much memory is KG507. The next one is answered, without output or files left."""

    async def ask() -> None:
        async with Readers(layout, processes=1, memory=300 << 20) as readers:
            assert await outcome(readers, PRODUCT, seconds=patient(60)) == "KG507"
            began = time.monotonic()
            assert await outcome(readers, "ASK {}") == "whole"
            assert time.monotonic() - began < patient(1)
            assert readers.stats().ended["memory"] == 1

    monkeypatch.chdir(tmp_path)
    asyncio.run(ask())
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


DEEP: Final[dict[str, Callable[[int], str]]] = {
    "braces": lambda n: "ASK " + "{" * n + "}" * n,
    "parens": lambda n: "ASK {FILTER(" + "(" * n + "true" + ")" * n + ")}",
    "nots": lambda n: "ASK {FILTER(" + "!" * n + "true)}",
    "paths": lambda n: "ASK {?s " + "(" * n + "<a:a>" + ")*" * n + " ?o}",
    "unions": lambda n: "ASK {" + "{}UNION" * n + "{}}",
}


@pytest.mark.parametrize("what", DEEP)
@pytest.mark.parametrize("depth", [5_000, 20_000])
def test_deep_queries_are_refused(layout: Layout, what: str, depth: int) -> None:
    """C12: deep nesting and long chains are KG516 with the place, and the reader continues."""

    async def ask() -> None:
        async with Readers(layout, processes=1) as readers:
            with pytest.raises(KgError) as caught:
                await whole(readers, DEEP[what](depth))
            assert caught.value.code == "KG516"
            assert caught.value.place is not None
            deeper = "the query nests deeper than 500"
            assert caught.value.message == (
                "the query has more than 5000 operators and patterns" if what == "unions" else deeper
            )
            assert set(readers.stats().ended) <= {"retired"}

    asyncio.run(ask())


def test_without_the_guard_only_a_reader_ends(layout: Layout, capfd: pytest.CaptureFixture[str]) -> None:
    """C12: deep queries without the guard overflow the stack of a reader only; the next query is answered."""

    async def ask() -> None:
        async with Readers(layout, processes=2, program=program("unguarded.py")) as readers:
            assert await outcome(readers, DEEP["braces"](110_000)) == "KG508"
            assert await outcome(readers, ALL) == "whole"
            assert readers.stats().ended["crashed"] >= 1

    asyncio.run(ask())
    assert capfd.readouterr() == ("", "")


def test_a_megabyte_of_hostile_text_costs_only_a_reader(layout: Layout) -> None:
    """C12: expensive texts are parsed in a reader. Meanwhile others are answered, and the deadline holds."""
    texts = [
        "SELECT * {" + "<" * 1_000_000,
        "'" * 1_000_000,
        "a:" * 500_000,
        "((<" * 300_000,
        "SELEC " + "x " * 500_000,
    ]

    async def ask() -> None:
        async with Readers(layout, processes=2) as readers:
            await whole(readers, "ASK {}")
            hostile = [asyncio.create_task(outcome(readers, text, seconds=3)) for text in texts]
            slowest = 0.0
            while not all(task.done() for task in hostile):
                began = time.monotonic()
                assert await outcome(readers, "ASK {}") == "whole"
                slowest = max(slowest, time.monotonic() - began)
                await asyncio.sleep(0.05)
            assert {await task for task in hostile} <= {"KG501", "KG503", "KG516"}
            assert slowest < patient(1)

    asyncio.run(ask())


@pytest.mark.skipif(sys.platform != "linux", reason="limits of processes are read in /proc")
def test_limits_are_set(layout: Layout) -> None:
    """C11: a reader has a memory limit, leaves no core file, and has a session without a terminal."""

    def look() -> None:
        servers = descendants().keys() - before
        told = [Path(f"/proc/{pid}/limits").read_text() for pid in servers]
        capped = [text for text in told if not re.search(r"Max address space\s+unlimited", text)]
        assert len(capped) == len(told) - 1
        assert all("Max core file size        0 " in text for text in capped)
        assert all(os.getsid(pid) != os.getsid(0) for pid in servers)

    async def ask() -> None:
        async with Readers(layout, processes=1, memory=1 << 30) as readers:
            # One for a request and one in reserve; both are ready.
            await until(lambda: readers.stats().idle == 2)
            look()

    before = descendants().keys()
    asyncio.run(ask())


def test_threads_of_views(layout: Layout, monkeypatch: pytest.MonkeyPatch) -> None:
    """Threads of a view reserve no more than usual; a reader with a running thread gets no other request."""
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))

    async def ask() -> None:
        async with Readers(layout, processes=1, calls="query.readers.views") as readers:
            assert json.loads(await readers.call("stack", {}))["bytes"] == 0
            left = json.loads(await readers.call("leave", {}))["process"]
            assert json.loads(await readers.call("work", {"seconds": 0}))["process"] != left
            assert readers.stats().ended["retired"] == 1
            with pytest.raises(KgError) as failed:
                await readers.call("fail", {})
            assert str(json.loads(await readers.call("work", {"seconds": 0}))["process"]) != failed.value.message
            assert readers.stats().ended == {"retired": 2}

    asyncio.run(ask())
