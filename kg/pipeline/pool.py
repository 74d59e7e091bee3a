"""A pool of worker processes. A package that kills its worker, or never ends, fails alone.

Workers are forked where the system can, so that they share the indexes of the workspace. Of several, each is given its
next package before it has ended the one before, so that it never waits for the writing of the store; a single one
takes turns with the writing, so that a build with one job keeps one processor busy. A worker whose pipe closes ends,
so none outlives the build, however that ended.
"""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import signal
import time
from collections import deque
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.pipeline.work import Job, Outcome, failed, work

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from multiprocessing.process import BaseProcess
    from types import TracebackType
    from typing import Self

PACKAGE_SECONDS: Final = 300.0
"""How long one package may take; the largest known takes some seconds."""

_AHEAD: Final = 2
"""How many packages one of several workers is given at a time."""
_DEFECTS: Final = (ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError)
"""What is reported by its message; anything else ends the worker, which is reported too."""
_FIRST_OWN_FILE: Final = 3
"""Files below are the standard streams."""
_MOST_FILES: Final = 1 << 16
"""Where files are not limited, macOS gives a number that no loop reaches."""
_GC_THRESHOLD: Final = 500_000
"""So many new objects begin a collection; most of them are used until their package ends."""


class Task(NamedTuple):
    """A package to read; `earlier` names its last result of the same version, if there is one."""

    source: str
    name: str
    path: str
    earlier: str = ""


@dataclass(slots=True)
class _Worker:
    """A process with its pipe and its tasks, oldest first; `since` is when it began the oldest."""

    process: BaseProcess
    pipe: Connection
    given: deque[Task] = field(default_factory=deque)
    since: float = 0.0


class Pool:
    """The workers of one build, for a `with` statement: they start with it and are gone after it.

    The first of `tasks` are begun first, by up to `jobs` processes. A task whose worker dies, or that takes more than
    `deadline` seconds, gives a problem KG121.
    """

    def __init__(self, job: Job, tasks: Iterable[Task], jobs: int, deadline: float = PACKAGE_SECONDS) -> None:
        methods = multiprocessing.get_all_start_methods()
        self._context = multiprocessing.get_context("fork" if "fork" in methods else None)
        self._job = job
        self._queue = deque(tasks)
        self._size = max(1, min(jobs, len(self._queue)))
        self._deadline = deadline
        self._workers: list[_Worker] = []

    def __enter__(self) -> Self:
        gc.freeze()
        self._hand_out()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.process.join()
            worker.pipe.close()
        self._workers = []
        gc.unfreeze()

    @property
    def size(self) -> int:
        """How many packages are read at a time."""
        return self._size

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcome of each task as it comes."""
        while self._queue or self._busy:
            self._hand_out()
            yield from self._collect()

    @property
    def _busy(self) -> bool:
        """Whether any worker has something to do."""
        return any(worker.given for worker in self._workers)

    def _hand_out(self) -> None:
        """Give tasks to workers with free capacity; start workers while tasks remain."""
        while self._queue and len(self._workers) < self._size:
            self._start()
            self._give(self._workers[-1])
        ahead = _AHEAD if self._size > 1 else 1
        for _ in range(ahead):
            for worker in sorted(self._workers, key=lambda one: len(one.given)):
                if self._queue and len(worker.given) < ahead:
                    self._give(worker)

    def _collect(self) -> Iterator[Outcome]:
        """Wait for outcomes and yield them; tasks of a worker that ended go back, but for the one that ended it."""
        now = time.monotonic()
        left = [worker.since + self._deadline - now for worker in self._workers if worker.given]
        ready = wait([worker.pipe for worker in self._workers], timeout=max(0.0, min(left, default=0.0)))
        for worker in list(self._workers):
            if worker.pipe in ready:
                yield from self._receive(worker)
            elif worker.given and time.monotonic() - worker.since > self._deadline:
                yield from self._reap(worker, f"the package took longer than {self._deadline:g} s and was left out")

    def _start(self) -> None:
        here, there = self._context.Pipe()
        pipes = [worker.pipe for worker in self._workers]
        forked = self._context.get_start_method() == "fork"
        process = self._context.Process(
            target=_serve, args=(self._job, there, [here, *pipes]), kwargs={"forked": forked}, daemon=True
        )
        with _interrupts_held():
            process.start()
            there.close()
            self._workers.append(_Worker(process, here))

    def _give(self, worker: _Worker) -> None:
        if not worker.given:
            worker.since = time.monotonic()
        worker.given.append(self._queue.popleft())
        with contextlib.suppress(OSError):  # a worker that has died is found by `collect`
            worker.pipe.send(worker.given[-1])

    def _receive(self, worker: _Worker) -> Iterator[Outcome]:
        try:
            outcome: Outcome = worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join()
            message = f"the process that read the package ended with {end_of(worker.process.exitcode or 0)}"
            yield from self._reap(worker, message)
            return
        worker.given.popleft()
        worker.since = time.monotonic()
        yield outcome

    def _reap(self, worker: _Worker, message: str) -> Iterator[Outcome]:
        """Remove a worker and put its tasks back, but for the one it was at, which is yielded as failed."""
        worker.process.kill()
        worker.process.join()
        worker.pipe.close()
        self._workers.remove(worker)
        culprit = worker.given.popleft() if worker.given else None
        self._queue.extendleft(reversed(worker.given))
        if culprit:
            yield failed(*culprit[:3], message)


@contextlib.contextmanager
def _interrupts_held() -> Iterator[None]:
    """Defer Ctrl-C: a worker interrupted before `_serve` would clean up the build's work, as the build does.

    A worker starts with the signals held that its parent holds.
    """
    earlier = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, earlier)


def end_of(code: int) -> str:
    """Return in words how a process ended, by its exit code, which is negative for a signal."""
    return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def _serve(job: Job, pipe: Connection, others: list[Connection], *, forked: bool) -> None:
    """Read packages until the pipe closes; Ctrl-C is the business of the process that started this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    # A copy of another end of a pipe would keep this worker from seeing that the build has ended, and a copy of a
    # lock would outlive the build.
    for other in others:
        other.close()
    if forked:
        os.closerange(_FIRST_OWN_FILE, pipe.fileno())
        os.closerange(pipe.fileno() + 1, min(os.sysconf("SC_OPEN_MAX"), _MOST_FILES))
    gc.set_threshold(_GC_THRESHOLD)
    with contextlib.suppress(EOFError, OSError):
        while True:
            task: Task = pipe.recv()
            pipe.send(attempt(job, task))
    os._exit(0)


def attempt(job: Job, task: Task) -> Outcome:
    """Return the outcome of a task; a defect that raises is the problem of a failed one."""
    try:
        return work(job, task.source, task.path, task.earlier)
    except _DEFECTS as error:
        return failed(*task[:3], f"{type(error).__name__}: {error}")
