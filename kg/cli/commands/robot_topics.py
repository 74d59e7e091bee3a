"""`kg robot nodes`, `kg robot topics` and `kg robot record`: who is there, and what goes over the wires of a robot."""

from typing import Annotated

import typer

from kg.cli.options import Json, with_settings
from kg.lazily import lazily
from kg.settings import Settings

with lazily():
    from pathlib import Path

    from kg.cli.numbers import seconds
    from kg.cli.recording import list_nodes, list_topics, record_topics

File = Annotated[
    str,
    typer.Argument(metavar="FILE", help="New file: .bag for ROS 1, .mcap for ROS 2.", show_default=False),
]
Topics = Annotated[
    list[str] | None, typer.Argument(metavar="TOPIC", help="Topics to record, such as /scan; by default all.")
]
For = Annotated[
    str | None, typer.Option("--for", metavar="S", help="Record for this many seconds of the robot's time.")
]


@with_settings("robot")
def nodes(*, settings: Settings, json: Json = False) -> None:
    """List a robot's nodes with the states of managed ones.

    A managed node of ROS 2 (life cycle) works only in the state `active`. Until then, the capabilities that only it
    provides are not available. For example:

        kg robot nodes
        kg robot nodes --json
    """
    list_nodes(settings, json=json)


@with_settings("robot")
def topics(*, settings: Settings, json: Json = False) -> None:
    """List a robot's topics with types, publishers and subscribers.

    For a recording, messages and the rate (messages per second of the recording) are listed, too. For example:

        kg robot topics
        kg robot topics --robot bag://drive.mcap
    """
    list_topics(settings, json=json)


@with_settings("robot")
def record(
    file: File,
    names: Topics = None,
    *,
    settings: Settings,
    keep: For = None,
    json: Json = False,
) -> None:
    """Record topics of a robot to a file, until Ctrl-C.

    Topics that appear later are recorded, too. The file is complete after Ctrl-C, SIGTERM, --for, or the loss of the
    robot. Read it with --robot bag://FILE, `rosbag` or `ros2 bag`. For example:

        kg robot record drive.bag
        kg robot record drive.mcap /scan /odom --for 60
    """
    record_topics(settings, Path(file), names or (), keep=None if keep is None else seconds(keep, "--for"), json=json)
