"""`kg robot params`: the parameters of running nodes."""

from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli.diagnostics import note, problem
from kg.cli.options import Json, argument, option, with_settings
from kg.cli.output import Column, json_lines, listing, terminal
from kg.lazily import lazily
from kg.render.text import json_text, printable
from kg.settings import Settings

if TYPE_CHECKING:
    from kg.robot.connection import GraphProblem
    from kg.robot.parameters import NodeParameter

with lazily():
    import asyncio
    import math

    import msgspec

    from kg.robot.connecting import address_of, connected, inhabited, is_recording, not_commanded
    from kg.robot.parameters import find, parsed, read
    from kg.robot.parameters import write as write_parameter

_COLUMNS: Final = (
    Column("node", spare=1),
    Column("parameter", "name"),
    Column("type"),
    Column("value"),
    Column("limits", spare=2),
    Column("description", "dim", spare=3),
)
_LONGEST: Final = 60


Node = Annotated[str | None, argument("NODE", "A node, such as /amcl; in ROS 1, a node or a namespace.")]
Name = Annotated[str | None, argument("NAME", "A parameter of the node.")]
Value = Annotated[str | None, argument("VALUE", "Its new value, as in a parameter file.")]
DryRun = Annotated[bool, option("--dry-run", "Check the value without setting it.")]


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


def show_parameters(settings: Settings, node: str | None, name: str | None, *, json: bool) -> None:
    """Write the parameters of a robot or node, or one parameter; raises as `kg.robot.parameters.read`."""
    address = address_of(settings)

    async def read_parameters() -> "tuple[list[NodeParameter], list[GraphProblem]]":
        async with connected(address) as connection:
            await inhabited(connection)
            if node is None or name is None:
                return await read(connection, node)
            return [await find(connection, node, name)], []

    parameters, problems = asyncio.run(read_parameters())
    for one in problems:
        problem(one.code, one.message, one.subject)
    listing(_COLUMNS, map(_row, parameters), objects=map(_object, parameters) if json else None)
    if not (parameters or problems or json):
        note(f"{node or address} has no parameters")


def set_parameter(  # noqa: PLR0913 - the arguments and options of the command
    settings: Settings, node: str, name: str, text: str, *, dry_run: bool, json: bool
) -> None:
    """Set a parameter and write its old and new value; raises as `parsed` and `write` of `kg.robot.parameters`."""
    address = address_of(settings)
    if is_recording(address):
        raise not_commanded(address)

    async def change() -> "tuple[NodeParameter, NodeParameter]":
        async with connected(address) as connection:
            await inhabited(connection)
            before = await find(connection, node, name, new=True)
            value = parsed(before, text)
            if dry_run:
                return before, msgspec.structs.replace(before, value=value)
            return before, await write_parameter(connection, before, value)

    before, after = asyncio.run(change())
    if json or not terminal():
        json_lines([{**_object(after), "before": _plain(before.value), "set": not dry_run}])
    else:
        done = "would be" if dry_run else "is"
        note(f"{after.name} of {after.node} was {_shown(before)}, and {done} {_shown(after)}")


def _object(one: "NodeParameter") -> dict[str, Any]:
    fields: dict[str, Any] = msgspec.to_builtins(one)
    return {**fields, "value": _plain(one.value)}


def _plain(value: Any) -> Any:
    """Return a value for JSON; numbers that are not finite are written as in YAML."""
    if isinstance(value, list):
        return [_plain(one) for one in value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"
    return value


def _shown(one: "NodeParameter") -> str:
    if one.value is None:
        return "not set"
    value = _plain(one.value)
    text = printable(value) if isinstance(value, str) else json_text(value)
    return text if len(text) <= _LONGEST or not terminal() else f"{text[: _LONGEST - 3]}..."


def _row(one: "NodeParameter") -> tuple[str, ...]:
    bounds = [f"{bound:g}" if bound is not None else "" for bound in (one.minimum, one.maximum)]
    limits = " to ".join(bounds) if any(bounds) else one.constraints
    if one.read_only:
        limits = ", ".join(filter(None, ("read-only", limits)))
    return one.node, one.name, one.type, _shown(one), limits, one.description
