"""`kg robot simulate`: a robot to try things on."""

from typing import Annotated

import typer

from kg.cli.options import Store
from kg.cli.session import session
from kg.lazily import lazily

with lazily():
    from kg.cli.interruptible import interruptible
    from kg.cli.simulating import chosen, simulated

World = Annotated[str, typer.Argument(metavar="WORLD", help="`office` (a wheeled robot), `drone` or `arm`.")]
Master = Annotated[
    str | None,
    typer.Option("--master", metavar="ADDRESS", help="Join this system: ros1://HOST:PORT, dds://DOMAIN."),
]
Port = Annotated[str, typer.Option("--port", metavar="N", help="Port of the ROS master; 0 picks a free one.")]
Ros2 = Annotated[bool, typer.Option("--ros2", help="Use ROS 2 over DDS.")]
Speed = Annotated[str, typer.Option("--speed", metavar="N", help="Speed as a multiple of real time, or `max`.")]
Seconds = Annotated[str | None, typer.Option("--seconds", metavar="S", help="Stop after this many simulated seconds.")]
Seed = Annotated[str, typer.Option("--seed", metavar="N", help="Seed of the noise.")]
Exercise = Annotated[
    str | None, typer.Option("--exercise", metavar="N", help="Begin where this exercise (1 to 4) of onto-ros begins.")
]
Page = Annotated[bool, typer.Option("--page", help="Also show the robot on a page of `kg serve`.")]


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
        world,
        master=master,
        port=port,
        ros2=ros2,
        speed=speed,
        seconds=seconds,
        seed=seed,
        exercise=exercise,
    )
    interruptible(simulated(choice, session(context).settings(store=store) if page else None))
