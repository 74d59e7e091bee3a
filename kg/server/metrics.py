"""For supervisors: `/metrics`, counters for Prometheus, and `/health`, whether the server is alive and has its store.

Neither needs a reader, so they respond under any load.
"""

from __future__ import annotations

import time
from bisect import bisect_left
from collections import Counter
from itertools import accumulate
from typing import TYPE_CHECKING, Final

from prometheus_client import CollectorRegistry, Gauge, ProcessCollector, generate_latest
from prometheus_client.core import CounterMetricFamily, HistogramMetricFamily, Metric
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from prometheus_client.utils import floatToGoString
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from kg.errors import StoreError
from kg.server.state import state

if TYPE_CHECKING:
    from collections.abc import Iterator

    from starlette.requests import Request

    from kg.server.records import Record

_METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "QUERY"})
_SECONDS: Final = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)


class Metrics:
    """The counters of one server, in a registry of its own.

    Requests are counted in plain numbers, which cost a tenth of the library's counters, and become its samples when
    they are read.
    """

    def __init__(self) -> None:
        self.registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        registry.register(self)
        self._running = Gauge("kg_jobs", "Queries and views that run or wait.", registry=registry)
        self._readers = Gauge("kg_readers", "Reader processes that run at a time.", registry=registry)
        self._snapshot = Gauge("kg_snapshot", "The generation of the data in force.", registry=registry)
        self._age = Gauge("kg_snapshot_age_seconds", "Seconds since it became current.", registry=registry)

        self._requests: Counter[tuple[str, int]] = Counter()
        self._queries: Counter[str] = Counter()
        self._slower = [0] * (len(_SECONDS) + 1)
        """Queries by the first bound of `_SECONDS` that their time does not exceed."""
        self._seconds = 0.0
        self._rows = self._cached = self._bytes = 0

    def count(self, method: str, recorded: Record) -> None:
        """Count a finished request."""
        self._requests[method if method in _METHODS else "other", recorded.status] += 1
        self._bytes += recorded.sent
        if recorded.query is not None:
            seconds = recorded.seconds
            self._queries[recorded.outcome] += 1
            self._slower[bisect_left(_SECONDS, seconds)] += 1
            self._seconds += seconds
            self._rows += recorded.rows or 0
            self._cached += recorded.cached

    def collect(self) -> Iterator[Metric]:
        """Yield the counters, as the library calls for them."""
        requests = CounterMetricFamily("kg_requests", "Requests by method and status.", labels=("method", "status"))
        for (method, status), number in self._requests.items():
            requests.add_metric((method, str(status)), number)
        queries = CounterMetricFamily(
            "kg_queries", "Queries by outcome: ok, or the code of the error.", labels=("outcome",)
        )
        for outcome, number in self._queries.items():
            queries.add_metric((outcome,), number)
        bounds = [*map(floatToGoString, _SECONDS), "+Inf"]
        buckets = list(zip(bounds, accumulate(self._slower), strict=True))
        about = "Seconds until a query was answered."
        yield requests
        yield queries
        yield HistogramMetricFamily("kg_query_seconds", about, buckets=buckets, sum_value=self._seconds)
        yield CounterMetricFamily("kg_query_rows", "Rows and triples of answers.", value=self._rows)
        yield CounterMetricFamily("kg_cache_hits", "Queries answered without a reader.", value=self._cached)
        yield CounterMetricFamily("kg_sent_bytes", "Bytes of bodies of answers.", value=self._bytes)

    def text(self, request: Request) -> bytes:
        """Return all figures, with the current ones of the readers and the store."""
        shared = state(request)
        self._running.set(len(shared.readers.jobs))
        self._readers.set(shared.options.readers)
        pointer = shared.readers.layout.pointer
        try:
            self._snapshot.set(shared.readers.layout.current() or 0)
            self._age.set(time.time() - pointer.stat().st_mtime)
        except (StoreError, OSError):
            self._snapshot.set(float("nan"))
            self._age.set(float("nan"))
        return generate_latest(self.registry)


async def _metrics(request: Request) -> Response:
    metrics: Metrics = request.scope["kg.metrics"]
    return Response(metrics.text(request), headers={"Content-Type": CONTENT_TYPE_LATEST, "Cache-Control": "no-store"})


async def _health(request: Request) -> Response:
    """Answer 200 with the snapshot in force, its age in seconds and the readers; 503 when there is no store.

    A store on another server must have answered when it was last looked at, else 502.

    Requests that the server makes itself do not count, as in the list of jobs.
    """
    shared = state(request)
    layout = shared.readers.layout
    generation = layout.in_force()
    if generation is None:
        raise StoreError("KG301", "the store's data has been deleted")
    following = shared.readers.following
    if following is not None and following.failure is not None:
        raise following.failure
    jobs = sum(not job.own for job in shared.readers.jobs.values())
    waiting = shared.readers.stats().waiting
    return JSONResponse(
        {
            "status": "ok",
            "snapshot": str(generation),
            "age": round(time.time() - layout.pointer.stat().st_mtime, 3),
            "readers": shared.options.readers,
            "running": jobs - waiting,
            "waiting": waiting,
        },
        headers={"Cache-Control": "no-store"},
    )


ROUTES: Final = [Route("/metrics", _metrics), Route("/health", _health)]
"""Addresses for supervisors of the server."""
