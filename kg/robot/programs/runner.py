"""Execution of programs on a robot, also from a file on the robot at an address.

A pause takes effect before the next statement. A running movement or goal is stopped at once, and continued for its
remaining time, or sent again, on resumption. However a program ends, the robot is stopped.
"""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import msgspec

from kg.errors import CATALOGUE, RobotError
from kg.robot.connecting import connected, inhabited, lost, of_robot
from kg.robot.driving import Driver, Watchdog
from kg.robot.live import infer
from kg.robot.programs import values
from kg.robot.programs.check import check, doubts
from kg.robot.programs.events import Ended, Events, Problem
from kg.robot.programs.names import CapabilityIndex
from kg.robot.programs.places import Places, offered, placed, read_places
from kg.robot.programs.statements import Evaluation, Failed, Pace, Statements, Stopped
from kg.robot.tasks import ended, finished, first, spawn

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import ComputationGraph, GraphProblem
    from kg.robot.programs.tree import Program
    from kg.settings import Settings


class Runner:
    """Runs one program once.

    Args:
        driver: the robot; it must be open, and is not closed.
        program: it should have been checked for the driver's capabilities.
        on_event: receives the events listed in `kg.robot.programs.events`; `events` can emit more.
    """

    def __init__(
        self, driver: Driver, program: Program, on_event: Callable[[dict[str, Any]], None] | None = None
    ) -> None:
        self._driver = driver
        self._program = program
        self._clock = driver.connection.clock
        self._pace = Pace(self._clock)
        self.events = Events(on_event, self._clock, driver.log)
        evaluation = Evaluation(driver, CapabilityIndex(driver.capabilities), self.events)
        self._statements = Statements(driver, evaluation, self._pace, self.events)
        self._task: asyncio.Task[None] | None = None
        self._cancelled = False

    @property
    def paused(self) -> bool:
        """Whether the program is paused."""
        return self._pace.paused

    def pause(self) -> None:
        """Stop all movements, and pause."""
        if not self.paused:
            self._pace.pause()
            self.events.emit("paused")

    def resume(self) -> None:
        """Resume the program."""
        if self.paused:
            self.events.emit("resumed")
            self._pace.resume()

    def cancel(self) -> None:
        """Cancel the program; `run` returns after the robot has been stopped."""
        self._cancelled = True
        if self._task is not None:
            self._task.cancel()

    async def run(self) -> Ended:
        """Run the program, stop the robot, and return how the program ended.

        If the task that runs this is cancelled, the robot is stopped first.
        """
        self._task = asyncio.ensure_future(self._until_lost())
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
        """End running work, stop the robot, and return the result after emitting it."""
        await ended(task)
        left_moving = None
        try:
            await self._driver.stop()
        except RobotError as error:
            self.events.emit("error", code=error.code, message=error.message, hint=error.hint)
            left_moving = Problem.of(error, "", None)
        how, problem = self._how(task)
        problem = problem or left_moving
        if problem is not None and how != "cancelled":
            how = "failed"
        self.events.emit(how, seconds=round(self.events.seconds, 3), statements=self._statements.count)
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
                self.events.emit("error", code=error.code, message=error.message, hint=error.hint)
                return "failed", problem
            case _:
                raise error

    async def _until_lost(self) -> None:
        """Run the program until it ends; raise the reason if the robot is lost, or interrupted, before that."""

        async def gone() -> None:
            connection = self._driver.connection
            raise lost(connection.address, await connection.wait_lost())

        async def interrupted() -> None:
            raise await self._driver.wait_interrupted()

        await first(self._within_time(), first(gone(), interrupted()))

    async def _within_time(self) -> None:
        work = self._statements.program(self._program.body)
        seconds = self._program.seconds
        if seconds is None:
            await work
        elif await first(work, self._pace.sleep(seconds)) is None:
            shown = values.shown(values.Quantity(seconds, (("s", 1),)))
            raise RobotError("KG837", f"the program did not end within {shown}")


def limited(program: Program, seconds: float | None) -> Program:
    """Return a program with a time limit in seconds, unless its own is shorter."""
    if seconds is None or (program.seconds is not None and program.seconds <= seconds):
        return program
    return msgspec.structs.replace(program, seconds=seconds)


async def seen(address: str) -> tuple[ComputationGraph, Places]:
    """Return the computation graph at an address, and the places published there; raises as `look`."""
    async with connected(address) as connection:
        graph = await inhabited(connection)
        return graph, await offered(connection, graph)


async def execute(  # noqa: PLR0913 - what a run can say
    program: Program,
    address: str,
    settings: Settings,
    *,
    on_event: Callable[[dict[str, Any]], None],
    on_problems: Callable[[list[Problem]], None],
    dry_run: bool = False,
    exclusive: bool = False,
) -> Ended | None:
    """Connect, infer the robot's capabilities, check the program, and run it; None if it has errors.

    Places published by the robot, or in the file of the settings, replace their names. `on_problems` receives problems
    and doubts before anything moves. With `exclusive`, no other node may publish to topics that the program uses to
    move; without it, `on_event` receives a warning. Raises as `connected`, `inhabited` and `infer` of `kg.robot.live`,
    and `read_places`.
    """
    own = read_places(settings.places)

    def warn(problem: GraphProblem) -> None:
        message, hint = f"{problem.subject}: {problem.message}", CATALOGUE[problem.code].way_out
        runner.events.emit("warning", code=problem.code, message=message, hint=hint)

    async with connected(address) as connection:
        graph = await inhabited(connection)
        places = {**await offered(connection, graph), **own}
        program = placed(program, places)
        # In a thread: a blocked event loop would misread the clock of a simulation.
        capabilities = await asyncio.to_thread(infer, graph, settings, address=address)
        problems = [*check(program, capabilities, places), *doubts(program, capabilities, graph)]
        on_problems(problems)
        if any(problem.severity == "error" for problem in problems):
            return None
        watchdog = Watchdog(address, settings.watchdog)
        driving = Driver(
            connection,
            capabilities,
            dry_run=dry_run,
            exclusive=exclusive,
            on_problem=warn,
            watchdog=watchdog,
            graph=graph,
        )
        async with driving as driver:
            following = spawn(_follow(driver, settings), "following what the robot can do")
            runner = Runner(driver, program, on_event)
            try:
                return await runner.run()
            finally:
                await ended(following)


async def _follow(driver: Driver, settings: Settings) -> None:
    async for graph in driver.connection.changes():
        driver.saw(graph)
        capabilities = await asyncio.to_thread(infer, of_robot(graph), settings, address=driver.connection.address)
        if capabilities != driver.capabilities:
            await driver.take(capabilities)
