"""Tests of fair access to slots."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kg.errors import QueryError
from kg.query.readers.scheduler import Slots

if TYPE_CHECKING:
    from collections.abc import Sequence


async def _outcomes(slots: Slots, clients: Sequence[str]) -> list[str]:
    """Have each client request a slot while all are held; return who was served and refused, in order."""
    found: list[str] = []

    async def one(client: str) -> None:
        try:
            await slots.take(client, lambda _: None)
        except QueryError as error:
            found.append(f"{client} {error.code}")
        else:
            found.append(client)
            slots.give_back()

    tasks = [asyncio.create_task(one(client)) for client in clients]
    await asyncio.sleep(0)
    slots.give_back()
    await asyncio.gather(*tasks)
    return found


async def _held(slots: int, queue: int) -> Slots:
    """Return slots that are all held."""
    found = Slots(slots, queue)
    for _ in range(slots):
        await found.take("first", lambda _: None)
    return found


def test_few_requests_of_one_client_are_served_in_order() -> None:
    """A freed slot goes to the request that waited longest."""

    async def run() -> None:
        slots = await _held(2, 3)
        order: list[int] = []

        async def one(number: int) -> None:
            await slots.take("client", lambda _: None)
            order.append(number)

        tasks = [asyncio.create_task(one(number)) for number in range(2)]
        await asyncio.sleep(0)
        assert (slots.used, slots.waiting, order) == (2, 2, [])
        for _ in range(2):
            slots.give_back()
        await asyncio.gather(*tasks)
        assert (slots.used, slots.waiting, order) == (2, 0, [0, 1])
        for _ in range(2):
            slots.give_back()
        assert slots.used == 0

    asyncio.run(run())


def test_a_burst_delays_neither_the_newest_nor_the_oldest_for_long() -> None:
    """C13: while many wait, slots go to the newest and the oldest request of a client in turn."""

    async def run() -> None:
        slots = await _held(1, 100)
        order: list[int] = []

        async def one(number: int) -> None:
            await slots.take("client", lambda _: None)
            order.append(number)
            slots.give_back()

        tasks = [asyncio.create_task(one(number)) for number in range(8)]
        await asyncio.sleep(0)
        slots.give_back()
        await asyncio.gather(*tasks)
        assert order == [7, 0, 6, 1, 5, 2, 4, 3]

    asyncio.run(run())


def test_clients_are_served_in_turn() -> None:
    """A client with one request does not wait for all requests of another."""

    async def run() -> None:
        slots = await _held(1, 100)
        assert await _outcomes(slots, [*"aaaabb", "c"]) == [*"abcabaa"]

    asyncio.run(run())


def test_a_full_queue_refuses() -> None:
    """C13: a request beyond the queue is refused with KG509."""

    async def run() -> None:
        slots = await _held(1, 2)
        assert await _outcomes(slots, "aaa") == ["a KG509", "a", "a"]

    asyncio.run(run())


def test_without_a_queue_nothing_waits() -> None:
    """With an empty queue, a request that gets no slot at once is refused."""

    async def run() -> None:
        slots = await _held(1, 0)
        with pytest.raises(QueryError, match="KG509"):
            await slots.take("a", lambda _: None)

    asyncio.run(run())


def test_one_client_cannot_fill_the_queue() -> None:
    """C13: in a full queue the newest request of the client with the most makes room for another client."""

    async def run() -> None:
        slots = await _held(1, 4)
        assert await _outcomes(slots, "aaaabbb") == ["b KG509", "a KG509", "a KG509", "a", "b", "a", "b"]

    asyncio.run(run())


@given(st.lists(st.sampled_from("abc"), max_size=30), st.integers(1, 3), st.integers(0, 8))
def test_every_request_is_served_or_refused(clients: list[str], count: int, queue: int) -> None:
    """For clients in any order: each request ends, as many as fit are served, and all slots are free again."""

    async def run() -> None:
        slots = await _held(count, queue)
        found = await _outcomes(slots, clients)
        assert sorted(one.split()[0] for one in found) == sorted(clients)
        assert sum(" " not in one for one in found) == min(len(clients), queue)
        for _ in range(count - 1):
            slots.give_back()
        assert (slots.used, slots.waiting) == (0, 0)

    asyncio.run(run())


def test_a_wait_that_ends_passes_its_slot_on() -> None:
    """A request that is cancelled when its slot is granted, or ended while it waits, holds no slot."""

    async def run() -> None:
        slots = await _held(1, 10)
        first = asyncio.create_task(slots.take("a", lambda _: None))
        second = asyncio.create_task(slots.take("a", lambda _: None))
        await asyncio.sleep(0)
        slots.give_back()
        first.cancel()
        await second
        slots.give_back()
        assert (slots.used, slots.waiting) == (0, 0)
        places: list[asyncio.Future[None]] = []
        await slots.take("a", places.append)
        waiting = asyncio.create_task(slots.take("a", places.append))
        await asyncio.sleep(0)
        places[0].set_exception(QueryError("KG510", "ended"))
        with pytest.raises(QueryError, match="KG510"):
            await waiting
        slots.give_back()
        assert (slots.used, slots.waiting) == (0, 0)

    asyncio.run(run())
