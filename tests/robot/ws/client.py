"""Shared by tests of both protocols, as clients of a bridge."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager
from typing import TYPE_CHECKING

from patience import patient

from kg.robot.connecting import connect

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Callable

    from kg.robot.connection import ComputationGraph, Connection, Received, Subscription

__all__ = ["first", "joined", "seen", "until"]


@asynccontextmanager
async def joined(address: str) -> AsyncIterator[Connection]:
    """Join as a client of a bridge."""
    connection = await connect(address, name="/kg")
    try:
        yield connection
    finally:
        await connection.aclose()


async def until(true: Callable[[], bool]) -> None:
    """Return when a condition holds."""
    async with asyncio.timeout(patient(5)):
        while not true():  # noqa: ASYNC110 - the server runs in other threads
            await asyncio.sleep(0.005)


async def first(subscription: Subscription, number: int) -> list[Received]:
    """Return the first messages, up to a number."""
    found = []
    async with asyncio.timeout(patient(5)):
        async for one in subscription:
            found.append(one)
            if len(found) == number:
                break
    return found


async def seen(connection: Connection, true: Callable[[ComputationGraph], bool]) -> ComputationGraph:
    """Return the first graph that satisfies a condition."""
    async with asyncio.timeout(patient(5)):
        async for graph in connection.changes():
            if true(graph):
                return graph
    raise AssertionError
