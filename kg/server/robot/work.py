"""Running work on a robot for pages: values that they follow, driving by hand, and the program.

Each capability is read once for all pages, at a rate for people. Driving by hand needs an open page that sends signs of
life. One program runs at a time, and all pages see its progress.
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
from kg.server.robot.judging import problem_object
from kg.server.robot.listeners import Listener, Listeners, failure

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability
    from kg.robot.driving import Driver, Outcome
    from kg.robot.programs.events import Ended
    from kg.robot.programs.tree import Program

_VALUES_EVERY: Final = 0.1  # seconds between two values of a capability sent to pages; the newest value is always sent

_ELEMENTS: Final = 50  # how many elements of a list are sent


class Readings:
    """The subscriptions for the values that pages follow."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._driver: Driver | None = None
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._newest: dict[str, Any] = {}
        self._waiting: dict[str, asyncio.TimerHandle] = {}
        self._failed: set[str] = set()

    def follow(self, driver: Driver | None) -> None:
        """Subscribe to the followed capabilities only, and retry failed ones; without a driver to none."""
        wanted = self._listeners.reads() if driver is not None else frozenset()
        unchanged = wanted - self._failed if driver is self._driver else frozenset()
        self._driver = driver
        self._failed.clear()
        for name in self._tasks.keys() - unchanged:
            self._tasks.pop(name).cancel()
            self._newest.pop(name, None)  # queued values are of another robot, or for closed pages
        if driver is not None:
            for name in wanted - self._tasks.keys():
                self._tasks[name] = asyncio.create_task(self._read(driver, name))
                self._tasks[name].add_done_callback(partial(self._over, name))

    async def aclose(self) -> None:
        """Close all subscriptions."""
        tasks = tuple(self._tasks.values())
        self.follow(None)
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _read(self, driver: Driver, name: str) -> None:
        async for value in driver.read(name):
            self._newest[name] = value
            if name not in self._waiting:
                self._send_value(name)

    def _over(self, name: str, task: asyncio.Task[None]) -> None:
        error = failure(task, f"reading {name}")
        if error is not None and self._tasks.get(name) is task:
            self._failed.add(name)
            self._listeners.publish({"event": "value", "capability": name, "problem": problem(error)}, of=name)

    def _send_value(self, name: str) -> None:
        """Send the newest value, and after the interval the one that has arrived by then."""
        self._waiting.pop(name, None)
        if (value := self._newest.pop(name, None)) is not None:
            self._listeners.publish({"event": "value", "capability": name, "value": plain(value)}, of=name)
            self._waiting[name] = asyncio.get_running_loop().call_later(_VALUES_EVERY, self._send_value, name)


def plain(value: Any) -> Any:
    """Return a value as JSON, which lacks infinity and NaN."""
    if isinstance(value, float) and not isfinite(value):
        return None if isnan(value) else "∞" if value > 0 else "-∞"
    if isinstance(value, dict):
        return {key: plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value[:_ELEMENTS]]
    return f"{len(value)} bytes" if isinstance(value, bytes) else value


SILENT: Final = 4.0
"""Seconds without a sign of life after which a driving page is considered abandoned."""
_LONGEST: Final = 60.0
"""Maximum seconds of one movement by hand; a goal, which ends by itself, may take ten times as long."""
_USUAL: Final = 1.0  # default seconds of a movement
_MOST: Final = 16  # maximum number of movements by hand at a time


class Hands:
    """Movements by hand, each a task that belongs to a page."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._tasks: dict[asyncio.Task[Outcome], Listener] = {}

    @property
    def busy(self) -> bool:
        """Whether any movement runs."""
        return bool(self._tasks)

    def do(
        self,
        driver: Driver,
        listener: Listener,
        capability: Capability,
        arguments: Mapping[str, Any],
        seconds: float | None,
    ) -> None:
        """Start a movement; all pages receive its progress.

        Raises:
            RobotError: KG847 too many movements, KG848 the duration is too long.
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
        listener.last_beat = asyncio.get_running_loop().time()
        work = driver.do(capability.name, dict(arguments), seconds=chosen)
        task = asyncio.ensure_future(work)
        self._tasks[task] = listener
        task.add_done_callback(partial(self._over, capability, listener))
        self._notify_hand("doing", capability, listener)

    def _over(self, capability: Capability, listener: Listener, task: asyncio.Task[Outcome]) -> None:
        self._tasks.pop(task, None)
        error = failure(task, "driving by hand")
        if error is not None:
            self._notify_hand("failed", capability, listener, problem=problem(error))
        elif not task.cancelled() and (did_not_move := task.result().problem) is not None:
            self._notify_hand("failed", capability, listener, problem=problem(did_not_move))
        else:
            self._notify_hand("stopped" if task.cancelled() else task.result().ended, capability, listener)

    def _notify_hand(self, state: str, capability: Capability, listener: Listener, **more: Any) -> None:
        event = {"event": "hand", "state": state, "capability": capability.name, **more}
        self._listeners.publish({**event, "own": False}, but=listener)
        listener.queue({**event, "own": True})

    async def watch(self) -> None:
        """Stop the movements of abandoned pages, until cancelled."""
        while True:
            await asyncio.sleep(SILENT / 4)
            latest = asyncio.get_running_loop().time() - SILENT
            await self.stop({one for one in self._tasks.values() if one.last_beat < latest})

    async def stop(self, whose: set[Listener] | None = None) -> None:
        """Stop the movements of certain pages, or all."""
        await ended(*(task for task, listener in self._tasks.items() if whose is None or listener in whose))


_STEPS_EVERY: Final = 0.05
"""Seconds between two updates on the running statements: a program may run thousands in that time."""


class Running:
    """The running program and its progress."""

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
        """Whether a program runs or is paused."""
        return self._task is not None and not self._task.done()

    def status(self) -> dict[str, Any]:
        """Return the state of the program for pages: its name, whether it runs, and its running statements."""
        return {"state": self._state, "name": self._name, "running": list(+self._at)}

    def start(self, driver: Driver, program: Program) -> None:
        """Run a program, and send its progress to pages."""
        self._name = program.name
        self._at.clear()
        self._runner = Runner(driver, program, on_event=self._step)
        self._be("running")
        self._task = asyncio.create_task(self._runner.run())
        self._task.add_done_callback(self._ended)

    def _step(self, event: dict[str, Any]) -> None:
        """Send the progress of the program: running statements, values read and set, and texts."""
        kind, identity = event["event"], event["id"]
        if kind in {"enter", "leave"}:
            self._at[identity] += 1 if kind == "enter" else -1
            if self._pacing is None:
                self._pacing = asyncio.get_running_loop().call_later(_STEPS_EVERY, self._send_position)
        elif kind == "value":
            value = {event["parameter"]: plain(event["value"])}
            self._listeners.publish({"event": "value", "capability": event["capability"], "value": value})
        elif kind == "set":
            self._listeners.publish({"event": "step", "variable": event["variable"], "shown": event["shown"]})
        elif kind == "warning":
            self._listeners.publish({"event": "step", "log": f"warning[{event['code']}]: {event['message']}"})
        elif kind == "log":
            self._listeners.publish({"event": "step", "log": event["message"]})

    def _send_position(self) -> None:
        self._pacing = None
        if self.active:
            self._listeners.publish({"event": "step", "running": list(+self._at)})

    def pause(self) -> None:
        """Pause the program, if it runs."""
        if self.active and self._runner is not None and self._state == "running":
            self._runner.pause()
            self._be("paused")

    def resume(self) -> None:
        """Resume the program, if it is paused."""
        if self.active and self._runner is not None and self._state == "paused":
            self._runner.resume()
            self._be("running")

    async def stop(self) -> None:
        """Stop the program, if it runs."""
        if self._task is not None and self.active:
            await ended(self._task)

    def _ended(self, task: asyncio.Task[Ended]) -> None:
        error = failure(task, "running a program")
        if task is not self._task:
            return
        if error is not None:
            self._be("failed", problem=problem(error))
        elif task.cancelled() or task.result().ended == "cancelled":
            self._be("stopped")
        else:
            end = task.result()
            self._be(end.ended, **({"problem": problem_object(end.problem)} if end.problem else {}))

    def _be(self, state: str, **more: Any) -> None:
        if state not in {"running", "paused"}:
            self._at.clear()
        self._state = state
        self._listeners.publish({"event": "program", "state": state, "name": self._name, **more})
