"""Nodes, containers, components and processes as they are started, with the command lines that they get.

Source: `launch_ros.actions.Node`, `ComposableNodeContainer`, `LoadComposableNodes`, design.ros2.org on ROS command line
arguments, and `rcl` for the remappings: the first rule that fits a name counts, and those of the command line come
before those that are set for all nodes, these before those of the node itself.

Managers of controllers in a simulator are plugins of robot descriptions, with parameter files of their own. Rows
`manager` of `ontology/simulation.toml` list them. They are there only if a program of the configuration hands a
description to a simulator, as descriptions of real robots have these plugins as well.
"""

from __future__ import annotations

import posixpath
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from kg.facts import LaunchParameter, LaunchPlugin, LaunchProblemKind, Remap, StartedNode, StartKind
from kg.launch.files.ros2.actions import Executable, Include, LoadComponents, NodeAction, Text
from kg.launch.files.ros2.context import HOLE, Context, GlobalFile
from kg.launch.files.ros2.parameters import Owner, node_parameters
from kg.launch.files.ros2.substitute import holds
from kg.launch.files.ros2.values import of_text
from kg.launch.wiring.simulation_table import manager_of, spawner_of
from kg.names import join, normalise

_REMAP: Final = {"-r", "--remap"}
_PARAMETER: Final = {"-p", "--param"}
_FILE: Final = {"--params-file", "--param-file"}
_WITH_OPERAND: Final = {"--log-level", "--log-config-file", "--log-file-name", "-e", "--enclave"}


@dataclass(slots=True)
class CommandLine:
    """The parts of a command line; `rest` are the arguments that are not for ROS."""

    remaps: list[tuple[str, str]] = field(default_factory=list)
    parameters: list[tuple[str, str | None]] = field(default_factory=list)
    """Names and values as YAML, or the path of a file and None, in order."""
    name: str | None = None
    namespace: str | None = None
    rest: list[str] = field(default_factory=list)


def parse_command_line(words: Sequence[str]) -> CommandLine:
    """Parse `words`; rules outside of `--ros-args` count as well, as they did before ROS 2 Eloquent."""
    line = CommandLine()
    inside = False
    remaining = iter(words)
    for word in remaining:
        if word == "--ros-args":
            inside = True
        elif inside and word == "--":
            inside = False
        elif inside:
            _option(line, word, remaining)
        elif ":=" in word:
            _rule(line, word)
        else:
            line.rest.append(word)
    return line


def _option(line: CommandLine, word: str, remaining: Iterator[str]) -> None:
    if word in _REMAP:
        _rule(line, next(remaining, ""))
    elif word in _PARAMETER:
        name, colon, value = next(remaining, "").partition(":=")
        if colon:
            line.parameters.append((name, value))
    elif word in _FILE:
        line.parameters.append((next(remaining, ""), None))
    elif word in _WITH_OPERAND:
        next(remaining, None)
    elif ":=" in word:
        _rule(line, word)


def _rule(line: CommandLine, rule: str) -> None:
    """Take a rule of remapping; of several for one thing the first counts."""
    source, colon, target = rule.partition(":=")
    if not colon:
        return
    if source in ("__node", "__name"):
        line.name = line.name or target
    elif source == "__ns":
        line.namespace = line.namespace or target
    else:
        line.remaps.append((source, target))


_KINDS: Final = {
    "node": StartKind.NODE,
    "lifecycle-node": StartKind.LIFECYCLE_NODE,
    "container": StartKind.CONTAINER,
    "component": StartKind.COMPONENT,
}
_RUN: Final = ("ros2", "run")
_TOOLS: Final = {
    ("topic", "pub"),
    ("topic", "echo"),
    ("service", "call"),
    ("action", "send_goal"),
    ("control", "load_controller"),
    ("control", "load_start_controller"),
}
"""Commands of `ros2` that are nodes."""


def start_node(context: Context, action: NodeAction) -> None:
    """Start the node of an action, and load the components of a container into it."""
    words = [context.perform(word) for word in action.arguments]
    ros_words = [context.perform(word) for word in action.ros_arguments]
    line = parse_command_line([*words, "--ros-args", *ros_words])
    name = line.name or _optional(context, action.name) or None
    namespace = line.namespace or _optional(context, action.namespace)
    executable = _optional(context, action.executable)
    kind, contains = _KINDS[action.kind], (executable or "").startswith("component_container")
    if action.kind == "node" and contains and _optional(context, action.package) == "rclcpp_components":
        kind = StartKind.CONTAINER
    full = _record(context, action, kind, name, namespace, line, executable)
    context.results.containers[id(action)] = full
    for component in action.components:
        _load(context, component, full)


def load_components(context: Context, action: LoadComponents) -> None:
    """Load components into a running container; its name is seen from the root, for launch's own node is there."""
    host = context.results.containers.get(id(action.container)) if action.container else None
    if host is None and action.target is not None:
        host = normalise(f"/{context.perform(action.target)}")
    if host is None:
        context.unresolved("the container that components are loaded into is not known")
    for component in action.components:
        _load(context, component, host)


def execute_process(context: Context, action: Executable) -> None:
    """Start the node that a command starts: `ros2 run PACKAGE EXECUTABLE`, a tool, or what is given `--ros-args`."""
    words = _words([context.perform(word) for word in action.command])
    program = [posixpath.basename(word) for word in words[:1]] + words[1:2]
    if tuple(program) == _RUN:
        package, executable, rest = _run_operands(words[2:])
    elif program[:1] == ["ros2"] and tuple(words[1:3]) in _TOOLS:
        package, executable, rest = f"ros2{words[1]}", "ros2", words[2:]
    elif "--ros-args" in words[1:]:
        package, executable, rest = None, posixpath.basename(words[0]), words[1:]
    else:
        return
    if executable is None:
        context.problem(LaunchProblemKind.MALFORMED, f"`{' '.join(words)}` names no package and executable")
        return
    line = parse_command_line(rest)
    namespace = line.namespace or "/"
    _append(
        context,
        StartedNode(
            line.name,
            normalise(f"/{namespace}"),
            StartKind.NODE,
            context.location,
            context.chain,
            package,
            executable,
            remaps=tuple(_remaps(context, line.remaps, line.name)),
            parameters=node_parameters(context, Owner(normalise(f"/{namespace}"), line.name), _rules(context, line)),
            arguments=tuple(line.rest),
            condition=" and ".join(context.conditions) or None,
        ),
    )


def launched(context: Context, action: Executable) -> Include | None:
    """Return the include that `ros2 launch PACKAGE FILE NAME:=VALUE` amounts to; None for other commands."""
    words = _words([context.quietly(word) for word in action.command])
    if [posixpath.basename(word) for word in words[:1]] + words[1:2] != ["ros2", "launch"]:
        return None
    operands = [word for word in words[2:] if not word.startswith("-")]
    arguments = [word.partition(":=") for word in operands if ":=" in word]
    match [word for word in operands if ":=" not in word]:
        case [path]:
            file = path
        case [package, name]:
            file = context.files.launch_file(package, name)
        case _:
            return None
    pairs = tuple(((name,), (value,)) for name, _, value in arguments)
    return Include(location=action.location, path=(file,), arguments=pairs)


def _words(command: list[str]) -> list[str]:
    return command[0].split() if len(command) == 1 else command  # a line for a shell


def _run_operands(words: Sequence[str]) -> tuple[str | None, str | None, Sequence[str]]:
    """Return the package, the executable and the arguments of `ros2 run`, whose own options come first."""
    start = 0
    while start < len(words) and words[start].startswith("--"):
        start += 2 if words[start] == "--prefix" else 1
    package, executable = (*words[start : start + 2], None, None)[:2]
    return package, executable, words[start + 2 :]


def _load(context: Context, component: NodeAction, host: str | None) -> None:
    """Load a component, which inherits nothing of its container but the place."""
    with context.at(component.location):
        conditions = context.conditions
        for condition in filter(None, (component.choice, component.condition)):
            held = holds(context, condition)
            if held is False:
                context.conditions = conditions
                return
            if held is None:
                context.conditions += (condition.words,)
        name, namespace = _optional(context, component.name) or None, _optional(context, component.namespace)
        _record(context, component, StartKind.COMPONENT, name, namespace, CommandLine(), host=host)
        context.conditions = conditions


def _record(  # noqa: PLR0913, PLR0917 - how a node is started
    context: Context,
    action: NodeAction,
    kind: StartKind,
    name: str | None,
    namespace: str | None,
    line: CommandLine,
    executable: str | None = None,
    host: str | None = None,
) -> str:
    """Add a node to the results, and return its absolute name; `host` is the container that a component is in."""
    within = normalise(f"/{join(context.namespace, namespace)}") if namespace else context.namespace
    loaded = kind is StartKind.COMPONENT
    whole = loaded or (name is not None and (bool(namespace) or context.scope.namespace is not None))
    own = [(context.perform(source), context.perform(target), place) for source, target, place in action.remaps]
    sources = [*_rules(context, line), *context.scope.parameters, *action.parameters]
    node = StartedNode(
        name=name,
        namespace=within,
        kind=kind,
        location=action.location,
        chain=context.chain,
        package=_optional(context, action.package),
        executable=executable,
        plugin=_optional(context, action.plugin),
        host=host,
        remaps=(
            *_remaps(context, line.remaps, name),
            *context.scope.remaps,
            *(Remap(source, target, place, context.chain) for source, target, place in own),
        ),
        parameters=node_parameters(context, Owner(within, name, loaded, whole), sources),
        arguments=tuple(line.rest),
        condition=" and ".join(context.conditions) or None,
        settings=tuple((key, context.perform(value)) for key, value in action.settings),
    )
    _append(context, node)
    return f"{within.rstrip('/')}/{name or HOLE}"


def _append(context: Context, node: StartedNode) -> None:
    if context.results.budget.allows_node(context.limit, node):
        context.results.nodes.append(node)


def _remaps(context: Context, rules: Sequence[tuple[str, str]], name: str | None) -> list[Remap]:
    """Return rules of a command line as remappings of one node: those for another node are left out."""
    remaps = []
    for source, target in rules:
        node, colon, rest = source.rpartition(":")
        if not colon or name is None or node == name:
            remaps.append(Remap(rest if name else source, target, context.location, context.chain))
    return remaps


def _rules(context: Context, line: CommandLine) -> list[LaunchParameter | GlobalFile]:
    """Return the parameters of a command line."""
    rules: list[LaunchParameter | GlobalFile] = []
    for name, written in line.parameters:
        if written is None:
            rules.append(GlobalFile(name, context.location, context.chain))
        else:
            value, kind = of_text(written)
            rules.append(LaunchParameter(name, value, context.location, context.chain, kind))
    return rules


def _optional(context: Context, text: Text | None) -> str | None:
    return None if text is None else context.perform(text)


_ROS: Final = 2


def managers(context: Context, nodes: Iterable[StartedNode], plugins: Sequence[LaunchPlugin]) -> Iterator[StartedNode]:
    """Yield the managers that plugins of robot descriptions are, each one once."""
    rows = [(plugin, row) for plugin in plugins if (row := manager_of(plugin.library, _ROS)) is not None]
    if not rows or not any(spawner_of(node.package, node.executable, _ROS) for node in nodes):
        return
    seen: set[str] = set()
    for plugin, row in rows:
        texts = {one.element: one.text for one in reversed(plugin.values)}
        name = next((texts[element] for element in row.name if texts.get(element)), row.named)
        namespace = normalise(f"/{texts.get(row.namespace, '')}")
        if f"{namespace}/{name}" in seen or HOLE in name + namespace:
            continue
        seen.add(f"{namespace}/{name}")
        files = [
            GlobalFile(one.text, one.location, plugin.chain)
            for one in plugin.values
            if one.element == row.parameters and HOLE not in one.text
        ]
        rules = ((*one.text.partition(":="), one) for one in plugin.values if one.element == row.remapping)
        yield StartedNode(
            name=name,
            namespace=namespace,
            kind=StartKind.INNER,
            location=plugin.location,
            chain=plugin.chain,
            package=row.package,
            plugin=plugin.name,
            remaps=tuple(
                Remap(source.strip(), target.strip(), one.location, plugin.chain)
                for source, mark, target, one in rules
                if mark
            ),
            parameters=node_parameters(context, Owner(namespace, name), files),
            condition=plugin.condition,
        )
