"""Tasks that report their errors."""

from __future__ import annotations

import asyncio

import pytest

from kg.robot.tasks import Tasks, ended, finished, spawn


def test_an_error_that_nobody_awaits_is_told_at_once(caplog: pytest.LogCaptureFixture) -> None:
    """An error of a task is logged at once with its work, even if the task is still referenced; a normal end is not."""

    async def fail() -> None:
        raise ValueError("no such thing")

    async def scene() -> str:
        failing, waiting = spawn(fail(), "looking"), spawn(asyncio.sleep(60), "waiting")
        await asyncio.sleep(0.01)
        told = caplog.text
        await ended(failing, waiting)
        return told

    assert "looking failed: no such thing" in asyncio.run(scene())
    assert "waiting" not in caplog.text


def test_tasks_end_with_their_owner(caplog: pytest.LogCaptureFixture) -> None:
    """Running work of an owner is counted, awaited or cancelled with it, and its errors are reported."""

    async def fail() -> None:
        raise ValueError("no such thing")

    async def scene() -> tuple[int, int, bool]:
        tasks = Tasks()
        tasks.spawn(fail(), "looking")
        waiting = asyncio.ensure_future(asyncio.sleep(60))
        tasks.hold(waiting)
        begun = len(tasks)
        await asyncio.sleep(0.01)
        going = len(tasks)
        tasks.cancel()
        await tasks.done()
        return begun, going, waiting.cancelled()

    assert asyncio.run(scene()) == (2, 1, True)
    assert "looking failed: no such thing" in caplog.text


def test_what_has_to_come_to_its_end_does() -> None:
    """Uninterruptible work completes despite repeated cancellation of its waiter, which is raised afterwards."""

    async def scene() -> list[str]:
        told: list[str] = []
        go = asyncio.Event()

        async def work() -> str:
            await go.wait()
            told.append("done")
            return "well"

        waiting = asyncio.ensure_future(finished(work()))
        for _ in range(3):
            await asyncio.sleep(0)
            waiting.cancel()
        await asyncio.sleep(0)
        assert not waiting.done()
        go.set()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        told.append(await finished(work()))
        return told

    assert asyncio.run(scene()) == ["done", "done", "well"]
