"""Reader pool of one store, for asyncio: `ask` a query, `call` a view, `cancel` a request.

async with Readers(layout) as readers:
    async with readers.ask(Question(text="ASK {}", formats={"boolean": "json"}), seconds=30) as answer:
        answer.head.kind                                    "boolean"
        body = b"".join([part async for part in answer.parts()])
        answer.end.rows                                     1

`scheduler` decides which request runs when. The response of a quick query is yielded when complete, that of a long one
as a stream.
"""

from __future__ import annotations

import asyncio
import secrets
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any, Final, Self

import msgspec

from kg.errors import KgError, QueryError
from kg.query.readers.answers import Answer, Job
from kg.query.readers.cache import AnswerCache, CachedResponse, CacheStats, Pointer
from kg.query.readers.lookups import LookUps
from kg.query.readers.messages import Call, Configuration, Question, frame
from kg.query.readers.processes import PROGRAM, Fleet, Spawner
from kg.query.readers.scheduler import Run, Scheduler
from kg.query.runner import DeadlineError
from kg.store.following import Following

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Mapping, Sequence

    from kg.store.layout import Layout

__all__ = ["Answer", "Job", "Readers", "Stats"]

_LOOK_SECONDS: Final = 0.5
"""Interval at which the pool checks for new data."""

_PREPARE_SECONDS: Final = 2.0
"""Delay before preparation, so short-lived sessions skip it."""

_CLOSED: Final = "the readers are closed"


class Stats(msgspec.Struct, frozen=True):
    """Reader pool statistics: `idle` processes, queries in a slot (`quick`), `long` queries, and `waiting` requests.

    `views` is the number of running calls of views. `spawned` counts all processes so far, `ended` those that exited,
    by cause: `deadline`, `cancelled`, `left` (the client disconnected), `memory`, `crashed`, `busy` (too many long
    queries), `retired` (surplus, too large, or with lowered priority). `snapshot` is the current data.
    """

    idle: int
    quick: int
    long: int
    views: int
    waiting: int
    spawned: int
    ended: dict[str, int]
    cache: CacheStats
    snapshot: str | None


class Readers:
    """Reader processes of one store.

    `processes` is the number of slots for queries, and of long queries that run at a time. At most `queue` queries wait
    for a slot. `memory` is the memory limit of a request in bytes. `cache` is the size of the cache of responses in
    bytes; 0 turns it off. `calls` and `settings` are those of `messages.Configuration`. `prepare` names a view that
    computes shared results in advance. It is called without a deadline soon after the start, and after each change of
    the data. The standard error of readers is logged, and they do not receive signals from the keyboard of a terminal.
    `program` is the command of the fork server.
    """

    def __init__(  # noqa: PLR0913 - all by name
        self,
        layout: Layout,
        *,
        processes: int = 2,
        queue: int = 256,
        memory: int | None = 2 << 30,
        cache: int = 0,
        calls: str = "",
        prepare: str = "",
        settings: Mapping[str, Any] | None = None,
        program: Sequence[str] = PROGRAM,
    ) -> None:
        self.layout = layout
        self._prepare = prepare
        self._preparing: asyncio.Task[None] | None = None
        self.jobs: dict[str, Job] = {}
        configuration = Configuration(str(layout.root), memory, calls, dict(settings or {}), layout.address)
        self._fleet = Fleet(Spawner(configuration, program), processes + 1)
        self._scheduler = Scheduler.of(processes, queue, self._fleet)
        self.following = Following(layout) if layout.address is not None else None
        """Looks at the data of a server, which may be new before we notice: answers of queries are not kept."""
        self._cache = AnswerCache(0 if self.following else cache)
        self._pointer = Pointer(layout)
        self._look_ups = LookUps(layout)
        self._looking: asyncio.Task[None] | None = None
        self._following: asyncio.Task[None] | None = None
        self._closed = False

    async def __aenter__(self) -> Self:
        self._fleet.fill()
        self._looking = asyncio.get_running_loop().create_task(self._look())
        if self.following is not None:
            self._following = asyncio.get_running_loop().create_task(_follow(self.following))
        self._begin_preparing()
        return self

    async def __aexit__(self, *_: object) -> None:
        self._closed = True
        for job in tuple(self.jobs.values()):
            job.end(QueryError("KG510", _CLOSED))
        for task in (self._looking, self._following, self._preparing):
            if task is not None:
                task.cancel()
                await asyncio.gather(task, return_exceptions=True)
        await self._look_ups.close()
        await self._fleet.close()

    @asynccontextmanager
    async def ask(
        self, request: Question | Call, *, seconds: float | None = None, job: str | None = None, client: str = ""
    ) -> AsyncIterator[Answer]:
        """Send a request and yield its response after the head has arrived; leaving the context early cancels it.

        `job` is the identity to cancel it by. Slots go to clients (`client`) in turn. The deadline `seconds` counts
        from here until the caller leaves the context, including the wait. So a slow caller does not occupy a reader for
        longer.

        Raises KgError: an error of the reader; KG503 deadline, KG505 a job of this identity runs, KG507 memory limit,
        KG508 the reader exited, KG509 busy, KG510 cancelled.
        """
        message = frame(request)
        room = self._cache.largest if isinstance(request, Question) else 0
        text = request.text if isinstance(request, Question) else request.name
        entry = Job(job or secrets.token_urlsafe(16), text, client)
        entry.own = isinstance(request, Call) and request.name == self._prepare
        cached = self._cache.get(message, self._pointer.snapshot()) if room else None
        if cached is not None:
            yield Answer.of(entry, cached)
            return
        if self._closed:
            raise QueryError("KG510", _CLOSED)
        if entry.identity in self.jobs:
            raise QueryError("KG505", "the job with this identity is still running", hint="Choose another identity.")
        self.jobs[entry.identity] = entry
        timer = asyncio.get_running_loop().call_later(seconds, _expire, entry, seconds) if seconds else None
        run = Run(self._scheduler, entry, message, room, view=isinstance(request, Call))
        try:
            answer = await run.begin()
            yield answer
            if (body := answer.copy) is not None and answer.end is not None:
                self._cache.put(message, CachedResponse(answer.head, body, answer.end), self._pointer.snapshot())
        except KgError as error:
            run.error = error
            raise
        finally:
            if timer:
                timer.cancel()
            self.jobs.pop(entry.identity, None)
            run.leave()

    def cached(self, message: bytes) -> CachedResponse | None:
        """Return the cached response to a question, framed as `message`, from the current data; None if not cached."""
        snapshot = self._pointer.snapshot()
        if snapshot is None or not self._cache.has(message, snapshot):
            return None
        return self._cache.get(message, snapshot)

    def look_up(self, question: Question, message: bytes) -> CachedResponse | None:
        """Return the response to a question that needs no reader (see `lookups`), and cache it; else None.

        `message` is the frame of the question.
        """
        snapshot = self._pointer.snapshot()
        response = None if snapshot is None or self._closed else self._look_ups.answer(question, snapshot)
        if response is not None:
            self._cache.put(message, response, snapshot)
        return response

    async def call(
        self, name: str, arguments: Mapping[str, Any], *, seconds: float | None = 60, client: str = ""
    ) -> bytes:
        """Return the JSON of a view; raises as `ask`."""
        async with self.ask(Call(name, dict(arguments)), seconds=seconds, client=client) as answer:
            return b"".join([part async for part in answer.parts()])

    def cancel(self, identity: str) -> bool:
        """Cancel a request; return false if none with this identity runs."""
        job = self.jobs.get(identity)
        if job is not None:
            job.end(QueryError("KG510", "the query was cancelled"))
        return job is not None

    def moved(self) -> None:
        """Check for new data now instead of within half a second."""
        self._look_ups.release(self._pointer.snapshot())
        self._fleet.refresh()

    def stats(self) -> Stats:
        """Return the statistics."""
        scheduler, fleet = self._scheduler, self._fleet
        return Stats(
            idle=fleet.idle,
            quick=scheduler.queries.used,
            long=scheduler.long.size,
            views=scheduler.views.used,
            waiting=scheduler.queries.waiting + scheduler.views.waiting,
            spawned=fleet.spawned,
            ended=dict(fleet.ended),
            cache=self._cache.stats(),
            snapshot=self._pointer.snapshot(),
        )

    async def _look(self) -> None:
        """Check for new data regularly."""
        current = self._pointer.snapshot()
        while True:
            await asyncio.sleep(_LOOK_SECONDS)
            newest = self._pointer.snapshot()
            if newest != current:
                current = newest
                self.moved()
                self._begin_preparing()

    def _begin_preparing(self) -> None:
        if self._preparing is not None:
            self._preparing.cancel()
        self._preparing = asyncio.get_running_loop().create_task(self._run_prepare()) if self._prepare else None

    async def _run_prepare(self) -> None:
        await asyncio.sleep(_PREPARE_SECONDS)
        # A request that needs the preparation reports the error.
        with suppress(KgError):
            await self.call(self._prepare, {}, seconds=None)


async def _follow(following: Following) -> None:
    while True:
        await asyncio.to_thread(following.look)
        await asyncio.sleep(following.pause)


def _expire(job: Job, seconds: float) -> None:
    message = f"the query ran longer than {seconds:g} s"
    job.end(DeadlineError("KG503", message, hint="Ask less, or raise the timeout."))
