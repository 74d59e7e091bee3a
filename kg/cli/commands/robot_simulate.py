"""`kg robot simulate`: a robot to try things on."""

from typing import Annotated

import typer

from kg.cli.options import Store
from kg.cli.session import session

__all__ = ["simulate"]

World = Annotated[str, typer.Argument(metavar="WORLD", help="`office` (a robot on wheels) or `drone`.")]
Master = Annotated[
    str | None,
    typer.Option("--master", metavar="ADDRESS", help="Join this system: ros1://HOST:PORT, dds://DOMAIN."),
]
Port = Annotated[str, typer.Option("--port", metavar="N", help="Where our own ROS master listens; 0 is a free port.")]
Ros2 = Annotated[bool, typer.Option("--ros2", help="Speak ROS 2 over DDS.")]
Speed = Annotated[str, typer.Option("--speed", metavar="N", help="So many times real time, or `max`.")]
Seconds = Annotated[str | None, typer.Option("--seconds", metavar="S", help="End after so many simulated seconds.")]
Seed = Annotated[str, typer.Option("--seed", metavar="N", help="Another seed makes other noise.")]
Page = Annotated[bool, typer.Option("--page", help="Show the robot on a page of `kg serve` meanwhile.")]


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
    page: Page = False,
    store: Store = None,
) -> None:
    """Simulate a robot, which nodes of ROS speak for: a wheeled one in an office, or a drone over a field.

    The office has rooms with names, the field has pads; tags hang and lie there. A ROS master of our own is started
    unless --master names a system that runs. With another --speed than 1, nodes take their time from /clock. Needs the
    extra `simulate`. For example:

        kg robot simulate office
        kg robot simulate drone --master ros1://localhost:11311
        kg robot simulate office --ros2 --page
        kg robot simulate drone --speed max --seconds 600
    """
    from kg.cli.interruptible import interruptible  # noqa: PLC0415 - start-up time
    from kg.cli.simulating import chosen, simulated  # noqa: PLC0415 - start-up time

    choice = chosen(world, master=master, port=port, ros2=ros2, speed=speed, seconds=seconds, seed=seed)
    interruptible(simulated(choice, session(context).settings(store=store) if page else None))
