"""`kg robot params`: the parameters of running nodes."""

from typing import Annotated

import typer

from kg.cli.options import Json, with_settings
from kg.lazily import lazily
from kg.settings import Settings

with lazily():
    from kg.cli.parameters import set_parameter, show_parameters

Node = Annotated[
    str | None, typer.Argument(metavar="NODE", help="A node, such as /amcl; in ROS 1, a node or a namespace.")
]
Name = Annotated[str | None, typer.Argument(metavar="NAME", help="A parameter of the node.")]
Value = Annotated[str | None, typer.Argument(metavar="VALUE", help="Its new value, as in a parameter file.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Check the value without setting it.")]


@with_settings("robot")
def params(  # noqa: PLR0913 - the options of a command
    node: Node = None,
    name: Name = None,
    value: Value = None,
    *,
    settings: Settings,
    dry_run: DryRun = False,
    json: Json = False,
) -> None:
    """Show the parameters of running nodes, or set one.

    With NODE, shows those of one node; with NAME, one of them; with VALUE, sets it. The value must have the type and be
    within the limits that the node describes, and the node can refuse it. A parameter can change how a robot moves:
    nothing stops a robot when it is set. Write a negative value last, after `--`. For example:

        kg robot params
        kg robot params /amcl max_beams
        kg robot params /controller_server FollowPath.max_vel_x 0.3
        kg robot params /controller_server FollowPath.min_vel_x -- -0.1
        kg robot params /move_base base_local_planner dwa_local_planner/DWAPlannerROS --dry-run
    """
    if node is not None and name is not None and value is not None:
        set_parameter(settings, node, name, value, dry_run=dry_run, json=json)
    else:
        show_parameters(settings, node, name, json=json)
