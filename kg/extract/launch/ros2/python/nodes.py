"""Nodes, containers and components."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import LoadComponents, NodeAction
from kg.extract.launch.ros2.python.conditions import condition_on
from kg.extract.launch.ros2.python.parameters import sources_of
from kg.extract.launch.ros2.python.values import (
    Made,
    condition_of,
    entries_of,
    launch_text,
    options,
    pair_of,
    reason_of,
    terms_of_way,
)
from kg.extract.launch.ros2.texts import join, unknown_text
from kg.holes import ANONYMOUS
from kg.symbolic.operators import NULL
from kg.symbolic.values import Either, Mapping, Sequence, Text, Unknown, Value, rows

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.python.reading import Reading
    from kg.extract.launch.ros2.texts import Condition
    from kg.extract.launch.ros2.texts import Text as LaunchText
    from kg.facts import Location

__all__ = ["NODES"]

_SETTINGS: Final = (
    "output", "output_format", "respawn", "respawn_delay", "respawn_max_retries", "prefix", "exec_name", "cwd", "shell",
    "emulate_tty", "sigterm_timeout", "sigkill_timeout", "autostart",
)  # fmt: skip
_NAMING: Final = ("package", "executable", "plugin", "name", "namespace", "node_executable", "node_name")
_MAX_OPTIONS: Final = 16


def _rows(made: Made) -> list[tuple[Condition | None, Made]]:
    """Return a node for each option of what it is and how it is called, with the condition of the option."""
    names = [name for name in _NAMING if isinstance(made.fields.get(name), Either)]
    if not names:
        return [(None, made)]
    found = rows(tuple(made.fields[name] for name in names), _MAX_OPTIONS)
    return [
        (
            condition_of(terms_of_way(way)),
            replace(made, fields={**made.fields, **dict(zip(names, row, strict=True))}),
        )
        for row, way in found
    ]


def _optional(value: Value | None) -> LaunchText | None:
    return None if value is None else launch_text(value)


def _node(kind: str) -> Callable[[Reading, Made], list[Action]]:
    def read(reading: Reading, made: Made) -> list[Action]:
        found: list[Action] = []
        for condition, one in _rows(made):
            found += reading.under(condition, [_started(reading, one, kind)])
        return found

    return read


def _started(reading: Reading, made: Made, kind: str) -> NodeAction:
    component = kind == "component"
    return NodeAction(
        location=made.location,
        condition=condition_on(made),
        kind=kind,
        package=_optional(made.value("package")),
        executable=None if component else _optional(made.first("executable", "node_executable")),
        plugin=_optional(made.first("plugin", "node_plugin")) if component else None,
        name=_optional(made.first("name", "node_name")),
        namespace=_optional(made.first("namespace", "node_namespace")),
        remaps=_remaps(reading, made),
        parameters=sources_of(reading, made),
        arguments=() if component else _texts(reading, made, "arguments"),
        ros_arguments=() if component else _texts(reading, made, "ros_arguments"),
        settings=_extra(made) if component else _settings(made),
        components=() if component else tuple(_components(reading, made)),
    )


def _settings(made: Made) -> tuple[tuple[str, LaunchText], ...]:
    given = {name: held for name in _SETTINGS if (held := made.value(name)) is not None}
    output = given.get("output")
    if isinstance(output, Mapping):
        streams = {key.known: value for key, value in output.items if isinstance(key, Text)}
        given["output"] = streams.get("stdout", streams.get("both", Text.of("")))
    found = [("launch-prefix" if name == "prefix" else name, launch_text(value)) for name, value in given.items()]
    for name in ("env", "additional_env"):
        found += [(f"env {_flat(key)}", launch_text(value)) for key, value in entries_of(made.value(name))]
    end = made.value("on_exit")
    if isinstance(end, Made) and end.name in ("Shutdown", "ShutdownAction", "EmitEvent"):
        found.append(("required", ("true",)))
    return tuple(found)


def _extra(made: Made) -> tuple[tuple[str, LaunchText], ...]:
    value = made.value("extra_arguments")
    tables = value.items if isinstance(value, Sequence) else ()
    return tuple((_flat(key), launch_text(item)) for table in tables for key, item in entries_of(table))


def _flat(value: Value) -> str:
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in launch_text(value))


def _texts(reading: Reading, made: Made, name: str) -> tuple[LaunchText, ...]:
    value = made.value(name)
    if value is None:
        return ()
    if isinstance(value, Text):
        return (launch_text(value),)
    found = reading.machine.items(value)
    if found is None:
        return (unknown_text(reason_of(value)),)
    return tuple(launch_text(item) if not terms else unknown_text(_depends(terms)) for item, terms in found)


def _depends(terms: tuple[str, ...]) -> str:
    return f"it depends on `{terms[0].lstrip('!?')}`"


def _remaps(reading: Reading, made: Made) -> tuple[tuple[LaunchText, LaunchText, Location], ...]:
    value = made.value("remappings")
    if value is None:
        return ()
    found = reading.machine.items(value)
    rest = made.place("remappings")
    found = found if found is not None else [(Unknown(reason_of(value)), ())]
    remaps: list[tuple[LaunchText, LaunchText, Location]] = []
    for (item, terms), place in zip(found, reading.places_of(value, len(found), rest), strict=True):
        pair = pair_of(item)
        if pair is None:
            reading.unresolved(f"a remapping is not known: {reason_of(item)}", place)
            continue
        target = Unknown("it is remapped under a condition that is not known") if terms else pair[1]
        remaps.append((launch_text(pair[0]), join(list(launch_text(target))), place))
    return tuple(remaps)


def _components(reading: Reading, made: Made) -> list[NodeAction]:
    """Return the components of a list, whatever conditions it has; what is not known is said."""
    value = made.value("composable_node_descriptions")
    return _listed(reading, made, value, None) if value is not None else []


def _listed(reading: Reading, made: Made, value: Value, condition: Condition | None) -> list[NodeAction]:
    if isinstance(value, Either):
        return [one for each, item in options(value) for one in _listed(reading, made, item, each or condition)]
    if isinstance(value, Sequence):
        return [one for item in value.items for one in _listed(reading, made, item, condition)]
    if isinstance(value, Made) and value.name in ("ComposableNode", "ComposableLifecycleNode"):
        found = ((each or condition, _started(reading, one, "component")) for each, one in _rows(value))
        return [replace(one, condition=one.condition or each) for each, one in found]
    if value != NULL:
        reading.unresolved(f"a component is not known: {reason_of(value)}", made.location)
    return []


def _load(reading: Reading, made: Made) -> list[Action]:
    target = made.value("target_container")
    found = reading.actions(target, made.location) if isinstance(target, Made) and target.name in NODES else []
    container = found[0] if found and isinstance(found[0], NodeAction) else None
    return [
        LoadComponents(
            location=made.location,
            condition=condition_on(made),
            target=_optional(target) if container is None else None,
            components=tuple(_components(reading, made)),
            container=container,
        )
    ]


NODES: Final[dict[str, tuple[tuple[str, ...], Callable[[Reading, Made], list[Action]]]]] = {
    "Node": ((), _node("node")),
    "LifecycleNode": ((), _node("lifecycle-node")),
    "ComposableNodeContainer": ((), _node("container")),
    "ComposableNode": ((), _node("component")),
    "ComposableLifecycleNode": ((), _node("component")),
    "LoadComposableNodes": ((), _load),
}
"""What starts nodes, by class: the names of its parameters in order, and what it is read as."""
