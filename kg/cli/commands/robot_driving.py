"""`kg robot read` and `kg robot do`: what a robot senses, and making it act."""

import math
import sys
from collections import Counter
from contextlib import asynccontextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli.diagnostics import note, report, say
from kg.cli.options import Exclusive, Json, argument, frequency, option, whole, with_settings
from kg.cli.options import seconds as seconds_of
from kg.cli.output import json_lines, json_value, terminal, write
from kg.errors import CATALOGUE, RobotError, UsageError
from kg.lazily import lazily
from kg.render.text import count, printable
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import AsyncGenerator, AsyncIterator, Callable, Iterator, Mapping, Sequence

    from kg.robot.capability import Capability
    from kg.robot.connection import ComputationGraph, Connection, GraphProblem


with lazily():
    import asyncio

    import msgspec

    from kg.cli.interruptible import interruptible
    from kg.robot.clock import within
    from kg.robot.connecting import address_of, connected, inhabited, is_recording, not_commanded
    from kg.robot.driving import Driver, Outcome, Plan, Watchdog, find
    from kg.robot.driving.observing import Throttle
    from kg.robot.live import infer
    from kg.robot.programs.places import at_place, offered, read_places
    from kg.robot.tasks import ended, spawn


CapabilityName = Annotated[
    str, argument("CAPABILITY", "Name of a capability (see `kg robot capabilities`), its label or a synonym.")
]
Readable = Annotated[
    str,
    argument(
        "CAPABILITY", "Name, label or synonym of a capability (see `kg robot capabilities`), or a topic such as /scan."
    ),
]
Values = Annotated[
    list[str] | None, argument("NAME=VALUE", "Parameters, with or without units: forward=20cm/s, or at=PLACE.")
]
Way = Annotated[
    str | None, option("--way NAME", "Topic, service, action, node or message type to use, if there are several.")
]
Once = Annotated[bool, option("--once", "Read one value and exit.")]
Count = Annotated[str | None, option("--count -n N", "Read this many values and exit.")]
Seconds = Annotated[str | None, option("--seconds S", "Read for this many seconds of the robot's time and exit.")]
Rate = Annotated[str | None, option("--rate HZ", "Maximum values per second, and how often a service is called.")]
For = Annotated[str | None, option("--for S", "Duration of a movement, in seconds of the robot's time.")]
Within = Annotated[str | None, option("--timeout S", "Time limit of a goal or service call, in seconds.")]
DryRun = Annotated[bool, option("--dry-run", "Print what would be sent where, without sending it.")]


@with_settings("robot")
def read(  # noqa: PLR0913 - the options of a command
    capability: Readable,
    *,
    settings: Settings,
    once: Once = False,
    count: Count = None,
    seconds: Seconds = None,
    rate: Rate = None,
    way: Way = None,
    json: Json = False,
) -> None:
    """Print values sensed or stored by a robot, one per line, until Ctrl-C.

    Values have the names and units of the capability's parameters. In JSON, null represents no reading or an infinite
    one. Messages of a topic are printed as JSON. For example:

        kg robot read sensingPose
        kg robot read laserScanning --rate 2
        kg robot read /odom --robot bag://drive.mcap
        kg robot read sensingBattery --once --json
    """
    options = Reading.of(once=once, count=count, seconds=seconds, rate=rate, way=way, json=json)
    work = _read_topic if capability.startswith("/") else _read
    interruptible(work(settings, capability, options))


@with_settings("places", "robot", "watchdog")
def do(  # noqa: PLR0913 - the options of a command
    capability: CapabilityName,
    values: Values = None,
    *,
    settings: Settings,
    keep: For = None,
    timeout: Within = None,
    way: Way = None,
    dry_run: DryRun = False,
    exclusive: Exclusive = False,
    json: Json = False,
) -> None:
    """Run a capability of a robot and wait until it is done.

    A movement continues for --for seconds and always ends with a stop command, even on Ctrl-C, on an error, or if the
    robot's node disappears. A goal (an action) reports its progress and is cancelled on Ctrl-C. Ctrl-Z also ends the
    command. If this process hangs or is killed, a watchdog stops the robot after --watchdog seconds. Values outside a
    parameter's limits are refused. A place can be used instead of coordinates: a simulated robot has some, and a file
    can define others (--places). For example:

        kg robot do drivingAtVelocity forward=0.2 turn=10deg/s --for 2
        kg robot do goingToPose x=3 y=150cm heading=90deg --timeout 60
        kg robot do goingToPose at=kitchen --timeout 60
        kg robot do takingOff --dry-run
    """
    options = Doing.of(
        values or [], keep=keep, timeout=timeout, way=way, dry_run=dry_run, exclusive=exclusive, json=json
    )
    interruptible(_do(settings, capability, options), moves=True)


_FIRST: Final = 5.0  # wall-clock seconds to wait for the first value if reading is limited
_QUEUE: Final = 100  # maximum number of queued messages of a topic
_FEEDBACK: Final = 1.0  # maximum progress reports per wall-clock second for people


@dataclass(frozen=True, slots=True)
class Reading:
    """Options of reading a capability: at most `count` values or `seconds`, at most `rate` per second."""

    count: int | None
    seconds: float | None
    rate: float | None
    way: str | None
    json: bool

    @classmethod
    def of(cls, *, once: bool, count: str | None, seconds: str | None, rate: str | None, **more: Any) -> "Reading":
        """Return it as a user's options say it; UsageError KG003 for a text that is not a number."""
        if once and count is not None:
            raise UsageError("KG003", "--once conflicts with --count", hint="Leave one out.")
        number = 1 if once else whole(count, "--count", 1) if count is not None else None
        time = seconds_of(seconds, "--seconds") if seconds is not None else _FIRST if once else None
        return cls(number, time, None if rate is None else frequency(rate, "--rate"), **more)


@dataclass(frozen=True, slots=True)
class Doing:
    """Options of executing a capability: its arguments, duration, and whether it is a dry run."""

    arguments: "Mapping[str, str]"
    keep: float | None
    timeout: float | None
    way: str | None
    dry_run: bool
    exclusive: bool
    json: bool

    @classmethod
    def of(cls, values: "Sequence[str]", *, keep: str | None, timeout: str | None, **more: Any) -> "Doing":
        """Return the options as given by the user; UsageError KG003 for an invalid number or NAME=VALUE."""
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
            **more,
        )


@asynccontextmanager
async def _driver(settings: Settings, **options: Any) -> "AsyncIterator[tuple[Driver, ComputationGraph]]":
    address = address_of(settings)
    async with connected(address) as connection:
        graph = await inhabited(connection)
        # In a thread: a blocked event loop would misread the clock of a simulation.
        capabilities = await asyncio.to_thread(infer, graph, settings, address=address)
        watchdog = Watchdog(address, settings.watchdog)
        async with Driver(connection, capabilities, watchdog=watchdog, graph=graph, **options) as driver:
            yield driver, graph


async def _read(settings: Settings, name: str, options: "Reading") -> None:
    async with _driver(settings) as (driver, _):
        capability = find(driver.capabilities, name, "read")
        for doubt in await driver.doubts(name, "read", way=options.way):
            warn(doubt, json=options.json)
        values = driver.read(name, way=options.way, rate=options.rate)
        await _write_in_time(
            values,
            capability.name,
            options,
            driver.connection,
            lambda one: write_values(one, capability, json=options.json),
        )


async def _read_topic(settings: Settings, topic: str, options: "Reading") -> None:
    """Write the messages of a topic as JSON."""
    if options.way is not None:
        raise UsageError("KG003", f"`{topic}` is a topic, so --way has no effect", hint="Leave out --way.")
    async with connected(address_of(settings)) as connection:
        subscription = await connection.subscribe(topic, queue=_QUEUE)
        throttle = Throttle(options.rate)
        values = (one.value async for one in subscription if throttle.takes(one.at))
        try:
            await _write_in_time(values, topic, options, connection, write_message)
            if options.count is None and options.seconds is None and not is_recording(connection.address):
                raise RobotError("KG803", f"`{topic}` has ended")
        finally:
            await subscription.aclose()


async def _write_in_time(
    values: "AsyncGenerator[dict[str, Any], None]",
    name: str,
    options: "Reading",
    connection: "Connection",
    show: "Callable[[dict[str, Any]], None]",
) -> None:
    """Write values up to the requested number or duration; KG825 if there was none."""
    try:
        # Until the first value, seconds are wall-clock: connecting takes as long however fast a simulation runs.
        seconds = None if options.seconds is None else max(options.seconds, _FIRST)
        first = await asyncio.wait_for(anext(values), seconds)
    except (TimeoutError, StopAsyncIteration):
        raise RobotError("KG825", f"nothing was read of `{name}`") from None
    show(first)

    async def show_values() -> None:
        shown = 1
        while options.count is None or shown < options.count:
            value = await anext(values, None)
            if value is None:
                return
            show(value)
            shown += 1

    if options.seconds is None:
        await show_values()
    else:
        with suppress(TimeoutError):
            await within(connection.clock, options.seconds, show_values())


async def _do(settings: Settings, name: str, chosen: "Doing") -> None:
    from kg.robot.programs.names import AT  # noqa: PLC0415 - start-up time

    # Without `at`, the file is not read: landing must not fail because it is missing.
    own = read_places(settings.places) if AT in chosen.arguments else {}
    options = {"exclusive": chosen.exclusive, "on_problem": lambda one: warn(one, json=chosen.json)}
    if is_recording(address_of(settings)):
        raise not_commanded(address_of(settings))
    async with _driver(settings, **options) as (driver, graph):
        capability = find(driver.capabilities, name, "write")
        arguments = chosen.arguments
        if AT in arguments:
            arguments = at_place(capability, arguments, {**await offered(driver.connection, graph), **own})
        seconds = chosen.timeout if chosen.keep is None else chosen.keep
        plan = await driver.plan(name, arguments, seconds=seconds, way=chosen.way)
        if chosen.dry_run:
            show_plan(plan, json=chosen.json)
            return
        if plan.rate and chosen.keep is None:
            raise UsageError("KG003", f"`{plan.capability}` needs a duration", hint="For example: --for 2.")
        if not plan.rate and chosen.keep is not None:
            raise UsageError(
                "KG003", f"`{plan.capability}` ends by itself", hint="Leave out --for; --timeout bounds it."
            )
        for doubt in await driver.doubts(name, "write", way=chosen.way):
            warn(doubt, json=chosen.json)
        throttle = Throttle(None if chosen.json else _FEEDBACK)

        def feedback(values: "Mapping[str, Any]") -> None:
            # Wall-clock: people do not read faster when a simulation runs faster.
            if throttle.takes(monotonic()):
                write_feedback(values, capability, json=chosen.json)

        async def follow() -> None:
            async for changed in driver.connection.changes():
                driver.saw(changed)

        following = spawn(follow(), "following other controllers of the robot")
        try:
            outcome = await driver.do(name, arguments, seconds=seconds, way=chosen.way, on_feedback=feedback)
        finally:
            await ended(following)
        show_outcome(outcome, capability, json=chosen.json)
        if outcome.problem is not None:
            raise outcome.problem


_LONGEST: Final = 60
_WIDEST: Final = 100  # maximum columns of a progress line
_QUATERNION: Final = {"x", "y", "z", "w"}


def write_values(value: "Mapping[str, Any]", capability: "Capability", *, json: bool) -> None:
    """Write values by parameter, with units on a terminal, else as a line of JSON."""
    if json or not terminal():
        write_message(value)
    else:
        write(_words(value, capability))
        sys.stdout.flush()


def write_message(value: "Mapping[str, Any]") -> None:
    """Write a message as a line of JSON."""
    json_lines([json_value(value, _of_bytes)])
    sys.stdout.flush()


def warn(doubt: "GraphProblem", *, json: bool) -> None:
    """Warn of an expected failure, with a hint; with `json` also as a line of the data."""
    error = RobotError(doubt.code, f"{doubt.subject}: {doubt.message}")
    report(error, "warning")
    if json:
        hint = CATALOGUE[doubt.code].way_out
        event = {"event": "warning", "code": doubt.code, "name": doubt.subject, "message": doubt.message, "hint": hint}
        write_message(event)


def write_feedback(value: "Mapping[str, Any]", capability: "Capability", *, json: bool) -> None:
    """Write the progress of a goal: as a line of data with `json`, else as a short text."""
    if json:
        write_values({"feedback": value}, capability, json=True)
    elif words := _words(value, capability):
        say(words if len(words) <= _WIDEST else f"{words[: _WIDEST - 3]}...")


def show_outcome(outcome: "Outcome", capability: "Capability", *, json: bool) -> None:
    """Write the outcome of a command and its results."""
    if json or not terminal():
        result = {"ended": outcome.ended, "sent": outcome.sent, "values": outcome.values}
        if outcome.moved is not None:
            result["moved"] = outcome.moved
        json_lines([json_value(result, _of_bytes)])
        return
    if outcome.values:
        write(_words(outcome.values, capability))
    plan = outcome.plan
    if plan.kind == "topic":
        after = ", then a zero command" if plan.afterwards is not None else ""
        note(f"sent {count(outcome.sent, 'message')} to {plan.name}{after}")
    else:
        note(f"{plan.name} is {outcome.ended}")


def show_plan(plan: "Plan", *, json: bool) -> None:
    """Write the plan of a dry run."""
    if json or not terminal():
        json_lines([json_value(msgspec.to_builtins(plan), _of_bytes)])
        return
    often = f" {plan.rate:g} times a second" if plan.rate else ""
    time = f" for {plan.seconds:g} s" if plan.rate and plan.seconds else ""
    note(f"{plan.capability} would send to the {plan.kind} {plan.name} of {plan.node}{often}{time}:")
    for line in _lines({plan.type: plan.message}):
        write(printable(line))
    if plan.afterwards is not None:
        note("then the same with zeros, to stop")


def _lines(value: "Mapping[str, Any]", depth: int = 0) -> list[str]:
    lines = []
    for name, one in value.items():
        if isinstance(one, dict):
            lines += [f"{'  ' * depth}{name}:", *_lines(one, depth + 1)]
        else:
            lines.append(f"{'  ' * depth}{name}: {_short(one)}")
    return lines


def _words(value: "Mapping[str, Any]", capability: "Capability") -> str:
    units = {one.name: one.unit for one in capability.parameters}
    leaves = dict(_leaves(value))
    shared = Counter(ending for name in leaves for ending in _endings(name))
    short = {
        next((one for one in _endings(name) if shared[one] == 1), name): value_of for name, value_of in leaves.items()
    }
    parts = []
    for name, one in short.items():
        unit = f" {units[name]}" if units.get(name) and isinstance(one, int | float) else ""
        parts.append(f"{name} {_short(one):>8}{unit}")
    return printable("   ".join(parts)).rstrip()


def _endings(path: str) -> "Iterator[str]":
    """Yield the suffixes of a path, the shortest first: `c`, `b.c`, `a.b.c`."""
    steps = path.split(".")
    return (".".join(steps[-length:]) for length in range(1, len(steps) + 1))


def _leaves(value: "Mapping[str, Any]", before: str = "") -> "Iterator[tuple[str, Any]]":
    """Yield the scalar fields of a message by path, except headers and quaternions."""
    for name, one in value.items():
        if not isinstance(one, dict):
            yield before + name, one
        elif name != "header" and set(one) != _QUATERNION:
            yield from _leaves(one, f"{before}{name}.")


def _short(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return "free" if math.isinf(value) else f"{value:.3f}"
    text = _of_bytes(value) if isinstance(value, bytes) else str(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


_SHOWN: Final = 16
"""Bytes up to which an array is written in hexadecimal: identities of goals are that long, and images longer."""


def _of_bytes(value: bytes) -> str:
    return value.hex() if len(value) <= _SHOWN else f"{len(value)} bytes"
