"""The shell's access to the store: queries and views through reader processes, and the current snapshot."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, Final

import msgspec
import pyoxigraph

from kg.errors import KgError
from kg.query.readers.messages import End, Head, Question
from kg.query.readers.pool import Job, Readers
from kg.query.result import Boolean, Graph, Result, Solutions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.settings import Settings
    from kg.store.layout import Layout

_FORMATS: Final = {"rows": "json", "boolean": "json", "graph": "ntriples"}
_PROCESSES: Final = 2
_CACHE_BYTES: Final = 16 << 20
_VIEW_SECONDS: Final = 60.0


class Link:
    """One store, read by processes that are stopped by `close`."""

    def __init__(self, settings: Settings, layout: Layout) -> None:
        self.settings = settings
        self.layout = layout
        self._prefixes: tuple[str | None, Mapping[str, str]] = (None, {})
        self._readers = Readers(
            layout, processes=_PROCESSES, cache=_CACHE_BYTES, calls="kg.views.calls", settings=settings.chosen()
        )

    async def open(self) -> None:
        """Start the readers."""
        await self._readers.__aenter__()

    async def close(self) -> None:
        """Stop the readers and their work."""
        await self._readers.__aexit__(None, None, None)

    async def call(self, view: str, **arguments: Any) -> Any:
        """Return the result of a view; KgError as `Readers.call`."""
        return msgspec.json.decode(await self._readers.call(view, arguments, seconds=_VIEW_SECONDS))

    async def ask(self, text: str, *, job: str, rows: int | None) -> Result:
        """Run a query with at most `rows` rows; KgError as `Readers.ask`, with places in `text`."""
        question = Question(text=text, formats=_FORMATS, rows=rows)
        async with self._readers.ask(question, seconds=self.settings.timeout or None, job=job) as answer:
            body = b"".join([part async for part in answer.parts()])
        assert answer.end is not None  # noqa: S101 - the parts have come to their end
        return await asyncio.to_thread(_result, answer.head, body, answer.end, rows)

    async def prefixes(self, snapshot: str) -> Mapping[str, str]:
        """Return the prefixes of the store, requested once per snapshot."""
        if self._prefixes[0] != snapshot:
            self._prefixes = snapshot, await self.call("prefixes")
        return self._prefixes[1]

    def stop(self, job: str) -> bool:
        """Cancel a query; return False if it is not running."""
        return self._readers.cancel(job)

    def job(self, identity: str) -> Job | None:
        """Return the state of a waiting or running query."""
        return self._readers.jobs.get(identity)

    def snapshot(self) -> int | None:
        """Return the current generation of the store; None if the store is missing or unreadable."""
        try:
            return self.layout.in_force()
        except KgError:
            return None


def _result(head: Head, body: bytes, end: End, limit: int | None) -> Result:
    cut = limit if end.more else None
    if head.kind == "graph":
        triples = tuple(quad.triple for quad in pyoxigraph.parse(body, pyoxigraph.RdfFormat.N_TRIPLES))
        return Graph(triples, end.seconds, head.snapshot, cut)
    answer = pyoxigraph.parse_query_results(body, pyoxigraph.QueryResultsFormat.JSON)
    if isinstance(answer, pyoxigraph.QueryBoolean):
        return Boolean(bool(answer), end.seconds, head.snapshot)
    variables = tuple(variable.value for variable in answer.variables)
    return Solutions(variables, tuple(tuple(row) for row in answer), end.seconds, head.snapshot, cut)
