"""Where the work of a query happens, and how it is ended.

The engine cannot be interrupted. For the owner's own queries the work runs in a thread that is left behind when
its deadline passes or Ctrl-C comes; it ends with the process. A runner for queries of others starts a process that
it can kill; it takes the same calls.
"""

from __future__ import annotations

import threading
import time
from concurrent.futures import Future, wait
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from kg.errors import Exit, QueryError

if TYPE_CHECKING:
    from collections.abc import Callable

Answer = TypeVar("Answer")

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over the query; what `kg.query.guard` lets through needs less than this (reserved, not used)."""
_ROOM_SECONDS: Final = 5.0
_ROOM_PAUSE: Final = 0.005
"""Seconds: how long room for a stack is waited for, and how often is looked."""
_STARTING: Final = threading.Lock()
"""How large stacks are is one setting of the whole process: it is changed for one thread at a time."""


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
    answer: Future[Answer] = Future()

    def run() -> None:
        try:
            answer.set_result(work())
        except BaseException as error:  # noqa: BLE001 - it is raised where the answer is waited for
            answer.set_exception(error)

    thread = threading.Thread(target=run, daemon=True)
    _start(thread)
    if not wait([answer], timeout).done:
        message = f"the query ran longer than {timeout:g} s"
        raise DeadlineError("KG503", message, hint="Raise `--timeout` or ask less.")
    # Its stack is given back before long, which matters where address space is bounded.
    thread.join()
    return answer.result()


def _start(thread: threading.Thread) -> None:
    """Start a thread with a large stack; raises RuntimeError where there is no room for that.

    A thread that was joined may not have left the processor yet, on a machine that is busy, and holds its stack till
    then: there is room a moment later.
    """
    end = time.monotonic() + _ROOM_SECONDS
    while True:
        with _STARTING:
            size = threading.stack_size(_STACK_BYTES)
            try:
                thread.start()
            except RuntimeError:
                if time.monotonic() > end:
                    raise
            else:
                return
            finally:
                threading.stack_size(size)
        time.sleep(_ROOM_PAUSE)
