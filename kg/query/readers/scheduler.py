"""Scheduling of requests on readers: one queue, short first turns, and shared processors for long queries.

Each query waits for a *slot*, and slots go to the clients in turn (`slots.Slots`). In its slot it has a first turn:
10 ms of processor time while others wait, else 100 ms. Most queries end in it. Others continue in their reader without
a slot, as *long* queries. As many long queries run at a time as there are slots; the others are paused
(`sharing.Sharing`). Those with the least run time go next. After 100 ms of processor time the priority of the reader is
lowered. No query is restarted, and costs are not estimated in advance.

So a query waits for a slot at most as long as the first turns of the requests ahead of it, however many long queries
there are. A query is refused (KG509) only if the queue is full or too many long queries are held. Each held query is a
process that may use the memory of one query.

Calls of views have slots of their own and no turns, because their work is bounded and a person waits for the page.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import KgError
from kg.query.readers.answers import Answer
from kg.query.readers.sharing import Sharing
from kg.query.readers.slots import Slots

if TYPE_CHECKING:
    from kg.query.readers.fleet import Fleet
    from kg.query.readers.jobs import Job
    from kg.query.readers.processes import Process

_TURN_SECONDS: Final = 0.01
_LONE_TURN_SECONDS: Final = 0.1
"""Processor time of the first turn, while other queries wait and while none does."""
_TURN_ROUNDS: Final = 3
"""Limit of a turn's elapsed time, as a multiple of its processor time, if the reader waits for a processor or disk."""
_CHECK_SECONDS: Final = 0.005
"""Interval at which the end of a turn is checked."""
_TURN_BYTES: Final = 1 << 20
"""A larger response ends the turn, and is streamed."""
_LONG_PER_SLOT: Final = 40
"""Long queries held per slot, running and paused. A paused reader uses about 6 MB plus the memory of its query."""

_CAUSES: Final = {"KG503": "deadline", "KG510": "cancelled", "KG507": "memory", "KG508": "crashed", "KG509": "busy"}


@dataclass(frozen=True, slots=True)
class Scheduler:
    """State shared by all requests: slots for queries and for views, the readers of long queries, and all readers."""

    queries: Slots
    views: Slots
    long: Sharing
    fleet: Fleet

    @classmethod
    def of(cls, processes: int, queue: int, fleet: Fleet) -> Scheduler:
        """Return a scheduler with `processes` slots; at most `queue` queries wait, and as many calls of views."""
        long = Sharing(processes, processes * _LONG_PER_SLOT)
        return cls(Slots(processes, queue), Slots(processes + 1, queue), long, fleet)


class Run:
    """Run of one request, sent as `message`.

    Up to `copied` bytes of its response are retained. `view` is whether it calls a view.
    """

    def __init__(self, scheduler: Scheduler, job: Job, message: bytes, copied: int, *, view: bool = False) -> None:
        self._scheduler = scheduler
        self._job = job
        self._message = message
        self._copied = copied
        self._view = view
        self._slots: Slots | None = None
        self._process: Process | None = None
        self._answer: Answer | None = None
        self.error: KgError | None = None

    async def begin(self) -> Answer:
        """Return the response, which is complete or that of a long query; raises as `Answer.parts`, and KG509."""
        try:
            # Idle readers may have been killed unnoticed.
            for _ in range(1 + self._scheduler.fleet.idle):
                try:
                    return await self._run()
                except KgError:
                    if self._process is None or not self._process.unread or self._job.cause is not None:
                        raise
                    self._leave_reader("crashed")
                    self._leave_slot()
            return await self._run()
        except KgError as error:
            # Report the cause of the cancellation rather than its consequence.
            raise self._job.cause or error from error

    def leave(self) -> None:
        """Release the reader and the slot; a running query is killed."""
        self._leave_reader()
        self._leave_slot()

    async def _run(self) -> Answer:
        slots = self._scheduler.views if self._view else self._scheduler.queries
        await slots.take(self._job.client, self._job.wait_at)
        self._slots = slots
        self._process = process = await self._scheduler.fleet.take(self._job.wait_at)
        self._job.run_on(process)
        process.start(self._message)
        self._answer = answer = Answer(self._job, process, self._copied)
        if self._view:
            await answer.begin()
        elif await self._ends_in_turn(answer, process):
            self.leave()
        else:
            self._scheduler.long.add(process, self._job.client)
            self._leave_slot()
            await answer.begin()
        return answer

    async def _ends_in_turn(self, answer: Answer, process: Process) -> bool:
        """Receive the response until its first turn is over; return whether it is complete."""
        began = time.monotonic()
        while not await answer.collect(_CHECK_SECONDS, _TURN_BYTES):
            turn = _TURN_SECONDS if self._scheduler.queries.waiting else _LONE_TURN_SECONDS
            late = time.monotonic() - began >= turn * _TURN_ROUNDS
            if late or process.used() >= turn or answer.buffered_bytes > _TURN_BYTES:
                return False
        return True

    def _leave_reader(self, cause: str | None = None) -> None:
        process, self._process, self._job.process = self._process, None, None
        if process is None:
            return
        self._scheduler.long.remove(process)
        if cause or not self._is_ready():
            self._scheduler.fleet.drop(process, cause or self._why())
        else:
            self._scheduler.fleet.put(process)

    def _is_ready(self) -> bool:
        """Return whether the reader can take another request."""
        finished = self._answer is not None and self._answer.finished and not self._answer.last
        return finished and self._job.cause is None and (self.error is None or self.error.code != "KG507")

    def _why(self) -> str:
        """Return the cause for replacing the reader."""
        error = self._job.cause or self.error
        finished = self._answer is not None and self._answer.finished
        return _CAUSES.get(error.code if error else "", "retired" if finished else "left")

    def _leave_slot(self) -> None:
        if self._slots is not None:
            self._slots.give_back()
            self._slots = None
