"""Background tasks: their errors are reported, and they end with their owner.

Use `spawn`, or the `Tasks` of an owner, for a task that might never be awaited. If its creator always awaits it,
`asyncio.ensure_future` is enough: the error is raised there.
"""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

Result = TypeVar("Result")


def spawn(work: Coroutine[Any, Any, Result], what: str) -> asyncio.Task[Result]:
    """Start a task that might never be awaited; an error that ends it is reported at once as one of `what`."""
    task = asyncio.create_task(work)
    task.add_done_callback(partial(_over, what))
    return task


class Tasks:
    """The background tasks of one owner, which end with it."""

    def __init__(self) -> None:
        self._running: set[asyncio.Task[Any]] = set()

    def __len__(self) -> int:
        return len(self._running)

    def spawn(self, work: Coroutine[Any, Any, Result], what: str) -> asyncio.Task[Result]:
        """Start a task as `kg.robot.tasks.spawn` does."""
        task = spawn(work, what)
        self.hold(task)
        return task

    def hold(self, task: asyncio.Task[Any]) -> None:
        """Let an existing task end with the owner."""
        self._running.add(task)
        task.add_done_callback(self._running.discard)

    def cancel(self) -> None:
        """Cancel all tasks without waiting."""
        for task in self._running:
            task.cancel()

    async def done(self) -> None:
        """Return when all tasks have finished by themselves."""
        await asyncio.gather(*self._running, return_exceptions=True)


def call_in(loop: asyncio.AbstractEventLoop, call: Callable[..., object], *arguments: object) -> None:
    """Call something in an event loop, from another thread; does nothing if the loop is closed."""
    with suppress(RuntimeError):
        loop.call_soon_threadsafe(call, *arguments)


def _over(what: str, task: asyncio.Task[Any]) -> None:
    if not task.cancelled() and (error := task.exception()) is not None:
        report(what, error)


def report(what: str, error: BaseException) -> None:
    """Report an error to the handler of the event loop, which logs it by default."""
    message = f"{what} failed: {error}"
    asyncio.get_running_loop().call_exception_handler({"message": message, "exception": error})


async def ended(*tasks: asyncio.Future[Any]) -> None:
    """Cancel tasks and return when they have ended, in any way."""
    for task in tasks:
        task.cancel()
    if tasks:
        await asyncio.gather(*tasks, return_exceptions=True)


async def finished(work: Coroutine[Any, Any, Result]) -> Result:
    """Return the result of work that must complete: repeated cancellations of the caller wait for it."""
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
    """Return the result or exception of code of others; cancelling the caller cancels it."""
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
    """Await two things at once: return the result of the first in a tuple, or None if the second finishes earlier.

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
