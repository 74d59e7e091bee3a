"""Workers of a build on a Dask cluster, with the interface of `kg.pipeline.pool`.

    with ClusterPool("tcp://scheduler:8786", task_groups, request, report) as pool:
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
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, SourceError
from kg.pipeline.artifacts import Artifacts, without_extra
from kg.pipeline.extracting import Extractor, Reading, Request
from kg.pipeline.work import Outcome, failed

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from types import TracebackType
    from typing import Self

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
    found: list[list[Task]] = []
    open_ones: dict[str, tuple[list[Task], int]] = {}
    for task, size in tasks:
        batch, total = open_ones.get(task.source, ([], 0))
        if not batch or total + size > _BATCH_BYTES:
            batch, total = [], 0
            found.append(batch)
        batch.append(task)
        open_ones[task.source] = batch, total + size
    return found


def read_packages(request: Request, tasks: Sequence[Task]) -> list[Reading]:
    """Read packages, in an extractor process of this worker thread; runs on the cluster."""
    from distributed import get_worker  # noqa: PLC0415 - part of the extra `cluster`

    worker = get_worker()
    worker.log_event(_TOPIC, {"worker": worker.address, "source": tasks[0].source, "packages": len(tasks)})
    if not hasattr(_own, "extractor"):
        _own.extractor = Extractor()
    found = []
    for task in tasks:
        found.append(_own.extractor.read(request, task))
        if found[-1].code:
            break
    return found


class ClusterPool:
    """Workers of one build; a context manager that connects and submits all work.

    A package whose worker dies or exceeds the time limit gets a second attempt, then KG121.

    Raises:
        UsageError: KG125 without the extra `cluster`.
        SourceError: KG126 if no cluster is at the address, or it has no workers (any more); KG127 if a worker cannot
            read the sources as this machine does; KG128 if results cannot be written or read.
    """

    def __init__(
        self, address: str, work: Sequence[list[Task]], request: Request, artifacts: Artifacts, report: Report
    ) -> None:
        self._address = address
        self._work = work
        self._request = request
        self._artifacts = artifacts
        self._report = report
        self._news: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._given: dict[Any, list[Task]] = {}
        self._attempts: dict[Task, int] = {}
        self._client: Any = None
        self._cluster: Any = None

    def __enter__(self) -> Self:
        try:
            self._connect()
            self._client.subscribe_topic(_TOPIC, self._news.put)
            for batch in self._work:
                self._submit(batch)
        except BaseException:
            self._close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._close()

    def outcomes(self) -> Iterator[Outcome]:
        """Yield the outcome of each package as it arrives."""
        while self._given:
            try:
                news = self._news.get(timeout=_SILENT_SECONDS)
            except queue.Empty:
                self._require_worker()
                continue
            if isinstance(news, tuple):  # a log message of a worker, with its time
                self._report.placed(news[1]["worker"], news[1]["source"])
            elif news in self._given:
                yield from self._take(news)

    def _take(self, future: Any) -> Iterator[Outcome]:
        tasks = self._given.pop(future)
        readings: list[Reading]
        if future.status in {"cancelled", "lost"}:
            raise self._lost("the connection to the scheduler was lost")
        if error := future.exception():  # raised by a worker, or because workers died repeatedly
            problem = f"the worker that read the package failed: {error}"
            readings = [Reading(task, problem=problem, again=True) for task in tasks]
        else:
            readings = future.result()
        for reading in readings:
            if reading.code:
                hint = "All machines need the same kg, Python and libraries, and the sources under the same paths."
                raise SourceError(reading.code, reading.problem, place=Place(self._address), hint=hint)
            outcome = self._artifacts.outcome(reading.artifact) if reading.artifact else None
            if outcome is not None:
                yield outcome
                continue
            task, problem = reading.task, reading.problem or "the result was damaged before it was read"
            self._attempts[task] = self._attempts.get(task, 1) + 1
            if (reading.again or reading.artifact) and self._attempts[task] <= _ATTEMPTS:
                self._submit([task])
            else:
                yield failed(*task[:3], problem)

    def _submit(self, batch: list[Task]) -> None:
        # This name is visible on Dask's dashboard.
        key = f"{batch[0].source}:{batch[0].path}-{len(self._given)}-{id(batch):x}"
        future = self._client.submit(read_packages, self._request, batch, key=key, pure=False)
        self._given[future] = batch
        future.add_done_callback(self._news.put)

    def _connect(self) -> None:
        try:
            import dask  # noqa: PLC0415 - part of the extra `cluster`
            from distributed import Client, LocalCluster  # noqa: PLC0415 - the same
        except ImportError as error:
            raise without_extra() from error
        for name in _NOISY:  # errors are reported in our own words
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        kind, _, number = self._address.partition(":")
        try:
            if kind == LOCAL:
                dask.config.set({"distributed.worker.profile.enabled": False})  # it takes a hundred samples a second
                workers = max(1, min(int(number or 0) or os.cpu_count() or 1, len(self._work)))
                self._cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    dashboard_address="127.0.0.1:0",
                    silence_logs=logging.CRITICAL,
                )
            self._client = Client(self._cluster or self._address, timeout=_CONNECT_SECONDS, set_as_default=False)
            self._client.wait_for_workers(1, timeout=_CONNECT_SECONDS)
        except (OSError, TimeoutError, ValueError) as error:
            raise self._lost(str(error) or type(error).__name__) from error

    @property
    def size(self) -> int:
        """Number of packages read at a time: the threads of all workers."""
        return sum(self._client.nthreads().values())

    def _require_worker(self) -> None:
        """Raise if no worker is left to wait for."""
        try:
            self._client.wait_for_workers(1, timeout=_CONNECT_SECONDS)
        except (OSError, TimeoutError, ValueError) as error:
            raise self._lost("no worker is left") from error

    def _lost(self, message: str) -> SourceError:
        hint = "Check that the scheduler and its workers run. What was read is kept, and is not read again."
        return SourceError("KG126", f"the cluster cannot be used: {message}", place=Place(self._address), hint=hint)

    def _close(self) -> None:
        if self._client is not None:
            if self._given:
                self._client.cancel(list(self._given))
            self._client.close()
        if self._cluster is not None:
            self._cluster.close()
        self._client = self._cluster = None
        self._given = {}
