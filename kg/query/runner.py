"""Where the work of a query happens, and how it is ended.

The engine cannot be interrupted. For the owner's own queries the work runs in a thread that is left behind when
its deadline passes or Ctrl-C comes; it ends with the process. A runner for queries of others starts a process that
it can kill; it takes the same calls.
"""

from __future__ import annotations

import multiprocessing
import threading
from multiprocessing.pool import ThreadPool
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from kg.errors import Exit, QueryError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["DeadlineError", "Runner", "in_thread"]

Answer = TypeVar("Answer")

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over the query; what `kg.query.guard` lets through needs less than this (reserved, not used)."""


class DeadlineError(QueryError):
    """A query ran longer than it may (KG503)."""

    exit_code = Exit.TIMEOUT


class Runner(Protocol):
    """Runs `work` and returns what it returns, or raises what it raises."""

    def __call__(self, work: Callable[[], Answer], timeout: float | None) -> Answer:
        """Run `work`; DeadlineError KG503 when it takes more than `timeout` seconds (None: no limit)."""
        ...


def in_thread(work: Callable[[], Answer], timeout: float | None) -> Answer:
    """Run `work` in a thread of this process, so that deadlines and Ctrl-C are noticed at once.

    Raises:
        DeadlineError: KG503; the thread goes on until the process ends.
    """
    size = threading.stack_size(_STACK_BYTES)
    try:
        pool = ThreadPool(1)
    finally:
        threading.stack_size(size)
    try:
        return pool.apply_async(work).get(timeout)
    except multiprocessing.TimeoutError as error:
        message = f"the query ran longer than {timeout:g} s"
        raise DeadlineError("KG503", message, hint="Raise `--timeout` or ask less.") from error
    finally:
        pool.terminate()
