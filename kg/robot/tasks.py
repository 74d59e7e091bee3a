"""Tasks: work that goes on beside, whose errors are told, and ends with who began it.

Work that nobody may ever await is begun by `spawn`, or by the `Tasks` of the one that it ends with. Where the one who
begins it also awaits it, whatever happens, `asyncio.ensure_future` is enough: the error is raised there.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Coroutine
from functools import partial
from typing import Any, TypeVar

Result = TypeVar("Result")


def spawn(work: Coroutine[Any, Any, Result], what: str) -> asyncio.Task[Result]:
    """Begin work that nobody may ever await; an error that ends it is reported at once as that of `what`."""
    task = asyncio.create_task(work)
    task.add_done_callback(partial(_over, what))
    return task


class Tasks:
    """The work that goes on for one owner, and ends with it."""

    def __init__(self) -> None:
        self._running: set[asyncio.Task[Any]] = set()

    def __len__(self) -> int:
        return len(self._running)

    def spawn(self, work: Coroutine[Any, Any, Result], what: str) -> asyncio.Task[Result]:
        """Begin work as `kg.robot.tasks.spawn` does."""
        task = spawn(work, what)
        self.hold(task)
        return task

    def hold(self, task: asyncio.Task[Any]) -> None:
        """Let a task end with the owner that somebody else has begun."""
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    def cancel(self) -> None:
        """End all of it, without waiting for that."""
        for task in self._running:
            task.cancel()

    async def done(self) -> None:
        """Return when all of it is done, by itself."""
        await asyncio.gather(*self._running, return_exceptions=True)


def _over(what: str, task: asyncio.Task[Any]) -> None:
    if not task.cancelled() and (error := task.exception()) is not None:
        report(what, error)


def report(what: str, error: BaseException) -> None:
    """Report an error to the handler of the loop, which logs it where nobody has set another."""
    told = f"{what} failed: {error}"
    asyncio.get_running_loop().call_exception_handler({"message": told, "exception": error})


async def ended(*tasks: asyncio.Future[Any]) -> None:
    """Cancel tasks and return when they have ended, however they do."""
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.gather(*tasks, return_exceptions=True)


async def finished(work: Coroutine[Any, Any, Result]) -> Result:
    """Return what work gives that has to come to its end: who is impatient, and cancels us again and again, waits."""
    task = asyncio.ensure_future(work)
    cancelled: asyncio.CancelledError | None = None
    while not task.done():
        try:
            await asyncio.wait((task,))
        except asyncio.CancelledError as again:
            cancelled = again
    if cancelled is not None:
        raise cancelled
    return task.result()


async def outcome(work: Awaitable[Result]) -> Result | BaseException:
    """Return what code that is not ours gives, or what it raised, whatever that is; cancelling us cancels it."""
    task = asyncio.ensure_future(work)
    try:
        await asyncio.wait({task})
    except asyncio.CancelledError:
        task.cancel()
        raise
    if task.cancelled():
        return asyncio.CancelledError()
    return task.exception() or task.result()


async def first(one: Awaitable[Result], other: Awaitable[Any]) -> tuple[Result] | None:
    """Await two things at a time: return in a tuple what the one gives, or None when the other is there before it.

    The later one is cancelled; an error of either is raised.
    """
    one_task, other_task = asyncio.ensure_future(one), asyncio.ensure_future(other)
    try:
        await asyncio.wait({one_task, other_task}, return_when=asyncio.FIRST_COMPLETED)
        if one_task.done():
            return (one_task.result(),)
        other_task.result()
        return None
    finally:
        await ended(one_task, other_task)
