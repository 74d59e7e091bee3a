"""The readers of one store, for asyncio: `ask` a query, `call` a view, `cancel` what runs.

async with Readers(layout) as readers:
    async with readers.ask(Question(text="ASK {}", formats={"boolean": "json"}), seconds=30) as answer:
        answer.head.kind                                    "boolean"
        body = b"".join([part async for part in answer.parts()])
        answer.end.rows                                     1

`scheduler` decides which request runs when. An answer is given out when it is whole, or when its query turns out to be
long and is sent while it is found.
"""

from __future__ import annotations

import asyncio
import secrets
from contextlib import asynccontextmanager, suppress
from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.errors import KgError, QueryError
from kg.query.readers.answers import Answer
from kg.query.readers.cache import AnswerCache, CacheStats, Kept, Pointer
from kg.query.readers.fleet import Fleet
from kg.query.readers.jobs import Job
from kg.query.readers.lookups import LookUps
from kg.query.readers.messages import Call, Configuration, Question, frame
from kg.query.readers.processes import PROGRAM, Spawner
from kg.query.readers.scheduler import Run, Scheduler
from kg.query.runner import DeadlineError
from kg.store.following import Following

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Mapping, Sequence
    from typing import Self

    from kg.store.layout import Layout

__all__ = ["Answer", "Job", "Readers", "Stats"]

_LOOK_SECONDS: Final = 0.5
"""How often is looked whether the data has changed."""

_PREPARE_SECONDS: Final = 2.0
"""Who opens a store for one question ends before, and pays nothing."""

_CLOSED: Final = "the readers are closed"


class Stats(msgspec.Struct, frozen=True):
    """Figures of the readers: `idle` processes, queries in a slot (`quick`), `long` queries, and `waiting` requests.

    `views` is the number of calls of views that run. `spawned` is how many processes there were, `ended` how many of
    them by cause: `deadline`, `cancelled`, `left` (whoever asked went away), `memory`, `crashed`, `busy` (too many long
    queries), `retired` (not needed any more, grown large, or lowered in priority). `snapshot` is the data in force.
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

    `processes` is the number of slots for queries, and of long queries that run at a time; at most `queue` queries wait
    for a slot. `memory` is how many bytes a request may use. `cache` is how many bytes of answers are kept for
    requests that come again while the data is the same; 0 keeps none. `calls` and `settings` are those of
    `messages.Configuration`. `prepare` names a view that works out what the others then find; it is called without a
    deadline soon after the start, and after the data has changed. What readers say on standard error goes to the log
    alone, and keys that end the programs of a terminal do not reach them. `program` is what they are forked from.
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
        """Send a request and yield its answer, of which the head is there; leaving early ends the work.

        `job` is the identity to cancel it by. The `client` is served in turn with others. The deadline counts from
        here, waiting included, and until the caller has left: a caller that is slow to take an answer does not hold a
        reader for longer.

        Raises:
            KgError: what the reader says; KG503 deadline, KG505 a job of this identity runs, KG507 memory, KG508 the
                reader ended, KG509 busy, KG510 cancelled.
        """
        message = frame(request)
        room = self._cache.largest if isinstance(request, Question) else 0
        text = request.text if isinstance(request, Question) else request.name
        entry = Job(job or secrets.token_urlsafe(16), text, client)
        entry.own = isinstance(request, Call) and request.name == self._prepare
        kept = self._cache.get(message, self._pointer.snapshot()) if room else None
        if kept is not None:
            yield Answer.of(entry, kept)
            return
        self._admit(entry)
        timer = asyncio.get_running_loop().call_later(seconds, _expire, entry, seconds) if seconds else None
        run = Run(self._scheduler, entry, message, room, view=isinstance(request, Call))
        try:
            answer = await run.begin()
            yield answer
            if (body := answer.copy) is not None and answer.end is not None:
                self._cache.put(message, Kept(answer.head, body, answer.end), self._pointer.snapshot())
        except KgError as error:
            run.error = error
            raise
        finally:
            if timer:
                timer.cancel()
            self.jobs.pop(entry.identity, None)
            run.leave()

    def known(self, message: bytes) -> Kept | None:
        """Return the answer to a question, framed as a message, if it is kept for the data in force; else None."""
        snapshot = self._pointer.snapshot()
        if snapshot is None or not self._cache.has(message, snapshot):
            return None
        return self._cache.get(message, snapshot)

    def look_up(self, question: Question, message: bytes) -> Kept | None:
        """Return the answer to a question that needs no reader (see `lookups`), and keep it; else None.

        `message` is the frame of the question.
        """
        snapshot = self._pointer.snapshot()
        found = None if snapshot is None or self._closed else self._look_ups.answer(question, snapshot)
        if found is not None:
            self._cache.put(message, found, snapshot)
        return found

    async def call(
        self, name: str, arguments: Mapping[str, Any], *, seconds: float | None = 60, client: str = ""
    ) -> bytes:
        """Return the JSON that a view answers; raises as `ask`."""
        async with self.ask(Call(name, dict(arguments)), seconds=seconds, client=client) as answer:
            return b"".join([part async for part in answer.parts()])

    def cancel(self, identity: str) -> bool:
        """End a request; False when none of this identity runs."""
        job = self.jobs.get(identity)
        if job is not None:
            job.end(QueryError("KG510", "the query was cancelled"))
        return job is not None

    def moved(self) -> None:
        """Take note at once that the data has changed, which else takes half a second."""
        self._look_ups.release(self._pointer.snapshot())
        self._fleet.refresh()

    def stats(self) -> Stats:
        """Return how the readers do."""
        scheduler, fleet = self._scheduler, self._fleet
        return Stats(
            idle=fleet.idle,
            quick=scheduler.queries.held,
            long=scheduler.long.held,
            views=scheduler.views.held,
            waiting=scheduler.queries.waiting + scheduler.views.waiting,
            spawned=fleet.spawned,
            ended=dict(fleet.ended),
            cache=self._cache.stats(),
            snapshot=self._pointer.snapshot(),
        )

    def _admit(self, job: Job) -> None:
        if self._closed:
            raise QueryError("KG510", _CLOSED)
        if job.identity in self.jobs:
            raise QueryError("KG505", "the job with this identity is still running", hint="Choose another identity.")
        self.jobs[job.identity] = job

    async def _look(self) -> None:
        """Let idle readers go of data that is no longer in force."""
        known = self._pointer.snapshot()
        while True:
            await asyncio.sleep(_LOOK_SECONDS)
            found = self._pointer.snapshot()
            if found != known:
                known = found
                self.moved()
                self._begin_preparing()

    def _begin_preparing(self) -> None:
        if self._preparing is not None:
            self._preparing.cancel()
        self._preparing = asyncio.get_running_loop().create_task(self._run_prepare()) if self._prepare else None

    async def _run_prepare(self) -> None:
        await asyncio.sleep(_PREPARE_SECONDS)
        # Whoever asks for what could not be prepared is told why.
        with suppress(KgError):
            await self.call(self._prepare, {}, seconds=None)


async def _follow(following: Following) -> None:
    while True:
        await asyncio.to_thread(following.look)
        await asyncio.sleep(following.pause)


def _expire(job: Job, seconds: float) -> None:
    message = f"the query ran longer than {seconds:g} s"
    job.end(DeadlineError("KG503", message, hint="Ask less, or raise the timeout."))
