"""Nodes, containers and components, with their parameters as launch_ros takes them.

Source: `launch_ros.utilities.normalize_parameters`: texts stay texts, substitutions are read as YAML, dictionaries in
dictionaries make dotted names, and a list of texts with a substitution among them is one text.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.actions import LoadComponents, NodeAction, ParameterFile, ParameterValue
from kg.extract.launch.ros2.python.substitutions import condition_on, file_of, is_substitution
from kg.extract.launch.ros2.python.values import (
    Made,
    condition_of,
    entries_of,
    guarded,
    launch_text,
    options,
    pair_of,
    reason_of,
    terms_of_way,
)
from kg.extract.launch.ros2.texts import join, unknown_text
from kg.holes import ANONYMOUS
from kg.symbolic.operators import NULL, plain
from kg.symbolic.values import Either, Mapping, Number, Sequence, Text, Truth, TypeValue, Unknown, Value, rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.extract.launch.ros2.actions import Action, ParameterSource
    from kg.extract.launch.ros2.python.reading import Reading
    from kg.extract.launch.ros2.texts import Condition
    from kg.extract.launch.ros2.texts import Text as LaunchText
    from kg.facts import Location

__all__ = ["NODES", "value_of"]

_MAX_DEPTH: Final = 20
_MAX_ENTRIES: Final = 20_000


def value_of(name: LaunchText, value: Value, location: Location) -> ParameterValue:
    """Return one parameter."""
    if isinstance(value, Made) and value.name in ("ParameterValue", "Parameter"):
        kind, inner = value.fields.get("value_type"), value.fields.get("value", NULL)
        is_text = isinstance(kind, TypeValue) and kind.kind.names == ("builtins", "str")
        if is_text or isinstance(inner, Text):
            return ParameterValue(name, launch_text(inner), location, as_text=is_text)
        return value_of(name, inner, location)
    if isinstance(value, Number | Truth):
        return ParameterValue(name, _plain(value), location)
    if isinstance(value, Text):
        return ParameterValue(name, launch_text(value), location, as_text=value.known is not None)
    if isinstance(value, Sequence):
        return _list_value(name, list(value.items), location)
    return ParameterValue(name, launch_text(value), location)


def _plain(value: Value) -> bool | float:
    found = plain(value)
    return found if isinstance(found, bool | int | float) else 0


def _is_later(value: Value) -> bool:
    return is_substitution(value) or (isinstance(value, Text) and value.known is None)


def _list_value(name: LaunchText, values: list[Value], location: Location) -> ParameterValue:
    unknown = next((item for item in values if isinstance(item, Unknown | Either)), None)
    if any(map(_is_later, values)) and all(_is_later(item) or isinstance(item, Text) for item in values):
        return ParameterValue(name, join([part for item in values for part in launch_text(item)]), location)
    if unknown is not None:
        return ParameterValue(name, unknown_text(reason_of(unknown)), location)
    known = (plain(item) for item in values)
    found = [launch_text(item) if one is None else one for item, one in zip(values, known, strict=True)]
    return ParameterValue(name, list(found), location)


def sources_of(reading: Reading, made: Made) -> tuple[ParameterSource, ...]:
    """Return the parameters that a node gets, in their order."""
    value, location = made.value("parameters"), made.place("parameters")
    if value is None:
        return ()
    whole = isinstance(value, Mapping) or (isinstance(value, Text) and value.known is not None)
    found = [(value, ())] if whole else reading.machine.items(value)
    if found is None:
        return (ParameterFile(unknown_text(f"parameters are not known: {reason_of(value)}"), location),)
    places = reading.places_of(value, len(found), location)
    sources: list[ParameterSource] = []
    for (item, terms), place in zip(found, places, strict=True):
        if terms:
            words = terms[0].lstrip("!?")
            sources.append(ParameterFile(unknown_text(f"it depends on `{words}`"), place))
        else:
            sources += _source(reading, item, place)
    return tuple(sources)


def _source(reading: Reading, item: Value, location: Location) -> list[ParameterSource]:
    if isinstance(item, Mapping):
        return list(islice(_entries(reading, item, (), location), _MAX_ENTRIES))
    if isinstance(item, Made) and item.name == "Parameter":
        return [value_of(item.text("name") or (), item, item.location)]
    if isinstance(item, Sequence | Text) or is_substitution(item):
        return [file_of(item, location)]
    if item == NULL:
        return []
    return [ParameterFile(unknown_text(f"parameters are not known: {reason_of(item)}"), location)]


def _entries(
    reading: Reading, table: Mapping, prefix: LaunchText, location: Location, depth: int = 0
) -> Iterator[ParameterSource]:
    """Yield the entries of a dictionary, which may hold the same one many times."""
    for key, value in table.items:
        place = reading.place_of(key) or location
        name = join([*prefix, *([".", *launch_text(key)] if prefix else launch_text(key))])
        item, terms = guarded(value)
        if terms:
            yield ParameterValue(name, unknown_text(reason_of(value)), place)
        elif isinstance(item, Mapping) and depth < _MAX_DEPTH:
            yield from _entries(reading, item, name, place, depth + 1)
        elif item != NULL:
            yield value_of(name, item, place)
    if table.open:
        yield ParameterFile(unknown_text("more parameters: it is not known what a dictionary has"), location)


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
