"""Nodes, containers and components."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import join, reason_of, to_text, unknown_text
from kg.extract.launch.expressions.values import Choice, Guarded, Items, Table, Unknown, pair_of
from kg.extract.launch.ros2.actions import LoadComponents, NodeAction
from kg.extract.launch.ros2.python.conditions import condition_of
from kg.extract.launch.ros2.python.parameters import PARAMETERS, sources_of
from kg.extract.launch.ros2.python.values import Ignored
from kg.holes import ANONYMOUS

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.expressions.values import Condition, Text, Value
    from kg.extract.launch.ros2.python.call import Call
    from kg.facts import Location

__all__ = ["NODES"]

_SETTINGS: Final = {
    "output": "output",
    "output_format": "output_format",
    "respawn": "respawn",
    "respawn_delay": "respawn_delay",
    "respawn_max_retries": "respawn_max_retries",
    "prefix": "launch-prefix",
    "exec_name": "exec_name",
    "cwd": "cwd",
    "shell": "shell",
    "emulate_tty": "emulate_tty",
    "sigterm_timeout": "sigterm_timeout",
    "sigkill_timeout": "sigkill_timeout",
    "autostart": "autostart",
}


_NAMING: Final = ("package", "executable", "plugin", "name", "namespace", "node_executable", "node_name")
_MAX_OPTIONS: Final = 16


def _optional(value: Value) -> Text | None:
    return None if value is None else to_text(value)


def _split(make: Callable[[Call], Value]) -> Callable[[Call], Value]:
    """Return a maker that makes one node for each option of what the node is and how it is called."""

    def made(call: Call) -> Value:
        name = next((key for key in _NAMING if isinstance(call.kwargs.get(key), Choice)), None)
        choice = call.kwargs.get(name) if name is not None else None
        if name is None or not isinstance(choice, Choice):
            return make(call)
        options = [
            (condition, made(replace(call, kwargs={**call.kwargs, name: option})))
            for condition, option in choice.options[:_MAX_OPTIONS]
        ]
        return Choice(tuple(options))

    return made


def _node(kind: str) -> Callable[[Call], Value]:
    def make(call: Call) -> Value:
        return NodeAction(
            location=call.location,
            condition=condition_of(call),
            kind=kind,
            package=_optional(call.value("package")),
            executable=_optional(call.first("executable", "node_executable")),
            name=_optional(call.first("name", "node_name")),
            namespace=_optional(call.first("namespace", "node_namespace")),
            remaps=_remaps(call),
            parameters=sources_of(call, call.value("parameters"), call.place("parameters")),
            arguments=_texts(call, "arguments"),
            ros_arguments=_texts(call, "ros_arguments"),
            settings=_settings(call),
            components=_components(call, call.value("composable_node_descriptions")),
        )

    return make


def _component(call: Call) -> Value:
    return NodeAction(
        location=call.location,
        condition=condition_of(call),
        kind="component",
        package=_optional(call.value("package")),
        plugin=_optional(call.first("plugin", "node_plugin")),
        name=_optional(call.first("name", "node_name")),
        namespace=_optional(call.first("namespace", "node_namespace")),
        remaps=_remaps(call),
        parameters=sources_of(call, call.value("parameters"), call.place("parameters")),
        settings=_extra(call),
    )


def _settings(call: Call) -> tuple[tuple[str, Text], ...]:
    given = {name: call.kwargs[name] for name in _SETTINGS if call.kwargs.get(name) is not None}
    if isinstance(output := given.get("output"), Table):
        given["output"] = output.get("stdout", output.get("both", ""))
    found = [(_SETTINGS[name], to_text(value)) for name, value in given.items()]
    for name in ("env", "additional_env"):
        variables = call.value(name)
        if isinstance(variables, Table):
            found += [(f"env {_flat(key)}", to_text(value)) for key, value in variables.items()]
    if isinstance(call.value("on_exit"), Ignored):
        found.append(("required", ("true",)))
    return tuple(found)


def _extra(call: Call) -> tuple[tuple[str, Text], ...]:
    found = call.machine.iterate(call.value("extra_arguments") or ()) or []
    tables = [item for item in found if isinstance(item, Table)]
    return tuple((_flat(key), to_text(value)) for table in tables for key, value in table.items())


def _flat(value: Value) -> str:
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in to_text(value))


def _texts(call: Call, name: str) -> tuple[Text, ...]:
    value = call.value(name)
    if value is None:
        return ()
    found = call.machine.iterate(value) if not isinstance(value, str) else [value]
    return tuple(to_text(item) for item in found) if found is not None else (unknown_text(reason_of(value)),)


def _remaps(call: Call) -> tuple[tuple[Text, Text, Location], ...]:
    value = call.value("remappings")
    if value is None:
        return ()
    found = call.machine.iterate(value)
    places = value.places if isinstance(value, Items) else ()
    remaps: list[tuple[Text, Text, Location]] = []
    for number, item in enumerate(found if found is not None else [Unknown(reason_of(value))]):
        place = places[number] if found is not None and len(places) == len(found) else call.place("remappings")
        written = item.value if isinstance(item, Guarded) else item
        pair = pair_of(written)
        if pair is None:
            call.machine.unresolved(f"a remapping is not known: {reason_of(written)}", place)
            continue
        target = pair[1] if written is item else Unknown("it is remapped under a condition that is not known")
        remaps.append((to_text(pair[0]), join(list(to_text(target))), place))
    return tuple(remaps)


def _components(call: Call, value: Value, condition: Condition | None = None) -> tuple[NodeAction, ...]:
    """Return the components of a list, whatever conditions it has; what is not known is said."""
    if value is None:
        return ()
    if isinstance(value, NodeAction):
        return (_under(value, condition),)
    if isinstance(value, Guarded):
        return _components(call, value.value, value.condition)
    if isinstance(value, Choice):
        return tuple(made for each, option in value.options for made in _components(call, option, each or condition))
    if isinstance(value, Items | tuple):
        return tuple(made for item in value for made in _components(call, item, condition))
    call.machine.unresolved(f"a component is not known: {reason_of(value)}", call.location)
    return ()


def _under(node: NodeAction, condition: Condition | None) -> NodeAction:
    return replace(node, condition=condition) if condition is not None and node.condition is None else node


def _load(call: Call) -> Value:
    target = call.value("target_container")
    container = target if isinstance(target, NodeAction) else None
    return LoadComponents(
        location=call.location,
        condition=condition_of(call),
        target=_optional(target) if container is None else None,
        components=_components(call, call.value("composable_node_descriptions")),
        container=container,
    )


NODES: Final[dict[str, Callable[[Call], Value]]] = {
    **PARAMETERS,
    "Node": _split(_node("node")),
    "LifecycleNode": _split(_node("lifecycle-node")),
    "ComposableNodeContainer": _split(_node("container")),
    "ComposableNode": _split(_component),
    "ComposableLifecycleNode": _split(_component),
    "LoadComposableNodes": _load,
}
