"""`kg robot simulate`: a robot to try things on."""

from contextlib import suppress
from typing import TYPE_CHECKING, Annotated

import typer

from kg.cli.diagnostics import say
from kg.cli.options import Store, argument, factor, option, require_one_of, session, whole
from kg.cli.options import seconds as number_of_seconds
from kg.errors import StoreError, UsageError
from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.settings import Settings

with lazily():
    import asyncio
    import os
    import secrets
    import subprocess
    import sys
    from pathlib import Path
    from shlex import quote
    from tempfile import TemporaryDirectory

    from kg.cli.interruptible import interruptible
    from kg.evaluate.exercises import exercises
    from kg.resources import folder
    from kg.robot.connecting import scheme_of
    from kg.robot.simulation.running import Choice
    from kg.robot.simulation.running import simulate as run_simulation
    from kg.store.opening import layout_of

World = Annotated[str, argument("WORLD", "`office` (a wheeled robot), `drone` or `arm`.")]
Master = Annotated[str | None, option("--master ADDRESS", "Join this system: ros1://HOST:PORT, dds://DOMAIN.")]
Port = Annotated[str, option("--port N", "Port of the ROS master; 0 picks a free one.")]
Ros2 = Annotated[bool, option("--ros2", "Use ROS 2 over DDS.")]
Speed = Annotated[str, option("--speed N", "Speed as a multiple of real time, or `max`.")]
Seconds = Annotated[str | None, option("--seconds S", "Stop after this many simulated seconds.")]
Seed = Annotated[str, option("--seed N", "Seed of the noise.")]
Exercise = Annotated[str | None, option("--exercise N", "Begin where this exercise (1 to 4) of onto-ros begins.")]
Page = Annotated[bool, option("--page", "Also show the robot on a page of `kg serve`.")]


def simulate(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    world: World,
    *,
    master: Master = None,
    port: Port = "0",
    ros2: Ros2 = False,
    speed: Speed = "1",
    seconds: Seconds = None,
    seed: Seed = "0",
    exercise: Exercise = None,
    page: Page = False,
    store: Store = None,
) -> None:
    """Simulate a robot with ROS nodes: on wheels in an office, a drone, or an arm.

    The office has named rooms and the drone's field has pads; both contain tags. The arm has a gripper, and a table
    with cubes and trays. A separate ROS master is started unless --master names a running system. With --speed other
    than 1, nodes take their time from /clock. Needs the extra `simulate`. For example:

        kg robot simulate office
        kg robot simulate drone --master ros1://localhost:11311
        kg robot simulate office --ros2 --page
        kg robot simulate drone --speed max --seconds 600
        kg robot simulate drone --exercise 3
        kg robot simulate arm --page
    """
    choice = chosen(
        world, master=master, port=port, ros2=ros2, speed=speed, seconds=seconds, seed=seed, exercise=exercise
    )
    interruptible(simulated(choice, session(context).settings(store=store) if page else None))


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
) -> "Choice":
    """Return the simulation that the options select.

    Raises:
        UsageError: KG003 invalid options.
        RobotError: KG801 an invalid address of a master.
    """
    from kg.evaluate.exercises import ROBOTS  # noqa: PLC0415 - start-up time
    from kg.robot.simulation.plan import PLANS  # noqa: PLC0415 - start-up time

    require_one_of(world, PLANS, "world")
    own = whole(port, "--port", 0, 65535)
    if master is not None:
        scheme_of(master)
    if ros2 and master and master.startswith("ros1:"):
        raise UsageError("KG003", f"--ros2 does not go with the master {master}", hint="Name a domain: dds://0.")
    if own and (ros2 or master):
        other = f"--master {master}" if master else "--ros2"
        hint = "Leave out --port, which is of a ROS master of our own; ROS_DOMAIN_ID names a domain of ROS 2."
        raise UsageError("KG003", f"--port {port} does not go with {other}", hint=hint)
    robot = next((one for one in ROBOTS if one == world), None) if exercise else None
    if exercise and robot is None:
        hint = f"Exercises are of {' and '.join(ROBOTS)}."
        raise UsageError("KG003", f"--exercise does not go with the world `{world}`", hint=hint)
    number = whole(exercise, "--exercise", 1, 4) if exercise else 0
    return Choice(
        world,
        master,
        own,
        ros2,
        None if speed == "max" else factor(speed, "--speed"),
        number_of_seconds(seconds, "--seconds") if seconds else None,
        whole(seed, "--seed", 0),
        exercises()[number - 1].of(robot).start if robot else None,
    )


async def simulated(choice: "Choice", settings: "Settings | None") -> None:
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
        program = next((folder("examples") / "programs").glob(f"{choice.world}-1-*.kgp"))
        program = program.relative_to(Path.cwd()) if program.is_relative_to(Path.cwd()) else program
        say(f"      kg robot run {quote(str(program))} --robot {typed}")
        if address.startswith("ros1:"):
            say(f"      export ROS_MASTER_URI=http://{address.removeprefix('ros1://')}")
        if settings is None:
            say(f"      or with blocks, on a page: KG_TOKEN=choose-a-long-secret kg serve --robot {typed}")
        else:
            pages.append(asyncio.create_task(_shown(address, settings)))

    try:
        await run_simulation(choice, begun)
    finally:
        for task in pages:
            task.cancel()
        await asyncio.gather(*pages, return_exceptions=True)


async def _shown(address: str, settings: "Settings") -> None:
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
    process = await asyncio.create_subprocess_exec(
        *command, stdout=subprocess.DEVNULL, env=os.environ | {"KG_TOKEN": token}
    )
    try:
        await process.wait()
    finally:
        with suppress(ProcessLookupError):
            process.terminate()
        await process.wait()
