"""What goes through a robot for pages: values that they follow, driving by hand, and the program that runs.

Each capability is read once, however many look, and told at a pace for people. Somebody drives by hand while their page
is open and says so. One program runs at a time, told to all who look on.
"""

from __future__ import annotations

import asyncio
from collections import Counter
from functools import partial
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.programs.runner import Runner
from kg.robot.tasks import ended
from kg.server.errors import problem
from kg.server.robot.judging import told
from kg.server.robot.listeners import Listener, Listeners, failure

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability
    from kg.robot.driving import Driver, Outcome
    from kg.robot.programs.events import Ended
    from kg.robot.programs.tree import Program

_VALUES_EVERY: Final = 0.1  # seconds between two values of a capability that are told; the newest is never left out

_ELEMENTS: Final = 50  # how many elements of a list are told


class Readings:
    """What is read for those who look on."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._driver: Driver | None = None
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._newest: dict[str, Any] = {}
        self._waiting: dict[str, asyncio.TimerHandle] = {}
        self._failed: set[str] = set()

    def follow(self, driver: Driver | None) -> None:
        """Read what is followed now, and nothing else, and again what could not be; without a driver nothing."""
        wanted = self._listeners.reads() if driver is not None else frozenset()
        kept = wanted - self._failed if driver is self._driver else frozenset()
        self._driver = driver
        self._failed.clear()
        for name in self._tasks.keys() - kept:
            self._tasks.pop(name).cancel()
            self._newest.pop(name, None)  # what waits to be told is of a robot, or for pages, that have gone
        if driver is not None:
            for name in wanted - self._tasks.keys():
                self._tasks[name] = asyncio.create_task(self._read(driver, name))
                self._tasks[name].add_done_callback(partial(self._over, name))

    async def aclose(self) -> None:
        """Read nothing more."""
        tasks = tuple(self._tasks.values())
        self.follow(None)
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _read(self, driver: Driver, name: str) -> None:
        async for value in driver.read(name):
            self._newest[name] = value
            if name not in self._waiting:
                self._tell(name)

    def _over(self, name: str, task: asyncio.Task[None]) -> None:
        error = failure(task, f"reading {name}")
        if error is not None and self._tasks.get(name) is task:
            self._failed.add(name)
            self._listeners.tell({"event": "value", "capability": name, "problem": problem(error)}, of=name)

    def _tell(self, name: str) -> None:
        """Tell the newest value, and after a while the one that has come by then."""
        self._waiting.pop(name, None)
        if (value := self._newest.pop(name, None)) is not None:
            self._listeners.tell({"event": "value", "capability": name, "value": plain(value)}, of=name)
            self._waiting[name] = asyncio.get_running_loop().call_later(_VALUES_EVERY, self._tell, name)


def plain(value: Any) -> Any:
    """Return a value as JSON has it, which knows neither infinity nor what is not a number."""
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else "∞" if value > 0 else "-∞"
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value[:_ELEMENTS]]
    return f"{len(value)} bytes" if isinstance(value, bytes) else value


SILENT: Final = 4.0
"""Seconds that a page may say nothing while it drives; then nobody is thought to be there."""
_LONGEST: Final = 60.0
"""Seconds that one movement by hand takes at most; what ends by itself, as a goal, may take ten times as long."""
_USUAL: Final = 1.0  # seconds of a movement for which none are said
_MOST: Final = 16  # how many things are done by hand at a time


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


_STEPS_EVERY: Final = 0.05
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
                self._pacing = asyncio.get_running_loop().call_later(_STEPS_EVERY, self._tell_where)
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
