"""Driving by hand: what somebody does with a capability while their page is open and says so."""

from __future__ import annotations

import asyncio
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.tasks import ended
from kg.server.errors import problem
from kg.server.robot.ends import failure

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability
    from kg.robot.driving import Driver, Outcome
    from kg.server.robot.listeners import Listener, Listeners

__all__ = ["SILENT", "Hands"]

SILENT: Final = 4.0
"""Seconds that a page may say nothing while it drives; then nobody is thought to be there."""
_LONGEST: Final = 60.0
"""Seconds that one movement by hand takes at most; what ends by itself, as a goal, may take ten times as long."""
_USUAL: Final = 1.0
"""Seconds of a movement for which none are said."""
_MOST: Final = 16
"""How many things are done by hand at a time."""


class Hands:
    """What is done by hand, each a task that belongs to a page."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._tasks: dict[asyncio.Task[Outcome], Listener] = {}

    @property
    def busy(self) -> bool:
        """Whether anything is done by hand."""
        return bool(self._tasks)

    def do(
        self,
        driver: Driver,
        listener: Listener,
        capability: Capability,
        arguments: Mapping[str, Any],
        seconds: float | None,
    ) -> None:
        """Begin to do something; how it goes is told to all pages.

        Raises:
            RobotError: KG847 when too much is done already, KG848 for a time that is too long.
        """
        if len(self._tasks) >= _MOST:
            raise RobotError("KG847", f"{_MOST} things are done by hand already")
        lasts = any(way.rate > 0 for way in capability.ways)
        most = _LONGEST if lasts else 10 * _LONGEST
        chosen = (_USUAL if lasts else most) if seconds is None else seconds
        if not 0 < chosen <= most:
            raise RobotError(
                "KG848", f"`seconds` is {chosen:g}; a manual movement takes more than 0 and at most {most:g} s"
            )
        listener.heard = asyncio.get_running_loop().time()
        work = driver.do(capability.name, dict(arguments), seconds=chosen)
        task = asyncio.ensure_future(work)
        self._tasks[task] = listener
        task.add_done_callback(partial(self._over, capability, listener))
        self._tell("doing", capability, listener)

    def _over(self, capability: Capability, listener: Listener, task: asyncio.Task[Outcome]) -> None:
        self._tasks.pop(task, None)
        error = failure(task, "driving by hand")
        if error is not None:
            self._tell("failed", capability, listener, problem=problem(error))
        elif not task.cancelled() and (did_not_move := task.result().problem) is not None:
            self._tell("failed", capability, listener, problem=problem(did_not_move))
        else:
            self._tell("stopped" if task.cancelled() else task.result().ended, capability, listener)

    def _tell(self, state: str, capability: Capability, listener: Listener, **more: Any) -> None:
        event = {"event": "hand", "state": state, "capability": capability.name, **more}
        self._listeners.tell({**event, "own": False}, but=listener)
        listener.tell({**event, "own": True})

    async def watch(self) -> None:
        """Stop what belongs to pages that say nothing any more, until cancelled."""
        while True:
            await asyncio.sleep(SILENT / 4)
            latest = asyncio.get_running_loop().time() - SILENT
            await self.stop({one for one in self._tasks.values() if one.heard < latest})

    async def stop(self, whose: set[Listener] | None = None) -> None:
        """Stop what is done by hand, by certain pages or by all."""
        await ended(*(task for task, listener in self._tasks.items() if whose is None or listener in whose))
