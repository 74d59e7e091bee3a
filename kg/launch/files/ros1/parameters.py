"""`<param>` and `<rosparam>`: values given in place, read from files, or printed by commands that are not run.

Source: wiki.ros.org/roslaunch/XML/param and /rosparam.
"""

from __future__ import annotations

import re
import shlex
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE
from kg.facts import LaunchPlugin, LaunchProblemKind, Location
from kg.launch.files.access import SCHEME, UNREAD
from kg.launch.files.ros1.parameterfile import MOST_TEXT, Leaf, converted, join, leaf_of, read_tree, shown
from kg.launch.files.ros1.state import Private, Scope, State
from kg.launch.files.xacro.plugins import named_description, started

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.corpus.files import FilePath
    from kg.launch.files.ros1.evaluate import Element

_SOURCES: Final = ("value", "textfile", "binfile", "command")
_TYPES: Final = {
    "int": "int",
    "double": "double",
    "bool": "bool",
    "boolean": "bool",
    "str": "string",
    "string": "string",
}
_ROSPACK: Final = re.compile(r"`rospack find ([\w-]+)`")


def read_param(state: State, scope: Scope, element: Element, *, of_node: bool = False) -> None:
    """Set the parameter of a `<param>`; a private one, or one of a node, is kept for the nodes of the scope."""
    counts, words = state.condition(scope, element)
    if not counts:
        return
    name = state.text(scope, element, "name")
    name = name.strip() if name else name
    if not name:
        state.refused(scope, element, "it has no 'name'")
        return
    leaves = _values(state, scope, element, name)
    plugins = _described(state, scope, element) if len(leaves) == 1 else ()
    if plugins:
        leaves = (replace(leaves[0], plugins=plugins),)
    location, reason = state.location(scope, element.line), _only_if((*scope.conditions, words))
    if of_node or name.startswith("~"):
        scope.add_private(Private(name, leaves, location, scope.place.chain, reason))
        return
    for leaf in leaves:
        state.add_leaf(join(scope.namespace, name), leaf, location, scope.place.chain, reason)


def read_rosparam(state: State, scope: Scope, element: Element, *, of_node: bool = False) -> None:
    """Set the parameters of a `<rosparam>`; `dump` and `delete` change none of those that are set here.

    One of a node whose file cannot be read sets a parameter of unknown name.
    """
    counts, words = state.condition(scope, element)
    if not counts:
        return
    name = join(state.text(scope, element, "ns") or "", state.text(scope, element, "param") or "")
    command = state.text(scope, element, "command") or "load"
    file = state.text(scope, element, "file")
    if command not in {"load", "dump", "delete"}:
        state.refused(scope, element, f"'command' is load, dump or delete, not '{command}'")
    elif command == "delete" and file is not None:
        state.refused(scope, element, "'delete' takes no 'file'")
    elif command == "load":
        is_read = _load(state, scope, element, name, file, _only_if((*scope.conditions, words)))
        if of_node and not is_read:
            unread, full = Leaf((HOLE,), element.line, None, None, UNREAD), join(scope.namespace, name)
            state.add_leaf(full, unread, state.location(scope, element.line), scope.place.chain)


def _load(  # noqa: PLR0913, PLR0917 - what a `<rosparam>` says
    state: State, scope: Scope, element: Element, name: str, written: str | None, reason: str | None
) -> bool:
    """Set the parameters of a file or of the text of an element; return whether they are known."""
    source: FilePath | None = None
    text = element.text
    if written is not None:
        source, _ = state.locate(scope, element.line, written)
        data = state.open(scope, element.line, source) if source else None
        if data is None:
            return False
        text = data.decode()
    if state.boolean(scope, element, "subst_value") and "$" in text:
        text = state.resolved(scope, element.line, text, MOST_TEXT)
    tree = read_tree(text)
    lines = None if source else element.text_lines()

    def at(line: int) -> Location:
        return state.location(scope, line if lines is None else lines[min(line, len(lines)) - 1], source)

    for message, line in tree.problems:
        kind = LaunchProblemKind.LIMIT if tree.too_large else LaunchProblemKind.MALFORMED
        state.problem(scope, at(line), kind, message)
    if not name and not tree.is_mapping:
        state.refused(scope, element, "it needs 'param', as what it loads is not a mapping")
        return True
    full = join(scope.namespace, name) if name else scope.namespace
    for leaf in tree.leaves:
        state.add_leaf(full, leaf, at(leaf.line), scope.place.chain, reason)
    return True


def _only_if(conditions: tuple[str | None, ...]) -> str | None:
    words = [one for one in conditions if one]
    return f"it is set only if {' and '.join(words)}" if words else None


def _described(state: State, scope: Scope, element: Element) -> tuple[LaunchPlugin, ...]:
    """Return the plugins of the robot description that a file holds, or that xacro makes of one."""
    source = next((name for name in ("textfile", "command") if name in element.attributes), None)
    if source is None or "value" in element.attributes:
        return ()
    text = state.text(scope, element, source) or ""
    described = named_description(["cat", text] if source == "textfile" else _words(state, scope, element, text))
    file = state.files.find(described[0]).file if described is not None else None
    if described is None or file is None:
        return ()
    given = {name: shown(text) for name, text in described[1].items()}
    chain = (*scope.place.chain, state.location(scope, element.line))
    description = state.descriptions.read(file, given, chain)
    state.problems.update(dict.fromkeys(description.problems))
    state.read.update(dict.fromkeys(description.files))
    return description.plugins


def _values(state: State, scope: Scope, element: Element, name: str) -> tuple[Leaf, ...]:
    """Return the value of a `<param>` as leaves: one, which may be a robot description, or those of a YAML mapping."""
    kind = (element.attributes.get("type") or "auto").lower().strip()
    given = [source for source in _SOURCES if source in element.attributes]
    if len(given) != 1:
        state.refused(scope, element, f"the parameter '{name}' needs one of value, textfile, binfile, command")
        return (_unknown(element, kind, "it has no value"),)
    text = state.text(scope, element, given[0]) or ""
    reason: str | None = None
    if given[0] == "value":
        text = text.strip()
    elif given[0] == "command":
        text, reason = _printed(state, scope, element, text)
    else:
        text, reason = _content(state, scope, element, text, is_text=given[0] == "textfile")
    if reason is not None:
        return (_unknown(element, "" if given[0] == "binfile" else kind, reason),)
    if text == HOLE:
        return (_unknown(element, kind, f"it depends on an unknown value: {element.attributes[given[0]]}"),)
    return _converted(state, scope, element, text, kind)


def _converted(state: State, scope: Scope, element: Element, text: str, kind: str) -> tuple[Leaf, ...]:
    if kind == "yaml":
        tree = read_tree(text)
        for message, _ in tree.problems:
            state.refused(scope, element, message)
        if tree.is_empty:
            return (leaf_of(None, element.line),)
        return tuple(Leaf(leaf.keys, element.line, leaf.value, leaf.type, leaf.reason) for leaf in tree.leaves)
    try:
        return (leaf_of(converted(text, kind), element.line),)
    except ValueError as error:
        if HOLE not in text:
            state.refused(scope, element, f"the value is wrong: {error}")
        return (_unknown(element, kind, "its value does not fit its type"),)


def _unknown(element: Element, kind: str, reason: str) -> Leaf:
    return Leaf((), element.line, None, _TYPES.get(kind), reason)


def _content(state: State, scope: Scope, element: Element, text: str, *, is_text: bool) -> tuple[str, str | None]:
    """Return the content of a file, or why it is unknown."""
    file, reason = state.locate(scope, element.line, text)
    if file is None:
        return "", reason
    if not is_text:
        return "", "it is binary"
    data = state.open(scope, element.line, file)
    return ("", "the file cannot be read") if data is None else (data.decode(), None)


def _words(state: State, scope: Scope, element: Element, command: str) -> Sequence[str]:
    """Return the words of a command from its program on; none for a malformed one."""
    try:
        return started(shlex.split(_ROSPACK.sub(rf"{SCHEME}\1", command)))
    except ValueError as error:
        state.refused(scope, element, f"the command is wrong: {error}")
        return []


def _printed(state: State, scope: Scope, element: Element, command: str) -> tuple[str, str | None]:
    """Return the output of a command that prints a file, or why it is unknown."""
    words = _words(state, scope, element, command)
    if not words:
        return "", "its command is wrong"
    if len(words) == 2 and words[0].rpartition("/")[2] == "cat":  # noqa: PLR2004 - cat FILE
        return _content(state, scope, element, words[1], is_text=True)
    described = named_description(words)
    if described is not None:
        _, reason = state.locate(scope, element.line, described[0])
        return "", reason or "it is what xacro prints, which is not run"
    return "", "it is what a command prints, which is not run"
