"""`kg graph` and `kg instances`: what a launch file starts, in words, as a picture and for other programs."""

from collections import Counter
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Annotated, Final

import typer

from kg.cli.diagnostics import note
from kg.cli.drawing import Dot, Mermaid, Output, Svg, deliver, form_of
from kg.cli.options import All, Json, option, whole, with_settings
from kg.cli.output import Column, json_line, listing, numbers, terminal
from kg.cli.systems import (
    Arguments,
    Environment,
    File,
    Launch,
    Variants,
    chosen_systems,
    named,
    report_left_out_parts,
    report_malformed,
    report_unknown_ends,
)
from kg.errors import Exit, UnknownNameError, UsageError
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings
from kg.similar import unknown
from kg.store.opening import reading

with lazily():
    from kg.facts import NodeInstance, Role, StartKind, System
    from kg.graph.reading.systems import included, system_names
    from kg.graph.records import instance_object
    from kg.render.system_graph import SystemGraph, system_graph
    from kg.render.system_notations import system_lines, system_object, system_rows
    from kg.render.system_views import around, collapsed


_SHOWN: Final = 12
_COLUMNS: Final = (Column("node", "name"), Column("does"), Column("name"), Column("type"), Column("with"))

Focus = Annotated[
    str | None, option("--focus NODE", "Show only the surroundings of this node: its name, or a suffix of it.")
]
Depth = Annotated[
    str | None, option("--depth N", "Maximum distance from --focus in topics, services or actions; by default 1.")
]
Expand = Annotated[
    list[str] | None, option("--expand NAMESPACE", "Expand this namespace, however large; `/` expands all.")
]


@with_settings("store")
def graph(  # noqa: PLR0913 - the options of a command
    file: File = None,
    *,
    settings: Settings,
    launch: Launch = None,
    arg: Arguments = None,
    env: Environment = None,
    variants: Variants = False,
    focus: Focus = None,
    depth: Depth = None,
    expand: Expand = None,
    every: All = False,
    svg: Svg = False,
    dot: Dot = False,
    mermaid: Mermaid = False,
    json: Json = False,
    output: Output = None,
) -> None:
    """Show the nodes and connections that a launch file starts.

    Shows each node's topics, services and actions after namespaces, remappings and parameters, and the nodes at the
    other end. Nothing is run. For large systems, pictures collapse each namespace into one box. Dead ends and unknown
    parts are marked. Errors that launch would raise are reported as KG415 with exit code 1, because the rest of the
    file is then unknown. `kg node NAME` shows one node with the lines behind it. For example:

        kg graph rover.launch
        kg graph rover_robot rover.launch camera:=false -o rover.svg
        kg graph --launch rover.launch --focus move_base --mermaid
    """
    form = form_of({"svg": svg, "dot": dot, "mermaid": mermaid, "json": json}, output)
    if depth is not None and focus is None:
        raise UsageError("KG003", "--depth needs --focus", hint="Add `--focus NODE`.")
    launch, arg = named(file, launch, arg)
    launch = launch or _only(settings)
    (system,) = chosen_systems(settings, launch, arg, env, with_variants=variants)
    drawn = system_graph(system, every=every)
    if focus is not None:
        drawn = around(drawn, _focused(drawn, focus), whole(depth or "1", "--depth", 0))
    if form not in {"text", "json"}:
        drawn = collapsed(drawn, expand or ())
    if form == "text" and output is None and not terminal():
        rows = [
            (
                *(row.node, row.verb, row.name, row.type),
                ", ".join(filter(None, (*(row.others or (f"({row.nobody})",)), row.condition))),
            )
            for row in system_rows(drawn)
        ]
        listing(_COLUMNS, rows)
    else:
        deliver(_written(drawn, form), form, output, PurePosixPath(system.configuration.path).stem)
    if form == "text" or output is not None:
        report_left_out_parts(system)
    ends = drawn.ends().values()
    if form == "text" and (not ends or any(not (sources and targets) for sources, targets in ends)):
        report_unknown_ends(system)
    if report_malformed(settings, system):
        raise typer.Exit(Exit.FOUND)
    if form == "text" and not drawn.members:
        note(f"{system.configuration.name} starts no nodes")


def _written(graph: "SystemGraph", form: str) -> str:
    from kg.render.system_notations import system_dot, system_mermaid  # noqa: PLC0415 - start-up time
    from kg.render.system_svg import system_svg  # noqa: PLC0415 - start-up time

    if form == "json":
        return json_line(system_object(graph))
    if form == "text":
        return "".join(f"{line}\n" for line in system_lines(graph))
    return {"svg": system_svg, "dot": system_dot, "mermaid": system_mermaid}[form](graph)


def _only(settings: Settings) -> str:
    """Return the only launch file of the store; KG003 with those that no other one includes where there are several."""
    with reading(settings) as snapshot:
        names = sorted({one.name for one in system_names(snapshot)})
        inner = included(snapshot)
    if len(names) == 1:
        return names[0]
    if not names:
        hint = "`kg build FOLDER` reads those of a workspace."
        raise UnknownNameError("KG422", "the store has no launch file", hint=hint)
    outer = [name for name in names if name not in inner] or names
    more = f"\n... and {len(outer) - _SHOWN} more; `kg instances` lists all" if len(outer) > _SHOWN else ""
    hint = "\n".join(f"`kg graph {name}`" for name in outer[:_SHOWN]) + more
    raise UsageError("KG003", f"the store has {len(names)} launch files; choose one", hint=hint)


def _focused(graph: "SystemGraph", name: str) -> list[str]:
    """Return the nodes that a name means: itself, else those that end with it; KG001 when there is none."""
    keys = [member.key for member in graph.members]
    matches = [key for key in keys if key == name] or [key for key in keys if key.endswith(f"/{name.strip('/')}")]
    if not matches:
        ends = [key.rpartition("/")[2] for key in keys] if "/" not in name.strip("/") else []
        raise unknown("node", name, [*keys, *ends], otherwise="`kg instances FILE` lists the nodes.")
    return matches


_COUNTS: Final = ("pub", "sub", "srv", "cli", "act", "par")
_ONE: Final = (
    Column("instance", "name"),
    Column("node", spare=1),
    Column("kind", spare=2),
    *numbers(*_COUNTS, spare=4),
    Column("remark", spare=4),
    Column("file:line", "dim", spare=3),
)
_REMARKS: Final = {
    "unknown-package": "package not in the store",
    "unknown-node": "not in its package",
    "no-node": "a program without a node",
    "not-said": "known only at run time",
}
"""Why an instance has no counts, in few words; JSON has the whole reason."""
_UNTOLD: Final = {"cli", "par"}
_UNTYPED: Final = "of no node type of the store"
_ALL: Final = (Column("system"), *_ONE)


@with_settings("store")
def instances(  # noqa: PLR0913 - the options of a command
    file: File = None,
    *,
    settings: Settings,
    launch: Launch = None,
    arg: Arguments = None,
    env: Environment = None,
    variants: Variants = False,
    json: Json = False,
) -> None:
    """List the nodes that launch files start, with their run-time names.

    Launch files are evaluated, never run: includes, namespaces, remappings, parameters and conditions behave as in
    roslaunch and ros2 launch. Without a file, all launch files of the store are listed, each with its default
    arguments. A node whose package is not in the store has no counts. `kg node NAME` shows a node's remappings,
    parameters and lines. For example:

        kg instances rover.launch
        kg instances rover_robot rover.launch camera:=false
        kg instances --launch rover_robot/launch/rover.launch --json
    """
    launch, arg = named(file, launch, arg)
    listed = chosen_systems(settings, launch, arg, env, with_variants=variants)
    objects = (instance_object(system, one) for system in listed for one in system.instances)
    rows = [
        _row(one) if launch else (system.configuration.name, *_row(one))
        for system in listed
        for one in system.instances
    ]
    listing(_ONE if launch else _ALL, rows, objects=objects if json else None)
    if not listed and not json:
        note("no launch file in the store; `kg build FOLDER` reads those of a workspace")
    elif terminal() and not json:
        _notes(listed, len(rows), one=launch is not None)


def _row(instance: "NodeInstance") -> tuple[object, ...]:
    roles = [one.declared.role for one in instance.interfaces if not one.declared.implicit]
    actions = roles.count(Role.ACTION_SERVERS) + roles.count(Role.ACTION_CLIENTS)
    counts = [roles.count(role) for role in (Role.PUBLISHES, Role.SUBSCRIBES, Role.SERVICES, Role.CLIENTS)]
    numbers: tuple[object, ...] = (*counts, actions, len(instance.parameters))
    remark = _REMARKS.get(str(instance.missing), "") if not instance.type else ""
    started = instance.started
    if started.kind is StartKind.RUNNING and not instance.type:
        # Observed parts are certain; clients in ROS 1, and parameters, are never reported completely.
        numbers = tuple(
            number or ("" if title in _UNTOLD else 0) for title, number in zip(_COUNTS, numbers, strict=True)
        )
        remark = _UNTYPED
    elif not instance.type and not instance.interfaces:
        numbers = ("",) * len(_COUNTS)
    remark = ", ".join(filter(None, (remark, f"if {started.condition}" if started.condition else "")))
    return instance.name, instance.started_type, str(started.kind), *numbers, remark, str(started.location)


def _notes(shown: "Sequence[System]", rows: int, *, one: bool) -> None:
    listed = [instance for system in shown for instance in system.instances]
    missing = Counter(one.reason for one in listed if one.reason and not one.type and not one.interfaces)
    for reason, number in missing.most_common(5) if one else ():
        lacks = "node type" if any(system.sighting for system in shown) else "counts"
        note(f"{count(number, 'instance')} without {lacks}: {reason}")
    for instance in [one for one in listed if one.reason and (one.type or one.interfaces)][:5] if one else ():
        note(f"{instance.name}: {instance.reason}")
    for problem in [problem for system in shown for problem in system.configuration.problems][:5] if one else ():
        note(f"{problem.location}: {problem.message}")
    files = f" of {count(len(shown), 'launch file')}" if not one else ""
    ways = "`kg node NAME` shows one, `kg graph FILE` draws them, `kg lint` checks them"
    note(f"{count(rows, 'instance')}{files}; {ways}")
