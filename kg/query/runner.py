"""Run a query and enforce its deadline.

The engine cannot be interrupted. So queries of the owner run in a thread, which is abandoned at the deadline or on
Ctrl-C and ends with the process. Queries of others run in a process that can be killed (`kg.query.readers`).
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import Final, Protocol, TypeVar

from kg.errors import Exit, QueryError

Answer = TypeVar("Answer")

_STACK_BYTES: Final = 256 << 20
"""The engine recurses over the query. Queries that pass `kg.query.guard` need less stack (reserved, not used)."""
_ROOM_SECONDS: Final = 5.0
_ROOM_PAUSE: Final = 0.005
"""Seconds: total wait for address space for a stack, and the interval of the attempts."""
_STARTING: Final = threading.Lock()
"""The size of stacks is a setting of the process, so threads are started one at a time."""


class DeadlineError(QueryError):
    """The query exceeded its deadline (KG503)."""

    exit_code = Exit.TIMEOUT


class Runner(Protocol):
    """Runs `work` and returns its result, or raises its exception."""

    def __call__(self, work: Callable[[], Answer], timeout: float | None) -> Answer:
        """Run `work`; DeadlineError KG503 if it takes more than `timeout` seconds (None: no limit)."""
        ...


def in_thread(work: Callable[[], Answer], timeout: float | None) -> Answer:
    """Run `work` in a thread, so deadlines and Ctrl-C take effect at once.

    Raises DeadlineError: KG503; the thread runs on until the process exits.
    """
    answer: Future[Answer] = Future()

    def run() -> None:
        try:
            answer.set_result(work())
        except BaseException as error:  # noqa: BLE001 - raised again by the waiting thread
            answer.set_exception(error)

    thread = threading.Thread(target=run, daemon=True)
    _start(thread)
    if not wait([answer], timeout).done:
        message = f"the query ran longer than {timeout:g} s"
        raise DeadlineError("KG503", message, hint="Raise `--timeout` or ask less.")
    # Join to release the stack, which matters if address space is limited.
    thread.join()
    return answer.result()


def _start(thread: threading.Thread) -> None:
    """Start a thread with a large stack; raises RuntimeError if there is no address space for it.

    On a busy machine, a joined thread may hold its stack for a moment longer, so another attempt can succeed.
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
