"""Actions of launch and launch_ros: how objects of their classes are read.

Handlers of events become groups, under a condition if it cannot be known that the event comes. Sources: the packages
`launch`, `launch_ros` and `controller_manager`.
"""

from __future__ import annotations

import shlex
from dataclasses import replace
from functools import partial
from itertools import islice
from typing import TYPE_CHECKING, Final

from kg.facts import LaunchProblemKind, Location
from kg.holes import ANONYMOUS
from kg.launch.files.ros2 import actions as kinds
from kg.launch.files.ros2.actions import (
    Action,
    Condition,
    Group,
    LoadComponents,
    NodeAction,
    ParameterFile,
    ParameterSource,
    ParameterValue,
    Substitution,
    join,
    unknown_text,
)
from kg.launch.files.ros2.actions import Text as LaunchText
from kg.launch.files.ros2.python.values import (
    Instance,
    condition_of,
    condition_on,
    entries_of,
    file_of,
    guarded,
    is_substitution,
    launch_text,
    options,
    pair_of,
    pairs_of,
    reason_of,
    terms_of_way,
)
from kg.symbolic.operators import NULL, plain
from kg.symbolic.values import (
    Closure,
    Either,
    Mapping,
    Number,
    Sequence,
    Text,
    Truth,
    TypeValue,
    Unknown,
    Value,
    paths,
    rows,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.launch.files.ros2.python.reading import Reading

_MAX_DEPTH: Final = 20
_MAX_ENTRIES: Final = 20_000


def value_of(name: LaunchText, value: Value, location: Location) -> ParameterValue:
    """Return one parameter."""
    if isinstance(value, Instance) and value.name in ("ParameterValue", "Parameter"):
        kind, inner = value.fields.get("value_type"), value.fields.get("value", NULL)
        is_text = isinstance(kind, TypeValue) and kind.kind.names == ("builtins", "str")
        if is_text or isinstance(inner, Text):
            return ParameterValue(name, launch_text(inner), location, as_text=is_text)
        return value_of(name, inner, location)
    if isinstance(value, Number | Truth):
        constant = plain(value)
        return ParameterValue(name, constant if isinstance(constant, bool | int | float) else 0, location)
    if isinstance(value, Text):
        return ParameterValue(name, launch_text(value), location, as_text=value.exact is not None)
    if isinstance(value, Sequence):
        return _list_value(name, list(value.items), location)
    return ParameterValue(name, launch_text(value), location)


def _is_later(value: Value) -> bool:
    return is_substitution(value) or (isinstance(value, Text) and value.exact is None)


def _list_value(name: LaunchText, values: list[Value], location: Location) -> ParameterValue:
    unknown = next((item for item in values if isinstance(item, Unknown | Either)), None)
    if any(map(_is_later, values)) and all(_is_later(item) or isinstance(item, Text) for item in values):
        return ParameterValue(name, join([part for item in values for part in launch_text(item)]), location)
    if unknown is not None:
        return ParameterValue(name, unknown_text(reason_of(unknown)), location)
    constants = (plain(item) for item in values)
    items = [launch_text(item) if one is None else one for item, one in zip(values, constants, strict=True)]
    return ParameterValue(name, list(items), location)


def sources_of(reading: Reading, entity: Instance) -> tuple[ParameterSource, ...]:
    """Return the parameters that a node gets, in their order."""
    value, location = entity.value("parameters"), entity.place("parameters")
    if value is None:
        return ()
    whole = isinstance(value, Mapping) or (isinstance(value, Text) and value.exact is not None)
    items = [(value, ())] if whole else reading.machine.items(value)
    if items is None:
        return (ParameterFile(unknown_text(f"parameters are not known: {reason_of(value)}"), location),)
    places = reading.places_of(value, len(items), location)
    sources: list[ParameterSource] = []
    for (item, terms), place in zip(items, places, strict=True):
        if terms:
            sources.append(ParameterFile(_dependent(terms), place))
        else:
            sources += _sources(reading, item, place)
    return tuple(sources)


def _sources(reading: Reading, item: Value, location: Location) -> list[ParameterSource]:
    if isinstance(item, Mapping):
        return list(islice(_entries(reading, item, (), location), _MAX_ENTRIES))
    if isinstance(item, Instance) and item.name == "Parameter":
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


def _rows(entity: Instance) -> list[tuple[tuple[str, ...], Instance]]:
    """Return a node for each option of its type and name, with the terms of the option."""
    names = [name for name in _NAMING if isinstance(entity.fields.get(name), Either)]
    if not names:
        return [((), entity)]
    options = rows(tuple(entity.fields[name] for name in names), _MAX_OPTIONS)
    return [
        (terms_of_way(way), replace(entity, fields={**entity.fields, **dict(zip(names, row, strict=True))}))
        for row, way in options
    ]


def _optional(value: Value | None) -> LaunchText | None:
    return None if value is None else launch_text(value)


def _node(kind: str) -> Callable[[Reading, Instance], list[Action]]:
    def read(reading: Reading, entity: Instance) -> list[Action]:
        actions: list[Action] = []
        for terms, one in _rows(entity):
            more = reading.added(terms)
            if more is not None:
                actions += reading.under(condition_of(more), [_started(reading, one, kind)])
        return actions

    return read


def _started(reading: Reading, entity: Instance, kind: str) -> NodeAction:
    component = kind == "component"
    return NodeAction(
        location=entity.location,
        condition=condition_on(entity),
        kind=kind,
        package=_optional(entity.value("package")),
        executable=None if component else _optional(entity.first("executable", "node_executable")),
        plugin=_optional(entity.first("plugin", "node_plugin")) if component else None,
        name=_optional(entity.first("name", "node_name")),
        namespace=_optional(entity.first("namespace", "node_namespace")),
        remaps=_remaps(reading, entity),
        parameters=sources_of(reading, entity),
        arguments=() if component else _words(reading, entity, "arguments"),
        ros_arguments=() if component else _words(reading, entity, "ros_arguments"),
        settings=_extra(entity) if component else _settings(entity),
        components=() if component else tuple(_components(reading, entity)),
    )


def _settings(entity: Instance) -> tuple[tuple[str, LaunchText], ...]:
    given = {name: held for name in _SETTINGS if (held := entity.value(name)) is not None}
    output = given.get("output")
    if isinstance(output, Mapping):
        streams = {key.exact: value for key, value in output.items if isinstance(key, Text)}
        given["output"] = streams.get("stdout", streams.get("both", Text.of("")))
    settings = [("launch-prefix" if name == "prefix" else name, launch_text(value)) for name, value in given.items()]
    for name in ("env", "additional_env"):
        settings += [(f"env {_flat(key)}", launch_text(value)) for key, value in entries_of(entity.value(name))]
    end = entity.value("on_exit")
    if isinstance(end, Instance) and end.name in ("Shutdown", "ShutdownAction", "EmitEvent"):
        settings.append(("required", ("true",)))
    return tuple(settings)


def _extra(entity: Instance) -> tuple[tuple[str, LaunchText], ...]:
    value = entity.value("extra_arguments")
    tables = value.items if isinstance(value, Sequence) else ()
    return tuple((_flat(key), launch_text(item)) for table in tables for key, item in entries_of(table))


def _flat(value: Value) -> str:
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in launch_text(value))


def _words(reading: Reading, entity: Instance, name: str) -> tuple[LaunchText, ...]:
    value = entity.value(name)
    if value is None:
        return ()
    if isinstance(value, Text):
        return (launch_text(value),)
    items = reading.machine.items(value)
    if items is None:
        return (unknown_text(reason_of(value)),)
    return tuple(_dependent(terms) if terms else launch_text(item) for item, terms in items)


def _dependent(terms: tuple[str, ...]) -> LaunchText:
    """Return the text that is unknown because of a condition."""
    return unknown_text(f"it depends on `{terms[0].lstrip('!?')}`")


def _remaps(reading: Reading, entity: Instance) -> tuple[tuple[LaunchText, LaunchText, Location], ...]:
    value = entity.value("remappings")
    if value is None:
        return ()
    items = reading.machine.items(value)
    rest = entity.place("remappings")
    items = items if items is not None else [(Unknown(reason_of(value)), ())]
    remaps: list[tuple[LaunchText, LaunchText, Location]] = []
    for (item, terms), place in zip(items, reading.places_of(value, len(items), rest), strict=True):
        pair = pair_of(item)
        if pair is None:
            reading.unresolved(f"a remapping is not known: {reason_of(item)}", place)
            continue
        target = Unknown("it is remapped under a condition that is not known") if terms else pair[1]
        remaps.append((launch_text(pair[0]), join(list(launch_text(target))), place))
    return tuple(remaps)


def _components(reading: Reading, entity: Instance) -> list[NodeAction]:
    """Return the components of a list, each with the terms that it is in the list under; unknown parts are reported."""
    value = entity.value("composable_node_descriptions")
    return _listed(reading, entity, value, ()) if value is not None else []


def _listed(reading: Reading, entity: Instance, value: Value, terms: tuple[str, ...]) -> list[NodeAction]:
    if isinstance(value, Either):
        choices = ((reading.added(terms_of_way(way), terms), item) for item, way in paths(value))
        listed = (_listed(reading, entity, item, terms + more) for more, item in choices if more is not None)
        return [one for components in listed for one in components]
    if isinstance(value, Sequence):
        return [one for item in value.items for one in _listed(reading, entity, item, terms)]
    if isinstance(value, Instance) and value.name in ("ComposableNode", "ComposableLifecycleNode"):
        components = ((reading.added(more, terms), one) for more, one in _rows(value))
        return [
            replace(_started(reading, one, "component"), choice=condition_of(terms + more))
            for more, one in components
            if more is not None
        ]
    if value != NULL:
        reading.note(LaunchProblemKind.UNKNOWN_PART, f"a component is not known: {reason_of(value)}", entity.location)
    return []


def _load(reading: Reading, entity: Instance) -> list[Action]:
    target = entity.value("target_container")
    actions = reading.actions(target, entity.location) if isinstance(target, Instance) and target.name in NODES else []
    container = actions[0] if actions and isinstance(actions[0], NodeAction) else None
    return [
        LoadComponents(
            location=entity.location,
            condition=condition_on(entity),
            target=_optional(target) if container is None else None,
            components=tuple(_components(reading, entity)),
            container=container,
        )
    ]


NODES: Final[dict[str, tuple[tuple[str, ...], Callable[[Reading, Instance], list[Action]]]]] = {
    "Node": ((), _node("node")),
    "LifecycleNode": ((), _node("lifecycle-node")),
    "ComposableNodeContainer": ((), _node("container")),
    "ComposableNode": ((), _node("component")),
    "ComposableLifecycleNode": ((), _node("component")),
    "LoadComposableNodes": ((), _load),
}
"""What starts nodes, by class: the names of its parameters in order, and what it is read as."""


_MANAGER: Final = "controller_manager_name"


def _setting(what: str, *names: str) -> Callable[[Reading, Instance], list[Action]]:
    """Return the reader of a setting whose operands are arguments of these names."""

    def read(reading: Reading, entity: Instance) -> list[Action]:
        del reading
        operands = tuple(entity.text(name) or () for name in names)
        return [kinds.Setting(location=entity.location, condition=condition_on(entity), what=what, operands=operands)]

    return read


def _description(reading: Reading, entity: Instance) -> list[Action]:
    return reading.actions(entity.fields.get("entities", NULL), entity.location)


def _declare(reading: Reading, entity: Instance) -> list[Action]:
    name = reading.exact(entity.value("name"))
    if name is None:
        reason = reason_of(entity.value("name"))
        reading.unresolved(f"the name of an argument is not known: {reason}", entity.location)
        return []
    choices = entity.value("choices")
    listed = choices.items if isinstance(choices, Sequence) else ()
    return [
        kinds.DeclareArgument(
            location=entity.location,
            condition=condition_on(entity),
            name=name,
            default=entity.text("default_value"),
            description=reading.exact(entity.value("description")),
            choices=tuple(one.exact for one in listed if isinstance(one, Text) and one.exact is not None),
        )
    ]


def _environment(reading: Reading, entity: Instance) -> list[Action]:
    name, value = entity.text("name") or (), entity.text("value")
    if entity.name.startswith("Append"):
        before: LaunchText = (Substitution("env", (name, ())),)
        first = entity.value("prepend") == Truth(True)
        value = (*(value or ()), ":", *before) if first else (*before, ":", *(value or ()))
    del reading
    operands = (name,) if value is None else (name, value)
    return [kinds.Setting(location=entity.location, condition=condition_on(entity), what="variable", operands=operands)]


def _parameters(reading: Reading, entity: Instance) -> list[Action]:
    del reading
    source: ParameterSource
    if entity.name == "SetParametersFromFile":
        source = file_of(entity.value("filename"), entity.location)
    else:
        name = ("use_sim_time",) if entity.name == "SetUseSimTime" else entity.text("name") or ()
        source = value_of(name, entity.fields.get("value", NULL), entity.location)
    return [kinds.SetParameters(location=entity.location, condition=condition_on(entity), source=source)]


def _group(reading: Reading, entity: Instance) -> list[Action]:
    actions = reading.actions(entity.fields.get("actions", NULL), entity.location)
    given = entity.value("launch_configurations")
    complete = given is None or isinstance(given, Mapping)
    if given is not None and not complete:
        reading.unresolved(f"configurations of a group: {reason_of(given)}", entity.location)
    scoped = entity.name == "GroupAction" and entity.fields.get("scoped") != Truth(False)
    return [
        Group(
            location=entity.location,
            condition=condition_on(entity),
            actions=tuple(actions),
            scoped=scoped,
            # What an unknown dictionary keeps may be anything that was set before.
            forwarding=entity.fields.get("forwarding") != Truth(False) or not complete,
            configurations=pairs_of(entity, "launch_configurations"),
        )
    ]


def _process(reading: Reading, entity: Instance) -> list[Action]:
    value = entity.value("cmd")
    text = value.exact if isinstance(value, Text) else None
    if text is not None:
        try:
            command: tuple[LaunchText, ...] = tuple((word,) if word else () for word in shlex.split(text))
        except ValueError:  # quotes that are not closed
            command = ((text,),)
    else:
        items = reading.machine.items(value) if value is not None else None
        whole = launch_text(value) if value is not None else unknown_text("no command is given")
        command = tuple(launch_text(item) for item, _ in items) if items is not None else (whole,)
    return [kinds.Executable(location=entity.location, condition=condition_on(entity), command=command)]


def _opaque(reading: Reading, made: Instance) -> list[Action]:
    return [kinds.Opaque(location=made.location, condition=condition_on(made), run=partial(reading.run_function, made))]


def _ignored(reading: Reading, entity: Instance) -> list[Action]:
    del reading, entity
    return []


# Includes


def _include(reading: Reading, entity: Instance) -> list[Action]:
    actions: list[Action] = []
    for condition, source in options(entity.fields.get("launch_description_source", NULL)):
        actions += reading.under(condition, _included(reading, entity, source))
    return actions


def _source(value: Value) -> Value:
    if not isinstance(value, Instance) or not value.name.endswith("LaunchDescriptionSource"):
        return value
    given = value.first("launch_file_path", "launch_description", "location")
    return given if given is not None else Unknown("no launch file is given")


def _included(reading: Reading, made: Instance, source: Value) -> list[Action]:
    inner, condition, arguments = _source(source), condition_on(made), _arguments(reading, made)
    if isinstance(inner, Either):
        alternatives = ((each, _included(reading, made, option)) for each, option in options(inner))
        return [action for each, actions in alternatives for action in reading.under(each, actions)]
    if isinstance(inner, Instance) and inner.name == "LaunchDescription":
        actions = tuple(reading.actions(inner, made.location))
        scoped = bool(arguments)
        return [
            Group(location=made.location, condition=condition, actions=actions, scoped=scoped, configurations=arguments)
        ]
    resolvable = isinstance(inner, Text | Sequence) or is_substitution(inner)
    path, reason = (launch_text(inner), None) if resolvable else (None, reason_of(inner))
    return [kinds.Include(location=made.location, condition=condition, path=path, arguments=arguments, reason=reason)]


def _arguments(reading: Reading, entity: Instance) -> tuple[tuple[LaunchText, LaunchText], ...]:
    """Return `launch_arguments`: pairs, or a dictionary's items."""
    value = entity.value("launch_arguments")
    if value is None:
        return ()
    if isinstance(value, Mapping):
        value = Sequence(tuple(Sequence(pair) for pair in value.items), value.open)
    items = reading.machine.items(value)
    arguments: list[tuple[LaunchText, LaunchText]] = []
    for item, terms in items if items is not None else [(Unknown(reason_of(value)), ())]:
        pair = pair_of(item)
        if pair is None:
            reason = f"arguments of an include are not known: {reason_of(item)}"
            reading.unresolved(reason, entity.place("launch_arguments"))
            continue
        arguments.append((launch_text(pair[0]), _dependent(terms) if terms else launch_text(pair[1])))
    return tuple(arguments)


# Events


def _handler(what: str, *names: str, certain: bool = False) -> Callable[[Reading, Instance], list[Action]]:
    """Return the reader of a handler; `names` are its arguments with actions."""

    def read(reading: Reading, entity: Instance) -> list[Action]:
        value = entity.first(*names)
        if isinstance(value, Closure):
            value = reading.called(value, [Unknown("an event"), Unknown("a context")])
        actions = tuple(reading.actions(value if value is not None else NULL, entity.location))
        subject = _subject(reading, entity.first("target_action", "target_lifecycle_node"))
        condition = None if certain else Condition(None, written=f"{what} {subject}".strip())
        return [Group(location=entity.location, condition=condition, actions=actions, scoped=False)] if actions else []

    return read


def _subject(reading: Reading, value: Value | None) -> str:
    """Return the subject of an event, for the words of the condition."""
    actions = reading.actions(value, reading.location) if isinstance(value, Instance) and value.name in ENTITIES else []
    action = actions[0] if actions else None
    texts: LaunchText = ()
    if isinstance(action, NodeAction):
        texts = action.name or action.executable or ()
    elif isinstance(action, kinds.Executable):
        texts = action.command[0] if action.command else ()
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in texts)


def _register(reading: Reading, entity: Instance) -> list[Action]:
    value = entity.fields.get("event_handler", NULL)
    actions = reading.actions(value, entity.location)
    condition = condition_on(entity)
    if condition is None or not actions:
        return actions
    return [Group(location=entity.location, condition=condition, actions=tuple(actions), scoped=False)]


# Other packages


def _spawner(reading: Reading, entity: Instance) -> list[Action]:
    """Return a node that loads controllers: `controller_manager.launch_utils`."""
    names, table = entity.value("controller_names"), entity.value("controller_info_dict")
    files: list[LaunchText] = []
    for _, value in entries_of(table):
        for file in value.items if isinstance(value, Sequence) else [value]:
            files += [("--param-file",), launch_text(file)] if file not in (NULL, Text.of("")) else []
    given = names if names is not None else table if table is not None else NULL
    items = reading.machine.items(given)
    controllers = [launch_text(one) for one, _ in items] if items is not None else [unknown_text(reason_of(given))]
    extra = entity.value("extra_spawner_args")
    more = (reading.machine.items(extra) if extra is not None else None) or []
    manager: LaunchText = (Substitution("var", ((_MANAGER,),)),)
    return [
        kinds.DeclareArgument(location=entity.location, name=_MANAGER, default=("controller_manager",)),
        NodeAction(
            location=entity.location,
            package=("controller_manager",),
            executable=("spawner",),
            arguments=(
                *controllers,
                ("--controller-manager",),
                manager,
                *files,
                *(launch_text(value) for value, terms in more if not terms),
            ),
        ),
    ]


_NOTHING: Final = (
    "LogInfo", "Log", "LogDebug", "LogWarning", "LogError", "EmitEvent", "Shutdown", "ShutdownAction",
    "LifecycleTransition", "ChangeState", "SetROSLogDir", "UnregisterEventHandler", "ReadyToTest", "PushEnvironment",
    "PopEnvironment", "PushLaunchConfigurations", "PopLaunchConfigurations", "OnShutdown", "OpaqueCoroutine",
)  # fmt: skip
"""Actions and handlers that start nothing."""
_SPAWNERS: Final = "generate_controllers_spawner_launch_description"
ENTITIES: Final[dict[str, tuple[tuple[str, ...], Callable[[Reading, Instance], list[Action]]]]] = {
    **NODES,
    "LaunchDescription": (("entities",), _description),
    "DeclareLaunchArgument": (("name", "default_value"), _declare),
    "SetLaunchConfiguration": (("name", "value"), _setting("configuration", "name", "value")),
    "UnsetLaunchConfiguration": (("name",), _setting("configuration", "name")),
    **{f"{verb}EnvironmentVariable": (("name", "value"), _environment) for verb in ("Set", "Unset", "Append")},
    **dict.fromkeys(("PushRosNamespace", "PushROSNamespace"), (("namespace",), _setting("namespace", "namespace"))),
    "SetRemap": (("src", "dst"), _setting("remap", "src", "dst")),
    "SetParameter": (("name", "value"), _parameters),
    "SetUseSimTime": (("value",), _parameters),
    "SetParametersFromFile": (("filename",), _parameters),
    "GroupAction": (("actions",), _group),
    **dict.fromkeys(("TimerAction", "RosTimer", "ROSTimer"), ((), _group)),
    **dict.fromkeys(("ExecuteProcess", "ExecuteLocal"), ((), _process)),
    "OpaqueFunction": (("function",), _opaque),
    "IncludeLaunchDescription": (("launch_description_source", "launch_arguments"), _include),
    **{
        f"{kind}LaunchDescriptionSource": (("location",), _ignored)
        for kind in ("", "Python", "Any", "Frontend", "XML", "YAML")
    },
    "RegisterEventHandler": (("event_handler",), _register),
    "OnProcessStart": ((), _handler("on start of", "on_start", certain=True)),
    "OnExecutionComplete": ((), _handler("on completion of", "on_completion", certain=True)),
    "OnProcessExit": ((), _handler("on exit of", "on_exit")),
    "OnProcessIO": ((), _handler("on output of", "on_stdout", "on_stderr", "on_stdin")),
    "OnStateTransition": ((), _handler("on a transition of", "entities")),
    "OnActionEventBase": ((), _handler("on an event of", "on_event")),
    "EventHandler": ((), _handler("on an event", "entities", "entity")),
    _SPAWNERS: (("controller_names", "extra_spawner_args"), _spawner),
    f"{_SPAWNERS}_from_dict": (("controller_info_dict", "extra_spawner_args"), _spawner),
    **dict.fromkeys(_NOTHING, ((), _ignored)),
}
"""Actions by class: the names of its parameters in order, and what it is read as; what starts nothing gives none."""
