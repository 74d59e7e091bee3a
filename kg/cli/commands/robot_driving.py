"""`kg robot read` and `kg robot do`: what a robot senses, and making it act."""

from typing import Annotated

import typer

from kg.cli.options import Exclusive, Json, Places, Robot, WatchdogSeconds
from kg.cli.session import session

__all__ = ["do", "read"]

CapabilityName = Annotated[
    str,
    typer.Argument(
        metavar="CAPABILITY",
        help="Its name, as `kg robot capabilities` lists it, its label, or another name for it.",
    ),
]
Values = Annotated[
    list[str] | None,
    typer.Argument(metavar="NAME=VALUE", help="Its parameters, with or without units: forward=20cm/s, or at=PLACE."),
]
Way = Annotated[
    str | None,
    typer.Option("--way", metavar="NAME", help="Of several ways this: a topic, service, action, node or message type."),
]
Once = Annotated[bool, typer.Option("--once", help="Read one value, and end.")]
Count = Annotated[str | None, typer.Option("--count", "-n", metavar="N", help="Read so many values, and end.")]
Seconds = Annotated[
    str | None, typer.Option("--seconds", metavar="S", help="Read for so many seconds of the robot's time, and end.")
]
Rate = Annotated[
    str | None,
    typer.Option("--rate", metavar="HZ", help="At most so many values a second; how often a service is asked."),
]
For = Annotated[
    str | None, typer.Option("--for", metavar="S", help="Keep a movement up for so many seconds of the robot's time.")
]
Within = Annotated[
    str | None,
    typer.Option("--timeout", metavar="S", help="Give a goal, or a service, up after so many seconds."),
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Say what would be sent where, and send nothing.")]


def read(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    capability: CapabilityName,
    *,
    once: Once = False,
    count: Count = None,
    seconds: Seconds = None,
    rate: Rate = None,
    way: Way = None,
    robot: Robot = None,
    json: Json = False,
) -> None:
    """Read what a robot senses or knows, a line for each value, until Ctrl-C.

    Values are named by the parameters of the capability and in their units; in JSON, null stands for no reading, and
    for one that is infinite. For example:

        kg robot read sensingPose
        kg robot read laserScanning --rate 2
        kg robot read sensingBattery --once --json
    """
    from kg.cli.driving import Reading, read_capability  # noqa: PLC0415 - start-up time

    asked = Reading.of(once=once, count=count, seconds=seconds, rate=rate, way=way, json=json)
    read_capability(session(context).settings(robot=robot), capability, asked)


def do(  # noqa: PLR0913 - the options of a command
    context: typer.Context,
    capability: CapabilityName,
    values: Values = None,
    *,
    keep: For = None,
    timeout: Within = None,
    way: Way = None,
    dry_run: DryRun = False,
    exclusive: Exclusive = False,
    places: Places = None,
    robot: Robot = None,
    watchdog: WatchdogSeconds = None,
    json: Json = False,
) -> None:
    """Let a robot do something, and wait until it is done.

    A movement is kept up for --for seconds and ends with a command to stand still, whatever happens: also on Ctrl-C, on
    an error, and when the robot's node goes away. A goal (an action) tells how far it is, and is cancelled on Ctrl-C.
    Ctrl-Z ends the command, too. If this process hangs or is killed, a watchdog stops the robot after --watchdog
    seconds.
    Values out of a parameter's limits are refused. A place stands for its coordinates; a simulated robot knows some,
    others stand in a file (--places). For example:

        kg robot do drivingAtVelocity forward=0.2 turn=10deg/s --for 2
        kg robot do goingToPose x=3 y=150cm heading=90deg --timeout 60
        kg robot do goingToPose at=kitchen --timeout 60
        kg robot do takingOff --dry-run
    """
    from kg.cli.driving import Doing, do_capability  # noqa: PLC0415 - start-up time

    asked = Doing.of(values or [], keep=keep, timeout=timeout, way=way, dry_run=dry_run, exclusive=exclusive, json=json)
    do_capability(session(context).settings(robot=robot, places=places, watchdog=watchdog), capability, asked)
