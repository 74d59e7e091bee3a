"""Actions of launch and launch_ros: what the objects of their classes are read as.

Handlers of events become groups, under a condition if it cannot be known that the event comes. Sources: the packages
`launch`, `launch_ros` and `controller_manager`.
"""

from __future__ import annotations

import shlex
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.ros2 import actions as kinds
from kg.extract.launch.ros2.actions import Group, NodeAction
from kg.extract.launch.ros2.python.nodes import NODES, value_of
from kg.extract.launch.ros2.python.substitutions import condition_on, file_of, is_substitution, pairs_of
from kg.extract.launch.ros2.python.values import (
    Made,
    entries_of,
    launch_text,
    options,
    pair_of,
    reason_of,
)
from kg.extract.launch.ros2.texts import Condition, Substitution, unknown_text
from kg.holes import ANONYMOUS
from kg.symbolic.operators import NULL
from kg.symbolic.values import Closure, Either, Mapping, Sequence, Text, Truth, Unknown, Value

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.python.reading import Reading
    from kg.extract.launch.ros2.texts import Text as LaunchText

__all__ = ["ENTITIES"]

_MANAGER: Final = "controller_manager_name"


def _texts(kind: Callable[..., Action], **arguments: str) -> Callable[[Reading, Made], list[Action]]:
    """Return the reader of an action whose fields are texts, each by the name of its argument."""

    def read(reading: Reading, made: Made) -> list[Action]:
        del reading
        given: dict[str, Any] = {field: made.text(name) or () for field, name in arguments.items()}
        return [kind(location=made.location, condition=condition_on(made), **given)]

    return read


def _description(reading: Reading, made: Made) -> list[Action]:
    return reading.actions(made.fields.get("entities", NULL), made.location)


def _declare(reading: Reading, made: Made) -> list[Action]:
    name = reading.known(made.value("name"))
    if name is None:
        reason = reason_of(made.value("name"))
        reading.unresolved(f"the name of an argument is not known: {reason}", made.location)
        return []
    choices = made.value("choices")
    listed = choices.items if isinstance(choices, Sequence) else ()
    return [
        kinds.DeclareArgument(
            location=made.location,
            condition=condition_on(made),
            name=name,
            default=made.text("default_value"),
            description=reading.known(made.value("description")),
            choices=tuple(one.known for one in listed if isinstance(one, Text) and one.known is not None),
        )
    ]


def _environment(reading: Reading, made: Made) -> list[Action]:
    name, value = made.text("name") or (), made.text("value")
    if made.name.startswith("Append"):
        before: LaunchText = (Substitution("env", (name, ())),)
        first = made.value("prepend") == Truth(True)
        value = (*(value or ()), ":", *before) if first else (*before, ":", *(value or ()))
    del reading
    return [kinds.SetEnvironment(location=made.location, condition=condition_on(made), name=name, value=value)]


def _parameter(reading: Reading, made: Made) -> list[Action]:
    del reading
    name = ("use_sim_time",) if made.name == "SetUseSimTime" else made.text("name") or ()
    parameter = value_of(name, made.fields.get("value", NULL), made.location)
    return [kinds.SetParameter(location=made.location, condition=condition_on(made), parameter=parameter)]


def _parameter_file(reading: Reading, made: Made) -> list[Action]:
    del reading
    file = file_of(made.value("filename"), made.location)
    return [kinds.SetParametersFromFile(location=made.location, condition=condition_on(made), file=file)]


def _group(reading: Reading, made: Made) -> list[Action]:
    actions = reading.actions(made.fields.get("actions", NULL), made.location)
    given = made.value("launch_configurations")
    if given is not None and not isinstance(given, Mapping):
        reading.unresolved(f"configurations of a group: {reason_of(given)}", made.location)
    scoped = made.name == "GroupAction" and made.fields.get("scoped") != Truth(False)
    return [
        Group(
            location=made.location,
            condition=condition_on(made),
            actions=tuple(actions),
            scoped=scoped,
            forwarding=made.fields.get("forwarding") != Truth(False),
            configurations=pairs_of(made, "launch_configurations"),
        )
    ]


def _process(reading: Reading, made: Made) -> list[Action]:
    value = made.value("cmd")
    text = value.known if isinstance(value, Text) else None
    if text is not None:
        try:
            command: tuple[LaunchText, ...] = tuple((word,) if word else () for word in shlex.split(text))
        except ValueError:  # quotes that are not closed
            command = ((text,),)
    else:
        items = reading.machine.items(value) if value is not None else None
        whole = launch_text(value) if value is not None else unknown_text("no command is given")
        command = tuple(launch_text(item) for item, _ in items) if items is not None else (whole,)
    return [kinds.Executable(location=made.location, condition=condition_on(made), command=command)]


def _opaque(reading: Reading, made: Made) -> list[Action]:
    return [kinds.Opaque(location=made.location, condition=condition_on(made), run=partial(reading.run_function, made))]


def _ignored(reading: Reading, made: Made) -> list[Action]:
    del reading, made
    return []


# Includes


def _include(reading: Reading, made: Made) -> list[Action]:
    found: list[Action] = []
    for condition, source in options(made.fields.get("launch_description_source", NULL)):
        found += reading.under(condition, _included(reading, made, source))
    return found


def _source(value: Value) -> Value:
    if not isinstance(value, Made) or not value.name.endswith("LaunchDescriptionSource"):
        return value
    given = value.first("launch_file_path", "launch_description", "location")
    return given if given is not None else Unknown("no launch file is given")


def _included(reading: Reading, made: Made, source: Value) -> list[Action]:
    inner, condition, arguments = _source(source), condition_on(made), _arguments(reading, made)
    if isinstance(inner, Either):
        found = ((each, _included(reading, made, option)) for each, option in options(inner))
        return [action for each, actions in found for action in reading.under(each, actions)]
    if isinstance(inner, Made) and inner.name == "LaunchDescription":
        actions = tuple(reading.actions(inner, made.location))
        scoped = bool(arguments)
        return [
            Group(location=made.location, condition=condition, actions=actions, scoped=scoped, configurations=arguments)
        ]
    known = isinstance(inner, Text | Sequence) or is_substitution(inner)
    path, reason = (launch_text(inner), None) if known else (None, reason_of(inner))
    return [kinds.Include(location=made.location, condition=condition, path=path, arguments=arguments, reason=reason)]


def _arguments(reading: Reading, made: Made) -> tuple[tuple[LaunchText, LaunchText], ...]:
    """Return `launch_arguments`: pairs, or a dictionary's items."""
    value = made.value("launch_arguments")
    if value is None:
        return ()
    if isinstance(value, Mapping):
        value = Sequence(tuple(Sequence(pair) for pair in value.items), value.open)
    items = reading.machine.items(value)
    found: list[tuple[LaunchText, LaunchText]] = []
    for item, terms in items if items is not None else [(Unknown(reason_of(value)), ())]:
        pair = pair_of(item)
        if pair is None:
            reason = f"arguments of an include are not known: {reason_of(item)}"
            reading.unresolved(reason, made.place("launch_arguments"))
            continue
        given = unknown_text(f"it depends on `{terms[0].lstrip('!?')}`") if terms else launch_text(pair[1])
        found.append((launch_text(pair[0]), given))
    return tuple(found)


# Events


def _handler(what: str, *names: str, certain: bool = False) -> Callable[[Reading, Made], list[Action]]:
    """Return the reader of a handler; `names` are its arguments with actions."""

    def read(reading: Reading, made: Made) -> list[Action]:
        value = made.first(*names)
        if isinstance(value, Closure):
            value = reading.called(value, [Unknown("an event"), Unknown("a context")])
        actions = tuple(reading.actions(value if value is not None else NULL, made.location))
        subject = _subject(reading, made.first("target_action", "target_lifecycle_node"))
        condition = None if certain else Condition(None, written=f"{what} {subject}".strip())
        return [Group(location=made.location, condition=condition, actions=actions, scoped=False)] if actions else []

    return read


def _subject(reading: Reading, value: Value | None) -> str:
    """Return what an event is about, for the words of the condition."""
    found = reading.actions(value, reading.location) if isinstance(value, Made) and value.name in ENTITIES else []
    action = found[0] if found else None
    texts: LaunchText = ()
    if isinstance(action, NodeAction):
        texts = action.name or action.executable or ()
    elif isinstance(action, kinds.Executable):
        texts = action.command[0] if action.command else ()
    return "".join(part if isinstance(part, str) else ANONYMOUS for part in texts)


def _register(reading: Reading, made: Made) -> list[Action]:
    value = made.fields.get("event_handler", NULL)
    actions = reading.actions(value, made.location)
    condition = condition_on(made)
    if condition is None or not actions:
        return actions
    return [Group(location=made.location, condition=condition, actions=tuple(actions), scoped=False)]


# Other packages


def _spawner(reading: Reading, made: Made) -> list[Action]:
    """Return a node that loads controllers: `controller_manager.launch_utils`."""
    names, table = made.value("controller_names"), made.value("controller_info_dict")
    files: list[LaunchText] = []
    for _, value in entries_of(table):
        for file in value.items if isinstance(value, Sequence) else [value]:
            files += [("--param-file",), launch_text(file)] if file not in (NULL, Text.of("")) else []
    given = names if names is not None else table if table is not None else NULL
    items = reading.machine.items(given)
    controllers = [launch_text(one) for one, _ in items] if items is not None else [unknown_text(reason_of(given))]
    extra = made.value("extra_spawner_args")
    more = (reading.machine.items(extra) if extra is not None else None) or []
    manager: LaunchText = (Substitution("var", ((_MANAGER,),)),)
    return [
        kinds.DeclareArgument(location=made.location, name=_MANAGER, default=("controller_manager",)),
        NodeAction(
            location=made.location,
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
    "PopEnvironment", "PushLaunchConfigurations", "PopLaunchConfigurations", "OnShutdown",
)  # fmt: skip
"""Actions and handlers that start nothing."""
_PUSHED = _texts(kinds.PushNamespace, namespace="namespace")
_SPAWNERS: Final = "generate_controllers_spawner_launch_description"
ENTITIES: Final[dict[str, tuple[tuple[str, ...], Callable[[Reading, Made], list[Action]]]]] = {
    **NODES,
    "LaunchDescription": (("entities",), _description),
    "DeclareLaunchArgument": (("name", "default_value"), _declare),
    "SetLaunchConfiguration": (("name", "value"), _texts(kinds.SetConfiguration, name="name", value="value")),
    "UnsetLaunchConfiguration": (("name",), _texts(kinds.UnsetConfiguration, name="name")),
    **{f"{verb}EnvironmentVariable": (("name", "value"), _environment) for verb in ("Set", "Unset", "Append")},
    **dict.fromkeys(("PushRosNamespace", "PushROSNamespace"), (("namespace",), _PUSHED)),
    "SetRemap": (("src", "dst"), _texts(kinds.SetRemap, source="src", target="dst")),
    "SetParameter": (("name", "value"), _parameter),
    "SetUseSimTime": (("value",), _parameter),
    "SetParametersFromFile": (("filename",), _parameter_file),
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
