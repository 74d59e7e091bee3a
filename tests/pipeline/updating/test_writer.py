"""Tests of the writer process: order, deadline, crashes, other writers, and kills at any moment."""

from __future__ import annotations

import asyncio
import os
import signal
import time
from typing import TYPE_CHECKING, Any

import pytest
from patience import patient
from pipeline.updating.changing import PREFIX

from kg.errors import KgError
from kg.pipeline.updating.writer import Writer
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from pipeline.updating.changing import Bench

LONG = PREFIX + "INSERT { :a :n ?n } WHERE { SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l } }"
"""Takes hours on a few thousand quads."""
MANY = PREFIX + "INSERT DATA { " + " ".join(f":s{number} :p :o{number} ." for number in range(100_000)) + " }"


def played(own: Bench, play: Callable[[Writer], Awaitable[Any]], **options: Any) -> Any:
    """Run a function with a writer of a store."""

    async def main() -> Any:
        async with Writer(own.store.layout, own.settings, **options) as writer:
            return await play(writer)

    return asyncio.run(main())


async def code_of(change: Awaitable[Any]) -> str:
    """Return the error code of a change."""
    with pytest.raises(KgError) as caught:
        await change
    return caught.value.code


def much(own: Bench, number: int = 3000) -> None:
    """Write this number of quads into a store."""
    own.update("INSERT DATA { " + " ".join(f":s{one} :p :o{one} ." for one in range(number)) + " }")


def test_changes_are_made_in_order_and_rules_follow(own: Bench) -> None:
    """Each has its own snapshot, in the order of the requests; the settings are those given."""

    async def play(writer: Writer) -> list[Any]:
        updates = [writer.update(f"{PREFIX} INSERT DATA {{ :n{one} :next :n{one + 1} }}") for one in range(4)]
        graph = writer.put_graph("urn:test:g", b"<urn:test:n4> <urn:test:next> <urn:test:n5> .", "text/turtle")
        return await asyncio.gather(*updates, graph, writer.delete_graph("urn:test:g"))

    found = played(own, play)
    assert [one.snapshot for one in found] == ["1", "2", "3", "4", "5", "6"]
    assert [one.inferred for one in found] == [3, 6, 10, 15, 21, 15]
    assert found[4].created


def test_a_runaway_update_is_killed_at_its_deadline(own: Bench) -> None:
    """The store is unchanged, and another process makes the next update."""
    much(own)

    async def play(writer: Writer) -> tuple[str, float, str]:
        began = time.monotonic()
        code = await code_of(writer.update(LONG, seconds=1))
        elapsed = time.monotonic() - began
        return code, elapsed, (await writer.update(PREFIX + "INSERT DATA { :x :y :z }")).snapshot

    code, elapsed, snapshot = played(own, play)
    assert (code, snapshot) == ("KG503", "2")
    assert elapsed < patient(20)
    assert own.store.layout.numbers() == [2]


def test_an_update_that_is_left_is_ended(own: Bench) -> None:
    """A caller that stops waiting cancels the work, and those waiting are served."""
    much(own)

    async def play(writer: Writer) -> str:
        left = asyncio.create_task(writer.update(LONG))
        await asyncio.sleep(0.5)
        behind = asyncio.create_task(writer.update(PREFIX + "INSERT DATA { :x :y :z }", seconds=patient(60)))
        await asyncio.sleep(0)
        left.cancel()
        return (await behind).snapshot

    assert played(own, play) == "2"


def test_too_many_do_not_wait(own: Bench) -> None:
    """Those beyond the queue are refused; a deadline counts while waiting."""
    much(own)

    async def play(writer: Writer) -> list[str]:
        first = asyncio.create_task(code_of(writer.update(LONG, seconds=3)))
        await asyncio.sleep(0)
        second = asyncio.create_task(code_of(writer.update(LONG, seconds=1)))
        await asyncio.sleep(0)
        third = await code_of(writer.update(LONG, seconds=1))
        return [await first, await second, third]

    assert played(own, play, queue=1) == ["KG503", "KG503", "KG509"]


def test_a_build_that_writes_is_told(own: Bench) -> None:
    """While another process holds the lock, changes are refused; afterwards they are made."""

    async def play(writer: Writer) -> tuple[str, str]:
        with own.store.write("kg build src"):
            code = await code_of(writer.update(PREFIX + "INSERT DATA { :x :y :z }"))
        return code, (await writer.update(PREFIX + "INSERT DATA { :x :y :z }")).snapshot

    assert played(own, play) == ("KG302", "1")


def test_memory_is_capped(own: Bench) -> None:
    """A change that needs more memory than allowed fails alone."""
    own.update("INSERT DATA { :x :p :it }")
    twice = " ".join(f"BIND(CONCAT(?v{one}, ?v{one}) AS ?v{one + 1})" for one in range(40))
    text = f'{PREFIX} INSERT {{ :a :p ?v40 }} WHERE {{ BIND("much" AS ?v0) {twice} }}'

    async def play(writer: Writer) -> tuple[str, str]:
        code = await code_of(writer.update(text, seconds=patient(120)))
        return code, (await writer.update(PREFIX + "INSERT DATA { :x :y :z }")).snapshot

    code, snapshot = played(own, play, memory=2 << 30)
    assert code in {"KG507", "KG568"}
    assert snapshot == "2"


@pytest.mark.parametrize("seconds", [0.2, 0.8, 1.6])
def test_killed_in_the_middle_of_a_load_all_or_nothing_is_there(own: Bench, seconds: float) -> None:
    """Of 100,000 triples whose writer is killed (SIGKILL), all or none are there, and the store is writable."""
    own.update("INSERT DATA { :before :p :it }")

    async def play(writer: Writer) -> None:
        await writer.update(PREFIX + "INSERT DATA { :warm :p :it }")
        task = asyncio.create_task(writer.update(MANY, seconds=patient(120)))
        await asyncio.sleep(seconds)
        assert writer.process is not None
        os.kill(writer.process, signal.SIGKILL)
        try:
            await task
        except KgError as error:
            assert error.code == "KG568"  # noqa: PT017 - it may also have been made before

    played(own, play)
    reopened = EmbeddedStore(own.store.layout)
    with reopened.read() as snapshot:
        assert snapshot.count() in {2, 100_002}
    after = own.update("INSERT DATA { :after :p :it }")
    assert after.added == 1
    assert own.store.layout.numbers() == [int(after.snapshot)]
