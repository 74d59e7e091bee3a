"""`kg instances`: every node that launch files start, with the names it has then."""

from collections import Counter
from typing import TYPE_CHECKING, Final

from kg.cli.diagnostics import note
from kg.cli.options import Json, with_settings
from kg.cli.output import Column, listing, terminal
from kg.cli.systems import Arguments, Environment, File, Launch, Variants, chosen_systems, named
from kg.lazily import lazily
from kg.render.text import count
from kg.settings import Settings

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.facts import NodeInstance, System

with lazily():
    from kg.facts import Role, StartKind
    from kg.graph.records import instance_object

_COUNTS: Final = ("pub", "sub", "srv", "cli", "act", "par")
_ONE: Final = (
    Column("instance", "name"),
    Column("node", spare=1),
    Column("kind", spare=2),
    *(Column(title, "number", spare=4) for title in _COUNTS),
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
