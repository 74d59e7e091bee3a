"""The program that runs: one at a time, told to all who look on."""

from __future__ import annotations

import asyncio
from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from kg.robot.programs.runner import Runner
from kg.robot.tasks import ended
from kg.server.errors import problem
from kg.server.robot.ends import failure
from kg.server.robot.judging import told
from kg.server.robot.readings import plain

if TYPE_CHECKING:
    from kg.robot.driving import Driver
    from kg.robot.programs.events import Ended
    from kg.robot.programs.tree import Program
    from kg.server.robot.listeners import Listeners

__all__ = ["Running"]

_PACE: Final = 0.05
"""Seconds between two tellings of the statements that run: people see no more, and a program may do thousands."""


class Running:
    """What runs, and how far it is."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._runner: Runner | None = None
        self._task: asyncio.Task[Ended] | None = None
        self._name = ""
        self._state = "none"
        self._at: Counter[str | None] = Counter()
        self._pacing: asyncio.TimerHandle | None = None

    @property
    def active(self) -> bool:
        """Whether a program runs or pauses."""
        return self._task is not None and not self._task.done()

    def told(self) -> dict[str, Any]:
        """Return what is told of the program: its name, whether it runs, and the statements that do."""
        return {"state": self._state, "name": self._name, "running": list(+self._at)}

    def start(self, driver: Driver, program: Program) -> None:
        """Run a program; how it goes is told."""
        self._name = program.name
        self._at.clear()
        self._runner = Runner(driver, program, on_event=self._step)
        self._be("running")
        self._task = asyncio.create_task(self._runner.run())
        self._task.add_done_callback(self._ended)

    def _step(self, event: dict[str, Any]) -> None:
        """Tell what the program does: which statements run, what it reads, sets and says."""
        kind, identity = event["event"], event["id"]
        if kind in {"enter", "leave"}:
            self._at[identity] += 1 if kind == "enter" else -1
            if self._pacing is None:
                self._pacing = asyncio.get_running_loop().call_later(_PACE, self._tell_where)
        elif kind == "value":
            value = {event["parameter"]: plain(event["value"])}
            self._listeners.tell({"event": "value", "capability": event["capability"], "value": value})
        elif kind == "set":
            self._listeners.tell({"event": "step", "variable": event["variable"], "shown": event["shown"]})
        elif kind == "warning":
            self._listeners.tell({"event": "step", "log": f"warning[{event['code']}]: {event['message']}"})
        elif kind == "log":
            self._listeners.tell({"event": "step", "log": event["message"]})

    def _tell_where(self) -> None:
        self._pacing = None
        if self.active:
            self._listeners.tell({"event": "step", "running": list(+self._at)})

    def pause(self) -> None:
        """Pause, if it runs."""
        if self.active and self._runner is not None and self._state == "running":
            self._runner.pause()
            self._be("paused")

    def resume(self) -> None:
        """Go on, if it pauses."""
        if self.active and self._runner is not None and self._state == "paused":
            self._runner.resume()
            self._be("running")

    async def stop(self) -> None:
        """End it, if it runs."""
        if self._task is not None and self.active:
            await ended(self._task)

    def _ended(self, task: asyncio.Task[Ended]) -> None:
        """Tell how a program ended, if none was begun in that moment."""
        error = failure(task, "running a program")
        if task is not self._task:
            return
        if error is not None:
            self._be("failed", problem=problem(error))
        elif task.cancelled() or task.result().ended == "cancelled":
            self._be("stopped")
        else:
            end = task.result()
            self._be(end.ended, **({"problem": told(end.problem)} if end.problem else {}))

    def _be(self, state: str, **more: Any) -> None:
        if state not in {"running", "paused"}:
            self._at.clear()
        self._state = state
        self._listeners.tell({"event": "program", "state": state, "name": self._name, **more})
