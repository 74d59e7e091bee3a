"""Interpreter of statements: control flow, expressions, and time."""

from __future__ import annotations

import asyncio
from contextlib import aclosing, asynccontextmanager
from math import isfinite
from typing import TYPE_CHECKING, Any, Final, TypeVar

from kg.errors import RobotError
from kg.robot.programs import tree, values
from kg.robot.programs.events import Events, Problem
from kg.robot.programs.names import CapabilityIndex, takes_place
from kg.robot.tasks import ended, first

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Coroutine, Iterable

    from kg.robot.capability import Capability
    from kg.robot.clock import Clock
    from kg.robot.driving.driver import Driver
    from kg.robot.driving.routes import Outcome

_MOST_STEPS: Final = 20_000  # maximum number of statements without one that waits or acts

_T = TypeVar("_T")


class Pace:
    """The clock of a program, which stops while it is paused."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._steps = 0
        self.going = asyncio.Event()
        """Set while the program is not paused."""
        self._paused = asyncio.Event()
        self.going.set()

    @property
    def paused(self) -> bool:
        """Whether the program is paused, or will be before the next statement."""
        return self._paused.is_set()

    def pause(self) -> None:
        """Pause."""
        self.going.clear()
        self._paused.set()

    def resume(self) -> None:
        """Resume."""
        self._paused.clear()
        self.going.set()

    def waited(self) -> None:
        """Record that the program waited, which resets the limit of steps."""
        self._steps = 0

    async def step(self) -> None:
        """Enter a statement; RobotError KG837 after too many without a wait."""
        self._steps += 1
        if self._steps > _MOST_STEPS:
            hint = "Put `wait 0.1 s` into the loop."
            raise RobotError("KG837", f"more than {_MOST_STEPS} statements without a wait", hint=hint)
        await self.going.wait()
        await asyncio.sleep(0)

    async def sleep(self, seconds: float) -> None:
        """Sleep for some seconds, not counting pauses."""
        left = seconds
        while left > 0:
            await self.going.wait()
            begun = self._clock.now()
            if await self.until_paused(self._clock.sleep(left)) is not None:
                break
            left -= max(self._clock.now() - begun, 0.0)
        if seconds > 0:
            self.waited()

    async def until_paused(self, work: Coroutine[Any, Any, _T]) -> tuple[_T] | None:
        """Return the result of some work in a tuple; None if a pause came first, which cancels the work."""
        return await first(work, self._paused.wait())


async def together(*work: Coroutine[Any, Any, None]) -> None:
    """Run tasks in parallel and return when all are done; the first error cancels the others."""
    tasks = [asyncio.ensure_future(one) for one in work]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_EXCEPTION) if tasks else (set(), set())
        for task in tasks:
            if task in done:
                task.result()
    finally:
        await ended(*tasks)


_FIRST: Final = 10.0  # seconds to wait for the first message of a capability
_RATE: Final = 5.0  # calls per second of a service that a condition depends on


class Evaluation:
    """Evaluator of expressions: variables, which all parts of a program share, and the robot's readings."""

    def __init__(self, driver: Driver, index: CapabilityIndex, events: Events) -> None:
        self._driver = driver
        self.index = index
        self._events = events
        self._variables: dict[str, values.Quantity] = {}
        self._watchers: set[asyncio.Event] = set()

    def give(self, name: str, value: values.Quantity) -> None:
        """Assign a variable; watched conditions are evaluated again."""
        self._variables[name] = value
        for watcher in self._watchers:
            watcher.set()

    async def of(self, expression: tree.Expression, path: str, statement: tree.Statement) -> values.Quantity:
        """Return the value of an expression at a statement; waits for the first message of a reading.

        Raises:
            RobotError: KG833, KG838 no value, KG836 an unassigned variable, errors of reading.
        """
        match expression:
            case tree.Written():
                return values.written(expression)
            case tree.Variable():
                if expression.name not in self._variables:
                    raise RobotError("KG836", f"the variable `{expression.name}` has no value")
                return self._variables[expression.name]
            case tree.Read():
                capability = self.index.read(expression.capability)
                parameter = self.index.parameter(capability, expression.parameter)
                value = (await self._driver.latest(capability.name, seconds=_FIRST)).get(parameter.name)
                self._events.value(path, statement, capability, parameter, value)
                return values.of_parameter(parameter, value)
            case tree.Unary():
                return values.unary(expression.operator, await self.of(expression.of, path, statement))
            case tree.Binary():
                left = await self.of(expression.left, path, statement)
                if expression.operator not in {"and", "or"}:
                    return values.binary(expression.operator, left, await self.of(expression.right, path, statement))
                if values.truth(left) == (expression.operator == "or"):
                    return left  # the other side is not evaluated
                return values.Quantity(await self.truth(expression.right, path, statement))
            case tree.Position():
                components = {name: await self.of(one, path, statement) for name, one in expression.parts().items()}
                return values.place(components)

    async def truth(self, expression: tree.Expression, path: str, statement: tree.Statement) -> bool:
        """Return whether a condition holds; RobotError as `of`."""
        return values.truth(await self.of(expression, path, statement))

    async def seconds(self, expression: tree.Expression | None, path: str, statement: tree.Statement) -> float | None:
        """Return a duration in seconds, None for none; RobotError as `of`, KG835 for a negative one."""
        return None if expression is None else values.seconds(await self.of(expression, path, statement))

    @asynccontextmanager
    async def watching(self, condition: tree.Expression) -> AsyncIterator[asyncio.Event]:
        """Yield an event that is set whenever an input of a condition changes, or becomes unreadable."""
        news = asyncio.Event()
        names = {self.index.read(read.capability).name for read in tree.reads_of(condition)}
        listening = [asyncio.ensure_future(self._listen(name, news)) for name in names]
        self._watchers.add(news)
        try:
            yield news
            for task in listening:
                if task.done():
                    task.result()
        finally:
            self._watchers.discard(news)
            await ended(*listening)

    async def _listen(self, name: str, news: asyncio.Event) -> None:
        try:
            async with aclosing(self._driver.changes(name, rate=_RATE)) as changes:
                async for _ in changes:
                    news.set()
        finally:
            news.set()


_REST: Final = 0.02  # remaining seconds of a movement for which it is not restarted
_SLACK: Final = 1e-9


class Failed(Exception):  # noqa: N818 - it says how the program ended
    """Failure of a statement; names the innermost one."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(problem.message)
        self.problem = problem


class Stopped(Exception):  # noqa: N818 - it says how the program ended
    """The program ended itself."""


class _Left(Exception):  # noqa: N818 - control, no error
    """`break`: leave the innermost loop."""


class Statements:
    """Executes statements with the variables, the clock and the events of one program."""

    def __init__(self, driver: Driver, evaluation: Evaluation, pace: Pace, events: Events) -> None:
        self.count = 0
        self._driver = driver
        self._evaluation = evaluation
        self._pace = pace
        self._events = events

    async def program(self, body: Iterable[tree.Statement]) -> None:
        """Run a whole program; raises as `sequence`, and RobotError KG836 for a `break` outside a loop."""
        try:
            await self.sequence(body, "/body")
        except _Left:
            raise RobotError("KG836", "`break` outside a loop") from None

    async def sequence(self, body: Iterable[tree.Statement], path: str) -> None:
        """Run a sequence of statements; Failed at the first failure, Stopped by `stop`."""
        for number, statement in enumerate(body):
            here = f"{path}/{number}"
            try:
                await self._pace.step()
                self.count += 1
                self._events.emit("enter", here, statement)
                await self._carry_out(statement, here)
            except RobotError as error:
                self._events.emit("error", here, statement, code=error.code, message=error.message, hint=error.hint)
                raise Failed(Problem.of(error, here, statement.id)) from error
            finally:
                self._events.emit("leave", here, statement)

    async def _carry_out(self, statement: tree.Statement, path: str) -> None:
        match statement:
            case tree.Do():
                await self._do(statement, path)
            case tree.If():
                holds = await self._evaluation.truth(statement.condition, path, statement)
                part = "then" if holds else "otherwise"
                await self.sequence(statement.then if holds else statement.otherwise, f"{path}/{part}")
            case tree.While() | tree.Forever() | tree.Repeat() | tree.For():
                await self._loop(statement, path)
            case tree.Break():
                raise _Left
            case tree.Set():
                value = await self._evaluation.of(statement.value, path, statement)
                self._give(statement, statement.variable, value, path)
            case tree.Wait():
                await self._pace.sleep(await self._evaluation.seconds(statement.seconds, path, statement) or 0.0)
            case tree.WaitUntil():
                await self._wait_until(statement, path)
            case tree.Parallel():
                work = (self.sequence(one, f"{path}/branches/{n}") for n, one in enumerate(statement.branches))
                await together(*work)
            case tree.OnEvent():
                await self._on_event(statement, path)
            case tree.Log():
                message = values.shown(await self._evaluation.of(statement.message, path, statement))
                self._events.emit("log", path, statement, message=message)
            case tree.Stop():
                raise Stopped

    def _give(self, statement: tree.Statement, name: str, value: values.Quantity, path: str) -> None:
        self._evaluation.give(name, value)
        self._events.emit("set", path, statement, variable=name, value=value.value, shown=values.shown(value))

    async def _do(self, statement: tree.Do, path: str) -> None:
        index = self._evaluation.index
        capability = index.write(statement.capability)
        arguments = await self._arguments(capability, statement, path)
        duration = await self._evaluation.seconds(statement.seconds, path, statement)
        within = await self._evaluation.seconds(statement.within, path, statement)
        plan = await self._driver.plan(capability.name, arguments)
        moves = plan.rate > 0

        def feedback(reported: dict[str, Any]) -> None:
            self._events.emit("feedback", path, statement, capability=capability.name, values=reported)

        def work(seconds: float | None) -> Any:
            return self._driver.do(capability.name, arguments, seconds=seconds, on_feedback=feedback)

        left = duration if moves or within is None else within
        if moves or plan.kind == "action":
            outcome = await self._with_pauses(work, left, moves=moves)
            if outcome is not None:
                self._came(outcome, path, statement)
        else:
            self._came(await work(left), path, statement)
        self._pace.waited()

    async def _arguments(self, capability: Capability, statement: tree.Do, path: str) -> dict[str, Any]:
        """Return the values of parameters; explicit arguments override those of a place."""
        index = self._evaluation.index
        placed, given = {}, {}
        for name, expression in statement.arguments.items():
            value = await self._evaluation.of(expression, path, statement)
            if takes_place(capability, name):
                placed = values.of_place(value)
            else:
                given[index.parameter(capability, name).name] = value
        inputs = {**placed, **given}
        return {
            one.name: values.for_parameter(one, inputs[one.name]) for one in capability.parameters if one.name in inputs
        }

    def _came(self, outcome: Outcome, path: str, statement: tree.Statement) -> None:
        """Emit the command of a dry run, or a warning that the robot did not move; KG838 if another node stopped it."""
        plan = outcome.plan
        if outcome.ended == "stopped":
            raise RobotError("KG838", f"`{plan.capability}` was stopped from outside")
        if outcome.ended == "planned":
            where = {"capability": plan.capability, "kind": plan.kind, "name": plan.name, "type": plan.type}
            self._events.emit("planned", path, statement, **where, value=plan.message, seconds=plan.seconds)
        if (problem := outcome.problem) is not None:
            details = {"code": problem.code, "message": problem.message, "hint": problem.hint}
            self._events.emit("warning", path, statement, **details)

    async def _with_pauses(self, work: Any, left: float | None, *, moves: bool) -> Outcome | None:
        """Run a long action; a pause stops it, and it is restarted for the remaining time."""
        clock = self._driver.connection.clock
        while True:
            await self._pace.going.wait()
            begun = clock.now()
            done = await self._pace.until_paused(work(left))
            if done is not None:
                outcome: Outcome = done[0]
                return outcome
            if left is not None:
                left = max(left - max(clock.now() - begun, 0.0), 0.0 if moves else _REST)
                if moves and left <= _REST:
                    return None

    async def _loop(self, statement: tree.Loop, path: str) -> None:
        try:
            match statement:
                case tree.While():
                    while await self._evaluation.truth(statement.condition, path, statement):
                        await self._turn(statement, path)
                case tree.Forever():
                    while True:
                        await self._turn(statement, path)
                case tree.Repeat():
                    times = await self._evaluation.of(statement.times, path, statement)
                    if not times.number or times.dimension or not 0 <= times.value < float("inf"):
                        raise RobotError("KG833", f"a block cannot be repeated {values.shown(times)} times")
                    for _ in range(round(times.value)):
                        await self._turn(statement, path)
                case tree.For():
                    async for value in self._values(statement, path):
                        self._give(statement, statement.variable, value, path)
                        await self._turn(statement, path)
        except _Left:
            return

    async def _turn(self, statement: tree.Loop, path: str) -> None:
        await self._pace.step()
        await self.sequence(statement.body, f"{path}/body")

    async def _values(self, statement: tree.For, path: str) -> Any:
        async def number(expression: tree.Expression) -> values.Quantity:
            value = await self._evaluation.of(expression, path, statement)
            return values.binary("-", value, values.Quantity(0.0))  # refuses what is not a number

        if statement.of is not None:
            elements = (await self._evaluation.of(statement.of, path, statement)).value
            if not isinstance(elements, list | tuple):
                raise RobotError("KG833", f"{elements} is not a list")
            for element in elements:
                yield values.Quantity(element)
        elif statement.start is not None and statement.end is not None:
            start, end = await number(statement.start), await number(statement.end)
            step = values.Quantity(1.0, start.dimension) if statement.step is None else await number(statement.step)
            for number_of_step in range(_steps(start, end, step)):
                way = abs(step.value) if end.value >= start.value else -abs(step.value)
                yield values.Quantity(start.value + number_of_step * way, start.dimension)

    async def _wait_until(self, statement: tree.WaitUntil, path: str) -> None:
        seconds = await self._evaluation.seconds(statement.seconds, path, statement)
        waiting = self._until(statement.condition, path, statement)
        if seconds is None:
            await waiting
        elif await first(waiting, self._pace.sleep(seconds)) is None:
            if statement.otherwise is None:
                shown = values.shown(values.Quantity(seconds, (("s", 1),)))
                hint = "Add `otherwise` with the statements to run in that case."
                raise RobotError("KG837", f"the condition was not met within {shown}", hint=hint)
            await self.sequence(statement.otherwise, f"{path}/otherwise")

    async def _until(
        self, condition: tree.Expression, path: str, statement: tree.Statement, *, holds: bool = True
    ) -> None:
        """Return when a condition becomes true or false; it is evaluated whenever one of its inputs changes."""
        async with self._evaluation.watching(condition) as news:
            while True:
                await self._pace.going.wait()
                news.clear()  # before the evaluation, so that a change during it is not missed
                if await self._evaluation.truth(condition, path, statement) == holds:
                    return
                await news.wait()
                self._pace.waited()

    async def _on_event(self, statement: tree.OnEvent, path: str) -> None:
        body = self.sequence(statement.body, f"{path}/body")
        if statement.end:
            if await first(body, self._until(statement.condition, path, statement)) is None:
                self._events.emit("event", path, statement)
                await self.sequence(statement.then, f"{path}/then")
            return
        handling = asyncio.Lock()
        working = asyncio.ensure_future(body)
        watching = asyncio.ensure_future(self._whenever(statement, path, handling))
        try:
            await asyncio.wait({working, watching}, return_when=asyncio.FIRST_COMPLETED)
            if working.done():
                working.result()
                async with handling:  # finish the started sequence
                    watching.cancel()
        finally:
            await ended(working, watching)
        if not watching.cancelled():
            watching.result()

    async def _whenever(self, statement: tree.OnEvent, path: str, handling: asyncio.Lock) -> None:
        while True:
            await self._until(statement.condition, path, statement)
            async with handling:
                self._events.emit("event", path, statement)
                await self.sequence(statement.then, f"{path}/then")
            await self._until(statement.condition, path, statement, holds=False)


def _steps(start: values.Quantity, end: values.Quantity, step: values.Quantity) -> int:
    values.binary("-", start, end)
    values.binary("-", start, step)
    if step.value == 0:
        raise RobotError("KG838", "with a step of zero the end is never reached")
    steps = abs(end.value - start.value) / abs(step.value)
    if not isfinite(steps):
        raise RobotError("KG838", f"from {start.value:g} to {end.value:g} the steps never end")
    return int(steps + _SLACK) + 1
