"""The actions of ROS 2 launch, executed in order without running anything.

Source: `launch.actions` and `launch_ros.actions`. An action whose condition cannot be known is executed; what it starts
keeps the condition, and what it sets is unknown behind it wherever that differs from what was set before.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

from kg.extract.launch.ros2 import actions as kinds
from kg.extract.launch.ros2.context import HOLE, GlobalFile, Scope
from kg.extract.launch.ros2.include import include
from kg.extract.launch.ros2.nodes import execute_process, load_components, start_node
from kg.extract.launch.ros2.parameters import given_parameter
from kg.extract.launch.ros2.substitute import holds, perform
from kg.facts import LaunchArgument, LaunchParameter, LaunchProblemKind, Remap
from kg.names import join, normalise

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context

__all__ = ["run"]

_MOST_ACTIONS: Final = 50_000
_ACTIONS_OF_A_FUNCTION: Final = 25
"""How many actions the body of an `OpaqueFunction` counts for, as it is read each time."""
_MOST_DEPTH: Final = 200


def run(context: Context, actions: Sequence[Action], depth: int = 0) -> None:
    """Execute actions in order; `depth` counts the groups around them."""
    if depth > _MOST_DEPTH:
        context.problem(LaunchProblemKind.LIMIT, f"groups are nested deeper than {_MOST_DEPTH} levels")
        return
    for action in actions:
        context.found.actions += 1
        if context.found.actions > _MOST_ACTIONS:
            if not context.found.is_cut:
                context.found.is_cut = True
                context.problem(LaunchProblemKind.LIMIT, f"more than {_MOST_ACTIONS} actions are executed")
            return
        with context.at(action.location):
            held = True if action.condition is None else holds(context, action.condition)
            if held is None and action.condition is not None:
                with _unsure(context, action.condition.words):
                    _execute(context, action, depth)
            elif held:
                _execute(context, action, depth)


def _execute(context: Context, action: Action, depth: int) -> None:
    if isinstance(action, kinds.Group):
        _group(context, action, depth)
    elif isinstance(action, kinds.Opaque):
        context.found.actions += _ACTIONS_OF_A_FUNCTION
        run(context, action.run(context), depth + 1)
    elif isinstance(action, kinds.Include):
        include(context, action, lambda actions: run(context, actions, 0))
    else:
        _HANDLERS[type(action)](context, action)


@contextmanager
def _unsure(context: Context, condition: str) -> Iterator[None]:
    """Execute what may not be executed: afterwards only what both ways agree on is known."""
    before, conditions = context.scope.copy(), context.conditions
    context.conditions = (*conditions, condition)
    try:
        yield
    finally:
        context.conditions = conditions
        context.scope = _merged(before, context.scope, f"only where {condition}")


def _merged(before: Scope, after: Scope, reason: str) -> Scope:
    """Return what is known where either may hold; what is set in one only can be read in that one only."""
    settings = {**before.configurations, **after.configurations}
    for name in before.configurations.keys() & after.configurations.keys():
        if before.configurations[name] != after.configurations[name]:
            settings[name] = HOLE
    environment = {
        name: value if name in before.environment and before.environment[name] == value else HOLE
        for name, value in {**before.environment, **after.environment}.items()
    }
    namespace = after.namespace
    if namespace != before.namespace:
        kept = before.namespace if before.namespace and (namespace or "").startswith(f"{before.namespace}/") else ""
        namespace = normalise(f"/{kept}/{HOLE}")
    remaps = after.remaps[len(before.remaps) :]
    parameters = after.parameters[len(before.parameters) :]
    return Scope(
        settings,
        environment,
        namespace,
        (*before.remaps, *(replace(remap, target=HOLE) for remap in remaps)),
        (*before.parameters, *(_doubtful(parameter, reason) for parameter in parameters)),
    )


def _doubtful(parameter: LaunchParameter | GlobalFile, reason: str) -> LaunchParameter | GlobalFile:
    if isinstance(parameter, LaunchParameter):
        return replace(parameter, value=None, reason=reason)
    return replace(parameter, reason=reason)


def _group(context: Context, group: kinds.Group, depth: int) -> None:
    before = context.scope
    if group.scoped:
        context.scope = before.copy()
    settings = [(perform(context, name), perform(context, value)) for name, value in group.configurations]
    if group.scoped and not group.forwarding:
        context.scope = Scope(environment=dict(context.initial))
    context.scope.configurations.update(settings)
    run(context, group.actions, depth + 1)
    if group.scoped:
        context.scope = before


def _declare(context: Context, action: kinds.DeclareArgument) -> None:
    known = context.scope.configurations
    default = None if action.default is None else context.quietly(action.default)
    if action.name not in known:
        if action.default is not None:
            known[action.name] = perform(context, action.default)
        else:
            known[action.name] = HOLE
            _missing(context, action.name)
    value = known[action.name]
    if action.choices and value not in action.choices and HOLE not in value:
        message = f"the argument `{action.name}` is `{value}`, none of {', '.join(action.choices)}"
        context.problem(LaunchProblemKind.MALFORMED, message, action.name)
    if len(context.stack) == 1 and action.name not in context.found.arguments:
        context.found.arguments[action.name] = LaunchArgument(
            action.name, default, value, action.location, action.description, choices=action.choices
        )


def _missing(context: Context, name: str) -> None:
    if len(context.stack) == 1:
        context.unresolved(f"the argument `{name}` has no default", name)
    else:
        message = f"the argument `{name}` has no default and is not given"
        context.problem(LaunchProblemKind.MISSING_ARGUMENT, message, name)


def _set(context: Context, action: kinds.SetConfiguration) -> None:
    name = perform(context, action.name)
    context.scope.configurations[name] = perform(context, action.value)


def _unset(context: Context, action: kinds.UnsetConfiguration) -> None:
    context.scope.configurations.pop(perform(context, action.name), None)


def _reset(context: Context, action: kinds.ResetConfigurations) -> None:
    kept = {perform(context, name): perform(context, value) for name, value in action.configurations}
    context.scope = Scope(kept, context.scope.environment)


def _environment(context: Context, action: kinds.SetEnvironment) -> None:
    name = perform(context, action.name)
    context.scope.environment[name] = None if action.value is None else perform(context, action.value)


def _namespace(context: Context, action: kinds.PushNamespace) -> None:
    pushed = perform(context, action.namespace)
    context.scope.namespace = normalise(f"/{join(context.namespace, pushed)}")


def _remap(context: Context, action: kinds.SetRemap) -> None:
    source, target = perform(context, action.source), perform(context, action.target)
    context.scope.remaps += (Remap(source, target, action.location, context.chain),)


def _parameter(context: Context, action: kinds.SetParameter) -> None:
    context.scope.parameters += (given_parameter(context, action.parameter),)


def _parameters_file(context: Context, action: kinds.SetParametersFromFile) -> None:
    path = perform(context, action.file.read)
    context.scope.parameters += (GlobalFile(path, action.file.location, context.chain),)


_HANDLERS: Final[Mapping[type[Action], Callable[[Context, Any], None]]] = {
    kinds.DeclareArgument: _declare,
    kinds.SetConfiguration: _set,
    kinds.UnsetConfiguration: _unset,
    kinds.ResetConfigurations: _reset,
    kinds.SetEnvironment: _environment,
    kinds.PushNamespace: _namespace,
    kinds.SetRemap: _remap,
    kinds.SetParameter: _parameter,
    kinds.SetParametersFromFile: _parameters_file,
    kinds.NodeAction: start_node,
    kinds.LoadComponents: load_components,
    kinds.Executable: execute_process,
}
