"""`<node>` and `<test>`: the node with its names, remappings, arguments and settings; nodelets and their managers.

Source: wiki.ros.org/roslaunch/XML/node, wiki.ros.org/Remapping%20Arguments, wiki.ros.org/nodelet.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE
from kg.facts import LaunchParameter, LaunchProblemKind, Remap, StartedNode, StartKind
from kg.holes import ANONYMOUS, is_partial
from kg.launch.files.ros1.parameterfile import join, leaf_of, read_scalar, shown
from kg.launch.files.ros1.parameters import read_param, read_rosparam
from kg.names import normalise, resolve

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.launch.files.ros1.evaluate import Element
    from kg.launch.files.ros1.state import Scope, State

_MAPPING: Final = re.compile(rf"(?:[~/A-Za-z]|__?)[\w/{HOLE}]*:=.*|{HOLE}[\w/{HOLE}]*:=.*", re.DOTALL)
_SETTINGS: Final = ("machine", "respawn", "respawn_delay", "required", "output", "cwd", "launch-prefix", "clear_params")
_TEST_SETTINGS: Final = ("test-name", "time-limit", "retry")
_CHOICES: Final = {"output": ("log", "screen"), "cwd": ("ROS_HOME", "ros_home", "node")}
_NUMBERS: Final[dict[str, Callable[[str], float]]] = {"respawn_delay": float, "time-limit": float, "retry": int}
_NOT_OF_TESTS: Final = ("respawn", "respawn_delay", "output")
_NO_BOND: Final = "--no-bond"


@dataclass(frozen=True, slots=True)
class _Command:
    """The command line of a node: its arguments, remappings, private parameters and special keys."""

    arguments: tuple[str, ...]
    remaps: tuple[tuple[str, str], ...]
    parameters: tuple[tuple[str, str], ...]
    special: dict[str, str]


def read_node(state: State, scope: Scope, element: Element) -> None:
    """Add the node of a `<node>`, or of a `<test>`, whose node is under the test's name if it has none."""
    counts, words = state.condition(scope, element)
    if not counts:
        return
    is_test = element.tag == "test"
    name = _name(state, scope, element, is_test=is_test)
    outer = enter(state, scope, element)
    command = _command(state, scope, element)
    namespace = command.special.get("__ns", outer.namespace)
    inner = _inside(state, scope, element, join(outer.namespace, name), words)
    conditions = tuple(one for one in (*scope.conditions, words) if one)
    location, chain = state.location(scope, element.line), scope.place.chain
    own = normalise(shown(f"/{namespace}"))
    package, executable = state.text(scope, element, "pkg"), state.text(scope, element, "type")
    for attribute, value in (("pkg", package), ("type", executable)):
        if not (value or "").strip():
            state.refused(scope, element, f"it has no '{attribute}'")
    kind, plugin, host = _nodelet(package, executable, command.arguments)
    given = [Remap(shown(source), shown(target), location, chain) for source, target in command.remaps]
    state.add_node(
        scope,
        StartedNode(
            name=shown(name),
            namespace=own,
            kind=StartKind.TEST if is_test else kind,
            location=location,
            chain=chain,
            package=shown(package) if package else None,
            executable=shown(executable) if executable else None,
            plugin=shown(plugin) if plugin else None,
            host=resolve(shown(host), shown(name), own) if host else None,
            # Those that win come first: roslaunch puts them behind `args`, and of two the later counts.
            remaps=tuple(reversed([*given, *inner.all_remaps()])),
            arguments=tuple(map(shown, command.arguments)),
            condition=" and ".join(conditions) or None,
            settings=_settings(state, scope, element, inner),
        ),
    )
    for source, text in command.parameters:  # the node itself sets these, when all others are set
        leaf = leaf_of(read_scalar(text) if text != HOLE else HOLE)
        absolute = normalise(shown(f"{own}/{name}/{source}"))
        state.late.append(LaunchParameter(absolute, leaf.value, location, chain, type=leaf.type, reason=leaf.reason))


def enter(state: State, scope: Scope, element: Element) -> Scope:
    """Return the scope within an element that may have a namespace (`ns`) and clear parameters."""
    namespace = state.text(scope, element, "ns")
    clears = state.boolean(scope, element, "clear_params")
    if namespace == "" and state.unset and "$" in element.attributes["ns"]:
        message = f"its 'ns' is empty without the environment variable {' or '.join(state.unset)}"
        state.problem(scope, element.line, LaunchProblemKind.UNRESOLVED, f"<{element.tag}>: {message}")
        namespace = HOLE
    elif namespace == "":
        state.refused(scope, element, "its 'ns' is empty")
    elif namespace is not None and namespace.startswith("~"):
        state.refused(scope, element, f"'{namespace}' is not a namespace")
        namespace = None
    elif clears and namespace is None and element.tag not in {"node", "test"}:
        state.refused(scope, element, "it clears parameters and has no 'ns'")
    return scope.child(namespace)


def read_remap(state: State, scope: Scope, target: Scope, element: Element) -> None:
    """Add a `<remap>` to a scope; where it is not known whether it counts, its target is not known."""
    counts, words = state.condition(scope, element)
    if not counts:
        return
    names = [state.text(scope, element, attribute) for attribute in ("from", "to")]
    if not all(names):
        state.refused(scope, element, "it needs 'from' and 'to'")
        return
    source, to = (shown(_cleaned(name)) for name in names if name)
    if words:
        to = ANONYMOUS
    target.add_remap(Remap(source, to, state.location(scope, element.line), scope.place.chain))


def read_environment(state: State, scope: Scope, target: Scope, element: Element) -> None:
    """Add an `<env>` to a scope."""
    counts, words = state.condition(scope, element)
    if not counts:
        return
    name, value = state.text(scope, element, "name"), state.text(scope, element, "value")
    if not name or value is None:
        state.refused(scope, element, "it needs 'name' and 'value'")
    else:
        target.environment.append((shown(name), ANONYMOUS if words else shown(value)))


def _is_valid(name: str, value: str) -> bool:
    """Return whether roslaunch takes the value of a setting; an empty limit is none."""
    if name in _CHOICES:
        return value in _CHOICES[name]
    if name not in _NUMBERS or (not value and name != "respawn_delay"):
        return True
    try:
        return _NUMBERS[name](value) > 0 or name != "time-limit"
    except ValueError:
        return False


def _cleaned(name: str) -> str:
    """Return a name without superfluous slashes."""
    return ("/" if name.startswith("/") else "") + "/".join(part for part in name.split("/") if part)


def _name(state: State, scope: Scope, element: Element, *, is_test: bool) -> str:
    name = state.text(scope, element, "name")
    if is_test:
        for attribute in _NOT_OF_TESTS:
            if attribute in element.attributes:
                state.refused(scope, element, f"a test has no '{attribute}'")
        name = name or state.text(scope, element, "test-name")
    if not name:
        state.refused(scope, element, "it has no 'test-name'" if is_test else "it has no 'name'")
        return HOLE
    if "/" in name:
        state.refused(scope, element, f"the name '{name}' holds a namespace")
    return name


def _inside(state: State, scope: Scope, element: Element, name: str, words: str | None) -> Scope:
    """Read the children of a node; return the scope with its remappings and environment."""
    inner = scope.child()
    parameters = scope.child(name)
    parameters.private = []
    if words:
        parameters.conditions = (*scope.conditions, words)
    for child in element.children:
        tag = child.tag.lower()
        if tag == "remap":
            read_remap(state, scope, inner, child)
        elif tag == "param":
            read_param(state, parameters, child, of_node=True)
        elif tag == "rosparam":
            read_rosparam(state, parameters, child, of_node=True)
        elif tag == "env":
            read_environment(state, scope, inner, child)
    for one in () if state.has_all_parameters else (*scope.private, *parameters.private):
        for leaf in one.leaves:
            private = f"{parameters.namespace}{one.name.removeprefix('~')}"
            state.add_leaf(private, leaf, one.location, one.chain, one.reason)
    return inner


def _command(state: State, scope: Scope, element: Element) -> _Command:
    text = state.text(scope, element, "args") or ""
    try:
        words = shlex.split(text)
    except ValueError as error:
        state.refused(scope, element, f"'args': {error}")
        words = text.split()
    plain: list[str] = []
    remaps: list[tuple[str, str]] = []
    parameters: list[tuple[str, str]] = []
    special: dict[str, str] = {}
    for word in words:
        source, _, target = word.partition(":=")
        if not _MAPPING.fullmatch(word):
            plain.append(word)
        elif source.startswith("__"):
            special[source] = target
        elif source.startswith("_"):
            parameters.append((source[1:], target))
        else:
            remaps.append((source, target))
    return _Command(tuple(plain), tuple(remaps), tuple(parameters), special)


def _nodelet(
    package: str | None, executable: str | None, arguments: tuple[str, ...]
) -> tuple[StartKind, str | None, str | None]:
    """Return the kind of process, the class of a nodelet and the manager that it is loaded into."""
    words = [word for word in arguments if word != _NO_BOND]
    if (package, executable) != ("nodelet", "nodelet") or not words:
        return StartKind.NODE, None, None
    plugin = words[1] if len(words) > 1 else None
    if words[0] == "manager":
        return StartKind.NODELET_MANAGER, None, None
    if words[0] == "standalone":
        return StartKind.NODELET, plugin, None
    if words[0] == "load":
        return StartKind.NODELET, plugin, words[2] if len(words) > 2 else None  # noqa: PLR2004 - load CLASS MANAGER
    return StartKind.NODE, None, None


def _settings(state: State, scope: Scope, element: Element, inner: Scope) -> tuple[tuple[str, str], ...]:
    settings = [
        (name, shown(value))
        for name in (*_SETTINGS, *_TEST_SETTINGS)
        if (value := state.text(scope, element, name)) is not None
    ]
    if state.machine and not any(name == "machine" for name, _ in settings):
        settings.append(("machine", state.machine))
    for name, value in settings:
        if not is_partial(value) and not _is_valid(name, value):
            state.refused(scope, element, f"'{name}' cannot be '{value}'")
    respawn, required = (state.boolean(scope, element, name) for name in ("respawn", "required"))
    if respawn and required:
        state.refused(scope, element, "it has both 'respawn' and 'required'")
    return (*settings, *((f"env {name}", value) for name, value in inner.environment))
