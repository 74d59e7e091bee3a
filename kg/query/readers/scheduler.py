"""Scheduling of requests on readers: one queue, short first turns, and shared processors for long queries.

Each query waits for a *slot*, and slots go to the clients in turn (`Slots`). In its slot it has a first turn:
10 ms of processor time while others wait, else 100 ms. Most queries end in it. Others continue in their reader without
a slot, as *long* queries. As many long queries run at a time as there are slots; the others are paused
(`Sharing`). Those with the least run time go next. After 100 ms of processor time the priority of the reader is
lowered. No query is restarted, and costs are not estimated in advance.

So a query waits for a slot at most as long as the first turns of the requests ahead of it, however many long queries
there are. A query is refused (KG509) only if the queue is full or too many long queries are held. Each held query is a
process that may use the memory of one query.

Calls of views have slots of their own and no turns, because their work is bounded and a person waits for the page.
"""

from __future__ import annotations

import asyncio
import time
from collections import OrderedDict, defaultdict, deque
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import KgError, QueryError
from kg.query.readers.answers import Answer, Job

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.query.readers.processes import Fleet, Process


class Slots:
    """`slots`, each held by one request at a time; at most `queue` requests wait.

    Free slots go to the waiting clients in turn. Of the requests of one client, the oldest goes first. If more of them
    wait than there are slots, the newest and the oldest alternate. So a burst does not delay later requests for long,
    and each of its requests is served.

    If the queue is full, the client with the most waiting requests loses its newest one. So one client cannot fill the
    queue.
    """

    def __init__(self, slots: int, queue: int) -> None:
        self.used = 0
        self._slots = slots
        self._queue = queue
        self._newest = False
        self._waiting: OrderedDict[str, deque[asyncio.Future[None]]] = OrderedDict()

    @property
    def waiting(self) -> int:
        """Number of waiting requests."""
        return sum(map(len, self._waiting.values()))

    async def take(self, client: str, register: Callable[[asyncio.Future[None]], object]) -> None:
        """Take a slot, after waiting for one. `register` receives a future; an exception set on it ends the wait.

        Raises QueryError: KG509 if the queue is full and no other client has more requests in it.
        """
        if self.used < self._slots and not self._waiting:
            self.used += 1
            return
        if self.waiting >= self._queue:
            self._make_room(client)
        place: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(client, deque()).append(place)
        register(place)
        try:
            await place
        except BaseException:
            self._forget(client, place)
            if place.done() and not place.cancelled() and place.exception() is None:
                # The slot was granted at the moment when the wait ended.
                self.give_back()
            raise

    def give_back(self) -> None:
        """Release a slot, or pass it on to the next client."""
        while self._waiting:
            client, places = next(iter(self._waiting.items()))
            self._waiting.move_to_end(client)
            self._newest = not self._newest
            place = places[-1 if self._newest and len(places) > self._slots else 0]
            self._forget(client, place)
            if not place.done():
                place.set_result(None)
                return
        self.used -= 1

    def _make_room(self, client: str) -> None:
        """Remove the newest request of the client with the most waiting requests; KG509 if that is `client`."""
        busy = QueryError("KG509", f"{self.waiting} queries are waiting", hint="Try again in a second.")
        longest = max(self._waiting, key=lambda name: len(self._waiting[name]), default=client)
        if len(self._waiting.get(longest, ())) <= len(self._waiting.get(client, ())) + 1:
            raise busy
        place = self._waiting[longest][-1]
        self._forget(longest, place)
        if not place.done():
            place.set_exception(busy)

    def _forget(self, client: str, place: asyncio.Future[None]) -> None:
        places = self._waiting.get(client, deque())
        if place in places:
            places.remove(place)
        if not places:
            self._waiting.pop(client, None)


_ROUND_SECONDS: Final = 0.1
"""Interval at which the running readers are chosen again."""
_NICE_SECONDS: Final = 0.1
"""Processor time after which a reader gets a lower priority, for good. It then takes no further query."""


class Sharing:
    """Readers of long queries. `slots` of them run at a time, the others are paused; at most `most` are held.

    Readers with the least run time run next: first by the time of all long queries of their client, then by their own.
    Times of single queries count as equal up to a factor of two, and then the oldest goes first. So queries of similar
    length run one after the other, and a longer query does not delay them.

    Time counts while a reader may run, working or waiting, so no reader can hold its turn by waiting.
    """

    def __init__(self, slots: int, most: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._slots = slots
        self._most = most
        self._clock = clock
        self._clients: dict[Process, str] = {}
        self._seconds: dict[Process, float] = {}
        self._running: set[Process] = set()
        self._since = 0.0
        self._timer: asyncio.TimerHandle | None = None

    @property
    def size(self) -> int:
        """Number of held readers, running and paused."""
        return len(self._clients)

    def add(self, process: Process, client: str) -> None:
        """Add a reader that runs a query of `client`.

        Raises QueryError: KG509 if too many are held.
        """
        if self.size >= self._most:
            raise QueryError("KG509", f"{self.size} long queries are running", hint="Try again in a few seconds.")
        self._charge()
        self._clients[process] = client
        self._seconds[process] = 0.0
        self._running.add(process)
        self._choose()

    def remove(self, process: Process) -> None:
        """Remove a reader, if it is held; it may be paused."""
        if process in self._clients:
            self._charge()
            del self._clients[process], self._seconds[process]
            self._running.discard(process)
            self._choose()

    def turn(self) -> None:
        """Choose the readers that run next."""
        self._charge()
        self._choose()

    def _charge(self) -> None:
        now = self._clock()
        for process in self._running:
            self._seconds[process] += now - self._since
            if not process.nice and process.used() >= _NICE_SECONDS:
                process.give_way()
        self._since = now

    def _choose(self) -> None:
        of_client: defaultdict[str, float] = defaultdict(float)
        for process, client in self._clients.items():
            of_client[client] += self._seconds[process]
        order = sorted(self._clients, key=lambda one: (of_client[self._clients[one]], _level(self._seconds[one])))
        chosen = set(order[: self._slots])
        for process in self._running - chosen:
            process.pause()
        for process in chosen - self._running:
            process.resume()
        self._running = chosen
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if self.size:
            self._timer = asyncio.get_running_loop().call_later(_ROUND_SECONDS, self.turn)


def _level(seconds: float) -> int:
    """Return 0 for less than a turn, and one more for each doubling of `seconds`."""
    return int(seconds / _ROUND_SECONDS).bit_length()


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
