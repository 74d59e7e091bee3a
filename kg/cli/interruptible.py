"""Commands that clean up when they are ended by a signal: a robot is stopped before anything else."""

from __future__ import annotations

import asyncio
import signal
from typing import TYPE_CHECKING, Any

import typer

from kg.errors import Exit

if TYPE_CHECKING:
    from collections.abc import Coroutine

__all__ = ["interruptible"]


def interruptible(work: Coroutine[Any, Any, None]) -> None:
    """Run something; Ctrl-C, and a polite kill, cancel it, wait until it has cleaned up, and end with 130.

    So does a terminal that is closed, unless the process was started to outlive it (nohup).
    """
    try:
        asyncio.run(_cancelled_by_signals(work))
    except (KeyboardInterrupt, asyncio.CancelledError):
        raise typer.Exit(Exit.INTERRUPTED) from None


async def _cancelled_by_signals(work: Coroutine[Any, Any, None]) -> None:
    task = asyncio.ensure_future(work)
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            asyncio.get_running_loop().add_signal_handler(number, task.cancel)
    await task
