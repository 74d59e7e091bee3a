"""`/metrics`: counters of the server for Prometheus."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

from prometheus_client import CollectorRegistry, Counter, Gauge, Histogram, ProcessCollector, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from starlette.responses import Response
from starlette.routing import Route

from kg.errors import StoreError
from kg.server.state import state

if TYPE_CHECKING:
    from starlette.requests import Request

    from kg.server.records import Record

_METHODS: Final = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "QUERY"})
_SECONDS: Final = (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100)


class Metrics:
    """The counters of one server, in a registry of its own."""

    def __init__(self) -> None:
        self.registry = registry = CollectorRegistry()
        ProcessCollector(registry=registry)
        self._requests = Counter(
            "kg_requests_total", "Requests by method and status.", ("method", "status"), registry=registry
        )
        self._queries = Counter(
            "kg_queries_total", "Queries by outcome: ok, or the code of the error.", ("outcome",), registry=registry
        )
        self._seconds = Histogram(
            "kg_query_seconds", "Seconds until a query was answered.", buckets=_SECONDS, registry=registry
        )
        self._rows = Counter("kg_query_rows_total", "Rows and triples of answers.", registry=registry)
        self._cached = Counter("kg_cache_hits_total", "Queries answered without a reader.", registry=registry)
        self._bytes = Counter("kg_sent_bytes_total", "Bytes of bodies of answers.", registry=registry)
        self._running = Gauge("kg_jobs", "Queries and views that run or wait.", registry=registry)
        self._readers = Gauge("kg_readers", "Reader processes that run at a time.", registry=registry)
        self._snapshot = Gauge("kg_snapshot", "The generation of the data in force.", registry=registry)
        self._age = Gauge("kg_snapshot_age_seconds", "Seconds since it became current.", registry=registry)

        self._children: dict[tuple[str, int], Counter] = {}
        self._outcomes: dict[str, Counter] = {}

    def count(self, method: str, recorded: Record) -> None:
        """Count a finished request."""
        key = (method if method in _METHODS else "other", recorded.status)
        if key not in self._children:
            self._children[key] = self._requests.labels(key[0], str(recorded.status))
        self._children[key].inc()
        self._bytes.inc(recorded.sent)
        if recorded.query is not None:
            if recorded.outcome not in self._outcomes:
                self._outcomes[recorded.outcome] = self._queries.labels(recorded.outcome)
            self._outcomes[recorded.outcome].inc()
            self._seconds.observe(recorded.seconds)
            self._rows.inc(recorded.rows or 0)
            if recorded.cached:
                self._cached.inc()

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


ROUTES: Final = [Route("/metrics", _metrics)]
"""Addresses that Prometheus reads."""
