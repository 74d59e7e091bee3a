"""Commands with clean-up on signals: a robot is stopped before anything else."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Coroutine
from typing import Any

import typer

from kg.errors import Exit, RobotError


def interruptible(work: Coroutine[Any, Any, None], *, moves: bool = False) -> None:
    """Run something; Ctrl-C or SIGTERM cancels it, waits for its clean-up, and exits with 130.

    So does SIGHUP (a closed terminal), unless the process was started to survive it (nohup). A command that `moves` a
    robot is also ended by Ctrl-Z: the robot has to be stopped, and must not continue by itself later.

    Raises RobotError: KG828 ended by Ctrl-Z.
    """
    try:
        asyncio.run(_cancelled_by_signals(work, moves=moves))
    except (KeyboardInterrupt, asyncio.CancelledError):
        raise typer.Exit(Exit.INTERRUPTED) from None


async def _cancelled_by_signals(work: Coroutine[Any, Any, None], *, moves: bool) -> None:
    task = asyncio.ensure_future(work)
    received: list[signal.Signals] = []

    def cancel(number: signal.Signals) -> None:
        received.append(number)
        task.cancel()

    for number in (signal.SIGTERM, signal.SIGHUP, *([signal.SIGTSTP] if moves else [])):
        if signal.getsignal(number) is not signal.SIG_IGN:
            asyncio.get_running_loop().add_signal_handler(number, cancel, number)
    try:
        await task
    except asyncio.CancelledError:
        if signal.SIGTSTP in received:
            raise RobotError("KG828", "Ctrl-Z ended the command, and the robot was stopped") from None
        raise
