"""Tests of processor sharing among long queries."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, cast

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import QueryError
from kg.query.readers.scheduler import Sharing

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.readers.processes import Process


class _Reader:
    """A reader that records its orders."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.nice = False
        self.runs = True
        self.worked = 0.0

    def used(self) -> float:
        return self.worked

    def give_way(self) -> None:
        self.nice = True

    def pause(self) -> None:
        assert self.runs
        self.runs = False

    def resume(self) -> None:
        assert not self.runs
        self.runs = True


class _Shared:
    """Readers that share, with a clock controlled by the test."""

    def __init__(self, slots: int, most: int = 100) -> None:
        self.now = 1000.0
        self.sharing = Sharing(slots, most, lambda: self.now)
        self.readers: list[_Reader] = []

    def add(self, name: str, client: str = "") -> _Reader:
        reader = _Reader(name)
        self.sharing.add(_process(reader), client)
        self.readers.append(reader)
        return reader

    def remove(self, reader: _Reader) -> None:
        self.sharing.remove(_process(reader))
        self.readers.remove(reader)

    def after(self, seconds: float) -> str:
        """Return the names of the running readers after a turn of this length."""
        self.now += seconds
        self.sharing.turn()
        return self.running

    @property
    def running(self) -> str:
        return "".join(reader.name for reader in self.readers if reader.runs)


def _process(reader: _Reader) -> Process:
    return cast("Process", reader)


def _in_a_loop(test: Callable[[], None]) -> None:
    async def run() -> None:
        test()

    asyncio.run(run())


def test_as_many_run_as_there_are_slots() -> None:
    """The others are paused in their process, and continue when a slot is free."""

    def test() -> None:
        shared = _Shared(2)
        readers = [shared.add(name) for name in "abc"]
        assert (shared.running, shared.sharing.size) == ("ab", 3)
        shared.remove(readers[0])
        assert (shared.running, shared.sharing.size) == ("bc", 2)

    _in_a_loop(test)


def test_the_query_that_ran_least_runs_next() -> None:
    """C13: a new long query does not wait for one that has run longer; after equal times they take turns."""

    def test() -> None:
        shared = _Shared(1)
        shared.add("a")
        assert shared.after(5.0) == "a"
        shared.add("b")
        assert shared.running == "b"
        assert shared.after(3.0) == "b"
        assert shared.after(0.5) == "a"
        assert shared.after(2.0) == "b"

    _in_a_loop(test)


def test_queries_that_take_the_same_time_run_one_after_the_other() -> None:
    """Later ones do not delay the first: among equals, each ends after those before it."""

    def test() -> None:
        shared = _Shared(1)
        shared.add("a")
        for name in "bcd":
            shared.add(name)
            assert shared.after(0.02) == "a"

    _in_a_loop(test)


def test_a_reader_that_worked_long_has_a_lower_priority() -> None:
    """Processor time counts, not the time since the start."""

    def test() -> None:
        shared = _Shared(2)
        working, waiting = shared.add("a"), shared.add("b")
        working.worked, waiting.worked = 0.11, 0.01
        shared.after(10.0)
        assert (working.nice, waiting.nice) == (True, False)

    _in_a_loop(test)


def test_clients_share_alike() -> None:
    """A client with one long query gets as much processor time as a client with many."""

    def test() -> None:
        shared = _Shared(1)
        for name in "abcd":
            shared.add(name, "many")
        shared.add("x", "one")
        ran = [shared.after(0.1) for _ in range(100)]
        assert 48 <= ran.count("x") <= 52
        assert min(ran.count(name) for name in "abcd") >= 5

    _in_a_loop(test)


def test_too_many_are_refused() -> None:
    """C13: a long query beyond the limit is refused with KG509, and the others continue."""

    def test() -> None:
        shared = _Shared(1, most=2)
        shared.add("a")
        shared.add("b")
        with pytest.raises(QueryError, match="KG509"):
            shared.add("c")
        assert (shared.running, shared.sharing.size) == ("a", 2)

    _in_a_loop(test)


@given(st.lists(st.tuples(st.sampled_from(["add", "remove", "turn"]), st.integers(0, 9)), max_size=40))
def test_no_reader_is_left_paused_without_need(steps: list[tuple[str, int]]) -> None:
    """After any sequence of steps, as many readers run as possible."""

    def test() -> None:
        shared = _Shared(2, most=6)
        for step, number in steps:
            if step == "add" and len(shared.readers) < 6:
                shared.add(str(number), str(number % 3))
            elif step == "remove" and shared.readers:
                shared.remove(shared.readers[number % len(shared.readers)])
            elif step == "turn":
                shared.after(number / 10)
            assert len(shared.running) == min(2, len(shared.readers))

    _in_a_loop(test)


def test_turns_pass_without_being_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """While more are held than run, turns go on by a timer; afterwards nothing is scheduled."""
    monkeypatch.setattr("kg.query.readers.scheduler._ROUND_SECONDS", 0.001)

    async def run() -> None:
        sharing = Sharing(1, 10)
        readers: list[Any] = [_Reader("a"), _Reader("b")]
        for reader in readers:
            sharing.add(reader, "")
        ran: set[str] = set()
        while len(ran) < 2:
            ran |= {reader.name for reader in readers if reader.runs}
            await asyncio.sleep(0)
        for reader in readers:
            sharing.remove(reader)
        assert sharing._timer is None

    asyncio.run(run())
