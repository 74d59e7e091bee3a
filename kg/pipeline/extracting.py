"""Extractor process, which reads packages for a worker of a cluster, and its handle in the worker.

A worker runs several threads and must stay responsive, so packages are read in a separate process. A process that
crashes or hangs is replaced, and only its current package fails. The process exits with its worker.

The process itself only loads code, the tagger and the description of a build. A fork of it reads the packages; one that
has grown makes way for a new one, so the memory does not depend on the number of packages.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from multiprocessing import Pipe
from multiprocessing.connection import Connection, wait
from typing import TYPE_CHECKING, Final, NamedTuple, NoReturn

from kg.corpus.fetching.cache import LIMITS, checkout
from kg.corpus.fetching.lock import FETCHED, Entry
from kg.errors import KgError, SourceError
from kg.language.annotating import prepare
from kg.pipeline.artifacts import Artifacts
from kg.pipeline.plan import code_version
from kg.pipeline.pool import Task, attempt, end_of, own_memory
from kg.pipeline.recording import RecordingWorkspace
from kg.store.layout import user_cache

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from kg.corpus.files import Source

_START_SECONDS: Final = 120.0
"""Time limit for loading code, the tagger and the description of a build."""
_MOST_GROWTH: Final = 16 << 20
"""Bytes by which a fork may grow after its first package before it makes way for a new one."""
_END_SECONDS: Final = 0.5
"""Time limit for the exit of a process after closing its connection."""


class Request(NamedTuple):
    """Description of a build for a worker: the store of results, its job, and the time limit of a package (s)."""

    artifacts: str
    job: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Reading:
    """Outcome of one package on a worker.

    `artifact` is the name of its result, empty if it failed; then `problem` is the reason. `again` is whether another
    attempt may succeed. With `code`, an error of `kg`, the worker cannot read any package. `unfetched` is the folder of
    a source that `worker`, by its address, could not fetch.
    """

    task: Task
    artifact: str = ""
    problem: str = ""
    again: bool = False
    code: str = ""
    unfetched: str = ""
    worker: str = ""


class Extractor:
    """Reads packages, one at a time, in a process that starts with the first one and serves any number of builds."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: Connection | None = None
        self._request: Request | None = None

    def read(self, request: Request, task: Task) -> Reading:
        """Return the outcome of a package of a build, within the time limit of a package."""
        if self._process is not None and self._process.poll() is not None:
            self.close()  # it exited while idle
        is_new = self._pipe is None
        seconds = request.seconds + (0 if request == self._request else _START_SECONDS)
        try:
            reading = self._answer(self._pipe or self._start(), request, task, seconds)
        except TimeoutError:
            self.close()
            return Reading(task, problem=f"the package took longer than {seconds:g} s", again=True)
        except (EOFError, OSError):
            message = f"the process that read the package ended with {end_of(self.close())}"
            return Reading(task, problem=message, again=True)
        if reading.code:
            self.close()
            if not is_new:  # a new version of kg requires a new process
                return self.read(request, task)
        return reading

    def close(self) -> int:
        """Stop the process and return its exit code, negative for a signal."""
        process, pipe = self._process, self._pipe
        self._process = self._pipe = self._request = None
        if process is None or pipe is None:
            return 0
        pipe.close()
        try:
            code = process.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        if process.stdin:
            process.stdin.close()
        return code

    def _answer(self, pipe: Connection, request: Request, task: Task, seconds: float) -> Reading:
        if request != self._request:
            pipe.send(request)
            self._request = request
        pipe.send(task)
        while True:
            if not pipe.poll(seconds):
                raise TimeoutError
            reading: Reading | None = pipe.recv()
            if reading is not None:
                return reading
            seconds = request.seconds + LIMITS.seconds  # a source is being fetched; then its package is read

    def _start(self) -> Connection:
        """Start the process; if it cannot read packages, its first response is the error."""
        here, there = Pipe()
        command = [sys.executable, "-c", f"from {__name__} import main; main()", str(there.fileno())]
        # A Dask worker is a daemon process, so it must not use `multiprocessing`. Standard input closes when the
        # worker exits.
        self._process = subprocess.Popen(command, pass_fds=[there.fileno()], stdin=subprocess.PIPE)  # noqa: S603 - our own module
        there.close()
        self._pipe = here
        return here


def corpus_cache() -> Path:
    """Return the folder of this machine for repositories that its workers fetch."""
    return user_cache() / "corpus"


def main() -> None:
    """Read packages until the connection closes: each `Request` is followed by the tasks of that build."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _end_when_ready(sys.stdin.fileno())  # it closes with the worker
    pipe = Connection(int(sys.argv[1]))
    request, fork = Request("", "", 0), None
    with suppress(EOFError, OSError):
        while True:
            message = pipe.recv()
            if isinstance(message, Request):
                request, fork = message, None
                continue
            try:
                fork = fork or _Fork(_Reader(request, lambda: pipe.send(None)))
            except KgError as error:
                pipe.send(_impossible(message, error))
            else:
                pipe.send(fork.read(message))
    os._exit(0)


class _Fork:
    """A fork of this process that reads packages; a new one replaces it when it has grown."""

    def __init__(self, reader: _Reader) -> None:
        gc.collect()
        gc.freeze()
        self._reader = reader
        self._context = multiprocessing.get_context("fork")
        self._pipe: Connection | None = None
        self._first = 0

    def read(self, task: Task) -> Reading:
        """Return the outcome of a package. If the fork dies, this process ends in the same way."""
        pipe = self._pipe = self._pipe or self._start()
        reading: Reading
        try:
            pipe.send(task)
            reading, memory = pipe.recv()
        except (EOFError, OSError):
            self._process.join()
            _end_as(self._process.exitcode or 0)
        self._first = self._first or memory
        if memory > self._first + _MOST_GROWTH:
            pipe.close()
            self._process.join()
            self._pipe, self._first = None, 0
        return reading

    def _start(self) -> Connection:
        here, there = self._context.Pipe()
        self._process = self._context.Process(target=_serve, args=(self._reader, there, here), daemon=True)
        self._process.start()
        there.close()
        return here


def _serve(reader: _Reader, pipe: Connection, other: Connection) -> None:
    """Read packages in a fork until the connection closes."""
    other.close()
    if (parent := multiprocessing.parent_process()) is not None:
        _end_when_ready(parent.sentinel)
    with suppress(EOFError, OSError):
        while True:
            task: Task = pipe.recv()
            try:
                reading = reader.read(task)
            except KgError as error:
                reading = _impossible(task, error)
            pipe.send((reading, own_memory()))
    os._exit(0)


def _impossible(task: Task, error: KgError) -> Reading:
    where = f" ({error.place})" if error.place else ""
    return Reading(task, problem=f"{error.message}{where}", code=error.code)


def _end_as(code: int) -> NoReturn:
    """End this process as another one ended, by its exit code, which is negative for a signal."""
    if code < 0:
        with suppress(OSError):  # SIGKILL cannot be handled
            signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    os._exit(code)


def _end_when_ready(end: int) -> None:
    """End this process when a file descriptor is ready: that of a pipe whose other end closes with a process."""

    def watch() -> None:
        wait([end])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class _UnfetchedError(BaseException):
    """The source of a folder could not be fetched. The guards of extraction, which catch any Exception, let it pass."""

    def __init__(self, folder: Path, entry: Entry) -> None:
        super().__init__(f"{entry.state}: {entry.reason}")
        self.folder = folder


class _FetchingWorkspace(RecordingWorkspace):
    """A workspace that fetches a pinned source into the cache of this machine when a file of it is first read."""

    def __init__(self, sources: Iterable[Source], installed: Iterable[Path], waiting: Callable[[], None]) -> None:
        super().__init__(sources, installed)
        self._waiting = waiting
        self._roots: dict[Path, Path] = {}

    def root(self, source: Source) -> Path:
        """Return the folder with the files of a source."""
        if source.pin is None:
            return source.root
        if source.root not in self._roots:
            self._waiting()
            entry, folder = checkout(source.pin, source.root.name, corpus_cache())
            if entry.state != FETCHED:
                raise _UnfetchedError(source.root, entry)
            self._roots[source.root] = folder
        return self._roots[source.root]


class _Reader:
    """Reads packages of one build into the store of results, except those already there."""

    def __init__(self, request: Request, waiting: Callable[[], None]) -> None:
        """Load the job. `waiting` is called before a source is fetched.

        Raises:
            SourceError: KG127 for another version of `kg`, KG128 without the job.
            UsageError: KG141, KG142.
        """
        self._artifacts = Artifacts(request.artifacts)
        workspace = partial(_FetchingWorkspace, waiting=waiting)
        self._version, code, self._job = self._artifacts.job(request.job, workspace)
        prepare(self._job.model)
        if _code(self._job.model) != code:
            raise _elsewhere("has another version of kg, of Python or of the libraries that read sources")

    def read(self, task: Task) -> Reading:
        source = self._job.workspace.source(task.source)
        package = next((one for one in source.packages if one.path == task.path), None) if source else None
        if source is None or package is None:
            raise LookupError(f"{task.source}:{task.path}")
        if source.pin is None and not source.root.is_dir():
            raise _elsewhere(f"cannot read the folder {source.root}, which another machine of the build reads")
        read = partial(attempt, self._job, task)
        try:
            stored = self._artifacts.result(self._version, self._job, source, package, read)
        except _UnfetchedError as error:
            return Reading(task, problem=str(error), again=True, unfetched=str(error.folder))
        if not stored.name:
            return Reading(task, problem=stored.outcome.result.problems[0].message)
        return Reading(task, stored.name)


@cache
def _code(model: str) -> str:
    """Return the digest of the code of this process, computed when it is loaded."""
    return code_version(model)


def _elsewhere(message: str) -> SourceError:
    return SourceError("KG127", f"the worker on {socket.gethostname()} {message}")
