"""Watching the graph: whether it was watched long enough, what changed, and whether everybody has gone."""

from __future__ import annotations

import asyncio
from contextlib import aclosing, contextmanager
from typing import TYPE_CHECKING, Final

from kg.robot.ros2.graph import computation_graph

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, Callable, Iterator

    from kg.robot.connection import ComputationGraph, GraphProblem
    from kg.robot.ros2.middleware import Neighbourhood

__all__ = ["Watch"]

_PAUSE: Final = 0.05
"""Seconds in which changes are gathered: a node that starts tells a dozen ends."""
_GONE: Final = 2.0
"""Seconds without anybody after which a robot is lost; a node that starts anew is back sooner."""
_MOST_PROBLEMS: Final = 100


class Watch:
    """The graph as the middleware tells it, for those that wait on it.

    Args:
        look: gives who is there.
        settle: seconds until the graph is complete. Discovery is a matter of the network: its time is the wall's,
            also where that of the robot is simulated.

    `amend` may add to a graph what the middleware does not tell.
    """

    def __init__(self, look: Callable[[], Neighbourhood], settle: float) -> None:
        self._look = look
        self.amend: Callable[[ComputationGraph], ComputationGraph] = lambda seen: seen
        self._loop = asyncio.get_running_loop()
        self._settled = self._loop.time() + settle
        self._watchers: set[asyncio.Event] = set()
        self._problems: dict[GraphProblem, None] = {}
        self._seen = False
        self._leaving: asyncio.TimerHandle | None = None
        self._gathering: asyncio.TimerHandle | None = None
        self._cached: ComputationGraph | None = None
        self.lost: asyncio.Future[str] = self._loop.create_future()
        self.closed = False
        self._settling = self._loop.call_at(self._settled, self.changed)

    @property
    def complete(self) -> bool:
        """Whether the graph was watched long enough."""
        return self._loop.time() >= self._settled

    def now(self) -> ComputationGraph:
        """Return the graph as it is."""
        if self._cached is None or self._cached.complete != self.complete:
            seen = self.amend(computation_graph(self._look(), complete=self.complete))
            self._seen = self._seen or bool(seen.nodes)
            problems = sorted({*seen.problems, *self._problems})
            self._cached = type(seen)(seen.ros, seen.nodes, seen.ends, tuple(problems), seen.complete)
        return self._cached

    def report(self, problem: GraphProblem) -> None:
        """Add a problem that was met; each is told once, and the first hundred are enough."""
        if problem not in self._problems and len(self._problems) < _MOST_PROBLEMS:
            self._problems[problem] = None
            self.changed()

    def changed(self) -> None:
        """Wake up who watches, a moment later."""
        self._cached = None
        if self._gathering is None and not self.closed:
            self._gathering = self._loop.call_later(_PAUSE, self._tell)

    def _tell(self) -> None:
        self._gathering = None
        self._count()
        for watcher in self._watchers:
            watcher.set()

    def _count(self) -> None:
        """Notice that nobody is there any more, where somebody was."""
        if self.now().nodes:
            if self._leaving is not None:
                self._leaving.cancel()
                self._leaving = None
        elif self._seen and self._leaving is None and not self.lost.done():
            self._leaving = self._loop.call_later(_GONE, self._lose, "all nodes of the robot have left the domain")

    def _lose(self, why: str) -> None:
        if not self.lost.done():
            self.lost.set_result(why)

    async def settled(self) -> ComputationGraph:
        """Return the graph when it is complete."""
        await self.until(lambda graph: graph.complete)
        return self.now()

    async def until(self, true: Callable[[ComputationGraph], bool]) -> bool:
        """Return when a condition holds of the graph: True, or False when the connection was closed before."""
        async with aclosing(self.changes()) as graphs:
            async for graph in graphs:
                if true(graph):
                    return True
        return False

    async def changes(self) -> AsyncGenerator[ComputationGraph]:
        """Yield the graph as it is, and each time that it has changed, until it is closed."""
        last: ComputationGraph | None = None
        with self._watching() as event:
            while not self.closed:
                event.clear()
                if (graph := self.now()) != last:
                    yield graph
                    last = graph
                    continue
                await event.wait()

    @contextmanager
    def _watching(self) -> Iterator[asyncio.Event]:
        event = asyncio.Event()
        self._watchers.add(event)
        try:
            yield event
        finally:
            self._watchers.discard(event)

    def close(self) -> None:
        """End all watching."""
        self.closed = True
        for timer in (self._settling, self._leaving, self._gathering):
            if timer is not None:
                timer.cancel()
        for watcher in self._watchers:
            watcher.set()
