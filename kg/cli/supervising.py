"""Memory limits: the work runs in a child process, whose abnormal end becomes an error with a code.

The database is written in C++ and Rust, which abort the process on a failed allocation. That cannot be reported from
inside. A killed child leaves the store unchanged.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Final

from kg.errors import Exit, KgError

_SECONDS: Final = 0.1  # seconds between measurements of memory
_SIGNALS: Final = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD}
_ALLOCATING: Final = {signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS, signal.SIGILL, signal.SIGTRAP}
"""Signals by which C++ and Rust end on a failed allocation."""
_WORDS: Final = ("failed to map segment", "can't start new thread", "Cannot allocate memory", "memory allocation of")


class MemoryLimitError(KgError):
    """A command exceeded its memory limit (KG004)."""

    exit_code = Exit.TIMEOUT


def address_space() -> int:
    """Return the address space limit of this process in bytes (`ulimit -v`), 0 without one."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return 0
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return 0 if limit == resource.RLIM_INFINITY else limit


def is_out_of_memory(error: BaseException | None) -> bool:
    """Return whether an error, or one of its causes, is a failed allocation."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        # A C extension failed without a reason: without a limit, that is a defect.
        if isinstance(error, SystemError) and address_space():
            return True
        if any(words in str(error) for words in _WORDS):
            return True
        error = error.__cause__ or error.__context__
    return False


def supervise(most: int = 0) -> None:
    """Return in a child process; in the parent, wait for the child and exit like it.

    With `most`, the child and all its processes may use that many bytes together.

    Raises:
        MemoryLimitError: KG004 the child exceeded the limit, or failed an allocation under `ulimit -v`.
        SystemExit: the exit code of the child.
    """
    if not hasattr(signal, "sigtimedwait") or not Path("/proc/self/smaps_rollup").exists():
        return
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    child = os.fork()
    if child == 0:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        return
    status = _status(child, most)
    if status is None:
        raise MemoryLimitError("KG004", f"the command needs more than {most >> 20:,} MB of memory")
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in _ALLOCATING and address_space():
        limit = f"the limit of {address_space() >> 20:,} MB of address space (ulimit -v)"
        raise MemoryLimitError("KG004", f"the command failed to allocate memory under {limit}")
    raise SystemExit(128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status))


def _status(child: int, most: int) -> int | None:
    """Return the exit status of a child, None if it was killed for exceeding the limit."""
    while True:
        got = signal.sigtimedwait(_SIGNALS, _SECONDS)
        # The terminal signals the child too; signals from processes arrive here only.
        if got is not None and got.si_signo != signal.SIGCHLD and got.si_code <= 0:
            os.kill(child, got.si_signo)
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status
        if most and sum(map(_resident, _family(child))) > most:
            for process in _family(child):
                os.kill(process, signal.SIGKILL)
            os.waitpid(child, 0)
            return None


def _family(process: int) -> Iterator[int]:
    """Yield a process and its descendants."""
    yield process
    try:
        lists = [file.read_text() for file in Path(f"/proc/{process}/task").glob("*/children")]
    except OSError:
        return
    for other in " ".join(lists).split():
        yield from _family(int(other))


def _resident(process: int) -> int:
    """Return the memory of a process in bytes, with its share of shared pages; 0 if it has ended."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) << 10 for line in lines if line.startswith("Pss:"))
