"""`kg robot simulate`: its options, messages, and the page for the robot."""

from __future__ import annotations

import asyncio
import os
import secrets
import sys
from asyncio.subprocess import DEVNULL
from contextlib import suppress
from pathlib import Path
from shlex import quote
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from kg.cli.diagnostics import say
from kg.cli.numbers import factor, whole
from kg.cli.numbers import seconds as number_of_seconds
from kg.errors import StoreError, UsageError
from kg.lazily import lazily
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.robot.simulation.plan import Place
    from kg.settings import Settings

with lazily():
    from kg.evaluate.exercises import exercises
    from kg.resources import folder
    from kg.robot.connecting import scheme_of
    from kg.robot.simulation.running import Choice, simulate
    from kg.store.opening import layout_of


def chosen(  # noqa: PLR0913 - the options of a command
    world: str,
    *,
    master: str | None,
    port: str,
    ros2: bool,
    speed: str,
    seconds: str | None,
    seed: str,
    exercise: str | None = None,
) -> Choice:
    """Return the simulation that the options select.

    Raises:
        UsageError: KG003 invalid options.
        RobotError: KG801 an invalid address of a master.
    """
    from kg.robot.simulation.plan import PLANS  # noqa: PLC0415 - start-up time

    if world not in PLANS:
        hint = did_you_mean(world, PLANS) or f"One of {', '.join(PLANS)}."
        raise UsageError("KG003", f"unknown world `{world}`", hint=hint)
    own = whole(port, "--port", 0, 65535)
    if master is not None:
        scheme_of(master)
    if ros2 and master and master.startswith("ros1:"):
        raise UsageError("KG003", f"--ros2 does not go with the master {master}", hint="Name a domain: dds://0.")
    if own and (ros2 or master):
        other = f"--master {master}" if master else "--ros2"
        hint = "Leave out --port, which is of a ROS master of our own; ROS_DOMAIN_ID names a domain of ROS 2."
        raise UsageError("KG003", f"--port {port} does not go with {other}", hint=hint)
    return Choice(
        world,
        master,
        own,
        ros2,
        None if speed == "max" else factor(speed, "--speed"),
        number_of_seconds(seconds, "--seconds") if seconds else None,
        whole(seed, "--seed", 0),
        _start(world, whole(exercise, "--exercise", 1, 4)) if exercise else None,
    )


def _start(world: str, number: int) -> Place | None:
    """Return the start of the robot in an exercise; UsageError KG003 for a world without exercises."""
    from kg.evaluate.exercises import ROBOTS  # noqa: PLC0415 - start-up time

    robot = next((one for one in ROBOTS if one == world), None)
    if robot is None:
        hint = f"Exercises are of {' and '.join(ROBOTS)}."
        raise UsageError("KG003", f"--exercise does not go with the world `{world}`", hint=hint)
    return exercises()[number - 1].of(robot).start


async def simulated(choice: Choice, settings: Settings | None) -> None:
    """Simulate a robot and report its address; with `settings`, also run `kg serve` for it.

    Raises as `kg.robot.simulation.running.simulate`.
    """
    pages: list[asyncio.Task[None]] = []

    def begun(address: str) -> None:
        speed = "as fast as can be" if choice.speed is None else f"{choice.speed:g} times real time"
        say(f"{choice.world} at {address}, {speed}; Ctrl-C ends it")
        typed = quote(address)
        say(f"next: kg robot capabilities --live --robot {typed}")
        sense = "sensingHand" if choice.world == "arm" else "sensingPose"
        say(f"      kg robot read {sense} --robot {typed}")
        say(f"      kg robot run {quote(_example(choice.world))} --robot {typed}")
        if address.startswith("ros1:"):
            say(f"      export ROS_MASTER_URI=http://{address.removeprefix('ros1://')}")
        if settings is None:
            say(f"      or with blocks, on a page: KG_TOKEN=choose-a-long-secret kg serve --robot {typed}")
        else:
            pages.append(asyncio.create_task(_shown(address, settings)))

    try:
        await simulate(choice, begun)
    finally:
        for task in pages:
            task.cancel()
        await asyncio.gather(*pages, return_exceptions=True)


def _example(world: str) -> str:
    """Return the path of an example program, as short as it can be typed here."""
    path = next((folder("examples") / "programs").glob(f"{world}-1-*.kgp"))
    return str(path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path)


async def _shown(address: str, settings: Settings) -> None:
    """Run `kg serve` for the robot until cancelled; the reported token allows moving it.

    Without a store, a temporary one with the robot is used.
    """
    token = os.environ.get("KG_TOKEN") or secrets.token_urlsafe(12)
    say(f"token of the page, which moves the robot: {token}")
    robot = ("--robot", address)
    with TemporaryDirectory() as folder:
        try:
            store = str(layout_of(settings).root)
        except StoreError:
            store = str(Path(folder) / ".kg")
            await _ran(token, "robot", "watch", "--once", *robot, "--store", store)
        await _ran(token, "serve", *robot, "--port", "0", "--store", store)
        say("the page was closed; the robot continues")


async def _ran(token: str, *arguments: str) -> None:
    """Run `kg` in another process until it exits, or until cancelled."""
    command = [sys.executable, "-m", "kg", *arguments]
    process = await asyncio.create_subprocess_exec(*command, stdout=DEVNULL, env=os.environ | {"KG_TOKEN": token})
    try:
        await process.wait()
    finally:
        with suppress(ProcessLookupError):
            process.terminate()
        await process.wait()
