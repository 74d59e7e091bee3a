"""A ROS 2 launch file executed as the one that is started, with everything that it includes.

Source: the packages `launch` and `launch_ros` of ROS 2. What an included file sets stays set behind the include, unless
a scoped group is around it.
"""

from __future__ import annotations

import re
from contextlib import contextmanager
from dataclasses import replace
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, Final

from kg.facts import (
    LaunchArgument,
    LaunchConfiguration,
    LaunchDialect,
    LaunchInclude,
    LaunchParameter,
    LaunchProblem,
    LaunchProblemKind,
    Remap,
)
from kg.launch.files.ros2 import actions as kinds
from kg.launch.files.ros2.actions import Action, DeclareArgument, Include
from kg.launch.files.ros2.context import HOLE, Context, GlobalFile, Scope, find, unreadable
from kg.launch.files.ros2.frontend import read_xml, read_yaml
from kg.launch.files.ros2.nodes import execute_process, launched, load_components, managers, start_node
from kg.launch.files.ros2.parameters import given_parameter, without_others
from kg.launch.files.ros2.substitute import described, holds, perform
from kg.launch.wiring.similar_names import alike, alike_when_short
from kg.lazily import lazily
from kg.names import join, normalise

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from kg.corpus.files import FilePath
    from kg.launch.files.access import Files

with lazily():
    from kg.launch.files.ros2.python.reading import read_python

Tree = tuple["Sequence[Action]", "tuple[LaunchProblem, ...]"]

_MOST_TREES: Final = 4_000

_MARKUP: Final[dict[tuple[str, FilePath, LaunchDialect, bytes], Tree]] = {}
"""Files of XML and YAML by all that their trees depend on: the source that they are read for, their name, language
and the digest of their text."""

_PYTHON: Final[dict[Files, dict[FilePath, list[tuple[Mapping[str, str | None], Tree]]]]] = {}
"""Files of Python, for the reader of files that was used last: what is read of them depends on others that they import.
Each tree has the variables of the environment that it depends on.

The trees hold on to that reader, so no other is kept.
"""


_BY_ENDING: Final = {
    "py": LaunchDialect.ROS2_PYTHON,
    "xml": LaunchDialect.ROS2_XML,
    "yaml": LaunchDialect.ROS2_YAML,
    "yml": LaunchDialect.ROS2_YAML,
}
_PYTHON_FUNCTION: Final = re.compile(rb"^def generate_launch_description\b", re.MULTILINE)
_YAML_ROOT: Final = re.compile(rb"^['\"]?launch['\"]?\s*:", re.MULTILINE)


def dialect_of(file: FilePath, text: bytes) -> LaunchDialect:
    """Return the language of a launch file by its ending, otherwise by its text.

    Like `AnyLaunchDescriptionSource`, which tries each language on a file such as `robot.launch`.
    """
    if dialect := _BY_ENDING.get(file.path.rpartition(".")[2]):
        return dialect
    if text.lstrip().startswith(b"<"):
        return LaunchDialect.ROS2_XML
    if _PYTHON_FUNCTION.search(text):
        return LaunchDialect.ROS2_PYTHON
    return LaunchDialect.ROS2_YAML if _YAML_ROOT.search(text) else LaunchDialect.ROS2_XML


def read_actions(context: Context, file: FilePath, dialect: LaunchDialect | None = None) -> Sequence[Action]:
    """Return the actions of a launch file; none, and problems, for a file that cannot be read or does not parse.

    `dialect` is its language; None to find it.
    """
    content = context.files.read(file)
    if content is None:
        unreadable(context, file)
        return ()
    context.results.files.setdefault(file)
    if not context.allows("bytes of files", len(content)):
        return ()
    dialect = dialect or dialect_of(file, content)
    actions, problems = (
        _python(context, file, content)
        if dialect is LaunchDialect.ROS2_PYTHON
        else _markup(context, file, content, dialect)
    )
    for problem in problems:
        context.problem(problem.kind, problem.message, problem.subject, problem.location)
    return actions


def _markup(context: Context, file: FilePath, content: bytes, dialect: LaunchDialect) -> Tree:
    key = context.files.reader.repository, file, dialect, blake2b(content, digest_size=16).digest()
    if key not in _MARKUP:
        problems: list[LaunchProblem] = []
        reader = read_yaml if dialect is LaunchDialect.ROS2_YAML else read_xml
        if len(_MARKUP) >= _MOST_TREES:
            _MARKUP.clear()
        _MARKUP[key] = reader(context.files, file, content, problems), tuple(problems)
    return _MARKUP[key]


def _python(context: Context, file: FilePath, content: bytes) -> Tree:
    if context.files not in _PYTHON:
        _PYTHON.clear()
    trees = _PYTHON.setdefault(context.files, {}).setdefault(file, [])
    environment = context.scope.environment
    for variables, tree in trees:
        if all(environment.get(name) == value for name, value in variables.items()):
            return tree
    problems: list[LaunchProblem] = []
    actions, variables = read_python(context.files, file, content, problems, environment)
    trees.append((variables, (actions, tuple(problems))))
    return trees[-1][1]


_DEEPEST_FILE: Final = 100


def include(context: Context, action: Include, run: Callable[[Sequence[Action]], None]) -> None:
    """Execute the file of an include with `run`; record the include whether the file exists or not."""
    if not context.allows("includes"):
        return
    written = HOLE if action.path is None else context.perform(action.path)
    reason = action.reason if action.path is None else None
    if HOLE in written:
        message = f"the included file is unknown: {reason or f'`{written}`'}"
        context.problem(LaunchProblemKind.UNKNOWN_PART, message, written)
    file = find(context, written)
    context.results.includes.append(
        LaunchInclude(
            written,
            context.location,
            context.chain,
            file.repository if file else None,
            file.path if file else None,
            " and ".join(context.conditions) or None,
            None if file else reason or "the file does not exist, or its path is unknown",
        )
    )
    if file is None:
        context.scope.unread = True
    elif _may_enter(context, file):
        _enter(context, action, file, run)


def _may_enter(context: Context, file: FilePath) -> bool:
    if file in context.stack:
        context.problem(LaunchProblemKind.CYCLE, f"`{file.path}` includes itself", file.path)
        return False
    if len(context.stack) > _DEEPEST_FILE:
        context.problem(
            LaunchProblemKind.LIMIT, f"files include each other deeper than {_DEEPEST_FILE} levels", file.path
        )
        return False
    return True


def _enter(context: Context, action: Include, file: FilePath, run: Callable[[Sequence[Action]], None]) -> None:
    arguments = _arguments(context, action, file)
    actions = read_actions(context, file)
    given = {name for name, _ in arguments}
    context.scope.configurations.update(arguments)
    for inner in actions:
        # Launch requires that the include itself passes it: a value set before does not count.
        if not isinstance(inner, DeclareArgument) or inner.condition is not None or inner.default is not None:
            continue
        if inner.name not in given:
            message = f"`{file.path}` needs the argument `{inner.name}`, which the include does not pass"
            context.problem(LaunchProblemKind.MISSING_ARGUMENT, message, inner.name)
            context.scope.configurations.setdefault(inner.name, HOLE)
    _misspelt(context, given, {one.name for one in actions if isinstance(one, DeclareArgument)}, file)
    with context.inside(file):
        run(actions)


def _arguments(context: Context, action: Include, file: FilePath) -> list[tuple[str, str]]:
    """Return the arguments of an include; launch performs them when the file included is already the current one."""
    own, context.file = context.file, file
    try:
        return [(context.perform(name), context.perform(value)) for name, value in action.arguments]
    finally:
        context.file = own


def _misspelt(context: Context, given: set[str], declared: set[str], file: FilePath) -> None:
    """Note an argument that the file does not declare, where it declares one of a like name that is not passed.

    Launch takes arguments that nothing declares.
    """
    for name in sorted(given - declared):
        like = next((one for one in sorted(declared - given) if alike(name, one) or alike_when_short(name, one)), None)
        if like is not None and HOLE not in name:
            message = f"`{file.path}` declares no argument `{name}`, but `{like}`, which the include does not pass"
            context.problem(LaunchProblemKind.UNDECLARED_ARGUMENT, message, name)


_ACTIONS_OF_A_FUNCTION: Final = 25
"""How many actions the body of an `OpaqueFunction` counts for, as it is read each time."""
_MOST_DEPTH: Final = 200


def run(context: Context, actions: Sequence[Action], depth: int = 0) -> None:
    """Execute actions in order; `depth` counts the groups around them."""
    if depth > _MOST_DEPTH:
        context.limit(f"groups are nested deeper than {_MOST_DEPTH} levels")
        return
    for action in actions:
        if not context.allows("actions"):
            return
        with context.at(action.location):
            applies = True if action.condition is None else holds(context, action.condition)
            if applies is None and action.condition is not None:
                with _unsure(context, action.condition.words):
                    _execute(context, action, depth)
            elif applies:
                _execute(context, action, depth)


def _execute(context: Context, action: Action, depth: int) -> None:
    if isinstance(action, kinds.Group):
        _group(context, action, depth)
    elif isinstance(action, kinds.Opaque):
        context.allows("actions", _ACTIONS_OF_A_FUNCTION)
        run(context, action.run(context), depth + 1)
    elif isinstance(action, kinds.Include):
        include(context, action, lambda actions: run(context, actions, 0))
    elif isinstance(action, kinds.Executable) and (file := launched(context, action)):
        before, context.scope = context.scope, Scope(environment=dict(context.scope.environment))
        include(context, file, lambda actions: run(context, actions, 0))
        context.scope = before
    else:
        _HANDLERS[type(action)](context, action)


@contextmanager
def _unsure(context: Context, condition: str) -> Iterator[None]:
    """Execute actions under an unknown condition: only settings equal in both cases stay known."""
    before, conditions = context.scope.copy(), context.conditions
    context.conditions = (*conditions, condition)
    try:
        yield
    finally:
        context.conditions = conditions
        context.scope = _merged(before, context.scope, f"only where {condition}")


def _merged(before: Scope, after: Scope, reason: str) -> Scope:
    """Return the settings known in either case; those set in one only can be read in that one only."""
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
        # A namespace that may have been pushed is unknown below the one that is there in both cases.
        common = before.namespace if before.namespace and (namespace or "").startswith(f"{before.namespace}/") else ""
        namespace = normalise(f"/{common}/{HOLE}")
    remaps = after.remaps[len(before.remaps) :]
    parameters = after.parameters[len(before.parameters) :]
    return Scope(
        settings,
        environment,
        after.unread or before.unread,
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
    configurations = context.scope.configurations
    default = None if action.default is None else context.quietly(action.default)
    if action.name not in configurations:
        if action.default is not None:
            configurations[action.name] = perform(context, action.default)
        else:
            configurations[action.name] = HOLE
            if len(context.stack) == 1:
                context.unresolved(f"the argument `{action.name}` has no default", action.name)
            else:
                message = f"the argument `{action.name}` has no default and is not given"
                context.problem(LaunchProblemKind.MISSING_ARGUMENT, message, action.name)
    value = configurations[action.name]
    if action.choices and value not in action.choices and HOLE not in value:
        message = f"the argument `{action.name}` is `{value}`, none of {', '.join(action.choices)}"
        context.problem(LaunchProblemKind.MALFORMED, message, action.name)
    if len(context.stack) == 1 and action.name not in context.results.arguments:
        context.results.arguments[action.name] = LaunchArgument(
            action.name, default, value, action.location, action.description, choices=action.choices
        )


def _reset(context: Context, action: kinds.ResetConfigurations) -> None:
    configurations = {perform(context, name): perform(context, value) for name, value in action.configurations}
    context.scope = Scope(configurations, context.scope.environment)


def _set(context: Context, action: kinds.Setting) -> None:
    scope = context.scope
    match action.what, [perform(context, operand) for operand in action.operands]:
        case "configuration", [name, value]:
            scope.configurations[name] = value
        case "configuration", [name]:
            scope.configurations.pop(name, None)
        case "variable", [name, *values]:
            scope.environment[name] = next(iter(values), None)
        case "namespace", [pushed]:
            scope.namespace = normalise(f"/{join(context.namespace, pushed)}")
        case "remap", [source, target]:
            scope.remaps += (Remap(source, target, action.location, context.chain),)


def _parameters(context: Context, action: kinds.SetParameters) -> None:
    given = action.source
    if isinstance(given, kinds.ParameterValue):
        context.scope.parameters += (given_parameter(context, given),)
    else:
        context.scope.parameters += (GlobalFile(perform(context, given.read), given.location, context.chain),)


_HANDLERS: Final[Mapping[type[Action], Callable[[Context, Any], None]]] = {
    kinds.DeclareArgument: _declare,
    kinds.Setting: _set,
    kinds.ResetConfigurations: _reset,
    kinds.SetParameters: _parameters,
    kinds.NodeAction: start_node,
    kinds.LoadComponents: load_components,
    kinds.Executable: execute_process,
}


def evaluate(
    files: Files, file: FilePath, dialect: LaunchDialect, given: Mapping[str, str], environment: Mapping[str, str]
) -> LaunchConfiguration:
    """Return the configuration of a launch file with the arguments `given` and the known environment.

    Nothing is run. Errors and unknown parts are among its problems; no file makes this raise.
    """
    context = Context(files, file, given, environment)
    try:
        run(context, read_actions(context, file, dialect))
    except RecursionError:
        context.limit("something is nested too deep to be read")
    for name, defaults in context.results.defaults.items():
        value = next((one for one in defaults if one.strip("'\"")), None)
        if value is not None and "" in defaults:
            message = f"the environment variable {name} is `{value}` by default here, but empty by default elsewhere"
            context.problem(LaunchProblemKind.UNSET_VARIABLE, message, name, defaults[value])
    owner = files.reader.workspace.owner(file)
    results = context.results
    nodes = without_others(results.nodes)
    plugins = tuple(described(results, nodes))
    nodes = (*nodes, *managers(context, nodes, plugins))
    return LaunchConfiguration(
        repository=file.repository,
        package=owner.name if owner else "",
        path=file.path,
        ros=2,
        dialect=dialect,
        given=tuple(sorted(given.items())),
        arguments=tuple(results.arguments.values()),
        nodes=nodes,
        includes=tuple(results.includes),
        problems=tuple(results.problems),
        files=tuple((one.repository, one.path) for one in results.files),
        plugins=plugins,
    )
