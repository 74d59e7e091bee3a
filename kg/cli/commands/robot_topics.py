"""`kg robot nodes`, `topics`, `params` and `record`: who is there, and what goes over the wires of a robot."""

from collections import Counter
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, Any, Final

from kg.cli.diagnostics import note, problem
from kg.cli.options import Json, argument, option, seconds, with_settings
from kg.cli.output import Column, json_lines, listing, numbers, terminal
from kg.errors import RobotError
from kg.facts import Role
from kg.lazily import lazily
from kg.render.text import count, json_text, printable
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.robot.connection import ComputationGraph, GraphProblem


with lazily():
    import asyncio
    import math
    from pathlib import Path

    import msgspec

    from kg.cli.commands.robot import report_problems
    from kg.cli.commands.robot_driving import warn
    from kg.cli.interruptible import interruptible
    from kg.robot.bag.recording import Recorder
    from kg.robot.clock import within
    from kg.robot.connecting import address_of, connected, inhabited, is_recording, look, not_commanded
    from kg.robot.live.systems import is_implicit
    from kg.robot.parameters import NodeParameter, find, parsed, read
    from kg.robot.parameters import write as write_parameter


_NODES: Final = (
    Column("node", "name"),
    Column("state"),
    *numbers("publishes", "subscribes", "services", "actions"),
    Column("where", "dim", spare=2),
    Column("problem", spare=1),
)
_COUNTED: Final = {
    "publishes": Role.PUBLISHES,
    "subscribes": Role.SUBSCRIBES,
    "services": Role.SERVICES,
    "actions": Role.ACTION_SERVERS,
}
_TOPICS: Final = (
    Column("topic", "name"),
    Column("type"),
    Column("publishers", spare=2),
    Column("subscribers", spare=1),
    *numbers("messages", "rate"),
)
_RECORDED: Final = (
    Column("topic", "name"),
    Column("type"),
    Column("messages", "number"),
    Column("dropped", "number", spare=1),
)


File = Annotated[str, argument("FILE", "New file: .bag for ROS 1, .mcap for ROS 2.", show_default=False)]
Topics = Annotated[list[str] | None, argument("TOPIC", "Topics to record, such as /scan; by default all.")]
For = Annotated[str | None, option("--for S", "Record for this many seconds of the robot's time.")]


@with_settings("robot")
def nodes(*, settings: Settings, json: Json = False) -> None:
    """List a robot's nodes with the states of managed ones.

    A managed node of ROS 2 (life cycle) works only in the state `active`. Until then, the capabilities that only it
    provides are not available. For example:

        kg robot nodes
        kg robot nodes --json
    """
    graph = asyncio.run(look(address_of(settings)))
    report_problems(graph)
    ends = {
        (end.node, end.role, end.name) for end in graph.ends if not is_implicit(end.role, end.name, end.node, graph.ros)
    }
    counts = Counter((node, role) for node, role, _ in ends)
    listed = [
        {
            "name": node.name,
            "state": node.state,
            **{title: counts[node.name, role] for title, role in _COUNTED.items()},
            "address": node.address,
            "problem": node.problem,
        }
        for node in graph.nodes
    ]
    listing(_NODES, (tuple(one.values()) for one in listed), objects=listed if json else None)


@with_settings("robot")
def topics(*, settings: Settings, json: Json = False) -> None:
    """List a robot's topics with types, publishers and subscribers.

    For a recording, messages and the rate (messages per second of the recording) are listed, too. For example:

        kg robot topics
        kg robot topics --robot bag://drive.mcap
    """
    graph = asyncio.run(look(address_of(settings)))
    report_problems(graph)
    listed = _topics(graph)
    rows = []
    for one in listed:
        rate = None if one["rate"] is None else f"{one['rate']:.1f}"
        ends = (", ".join(one["publishers"]), ", ".join(one["subscribers"]))
        rows.append((one["name"], one["type"], *ends, one["messages"], rate))
    listing(_TOPICS, rows, objects=listed if json else None)


def _topics(graph: "ComputationGraph") -> list[dict[str, Any]]:
    topics_by_name: dict[str, dict[str, Any]] = {}
    recorded = {one.name: one for one in graph.recorded}
    for end in graph.ends:
        if end.role not in {Role.PUBLISHES, Role.SUBSCRIBES}:
            continue
        empty: dict[str, Any] = {"name": end.name, "type": None, "publishers": [], "subscribers": []}
        one = topics_by_name.setdefault(end.name, {**empty, "messages": None, "rate": None})
        one["type"] = one["type"] or end.type
        nodes = one["publishers" if end.role is Role.PUBLISHES else "subscribers"]
        if end.node not in nodes:
            nodes.append(end.node)
        if (recording := recorded.get(end.name)) is not None:
            one["messages"] = recording.count
            one["rate"] = round(recording.count / recording.seconds, 3) if recording.seconds else None
    return [topics_by_name[name] for name in sorted(topics_by_name)]


@with_settings("robot")
def record(file: File, names: Topics = None, *, settings: Settings, keep: For = None, json: Json = False) -> None:
    """Record topics of a robot to a file, until Ctrl-C.

    Topics that appear later are recorded, too. The file is complete after Ctrl-C, SIGTERM, --for, or the loss of the
    robot. Read it with --robot bag://FILE, `rosbag` or `ros2 bag`. For example:

        kg robot record drive.bag
        kg robot record drive.mcap /scan /odom --for 60
    """
    period = None if keep is None else seconds(keep, "--for")
    interruptible(_record(settings, Path(file), names or (), keep=period, json=json))


async def _record(settings: Settings, path: "Path", topics: "Sequence[str]", *, keep: float | None, json: bool) -> None:
    """Record topics until the command is ended, `keep` seconds have passed or the robot ends; then list them.

    Raises as `Recorder`; RobotError KG803 when the robot is lost, KG825 if no message arrived within `keep` seconds.
    """
    address = address_of(settings)
    async with connected(address) as connection:
        await inhabited(connection)
        recorder = Recorder(
            connection,
            path,
            topics=frozenset(topics) or None,
            begun=lambda topic, kind: note(f"recording {topic} ({kind})"),
            on_problem=lambda one: warn(one, json=False),
        )
        try:
            work = recorder.run()
            await (work if keep is None else within(connection.clock, keep, work))
        except TimeoutError:
            pass
        finally:
            done = recorder.close()
            listing(
                _RECORDED,
                [(one.topic, one.type, one.messages, one.dropped) for one in done],
                objects=map(asdict, done) if json else None,
            )
            number = sum(one.messages for one in done)
            if number:
                note(f"{count(number, 'message')} in {recorder.last - recorder.first:.1f} s: {path}")
        if not number:
            raise RobotError("KG825", "no message arrived, so no file was written")


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
