"""Connection of a build to a Dask cluster, and the workers that read its packages there.

    with Cluster("tcp://scheduler:8786", report) as cluster:
        with ClusterPool(cluster, batches(tasks), request, artifacts, homes) as pool:
            for outcome in pool.outcomes(): ...

Workers write results into a store that all machines share (`kg.pipeline.artifacts`); only names of results pass through
the scheduler. So the result of a package is complete or missing, whatever happens to a worker, and a worker that takes
over the remaining work finds the earlier results.
"""

from __future__ import annotations

import logging
import os
import queue
import threading
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, Self
from uuid import uuid4

from kg.errors import Place, SourceError
from kg.pipeline.artifacts import Artifacts, without_extra
from kg.pipeline.extracting import Extractor, Reading, Request
from kg.pipeline.sources import LostSourceError
from kg.pipeline.work import Outcome, failed

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from types import TracebackType

    from kg.pipeline.pool import Task
    from kg.pipeline.report import Report

LOCAL: Final = "local"
"""Address of a cluster on this machine for the duration of the build; `:N` adds the number of workers."""

_ATTEMPTS: Final = 2
"""Number of attempts to read a package."""
_BATCH_BYTES: Final = 1_000_000
"""Size of code after which the packages of a source form another batch; about two seconds."""
_CONNECT_SECONDS: Final = 30.0
_SILENT_SECONDS: Final = 60.0
"""Seconds without messages after which the cluster is checked."""
_NOISY: Final = ("distributed", "distributed.client", "distributed.core", "distributed.nanny", "tornado")
_TOPIC: Final = "kg"
_own = threading.local()
"""Extractor of this thread of a worker."""


def batches(tasks: Iterable[tuple[Task, int]]) -> list[list[Task]]:
    """Return packages, given with their sizes of code, as batches of one source each, in the same order."""
    result: list[list[Task]] = []
    open_ones: dict[str, tuple[list[Task], int]] = {}
    for task, size in tasks:
        batch, total = open_ones.get(task.source, ([], 0))
        if not batch or total + size > _BATCH_BYTES:
            batch, total = [], 0
            result.append(batch)
        batch.append(task)
        open_ones[task.source] = batch, total + size
    return result


def announce(source: str, *, fetching: bool = False) -> str:
    """Report that this worker begins to read or fetch a source, and return its address; runs on the cluster."""
    from distributed import get_worker  # noqa: PLC0415 - part of the extra `cluster`

    worker = get_worker()
    worker.log_event(_TOPIC, {"worker": worker.address, "source": source, "fetching": fetching})
    return str(worker.address)


def read_packages(request: Request, tasks: Sequence[Task]) -> list[Reading]:
    """Read packages, in an extractor process of this worker thread; runs on the cluster."""
    worker = announce(tasks[0].source)
    if not hasattr(_own, "extractor"):
        _own.extractor = Extractor()
    readings = []
    for task in tasks:
        readings.append(replace(_own.extractor.read(request, task), worker=worker))
        if readings[-1].code:
            break
    return readings


def machine_of(worker: str) -> str:
    """Return the part of the address of a worker that all workers of its machine share."""
    return worker.rpartition(":")[0]


class Cluster:
    """The cluster of a build, connected when it is first needed; a context manager that disconnects.

    Raises:
        UsageError: KG125 without the extra `cluster`.
        SourceError: KG126 if no cluster is at the address, or it has no workers (any more).
    """

    def __init__(self, address: str, report: Report) -> None:
        self.address = address
        self._report = report
        self._news: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._given: dict[Any, Any] = {}
        self._workers: tuple[str, ...] = ()
        self._client: Any = None
        self._own: Any = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.cancel()
        if self._client is not None:
            self._client.close()
        if self._own is not None:
            self._own.close()
        self._client = self._own = None

    def connect(self, most: int | None = None) -> None:
        """Connect, unless it is done; a cluster of this machine gets at most so many workers."""
        if self._client is None:
            self._connect(most)

    def submit(self, work: Any, function: Callable[..., Any], *arguments: Any, key: str, near: str = "") -> None:
        """Submit the call of a function, which `results` yields with `work`.

        A worker of the machine `near` is preferred, or of another one if it begins with `!`. The key is visible on
        Dask's dashboard.
        """
        machine, other = near.removeprefix("!"), near.startswith("!")
        preferred = [one for one in self._workers if near and (machine_of(one) == machine) != other]
        some = 0 < len(preferred) < len(self._workers)
        choice = {"workers": preferred, "allow_other_workers": True} if some else {}
        # A scheduler responds to a known key with its earlier result, also that of a first attempt.
        future = self._client.submit(function, *arguments, key=f"{key}-{uuid4().hex}", pure=False, **choice)
        self._given[future] = work
        future.add_done_callback(self._news.put)

    def has_other_machine(self, worker: str) -> bool:
        """Return whether the cluster has a worker on another machine than that of `worker`."""
        return any(machine_of(one) != machine_of(worker) for one in self._workers)

    def results(self) -> Iterator[tuple[Any, Any]]:
        """Yield each submitted work with its result, or with the exception that ended it, as it arrives."""
        while self._given:
            try:
                news = self._news.get(timeout=_SILENT_SECONDS)
            except queue.Empty:
                try:
                    self._require()
                except (OSError, TimeoutError, ValueError) as error:
                    raise self._lost("no worker is left") from error
                continue
            if isinstance(news, tuple):  # a log message of a worker, with its time
                self._show(**news[1])
            elif news in self._given:
                work = self._given.pop(news)
                if news.status in {"cancelled", "lost"}:
                    raise self._lost("the connection to the scheduler was lost")
                yield work, news.exception() or news.result()

    def cancel(self) -> None:
        """Cancel what has not finished."""
        if self._client is not None and self._given:
            self._client.cancel(list(self._given))
        self._given = {}

    @property
    def size(self) -> int:
        """Number of packages read at a time: the threads of all workers."""
        return sum(self._client.nthreads().values())

    def _connect(self, most: int | None) -> None:
        try:
            import dask  # noqa: PLC0415 - part of the extra `cluster`
            from distributed import Client, LocalCluster  # noqa: PLC0415 - the same
        except ImportError as error:
            raise without_extra() from error
        for name in _NOISY:  # errors are reported in our own words
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        kind, _, number = self.address.partition(":")
        try:
            if kind == LOCAL:
                dask.config.set({"distributed.worker.profile.enabled": False})  # it takes a hundred samples a second
                workers = int(number or 0) or os.cpu_count() or 1
                self._own = LocalCluster(
                    n_workers=max(1, workers if most is None else min(workers, most)),
                    threads_per_worker=1,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL,
                )
            self._client = Client(self._own or self.address, timeout=_CONNECT_SECONDS, set_as_default=False)
            self._client.subscribe_topic(_TOPIC, self._news.put)
            self._require()
        except (OSError, RuntimeError, TimeoutError, ValueError) as error:
            raise self._lost(str(error) or type(error).__name__) from error

    def _show(self, worker: str, source: str, *, fetching: bool) -> None:
        if fetching:
            self._report.fetching(f"{worker} fetches {source}")
        else:
            self._report.placed(worker, source)

    def _require(self) -> None:
        self._client.wait_for_workers(1, timeout=_CONNECT_SECONDS)
        self._workers = tuple(self._client.nthreads())

    def _lost(self, message: str) -> SourceError:
        hint = "Check that the scheduler and its workers run. What was read is kept, and is not read again."
        return SourceError("KG126", f"the cluster cannot be used: {message}", place=Place(self.address), hint=hint)


class ClusterPool:
    """Workers of one build, with the interface of `kg.pipeline.pool`; a context manager that submits all work.

    `homes` are the machines that have fetched sources, by name. A package whose worker dies or exceeds the time limit
    gets a second attempt, then KG121.

    Raises:
        LostSourceError: a source could not be fetched where a package needs it.
        SourceError: KG126 as `Cluster`; KG127 if a worker cannot read the sources as this machine does; KG128 if
            results cannot be written or read.
    """

    def __init__(
        self,
        cluster: Cluster,
        work: Sequence[list[Task]],
        request: Request,
        artifacts: Artifacts,
        homes: Mapping[str, str],
    ) -> None:
        self._cluster = cluster
        self._work = work
        self._request = request
        self._artifacts = artifacts
        self._homes = homes
        self._attempts: dict[Task, int] = {}

    def __enter__(self) -> Self:
        self._cluster.connect(len(self._work))
        for batch in self._work:
            self._submit(batch, self._homes.get(batch[0].source, ""))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._cluster.cancel()

    @property
    def size(self) -> int:
        """Number of packages read at a time."""
        return self._cluster.size

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcome of each package as it arrives."""
        for tasks, result in self._cluster.results():
            readings: list[Reading] = result
            if isinstance(result, BaseException):  # raised by a worker, or because workers died repeatedly
                problem = f"the worker that read the package failed: {result}"
                readings = [Reading(task, problem=problem, again=True) for task in tasks]
            for reading in readings:
                yield from self._take(reading)

    def _take(self, reading: Reading) -> Iterator[Outcome]:
        if reading.code:
            hint = "All machines need the same kg, Python and libraries, and the sources under the same paths."
            place = Place(self._cluster.address)
            raise SourceError(reading.code, reading.problem, place=place, hint=hint)
        outcome = self._artifacts.outcome(reading.artifact) if reading.artifact else None
        if outcome is not None:
            yield outcome
            return
        task, problem = reading.task, reading.problem or "the result was damaged before it was read"
        self._attempts[task] = self._attempts.get(task, 1) + 1
        if (reading.again or reading.artifact) and self._attempts[task] <= _ATTEMPTS:
            self._submit([task], f"!{machine_of(reading.worker)}" if reading.unfetched else "")
        elif reading.unfetched:
            raise LostSourceError(reading.unfetched, problem)
        else:
            yield failed(*task[:3], problem)

    def _submit(self, batch: list[Task], near: str) -> None:
        key = f"{batch[0].source}:{batch[0].path}"
        self._cluster.submit(batch, read_packages, self._request, batch, key=key, near=near)
