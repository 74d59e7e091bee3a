"""The values of expressions while a program runs: variables, and what the robot senses now."""

from __future__ import annotations

import asyncio
from contextlib import aclosing, asynccontextmanager
from typing import TYPE_CHECKING, Final

from kg.errors import RobotError
from kg.robot.programs import values
from kg.robot.programs.tree import Binary, Position, Read, Unary, Variable, Written
from kg.robot.programs.walk import reads_of
from kg.robot.tasks import ended

if TYPE_CHECKING:
    from collections.abc import AsyncIterator

    from kg.robot.driving.driver import Driver
    from kg.robot.programs.events import Events
    from kg.robot.programs.names import Known
    from kg.robot.programs.tree import Expression, Statement

__all__ = ["Evaluation"]

_FIRST: Final = 10.0
"""Seconds that are waited for the first message of a capability."""
_ASKED: Final = 5.0
"""How often a second a service is asked that a condition depends on."""


class Evaluation:
    """Variables, which all parts of a program share, and the senses of the robot."""

    def __init__(self, driver: Driver, known: Known, events: Events) -> None:
        """Begin without variables."""
        self._driver = driver
        self.known = known
        self._events = events
        self._variables: dict[str, values.Quantity] = {}
        self._watchers: set[asyncio.Event] = set()

    def give(self, name: str, value: values.Quantity) -> None:
        """Give a variable a value; conditions that are watched are looked at again."""
        self._variables[name] = value
        for watcher in self._watchers:
            watcher.set()

    async def of(self, expression: Expression, path: str, statement: Statement) -> values.Quantity:
        """Return the value of an expression at a statement; it waits for the first message of what is read.

        Raises:
            RobotError: KG833, KG838 when there is no value, KG836 for a variable without one, those of reading.
        """
        match expression:
            case Written():
                return values.written(expression)
            case Variable():
                if expression.name not in self._variables:
                    raise RobotError("KG836", f"the variable `{expression.name}` has no value")
                return self._variables[expression.name]
            case Read():
                return await self._read(expression, path, statement)
            case Unary():
                return values.unary(expression.operator, await self.of(expression.of, path, statement))
            case Binary():
                return await self._binary(expression, path, statement)
            case Position():
                said = {name: await self.of(one, path, statement) for name, one in expression.parts().items()}
                return values.place(said)

    async def truth(self, expression: Expression, path: str, statement: Statement) -> bool:
        """Return whether a condition holds; RobotError as `of`."""
        return values.truth(await self.of(expression, path, statement))

    async def seconds(self, expression: Expression | None, path: str, statement: Statement) -> float | None:
        """Return a time in seconds, None for none; RobotError as `of`, KG835 for a negative one."""
        return None if expression is None else values.seconds(await self.of(expression, path, statement))

    async def _binary(self, expression: Binary, path: str, statement: Statement) -> values.Quantity:
        left = await self.of(expression.left, path, statement)
        if expression.operator in {"and", "or"}:
            if values.truth(left) == (expression.operator == "or"):
                return left
            return values.Quantity(await self.truth(expression.right, path, statement))
        return values.binary(expression.operator, left, await self.of(expression.right, path, statement))

    async def _read(self, read: Read, path: str, statement: Statement) -> values.Quantity:
        capability = self.known.read(read.capability)
        parameter = self.known.parameter(capability, read.parameter)
        told = await self._driver.latest(capability.name, seconds=_FIRST)
        value = told.get(parameter.name)
        self._events.value(path, statement, capability, parameter, value)
        return values.of_parameter(parameter, value)

    @asynccontextmanager
    async def watching(self, condition: Expression) -> AsyncIterator[asyncio.Event]:
        """Yield an event that is set whenever something in a condition has changed, or can be sensed no more."""
        news = asyncio.Event()
        names = {self.known.read(read.capability).name for read in reads_of(condition)}
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
            async with aclosing(self._driver.changes(name, asked=_ASKED)) as told:
                async for _ in told:
                    news.set()
        finally:
            news.set()
