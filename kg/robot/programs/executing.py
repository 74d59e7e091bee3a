"""A program from a file, carried out on the robot at an address."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from kg.errors import CATALOGUE
from kg.robot.connecting import connected, inhabited, of_robot
from kg.robot.driving import Driver, Watchdog
from kg.robot.live import infer
from kg.robot.programs.check import check
from kg.robot.programs.doubts import doubts
from kg.robot.programs.places import offered, placed, read_places
from kg.robot.programs.runner import Runner
from kg.robot.tasks import ended, spawn

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import ComputationGraph, GraphProblem
    from kg.robot.programs.events import Ended
    from kg.robot.programs.places import Places
    from kg.robot.programs.problems import Problem
    from kg.robot.programs.tree import Program
    from kg.settings import Settings

__all__ = ["Execution", "execute", "limited", "seen"]


class Execution(NamedTuple):
    """What was wrong with a program, and how it ended; None when it was not begun, for there were errors."""

    problems: list[Problem]
    ended: Ended | None


def limited(program: Program, seconds: float | None) -> Program:
    """Return a program that is ended after so many seconds, if it has no shorter time of its own."""
    if seconds is None or (program.seconds is not None and program.seconds <= seconds):
        return program
    return msgspec.structs.replace(program, seconds=seconds)


async def seen(address: str) -> tuple[ComputationGraph, Places]:
    """Return the computation graph of the system at an address, and the places it tells; raises as `look`."""
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
) -> Execution:
    """Connect, ask what the robot can do, check the program, and run it if it has no errors.

    Places that the robot, or the file of the settings, tells stand for their names. `on_problems` is told what
    is wrong, and what may come to nothing, before anything moves. With `exclusive` no other node may publish to topics
    that the program moves; without it `on_event` gets a warning. Raises as `connected`, `inhabited` and `infer` of
    `kg.robot.live`, and `read_places`.
    """
    own = read_places(settings.places)

    def warn(problem: GraphProblem) -> None:
        message, hint = f"{problem.subject}: {problem.message}", CATALOGUE[problem.code].way_out
        runner.events.tell("warning", code=problem.code, message=message, hint=hint)

    async with connected(address) as connection:
        graph = await inhabited(connection)
        places = {**await offered(connection, graph), **own}
        program = placed(program, places)
        # In a thread: a loop that stands still would take the time of a simulation for what it was before.
        capabilities = await asyncio.to_thread(infer, graph, settings, address=address)
        problems = [*check(program, capabilities, places), *doubts(program, capabilities, graph)]
        on_problems(problems)
        if any(problem.severity == "error" for problem in problems):
            return Execution(problems, None)
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
                return Execution(problems, await runner.run())
            finally:
                await ended(following)


async def _follow(driver: Driver, settings: Settings) -> None:
    """Let a program go on with what the robot can do, whatever comes and goes meanwhile."""
    async for graph in driver.connection.changes():
        driver.saw(graph)
        found = await asyncio.to_thread(infer, of_robot(graph), settings, address=driver.connection.address)
        if found != driver.capabilities:
            await driver.take(found)
