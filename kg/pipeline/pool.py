"""A pool of worker processes. A package that kills its worker, or never finishes, fails alone.

Workers are forked if the system supports it, so they share the indexes of the workspace. Of several workers, each
receives its next package before it has finished the current one, so it never waits while the store is written. A single
one alternates with the writing, so a build with one job occupies one processor. A worker exits when its pipe closes, so
none outlives the build. One that has grown makes way for a spare one, which was forked with the first ones: later, the
parent has an open store and its threads. When all packages are read, the workers can do other parts of the build.
"""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import resource
import signal
import time
from collections import deque
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Protocol, Self

from kg.pipeline.work import Job, Outcome, failed, work

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from multiprocessing.process import BaseProcess
    from types import TracebackType

PACKAGE_SECONDS: Final = 300.0
"""Time limit of one package; the largest known takes some seconds."""

_AHEAD: Final = 2
"""Number of packages assigned to one of several workers at a time."""
_DEFECTS: Final = (ArithmeticError, AttributeError, LookupError, OSError, RuntimeError, TypeError, ValueError)
"""Exceptions reported by their message; any other terminates the worker, which is reported too."""
_FIRST_OWN_FILE: Final = 3
"""Lower file descriptors are the standard streams."""
_MOST_FILES: Final = 1 << 16
"""Upper bound for closing files: without a limit, macOS reports a number too large for a loop."""
_MOST_MEMORY: Final = 160 << 20
"""Bytes of its own with which a worker makes way for a spare one.

Freed memory is scattered, so little of it goes back to the system, and headers are kept for the next package. A spare
worker shares the memory that its parent had.
"""
_FAULTS: Final = 4096
"""Number of page faults, each a new page of its own, after which a worker measures its memory again.

Measuring visits the shared pages as well: 10 ms for 400 MB.
"""
_PACKAGES: Final = 12
"""Number of packages for which one spare worker is kept."""
_MOST_SPARES: Final = 40
"""Largest number of spare workers; each takes about a megabyte."""
_GC_THRESHOLD: Final = 500_000
"""Number of new objects that triggers a garbage collection; most objects live until their package is done."""


class Task(NamedTuple):
    """A package to read; `earlier` is the name of its last result of the same version, if any."""

    source: str
    name: str
    path: str
    earlier: str = ""


class Part(Protocol):
    """A part of other work; `shared` is what all parts are done with."""

    def run(self, shared: Any) -> Any:
        """Return the result."""


class _Shared(NamedTuple):
    """What the parts that a worker gets from now on are done with."""

    value: Any


@dataclass(slots=True)
class _Worker:
    """A process with its pipe and its tasks, oldest first; `since` is the start time of the oldest.

    One with an `heir` gets no more tasks, and the heir takes its place.
    """

    process: BaseProcess
    pipe: Connection
    given: deque[Task] = field(default_factory=deque)
    since: float = 0.0
    heir: _Worker | None = None


class Pool:
    """Workers of one build; a context manager that starts and stops them.

    The first of `tasks` are started first, by up to `jobs` processes. A task whose worker dies, or that takes more than
    `deadline` seconds, results in a problem KG121.
    """

    def __init__(self, job: Job, tasks: Iterable[Task], jobs: int, deadline: float = PACKAGE_SECONDS) -> None:
        methods = multiprocessing.get_all_start_methods()
        self._context = multiprocessing.get_context("fork" if "fork" in methods else None)
        self._job = job
        self._queue = deque(tasks)
        self._size = max(1, min(jobs, len(self._queue)))
        self._deadline = deadline
        self._workers: list[_Worker] = []
        self._spares: deque[_Worker] = deque()

    def __enter__(self) -> Self:
        gc.freeze()
        self._hand_out()
        if self._context.get_start_method() == "fork":  # others share nothing with their parent
            for _ in range(min(_MOST_SPARES, len(self._queue) // _PACKAGES)):
                self._fork(self._spares)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        workers = self._every()
        for worker in workers:
            worker.process.kill()
        for worker in workers:
            worker.process.join()
            worker.pipe.close()
        self._workers = []
        self._spares.clear()
        gc.unfreeze()

    @property
    def size(self) -> int:
        """Number of packages read at a time."""
        return self._size

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcome of each task as it arrives."""
        while self._queue or any(worker.given for worker in self._workers):
            self._hand_out()
            yield from self._collect()

    def answers(self, shared: object, parts: Sequence[Part]) -> Iterator[tuple[int, Any]]:
        """Yield the index and the result of each part, when all outcomes are read; None if its worker dies."""
        for worker in list(self._workers):  # those that have read packages have grown
            if worker.heir is None and self._spares:
                worker.heir = self._spares.popleft()
            if worker.heir is not None:
                self._remove(worker)
        waiting = deque(enumerate(parts))
        running: dict[Connection, int] = {}
        for worker in self._workers[: len(parts)]:
            with contextlib.suppress(OSError):
                worker.pipe.send(_Shared(shared))
                self._next(worker.pipe, waiting, running)
        while running:
            ready = wait(list(running))
            for pipe in [one for one in running if one in ready]:
                at, answer = running.pop(pipe), None
                with contextlib.suppress(EOFError, OSError):
                    answer = pipe.recv()
                    self._next(pipe, waiting, running)
                yield at, answer
        yield from ((at, None) for at, _ in waiting)

    @staticmethod
    def _next(pipe: Connection, waiting: deque[tuple[int, Part]], running: dict[Connection, int]) -> None:
        """Give a worker the next part, if there is one."""
        if waiting:
            at, part = waiting.popleft()
            running[pipe] = at
            pipe.send(part)

    def _hand_out(self) -> None:
        """Give tasks to workers with free capacity; start workers while tasks remain."""
        while self._queue and len(self._workers) < self._size:
            self._fork(self._workers)
            self._give(self._workers[-1])
        ahead = _AHEAD if self._size > 1 else 1
        for _ in range(ahead):
            for worker in sorted(self._workers, key=lambda one: len(one.given)):
                if self._queue and len(worker.given) < ahead and worker.heir is None:
                    self._give(worker)

    def _collect(self) -> Iterator[Outcome]:
        """Wait for outcomes and yield them.

        Tasks of an exited worker are queued again, except the one that was running.
        """
        now = time.monotonic()
        left = [worker.since + self._deadline - now for worker in self._workers if worker.given]
        ready = wait([worker.pipe for worker in self._workers], timeout=max(0.0, min(left, default=0.0)))
        for worker in list(self._workers):
            if worker.pipe in ready:
                yield from self._receive(worker)
            elif worker.given and time.monotonic() - worker.since > self._deadline:
                yield from self._reap(worker, f"the package took longer than {self._deadline:g} s and was left out")

    def _every(self) -> list[_Worker]:
        """Return all processes: workers, those that take their places, and spare ones."""
        return [*self._workers, *(worker.heir for worker in self._workers if worker.heir), *self._spares]

    def _fork(self, among: list[_Worker] | deque[_Worker]) -> None:
        here, there = self._context.Pipe()
        pipes = [worker.pipe for worker in self._every()]
        forked = self._context.get_start_method() == "fork"
        process = self._context.Process(
            target=_serve, args=(self._job, there, [here, *pipes]), kwargs={"forked": forked}, daemon=True
        )
        with _deferred_interrupts():
            process.start()
            there.close()
            among.append(_Worker(process, here))

    def _give(self, worker: _Worker) -> None:
        if not worker.given:
            worker.since = time.monotonic()
        worker.given.append(self._queue.popleft())
        with contextlib.suppress(OSError):  # `_collect` handles a dead worker
            worker.pipe.send(worker.given[-1])

    def _receive(self, worker: _Worker) -> Iterator[Outcome]:
        try:
            outcome, memory = worker.pipe.recv()
        except (EOFError, OSError):
            worker.process.join()
            message = f"the process that read the package ended with {end_of(worker.process.exitcode or 0)}"
            yield from self._reap(worker, message)
            return
        worker.given.popleft()
        worker.since = time.monotonic()
        if memory > _MOST_MEMORY and worker.heir is None and self._spares:
            worker.heir = self._spares.popleft()
        if worker.heir is not None and not worker.given:
            self._remove(worker)
        yield outcome

    def _reap(self, worker: _Worker, message: str) -> Iterator[Outcome]:
        """Remove a worker and yield the task that ran as failed."""
        culprit = worker.given.popleft() if worker.given else None
        self._remove(worker)
        if culprit:
            yield failed(*culprit[:3], message)

    def _remove(self, worker: _Worker) -> None:
        """End a worker, and queue its tasks again; its heir takes its place."""
        worker.process.kill()
        worker.process.join()
        worker.pipe.close()
        self._workers.remove(worker)
        if worker.heir is not None:
            self._workers.append(worker.heir)
        self._queue.extendleft(reversed(worker.given))


@contextlib.contextmanager
def _deferred_interrupts() -> Iterator[None]:
    """Defer Ctrl-C: a worker interrupted before `_serve` would clean up the build's work, as the build does.

    A worker inherits the blocked signals of its parent.
    """
    earlier = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, earlier)


def end_of(code: int) -> str:
    """Return a description of the exit of a process, by its exit code, which is negative for a signal."""
    return f"signal {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"


def _serve(job: Job, pipe: Connection, others: list[Connection], *, forked: bool) -> None:
    """Read packages, then do other parts, until the pipe closes; the parent process handles Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    # An inherited copy of another pipe would hide the end of the build from this worker, and an inherited lock would
    # outlive the build.
    for other in others:
        other.close()
    if forked:
        os.closerange(_FIRST_OWN_FILE, pipe.fileno())
        os.closerange(pipe.fileno() + 1, min(os.sysconf("SC_OPEN_MAX"), _MOST_FILES))
    gc.set_threshold(_GC_THRESHOLD)
    memory, measured = 0, 0
    shared: Any = None
    with contextlib.suppress(EOFError, OSError):
        while True:
            task: Task | _Shared | Part = pipe.recv()
            if isinstance(task, _Shared):
                shared = task.value
                continue
            if not isinstance(task, Task):
                pipe.send(task.run(shared))
                continue
            outcome = attempt(job, task)
            if (faults := resource.getrusage(resource.RUSAGE_SELF).ru_minflt) - measured >= _FAULTS:
                memory, measured = own_memory(), faults
            pipe.send((outcome, memory))
    os._exit(0)


def own_memory() -> int:
    """Return the bytes that only this process has, without those that it shares with its parent; 0 if unknown."""
    try:
        lines = Path("/proc/self/smaps_rollup").read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) << 10 for line in lines if line.startswith("Private_"))


def attempt(job: Job, task: Task) -> Outcome:
    """Return the outcome of a task; an exception becomes the problem of a failed one."""
    try:
        return work(job, task.source, task.path, task.earlier)
    except _DEFECTS as error:
        return failed(*task[:3], f"{type(error).__name__}: {error}")
