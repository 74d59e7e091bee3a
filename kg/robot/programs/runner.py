"""Programs carried out on a robot.

A pause is heeded at the next border of a statement; a movement or a goal that is going on is stopped at once, and
continued for the rest of its time, or given again, when the program goes on. However a program ends, the robot is
stopped.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from kg.errors import RobotError
from kg.robot.programs import values
from kg.robot.programs.evaluate import Evaluation
from kg.robot.programs.events import Ended, Events
from kg.robot.programs.names import Known
from kg.robot.programs.pace import Pace, first
from kg.robot.programs.problems import Problem
from kg.robot.programs.statements import Failed, Statements, Stopped
from kg.robot.tasks import ended, finished

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.driving.driver import Driver
    from kg.robot.programs.tree import Program

__all__ = ["Runner"]


class Runner:
    """Runs one program once.

    Args:
        driver: the robot; it must be open, and is not closed.
        program: what to do; it should have been checked for the driver's capabilities.
        on_event: told what happens, as `kg.robot.programs.events` says; `events` tells it more.
    """

    def __init__(
        self, driver: Driver, program: Program, on_event: Callable[[dict[str, Any]], None] | None = None
    ) -> None:
        self._driver = driver
        self._program = program
        self._clock = driver.connection.clock
        self._pace = Pace(self._clock)
        self.events = Events(on_event, self._clock)
        evaluation = Evaluation(driver, Known(driver.capabilities), self.events)
        self._statements = Statements(driver, evaluation, self._pace, self.events)
        self._task: asyncio.Task[None] | None = None
        self._cancelled = False

    @property
    def paused(self) -> bool:
        """Whether the program stands still."""
        return self._pace.paused

    def pause(self) -> None:
        """Stop what moves, and stand still."""
        if not self.paused:
            self._pace.pause()
            self.events.tell("paused")

    def resume(self) -> None:
        """Go on where the program stood still."""
        if self.paused:
            self.events.tell("resumed")
            self._pace.resume()

    def cancel(self) -> None:
        """End the program; `run` returns when the robot has been stopped."""
        self._cancelled = True
        if self._task is not None:
            self._task.cancel()

    async def run(self) -> Ended:
        """Carry the program out and return how it ended; the robot has been stopped then.

        When the task that runs this is cancelled, the robot is stopped before it ends.
        """
        self._task = asyncio.ensure_future(self._all())
        if self._cancelled:
            self._task.cancel()
        try:
            await asyncio.wait({self._task})
        except asyncio.CancelledError:
            self._cancelled = True
            raise
        finally:
            how, problem = await finished(self._end(self._task))
        return Ended(
            ended=how,  # type: ignore[arg-type] # one of its four words
            problem=problem if how == "failed" else None,
            statements=self._statements.count,
            seconds=self.events.seconds,
        )

    async def _end(self, task: asyncio.Task[None]) -> tuple[str, Problem | None]:
        """End what goes on, stop the robot, and return how the program ended, which is told."""
        await ended(task)
        left_moving = await self._still()
        how, problem = self._how(task)
        problem = problem or left_moving
        if problem is not None and how != "cancelled":
            how = "failed"
        self.events.tell(how, seconds=round(self.events.seconds, 3), statements=self._statements.count)
        return how, problem

    def _how(self, task: asyncio.Task[None]) -> tuple[str, Problem | None]:
        if task.cancelled():
            return "cancelled", None
        error = task.exception()
        match error:
            case None:
                return "done", None
            case Stopped():
                return "stopped", None
            case Failed():
                return "failed", error.problem
            case RobotError():
                problem = Problem.of(error, "", None)
                self.events.tell("error", code=error.code, message=error.message, hint=error.hint)
                return "failed", problem
            case _:
                raise error

    async def _still(self) -> Problem | None:
        """Stop the robot; return the problem that it could not be."""
        try:
            await self._driver.stop()
        except RobotError as error:
            self.events.tell("error", code=error.code, message=error.message, hint=error.hint)
            return Problem.of(error, "", None)
        return None

    async def _all(self) -> None:
        await first(self._within_time(), first(self._lost(), self._interrupted()))

    async def _lost(self) -> None:
        """Raise RobotError KG803 when the robot is lost, with the reason."""
        raise RobotError("KG803", f"the robot is lost: {await self._driver.connection.wait_lost()}")

    async def _interrupted(self) -> None:
        """Raise the error of an interruption, which no part of a program can outlive."""
        raise await self._driver.wait_interrupted()

    async def _within_time(self) -> None:
        work = self._statements.program(self._program.body)
        seconds = self._program.seconds
        if seconds is None:
            await work
        elif await first(work, self._pace.sleep(seconds)) is None:
            shown = values.shown(values.Quantity(seconds, (("s", 1),)))
            raise RobotError("KG837", f"the program did not end within {shown}")
