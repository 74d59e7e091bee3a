"""The way of one request through the lanes and through a reader."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import KgError
from kg.query.readers.answers import Answer
from kg.query.readers.known import Known, Marks
from kg.query.readers.lanes import Lane
from kg.query.readers.looks import looks_bounded

if TYPE_CHECKING:
    from kg.query.readers.fleet import Fleet
    from kg.query.readers.jobs import Job
    from kg.query.readers.processes import Process

__all__ = ["Course", "Lanes"]

_PATIENCE: Final = 0.25
_LEAST_PATIENCE: Final = 0.1
_PROMISE: Final = 0.4
"""Seconds: how long a request may stay in the first lane, and at least; where many wait, so long that the last of them
would have its turn in about as much as is promised."""

_ROUNDS: Final = 4
"""So many times as long it may stay when its reader gets no processor."""
_BUSY_SHARE: Final = 0.25
"""Of its time a reader has worked at least so much, if its request is slow."""

_QUANTUM: Final = 0.02
"""Seconds of processor time that one on trial has before it gives its slot to those who wait for one."""
_LOOK_SECONDS: Final = 0.01
"""How often is looked whether one has been in the first lane, or on trial, for long enough."""

_HELD_BYTES: Final = 1 << 20
"""How large an answer may become in the first lane."""

_DOUBT_NICENESS: Final = 5
_SLOW_NICENESS: Final = 10
"""How much readers give way to others (nice(2)) that run what is suspected and what was found to be slow.

More would keep slow requests from ending on a machine that is busy with other things, as robots are."""

_FLOOD_ROUNDS: Final = 2
"""So many times as many requests as run at a time are a flood when they were found to be slow in short order."""

_CAUSES: Final = {"KG503": "deadline", "KG510": "cancelled", "KG507": "memory", "KG508": "crashed"}


@dataclass(slots=True)
class Lanes:
    """What requests share: lanes, the readers, and what became of other requests.

    A query begins in `quick`; in a flood, when nothing is known of such, on `trial`, and when it is suspected to be
    slow, in `doubt`, which is a trial too; `slow` is for those that were. `views` is for calls of views, whose work is
    bounded and which people wait for: they neither give way nor begin anew.
    """

    quick: Lane
    trial: Lane
    doubt: Lane
    slow: Lane
    views: Lane
    fleet: Fleet
    known: Known

    @classmethod
    def of(cls, processes: int, most: int, queue: int, fleet: Fleet) -> Lanes:
        """Return lanes for so many processes each; `queue` requests may wait for the slow one, `most` for another."""
        quick, trial, doubt = Lane(processes, most), Lane(processes, most), Lane(processes, most, _DOUBT_NICENESS)
        slow, views = Lane(processes, queue, _SLOW_NICENESS), Lane(processes + 1, most)
        return cls(quick, trial, doubt, slow, views, fleet, Known(_FLOOD_ROUNDS * processes))

    @property
    def first_ones(self) -> tuple[Lane, ...]:
        """The lanes that requests begin in."""
        return self.quick, self.trial, self.doubt

    def first(self, marks: Marks, text: str) -> Lane:
        """Return the lane that a request begins in."""
        guess = self.known.guess(marks)
        if guess is None:
            return self.trial if looks_bounded(text) else self.doubt
        return self.quick if guess else self.doubt

    def is_over(self, lane: Lane, seconds: float, used: float | None) -> bool:
        """Tell whether a request has been in the first lane or on trial for long enough, with so much processor time.

        On a machine that has other things to do a request is not slow for having waited for a processor: as long as its
        reader got little of that it is given more time, some times over.
        """
        patience = _LEAST_PATIENCE
        if lane is self.quick:
            patience = max(patience, min(_PATIENCE, _PROMISE * lane.slots / (1 + lane.waiting)))
        elif lane.waiting and used is not None and used >= _QUANTUM:
            return True
        if seconds < patience:
            return False
        return used is None or used > patience * _BUSY_SHARE or seconds >= patience * _ROUNDS


class Course:
    """One request, sent as `message`; of its answer up to `copied` bytes are copied. `view`: it calls a view."""

    def __init__(self, lanes: Lanes, job: Job, message: bytes, copied: int, *, view: bool = False) -> None:
        self._lanes = lanes
        self._job = job
        self._message = message
        self._marks = Marks.of(message, job.text)
        self._copied = copied
        self._view = view
        self._lane: Lane | None = None
        self._process: Process | None = None
        self._answer: Answer | None = None
        self.error: KgError | None = None

    async def begin(self) -> Answer:
        """Return the answer, which is whole or in the second lane; raises as `Answer.parts`, and KG509."""
        try:
            # Those that wait may have been killed without anybody having noticed yet.
            for _ in range(1 + self._lanes.fleet.idle):
                try:
                    return await self._run()
                except KgError:
                    if self._process is None or not self._process.unread or self._job.cause is not None:
                        raise
                    self._leave_reader("crashed")
                    self._leave_lane()
            return await self._run()
        except KgError as error:
            # What fails because the request was ended is not what its caller wants to hear.
            raise self._job.cause or error from error

    async def _run(self) -> Answer:
        if self._view:
            return await self._run_in(self._lanes.views)
        answer = None
        if not self._lanes.known.is_slow(self._marks):
            answer = await self._quickly()
        return answer or await self._run_in(self._lanes.slow)

    def leave(self) -> None:
        """Give back all that is held; what still runs is ended."""
        self._leave_reader()
        self._leave_lane()

    async def _quickly(self) -> Answer | None:
        """Run in the first lane or on trial; None when the request is to be made again in the second lane."""
        if (lane := await self._enter_first()) is None:
            return None
        answer, process = await self._start(lane)
        if await self._ends_in_time(answer, process, lane):
            self._lanes.known.note(self._marks, quick=True)
            self.leave()
            return answer
        self._lanes.known.note(self._marks, quick=False)
        if not self._lanes.slow.try_take():
            self._leave_reader("moved")
            self._leave_lane()
            return None
        self._leave_lane()
        self._lane = self._lanes.slow
        process.give_way(self._lane.niceness)
        await answer.begin()
        return answer

    async def _enter_first(self) -> Lane | None:
        """Enter the lane to begin in, as it is when the request's turn has come; None when that is the second one."""
        known = self._lanes.known
        while not known.is_slow(self._marks):
            lane = self._lanes.first(self._marks, self._job.text)
            await self._enter(lane)
            # What becomes of others while this one waits tells where it belongs.
            if lane is self._lanes.first(self._marks, self._job.text) and not known.is_slow(self._marks):
                return lane
            self._leave_lane()
        return None

    async def _ends_in_time(self, answer: Answer, process: Process, lane: Lane) -> bool:
        """Wait for the end of an answer as long as the lane allows; tell whether it came."""
        began, before = time.monotonic(), process.processor_seconds()
        while not await answer.collect(_LOOK_SECONDS, _HELD_BYTES):
            now = process.processor_seconds()
            used = None if now is None or before is None else now - before
            if answer.held_bytes > _HELD_BYTES or self._lanes.is_over(lane, time.monotonic() - began, used):
                return False
        return True

    async def _run_in(self, lane: Lane) -> Answer:
        await self._enter(lane)
        answer, _ = await self._start(lane)
        await answer.begin()
        return answer

    async def _enter(self, lane: Lane) -> None:
        await lane.take(self._job.wait_at)
        self._lane = lane

    async def _start(self, lane: Lane) -> tuple[Answer, Process]:
        self._process = process = await self._lanes.fleet.take(self._job.wait_at, lane.niceness)
        self._job.run_on(process)
        process.send(self._message)
        self._answer = Answer(self._job, process, self._copied)
        return self._answer, process

    def _leave_reader(self, cause: str | None = None) -> None:
        process, self._process, self._job.process = self._process, None, None
        if process is None:
            return
        if cause or not self._is_ready():
            self._lanes.fleet.drop(process, cause or self._why())
            return
        self._lanes.fleet.put(process)

    def _is_ready(self) -> bool:
        """Tell whether the reader waits for another request."""
        settled = self._answer is not None and self._answer.settled and not self._answer.last
        return settled and self._job.cause is None and (self.error is None or self.error.code != "KG507")

    def _why(self) -> str:
        """Return what ends the reader."""
        error = self._job.cause or self.error
        settled = self._answer is not None and self._answer.settled
        return _CAUSES.get(error.code if error else "", "retired" if settled else "left")

    def _leave_lane(self) -> None:
        if self._lane is not None:
            self._lane.give_back()
            self._lane = None
