"""`kg robot read` and `kg robot do`: what a robot senses, and making it act."""

from typing import Annotated

import typer

from kg.cli.options import Exclusive, Json, with_settings
from kg.lazily import lazily
from kg.settings import Settings

with lazily():
    from kg.cli.driving import Doing, Reading, do_capability, read_capability

CapabilityName = Annotated[
    str,
    typer.Argument(
        metavar="CAPABILITY",
        help="Name of a capability (see `kg robot capabilities`), its label or a synonym.",
    ),
]
Readable = Annotated[
    str,
    typer.Argument(
        metavar="CAPABILITY",
        help="Name, label or synonym of a capability (see `kg robot capabilities`), or a topic such as /scan.",
    ),
]
Values = Annotated[
    list[str] | None,
    typer.Argument(metavar="NAME=VALUE", help="Parameters, with or without units: forward=20cm/s, or at=PLACE."),
]
Way = Annotated[
    str | None,
    typer.Option(
        "--way", metavar="NAME", help="Topic, service, action, node or message type to use, if there are several."
    ),
]
Once = Annotated[bool, typer.Option("--once", help="Read one value and exit.")]
Count = Annotated[str | None, typer.Option("--count", "-n", metavar="N", help="Read this many values and exit.")]
Seconds = Annotated[
    str | None, typer.Option("--seconds", metavar="S", help="Read for this many seconds of the robot's time and exit.")
]
Rate = Annotated[
    str | None,
    typer.Option("--rate", metavar="HZ", help="Maximum values per second, and how often a service is called."),
]
For = Annotated[
    str | None, typer.Option("--for", metavar="S", help="Duration of a movement, in seconds of the robot's time.")
]
Within = Annotated[
    str | None,
    typer.Option("--timeout", metavar="S", help="Time limit of a goal or service call, in seconds."),
]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Print what would be sent where, without sending it.")]


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
    read_capability(settings, capability, options)


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
    do_capability(settings, capability, options)
