"""What `kg robot read` and `kg robot do` do, and how they show it."""

from __future__ import annotations

import asyncio
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Any, Final

from kg.cli.driving_view import show_outcome, show_plan, tell, tell_feedback, tell_message, warn
from kg.cli.interruptible import interruptible
from kg.cli.numbers import frequency, whole
from kg.cli.numbers import seconds as seconds_of
from kg.errors import RobotError, UsageError
from kg.robot.clock import within
from kg.robot.connecting import address_of, connected, inhabited, is_recording, not_commanded
from kg.robot.driving import Driver, Watchdog, find
from kg.robot.driving.observing import Throttle
from kg.robot.live import infer
from kg.robot.programs.names import AT
from kg.robot.programs.places import at_place, offered, read_places
from kg.robot.tasks import ended, spawn

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, AsyncIterator, Callable, Mapping, Sequence

    from kg.robot.connection import ComputationGraph, Connection
    from kg.settings import Settings

_FIRST: Final = 5.0
"""Seconds of the wall that the first value may take where reading is to end."""
_QUEUE: Final = 100
"""Messages of a topic that may wait to be written."""
_FEEDBACK: Final = 1.0
"""How often a second of the wall a person is told how far a goal is."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What of a capability is to be read: until `count` values or `seconds` are over, `rate` a second at most."""

    count: int | None
    seconds: float | None
    rate: float | None
    way: str | None
    json: bool

    @classmethod
    def of(  # noqa: PLR0913 - the options of the command
        cls,
        *,
        once: bool,
        count: str | None,
        seconds: str | None,
        rate: str | None,
        way: str | None,
        json: bool,
    ) -> Reading:
        """Return it as a user's options say it; UsageError KG003 for what is no number."""
        if once and count is not None:
            raise UsageError("KG003", "--once conflicts with --count", hint="Leave one out.")
        number = 1 if once else whole(count, "--count", 1) if count is not None else None
        time = seconds_of(seconds, "--seconds") if seconds is not None else _FIRST if once else None
        return cls(number, time, None if rate is None else frequency(rate, "--rate"), way, json)


@dataclass(frozen=True, slots=True)
class Doing:
    """What is to be done with a capability: its arguments, how long, and whether in earnest."""

    arguments: Mapping[str, str]
    keep: float | None
    timeout: float | None
    way: str | None
    dry_run: bool
    exclusive: bool
    json: bool

    @classmethod
    def of(  # noqa: PLR0913 - the options of the command
        cls,
        values: Sequence[str],
        *,
        keep: str | None,
        timeout: str | None,
        way: str | None,
        dry_run: bool,
        exclusive: bool,
        json: bool,
    ) -> Doing:
        """Return it as a user's options say it; UsageError KG003 for what is no number, or no NAME=VALUE."""
        pairs = [one.partition("=") for one in values]
        for text, (name, sign, _) in zip(values, pairs, strict=True):
            if not sign or not name.strip():
                raise UsageError("KG003", f"`{text}` is not an argument", hint="Write NAME=VALUE, as in forward=0.2.")
        names = [name.strip() for name, _, _ in pairs]
        for name in names:
            if names.count(name) > 1:
                raise UsageError("KG003", f"`{name}` is given twice", hint="Give each parameter one value.")
        return cls(
            {name.strip(): value.strip() for name, _, value in pairs},
            None if keep is None else seconds_of(keep, "--for"),
            None if timeout is None else seconds_of(timeout, "--timeout"),
            way,
            dry_run,
            exclusive,
            json,
        )


@asynccontextmanager
async def _driver(settings: Settings, **options: Any) -> AsyncIterator[tuple[Driver, ComputationGraph]]:
    address = address_of(settings)
    async with connected(address) as connection:
        graph = await inhabited(connection)
        # In a thread: a loop that stands still would take the time of a simulation for what it was before.
        capabilities = await asyncio.to_thread(infer, graph, settings, address=address)
        watchdog = Watchdog(address, settings.watchdog)
        async with Driver(connection, capabilities, watchdog=watchdog, graph=graph, **options) as driver:
            yield driver, graph


def read_capability(settings: Settings, name: str, asked: Reading) -> None:
    """Write the values of a capability as they come; RobotError as `Driver.read`, KG825 when none came in time."""
    interruptible(_read(settings, name, asked))


async def _read(settings: Settings, name: str, asked: Reading) -> None:
    if name.startswith("/"):
        await _read_topic(settings, name, asked)
        return
    async with _driver(settings) as (driver, _):
        capability = find(driver.capabilities, name, "read")
        for doubt in await driver.doubts(name, "read", way=asked.way):
            warn(doubt, json=asked.json)
        values = driver.read(name, way=asked.way, rate=asked.rate)
        await _tell_in_time(
            values, capability.name, asked, driver.connection, lambda one: tell(one, capability, json=asked.json)
        )


async def _read_topic(settings: Settings, topic: str, asked: Reading) -> None:
    """Write the messages of a topic as JSON."""
    if asked.way is not None:
        raise UsageError("KG003", f"`{topic}` is a topic, so --way has no effect", hint="Leave out --way.")
    async with connected(address_of(settings)) as connection:
        subscription = await connection.subscribe(topic, queue=_QUEUE)
        throttle = Throttle(asked.rate)
        values = (one.value async for one in subscription if throttle.takes(one.at))
        try:
            await _tell_in_time(values, topic, asked, connection, tell_message)
            if asked.count is None and asked.seconds is None and not is_recording(connection.address):
                raise RobotError("KG803", f"`{topic}` has ended")
        finally:
            await subscription.aclose()


async def _tell_in_time(
    values: AsyncGenerator[dict[str, Any], None],
    name: str,
    asked: Reading,
    connection: Connection,
    show: Callable[[dict[str, Any]], None],
) -> None:
    """Write values until as many were told, or as much time is over, as was asked; KG825 when there was none."""
    try:
        # Until the first value seconds are of the wall: connecting takes as long however fast a simulation runs.
        seconds = None if asked.seconds is None else max(asked.seconds, _FIRST)
        first = await asyncio.wait_for(anext(values), seconds)
    except (TimeoutError, StopAsyncIteration):
        raise RobotError("KG825", f"nothing was read of `{name}`") from None
    show(first)
    rest = _tell_all(values, None if asked.count is None else asked.count - 1, show)
    if asked.seconds is None:
        await rest
    else:
        with suppress(TimeoutError):
            await within(connection.clock, asked.seconds, rest)


async def _tell_all(
    values: AsyncGenerator[dict[str, Any], None], most: int | None, show: Callable[[dict[str, Any]], None]
) -> None:
    told = 0
    while most is None or told < most:
        value = await anext(values, None)
        if value is None:
            return
        show(value)
        told += 1


def do_capability(settings: Settings, name: str, asked: Doing) -> None:
    """Do something and write how it goes; raises as `Driver.do`, and KG003 for a movement without an end."""
    interruptible(_do(settings, name, asked), moves=True)


async def _do(settings: Settings, name: str, asked: Doing) -> None:
    own = read_places(settings.places) if AT in asked.arguments else {}  # landing must not fail for want of a file
    options = {"exclusive": asked.exclusive, "on_problem": lambda one: warn(one, json=asked.json)}
    if is_recording(address_of(settings)):
        raise not_commanded(address_of(settings))
    async with _driver(settings, **options) as (driver, graph):
        capability = find(driver.capabilities, name, "write")
        arguments = asked.arguments
        if AT in arguments:
            arguments = at_place(capability, arguments, {**await offered(driver.connection, graph), **own})
        seconds = asked.timeout if asked.keep is None else asked.keep
        plan = await driver.plan(name, arguments, seconds=seconds, way=asked.way)
        if asked.dry_run:
            show_plan(plan, json=asked.json)
            return
        if plan.rate and asked.keep is None:
            raise UsageError("KG003", f"`{plan.capability}` needs a duration", hint="For example: --for 2.")
        if not plan.rate and asked.keep is not None:
            raise UsageError(
                "KG003",
                f"`{plan.capability}` ends by itself",
                hint="Leave out --for; --timeout bounds it.",
            )
        for doubt in await driver.doubts(name, "write", way=asked.way):
            warn(doubt, json=asked.json)
        throttle = Throttle(None if asked.json else _FEEDBACK)

        def feedback(told: Mapping[str, Any]) -> None:
            # Of the wall: a person reads no faster where a simulation runs faster.
            if throttle.takes(monotonic()):
                tell_feedback(told, capability, json=asked.json)

        following = spawn(_follow(driver), "following who else drives the robot")
        try:
            outcome = await driver.do(name, arguments, seconds=seconds, way=asked.way, on_feedback=feedback)
        finally:
            await ended(following)
        show_outcome(outcome, capability, json=asked.json)
        if outcome.problem is not None:
            raise outcome.problem


async def _follow(driver: Driver) -> None:
    async for graph in driver.connection.changes():
        driver.saw(graph)
