"""Event streams of pages, and their pending events."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, cast

from patience import patient

from kg.server.robot import work
from kg.server.robot.listeners import Listeners
from kg.server.robot.routes import _Events
from kg.server.robot.session import Session
from kg.server.robot.work import Readings
from kg.settings import load

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    import pytest
    from starlette.types import Message

    from kg.robot.driving import Driver


def test_a_page_that_goes_before_it_was_told_anything_is_forgotten() -> None:
    """A page that disconnects while the response headers are sent is removed from the listeners."""

    async def receive() -> Message:
        return {"type": "http.disconnect"}

    async def send(_: Message) -> None:
        await asyncio.Event().wait()

    async def scene() -> int:
        session = Session("memory://nobody", load({}, environment={}))
        answer = _Events(session)
        scope = {"type": "http", "asgi": {"spec_version": "2.3"}}
        await asyncio.wait_for(answer(scope, receive, send), patient(10))
        return len(session.listeners)

    assert asyncio.run(scene()) == 0


class _Reader:
    """Source of values for pages: yields the values put into it."""

    def __init__(self) -> None:
        self.values: asyncio.Queue[dict[str, Any]] = asyncio.Queue()

    async def read(self, _: str) -> AsyncIterator[dict[str, Any]]:
        while True:
            yield await self.values.get()


def test_what_was_read_of_a_robot_that_has_gone_is_not_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A pending value of a lost robot is not sent as a value of the next robot."""
    monkeypatch.setattr(work, "_VALUES_EVERY", 0.01)

    async def scene() -> list[float]:
        listeners = Listeners()
        page = listeners.add()
        page.reads = frozenset({"sensingPose"})
        reading, before, after = Readings(listeners), _Reader(), _Reader()
        reading.follow(cast("Driver", before))
        for x in (1.0, 2.0):
            before.values.put_nowait({"x": x})
        while not before.values.empty():  # noqa: ASYNC110 - it is read in the next turns of the loop
            await asyncio.sleep(0)
        reading.follow(None)
        reading.follow(cast("Driver", after))
        while reading._waiting:  # noqa: ASYNC110 - a turn that comes tells nobody
            await asyncio.sleep(0.005)
        after.values.put_nowait({"x": 3.0})
        told: list[float] = []
        while not told or told[-1] != 3.0:
            event = await asyncio.wait_for(page.waiting.get(), patient(10))
            told += [event["value"]["x"]] if event and event["event"] == "value" else []
        await reading.aclose()
        return told

    assert asyncio.run(asyncio.wait_for(scene(), patient(20))) == [1.0, 3.0]
