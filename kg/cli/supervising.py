"""Limits of memory: the work runs in a child process, and what ends that process becomes an error with a code.

The database is written in C++ and Rust, which end their process where an allocation fails. Nothing inside that process
can report it. A killed child leaves the store as it was.
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

_SECONDS: Final = 0.1  # how often memory is measured
_SIGNALS: Final = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD}
_ALLOCATING: Final = {signal.SIGABRT, signal.SIGSEGV, signal.SIGBUS, signal.SIGILL, signal.SIGTRAP}
"""What C++ and Rust end by where an allocation fails."""
_WORDS: Final = ("failed to map segment", "can't start new thread", "Cannot allocate memory", "memory allocation of")


class MemoryLimitError(KgError):
    """A command needs more memory than it may use (KG004)."""

    exit_code = Exit.TIMEOUT


def address_space() -> int:
    """Return the bytes of address space that this process may use (`ulimit -v`), 0 without a limit."""
    try:
        import resource  # noqa: PLC0415 - not on every system
    except ImportError:
        return 0
    limit = resource.getrlimit(resource.RLIMIT_AS)[0]
    return 0 if limit == resource.RLIM_INFINITY else limit


def is_out_of_memory(error: BaseException | None) -> bool:
    """Tell whether an error, or one that it follows from, is that of an allocation that failed."""
    while error is not None:
        if isinstance(error, MemoryError) or getattr(error, "errno", None) == errno.ENOMEM:
            return True
        # A C extension that does not report why it failed: without a limit, that is a defect.
        if isinstance(error, SystemError) and address_space():
            return True
        if any(words in str(error) for words in _WORDS):
            return True
        error = error.__cause__ or error.__context__
    return False


def supervise(most: int = 0) -> None:
    """Return in a child process; in this one wait for its end, and exit as it did.

    With `most`, the child and all its processes may hold that many bytes together.

    Raises:
        MemoryLimitError: KG004 when the child needed more, or ended by a failed allocation under `ulimit -v`.
        SystemExit: with the exit code of the child.
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
    """Return the status that a child ended with, None for one that was killed since it held too much."""
    while True:
        got = signal.sigtimedwait(_SIGNALS, _SECONDS)
        # The terminal sends its signals to the child, too; what a process sends arrives here alone.
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
    """Yield a process and all that it has started."""
    yield process
    try:
        lists = [file.read_text() for file in Path(f"/proc/{process}/task").glob("*/children")]
    except OSError:
        return
    for other in " ".join(lists).split():
        yield from _family(int(other))


def _resident(process: int) -> int:
    """Return the bytes that a process holds, with its part of what it shares; 0 for one that has ended."""
    try:
        lines = Path(f"/proc/{process}/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) << 10 for line in lines if line.startswith("Pss:"))
