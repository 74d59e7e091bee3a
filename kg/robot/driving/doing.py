"""Doing: topics once or renewed, services, and actions."""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final, TypeAlias
from uuid import uuid4

from kg.errors import RobotError
from kg.robot.clock import within
from kg.robot.driving.channels import Channel
from kg.robot.tasks import Tasks

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.connection import Connection, Goal
    from kg.robot.driving.channels import Command
    from kg.robot.driving.parts import Parts
    from kg.robot.driving.plans import Plan
    from kg.robot.driving.routes import Route
    from kg.robot.driving.watchdog import Watchdog

__all__ = ["Doing", "Feedback"]

Feedback: TypeAlias = "Callable[[dict[str, Any]], None]"
"""What is told how far an action is: its feedback by parameter, as it is where no parameter is known."""

_SERVICE: Final = 10.0
"""Seconds that a service may take when nothing else is said."""
_SERVED: Final = 5.0
"""Seconds to wait for an action server."""
_PATIENCE: Final = 2.0
"""Seconds of the wall that an action server is given to take a cancellation."""
_SLACK: Final = 1e-9


class Doing:
    """What is done over one connection."""

    def __init__(
        self, connection: Connection, parts: Parts, watchdog: Watchdog | None, *, limit: float, listen: float
    ) -> None:
        self.channels: dict[str, Channel] = {}
        self._connection = connection
        self._parts = parts
        self._watchdog = watchdog
        self._limit = limit
        self._listen = listen
        self._opening = asyncio.Lock()
        self._goals: dict[str, Command] = {}
        self._cancelling = Tasks()

    async def carry_out(
        self, command: Command, route: Route, plan: Plan, on_feedback: Feedback | None
    ) -> dict[str, Any]:
        """Do what is planned, and return what came of it; however it ends, movements are stopped, goals cancelled.

        Raises:
            RobotError: KG827 when something else moves the same part of the robot, and those of `Driver.do`.
        """
        with self._parts.held(command, route):
            return await self._done(command, route, plan, on_feedback)

    async def _done(self, command: Command, route: Route, plan: Plan, on_feedback: Feedback | None) -> dict[str, Any]:
        if plan.kind == "service":
            seconds = _SERVICE if plan.seconds is None else plan.seconds
            command.sent = 1
            return route.answer(await self._connection.call(plan.name, plan.type, plan.message, seconds=seconds))
        if plan.kind == "action":
            return await self._goal(command, route, plan, on_feedback)
        channel = await self._channel(plan, route)
        channel.take(command)
        try:
            await channel.heard(self._listen)
            await (self._move if route.moves else self._once)(command, channel, route, plan)
        finally:
            try:
                await channel.release(command)
            finally:
                if self._watchdog is not None and channel.zero is None:
                    await self._watchdog.forget(plan.name)
        return {}

    async def _channel(self, plan: Plan, route: Route) -> Channel:
        async with self._opening:
            if plan.name not in self.channels:
                # Latched, the zero command that ended a movement also reaches who lost its connection meanwhile.
                publication = await self._connection.advertise(plan.name, plan.type, latch=route.moves)
                self.channels[plan.name] = Channel(plan.name, publication, self._connection.clock, self._limit)
            return self.channels[plan.name]

    async def _once(self, command: Command, channel: Channel, route: Route, plan: Plan) -> None:
        if channel.zero is not None:
            await channel.send(channel.zero(), command)
            channel.zero = None
        await channel.send(route.restamped(plan.message, self._connection.clock.now()), command)

    async def _move(self, command: Command, channel: Channel, route: Route, plan: Plan) -> None:
        """Renew a command until its time is over; when the robot's clock is set back its time is over too."""
        clock, period = self._connection.clock, 1 / min(plan.rate, self._limit)
        stood, channel.zero = channel.zero is None, lambda: route.zero(clock.now())
        if stood and self._watchdog is not None and plan.afterwards is not None:
            await self._watchdog.watch_topic(plan.name, plan.type, plan.afterwards)
        begun = now = clock.now()
        end = float("inf") if plan.seconds is None else begun + plan.seconds
        while begun <= now < end - _SLACK:
            if self._watchdog is not None and (late := self._watchdog.late()) is not None:
                raise late
            await channel.send(route.restamped(plan.message, now), command)
            now = clock.now()
            due = begun + (int((now - begun) / period + _SLACK) + 1) * period
            await clock.sleep(min(due, end) - now)
            before, now = now, clock.now()
            begun = begun if now >= before else float("inf")

    async def _goal(self, command: Command, route: Route, plan: Plan, on_feedback: Feedback | None) -> dict[str, Any]:
        earlier, self._goals[plan.name] = self._goals.get(plan.name), command
        if earlier is not None:
            earlier.end("taken over")
        identity = uuid4().hex
        if self._watchdog is not None:
            await self._watchdog.watch_goal(plan.name, plan.type, identity)
        sending = asyncio.ensure_future(
            self._connection.send_goal(plan.name, plan.type, plan.message, seconds=_SERVED, identity=identity)
        )
        command.sent = 1
        done = False
        try:
            goal = await asyncio.shield(sending)
            result = await self._reached(goal, route, plan, on_feedback)
            done = True
            return route.answer(result)
        except RobotError as error:
            done = error.code == "KG809"
            raise
        finally:
            if self._goals.get(plan.name) is command:
                del self._goals[plan.name]
            try:
                if not done:
                    await self._cancel(sending)
            finally:
                if self._watchdog is not None:
                    await self._watchdog.forget(identity)

    async def _reached(self, goal: Goal, route: Route, plan: Plan, on_feedback: Feedback | None) -> dict[str, Any]:
        async def result() -> dict[str, Any]:
            if on_feedback is not None:
                async for feedback in goal.feedback():
                    on_feedback(route.answer(feedback))
            return await goal.result()

        if plan.seconds is None:
            return await result()
        try:
            return await within(self._connection.clock, plan.seconds, result(), pauses=True)
        except TimeoutError:
            raise RobotError(
                "KG825", f"`{plan.capability}` was not done within {plan.seconds:g} s; the goal was cancelled"
            ) from None

    async def _cancel(self, sending: asyncio.Future[Goal]) -> None:
        """Cancel a goal, also one that is just being sent, whatever becomes of who gave it."""
        await asyncio.shield(self._cancelling.spawn(_cancelled(sending), "cancelling a goal"))

    async def still(self, *, again: bool) -> None:
        """End all movements, with `again` those that had ended as well."""
        await asyncio.gather(*(one.still(again=again) for one in self.channels.values()))

    async def aclose(self) -> None:
        """Offer no topics any more."""
        try:
            await asyncio.gather(self._cancelling.done(), *(one.aclose() for one in self.channels.values()))
        finally:
            if self._watchdog is not None:
                await self._watchdog.release()


async def _cancelled(sending: asyncio.Future[Goal]) -> None:
    with suppress(RobotError, TimeoutError):
        async with asyncio.timeout(_PATIENCE):
            await (await sending).cancel()
