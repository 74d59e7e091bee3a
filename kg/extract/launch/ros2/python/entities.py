"""Actions of launch and launch_ros that are no nodes: arguments, configurations, groups, settings for all nodes."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.texts import known, reason_of, to_text
from kg.extract.launch.expressions.values import Substitution, Table
from kg.extract.launch.ros2.actions import (
    DeclareArgument,
    Executable,
    Group,
    Opaque,
    PushNamespace,
    SetConfiguration,
    SetEnvironment,
    SetParameter,
    SetParametersFromFile,
    SetRemap,
    UnsetConfiguration,
)
from kg.extract.launch.ros2.python.conditions import condition_of
from kg.extract.launch.ros2.python.flatten import actions_of
from kg.extract.launch.ros2.python.parameters import file_of, value_of
from kg.extract.launch.ros2.python.values import IGNORED, ContextValue, Description

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.extract.launch.expressions.values import Text, Value
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context
    from kg.extract.launch.ros2.python.call import Call

__all__ = ["ENTITIES"]


def _description(call: Call) -> Value:
    given = call.value("initial_entities", 0)
    entities = call.machine.items()
    if given is not None:
        found = call.machine.iterate(given)
        entities.extend([given] if found is None else found)
    return Description(entities)


def _declare(call: Call) -> Value:
    name = known(call.value("name", 0), call.machine.context)
    if name is None:
        reason = reason_of(call.value("name", 0))
        return call.machine.unresolved(f"the name of an argument is not known: {reason}", call.location)
    described = known(call.value("description"))
    choices = call.machine.iterate(call.value("choices")) or []
    return DeclareArgument(
        location=call.location,
        condition=condition_of(call),
        name=name,
        default=call.text("default_value", 1),
        description=described,
        choices=tuple(choice for choice in choices if isinstance(choice, str)),
    )


def _set_configuration(call: Call) -> Value:
    name, value = call.text("name", 0) or (), call.text("value", 1) or ()
    return SetConfiguration(location=call.location, condition=condition_of(call), name=name, value=value)


def _unset_configuration(call: Call) -> Value:
    return UnsetConfiguration(location=call.location, condition=condition_of(call), name=call.text("name", 0) or ())


def _set_environment(call: Call) -> Value:
    name, value = call.text("name", 0) or (), call.text("value", 1)
    return SetEnvironment(location=call.location, condition=condition_of(call), name=name, value=value)


def _append_environment(call: Call) -> Value:
    name, value = call.text("name", 0) or (), call.text("value", 1) or ()
    before: Text = (Substitution("env", (name, ())),)
    joined = (*value, ":", *before) if call.value("prepend") is True else (*before, ":", *value)
    return SetEnvironment(location=call.location, condition=condition_of(call), name=name, value=joined)


def _namespace(call: Call) -> Value:
    namespace = call.text("namespace", 0) or ()
    return PushNamespace(location=call.location, condition=condition_of(call), namespace=namespace)


def _remap(call: Call) -> Value:
    source, target = call.text("src", 0) or (), call.text("dst", 1) or ()
    return SetRemap(location=call.location, condition=condition_of(call), source=source, target=target)


def _parameter(call: Call) -> Value:
    made = value_of(call.text("name", 0) or (), call.value("value", 1), call.location)
    return SetParameter(location=call.location, condition=condition_of(call), parameter=made)


def _use_sim_time(call: Call) -> Value:
    made = value_of(("use_sim_time",), call.value("value", 0), call.location)
    return SetParameter(location=call.location, condition=condition_of(call), parameter=made)


def _parameter_file(call: Call) -> Value:
    file = file_of(call.value("filename", 0), call.location)
    return SetParametersFromFile(location=call.location, condition=condition_of(call), file=file)


def _group(call: Call) -> Value:
    actions = actions_of(call.machine, call.value("actions", 0), call.location)
    configurations = call.value("launch_configurations")
    pairs: list[tuple[Text, Text]] = []
    if isinstance(configurations, Table):
        pairs = [(to_text(name), to_text(value)) for name, value in configurations.items()]
    elif configurations is not None:
        call.machine.unresolved(f"configurations of a group: {reason_of(configurations)}", call.location)
    return Group(
        location=call.location,
        condition=condition_of(call),
        actions=tuple(actions),
        scoped=call.value("scoped", None, default=True) is not False,
        forwarding=call.value("forwarding", None, default=True) is not False,
        configurations=tuple(pairs),
    )


def _timer(call: Call) -> Value:
    actions = actions_of(call.machine, call.value("actions"), call.location)
    return Group(location=call.location, condition=condition_of(call), actions=tuple(actions), scoped=False)


def _process(call: Call) -> Value:
    value = call.value("cmd")
    parts = _words(value) if isinstance(value, str) else call.machine.iterate(value)
    command = tuple(to_text(part) for part in parts) if parts is not None else (to_text(call.value("cmd")),)
    return Executable(location=call.location, condition=condition_of(call), command=command)


def _words(command: str) -> list[Value]:
    try:
        return list(shlex.split(command))
    except ValueError:  # quotes that are not closed
        return [command]


def _opaque(call: Call) -> Value:
    machine, function = call.machine, call.value("function", 0)
    args = machine.iterate(call.value("args") or ()) or []
    given = call.value("kwargs")
    named = {key: value for key, value in given.items() if isinstance(key, str)} if isinstance(given, Table) else {}
    location, node, frame = call.location, call.node, call.frame

    def run(context: Context) -> Sequence[Action]:
        def body() -> Value:
            return machine.invoke(function, [ContextValue(context), *args], named, node, frame)

        return machine.within(context, body, location)

    return Opaque(location=location, condition=condition_of(call), run=run)


def _context(_: Call) -> Value:
    return ContextValue(None)


def _ignored(_: Call) -> Value:
    return IGNORED


ENTITIES: Final[dict[str, Callable[[Call], Value]]] = {
    "LaunchDescription": _description,
    "DeclareLaunchArgument": _declare,
    "SetLaunchConfiguration": _set_configuration,
    "UnsetLaunchConfiguration": _unset_configuration,
    "SetEnvironmentVariable": _set_environment,
    "UnsetEnvironmentVariable": _set_environment,
    "AppendEnvironmentVariable": _append_environment,
    "PushRosNamespace": _namespace,
    "PushROSNamespace": _namespace,
    "SetRemap": _remap,
    "SetParameter": _parameter,
    "SetUseSimTime": _use_sim_time,
    "SetParametersFromFile": _parameter_file,
    "GroupAction": _group,
    "TimerAction": _timer,
    "RosTimer": _timer,
    "ROSTimer": _timer,
    "ExecuteProcess": _process,
    "ExecuteLocal": _process,
    "OpaqueFunction": _opaque,
    "LaunchContext": _context,
    "LogInfo": _ignored,
    "Log": _ignored,
    "LogDebug": _ignored,
    "LogWarning": _ignored,
    "LogError": _ignored,
    "EmitEvent": _ignored,
    "Shutdown": _ignored,
    "ShutdownAction": _ignored,
    "LifecycleTransition": _ignored,
    "ChangeState": _ignored,
    "SetROSLogDir": _ignored,
    "UnregisterEventHandler": _ignored,
    "ReadyToTest": _ignored,
    "PushEnvironment": _ignored,
    "PopEnvironment": _ignored,
    "PushLaunchConfigurations": _ignored,
    "PopLaunchConfigurations": _ignored,
}
