"""Evaluates a roslaunch file as roslaunch loads it: nothing is executed, and every fact keeps its line.

Source: wiki.ros.org/roslaunch/XML and the rules of roslaunch's loader. Where roslaunch refuses a file, that is a
problem of the configuration, and what can be read in spite of it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE
from kg.facts import LaunchArgument, LaunchConfiguration, LaunchDialect, LaunchInclude, LaunchProblemKind
from kg.launch.files.markup import Document, Markup
from kg.launch.files.ros1.nodes import enter, read_environment, read_node, read_remap
from kg.launch.files.ros1.parameterfile import shown
from kg.launch.files.ros1.parameters import read_param, read_rosparam
from kg.launch.files.ros1.state import Given, Place, Scope, State

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.files import FilePath
    from kg.launch.files.access import Files

_WITH_TEXT: Final = "rosparam"


@dataclass(slots=True)
class Element:
    """An element; `line` is that of its start tag. Text is kept for `<rosparam>` only, as pieces with their lines."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)
    pieces: list[tuple[int, str]] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The text directly in the element, without comments."""
        return "".join(piece for _, piece in self.pieces)

    def text_lines(self) -> list[int]:
        """Return the line in the file of each line of `text`."""
        lines: list[int] = [self.pieces[0][0] if self.pieces else self.line]
        for first, piece in self.pieces:
            if not lines[-1]:
                lines[-1] = first
            for line in range(first + 1, first + piece.count("\n") + 1):
                lines.append(line)  # noqa: PERF402 - the loop sets the last entry, too
        return lines

    def below(self) -> Iterator[Element]:
        """Yield the element and all in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))


def _text(parent: Element, text: str, line: int) -> None:
    if parent.tag.lower() == _WITH_TEXT:
        parent.pieces.append((line, text))


_MARKUP: Final = Markup(Element, _text, cached=1024)


def read_document(text: bytes) -> Document[Element]:
    """Return the `<launch>` element of UTF-8 `text`; the part before an error in it is kept."""
    whole = _MARKUP.read(text)
    roots = [element for element in whole.root.below() if element.tag == "launch"] if whole.root else []
    if len(roots) == 1:
        return Document(roots[0], whole.problem)
    return Document(None, whole.problem or (f"the file has {'more than one' if roots else 'no'} <launch> element", 1))


_MOST_DEPTH: Final = 100
_MOST_LEVELS: Final = 150
"""Of groups and includes in one another, each of which takes frames of the interpreter's stack."""
_ROS1: Final = 1
_MACHINE: Final = ("name", "address", "env-loader", "ssh-port", "user", "password", "default", "timeout")


def evaluate(
    files: Files,
    file: FilePath,
    dialect: LaunchDialect,
    given: Mapping[str, str],
    environment: Mapping[str, str],
) -> LaunchConfiguration:
    """Return the configuration of the launch file, with everything that it includes.

    `given` are arguments that the caller sets, `environment` the only variables that are taken for known. Never raises
    for what is in a file: that is told as problems.
    """
    evaluation = _Evaluation(State(files, file, environment), given)
    evaluation.run(file)
    return evaluation.configuration(file, dialect)


class _Evaluation:
    """One evaluation of a file and its includes."""

    def __init__(self, state: State, given: Mapping[str, str]) -> None:
        self._state = state
        self._given = dict(given)
        self._arguments: dict[str, LaunchArgument] = {}
        self._open: list[tuple[FilePath, tuple[tuple[str, str], ...]]] = []
        self._levels = 0
        self._readers = {"node": read_node, "test": read_node, "param": read_param, "rosparam": read_rosparam}

    def run(self, file: FilePath) -> None:
        """Evaluate the file that is started."""
        scope = Scope(Place(file, self._state.files.folder(file)), arguments=dict(self._given))
        self._file(scope, file, 1)
        for name in self._given:
            if name not in self._arguments:
                message = f"the argument '{name}' is given to a file that does not declare it"
                self._state.problem(scope, 1, LaunchProblemKind.UNDECLARED_ARGUMENT, message, name)

    def configuration(self, file: FilePath, dialect: LaunchDialect) -> LaunchConfiguration:
        """Return the result."""
        state = self._state
        owner = state.files.reader.workspace.owner(file)
        return LaunchConfiguration(
            repository=file.repository,
            package=owner.name if owner else "",
            path=file.path,
            ros=_ROS1,
            dialect=dialect,
            given=tuple(self._given.items()),
            arguments=tuple(self._arguments.values()),
            nodes=tuple(state.nodes),
            parameters=(*state.parameters, *state.late),
            includes=tuple(state.includes),
            problems=tuple(state.problems),
            files=tuple((one.repository, one.path) for one in state.read),
            plugins=tuple(one for held in state.plugins.values() for one in held),
        )

    def _file(self, scope: Scope, file: FilePath, line: int) -> bool:
        """Evaluate a file in a scope of its own; return whether all of it was read."""
        data = self._state.open(scope, line, file)
        if data is None:
            return False
        document = read_document(data)
        if document.problem is not None:
            message, where = document.problem
            self._state.problem(scope, where, LaunchProblemKind.MALFORMED, message)
        if document.root is not None:
            self._open.append((file, tuple(sorted(scope.arguments.items()))))
            self._children(scope, document.root)
            self._open.pop()
        return document.problem is None

    def _children(self, scope: Scope, parent: Element) -> None:
        if self._levels >= _MOST_LEVELS:
            self._state.limit(scope, parent.line, f"groups and includes are nested deeper than {_MOST_LEVELS} levels")
            return
        self._levels += 1
        self._elements(scope, parent)
        self._levels -= 1

    def _elements(self, scope: Scope, parent: Element) -> None:
        for element in parent.children:
            if not self._state.allows(scope, element.line, "elements"):
                return
            reader = self._readers.get(element.tag)
            if reader is not None:
                reader(self._state, scope, element)
            elif element.tag == "arg":
                self._argument(scope, element)
            elif element.tag == "remap":
                read_remap(self._state, scope, scope, element)
            elif element.tag == "env":
                read_environment(self._state, scope, scope, element)
            elif element.tag == "machine":
                self._machine(scope, element)
            elif element.tag in {"group", "include"}:
                self._nested(scope, element)

    def _nested(self, scope: Scope, element: Element) -> None:
        counts, words = self._state.condition(scope, element)
        if not counts:
            return
        inner = enter(self._state, scope, element)
        if words:
            inner.conditions = (*scope.conditions, words)
        if element.tag == "group":
            inner.private = list(inner.private)
            self._children(inner, element)
        else:
            self._include(scope, inner, element)

    def _argument(self, scope: Scope, element: Element) -> None:
        state, written = self._state, self._written(scope, element)
        if written is None:
            return
        name, value, default, words = written
        if value is not None and default is not None:
            state.refused(scope, element, f"the argument '{name}' has both a value and a default")
        refused = scope.declare(name, value, default, certain=words is None)
        if refused:
            state.problem(scope, element.line, refused[0], refused[1], name)
        if scope.place.chain:
            return
        if name not in scope.arguments:  # in the file that is started, one that is not given is unknown
            scope.arguments[name] = HOLE
            message = f"the argument '{name}' has no default and is not given"
            state.problem(scope, element.line, LaunchProblemKind.UNRESOLVED, message, name)
        now = scope.arguments[name]
        argument = LaunchArgument(
            name=shown(name),
            default=None if default is None else shown(default),
            value=None if now == HOLE else shown(now),
            location=state.location(scope, element.line),
            description=element.attributes.get("doc"),
            fixed=value is not None,
        )
        self._arguments.setdefault(name, argument)

    def _written(self, scope: Scope, element: Element) -> tuple[str, str | None, str | None, str | None] | None:
        """Return name, value, default and unknown condition of an `<arg>`; None for one that does not count."""
        state = self._state
        counts, words = state.condition(scope, element)
        name = state.text(scope, element, "name")
        if not counts:
            if name and any("env " in element.attributes.get(key, "") for key in ("if", "unless")):
                scope.unmet.add(name)
            return None
        if not name:
            state.refused(scope, element, "it has no 'name'")
            return None
        return name, state.text(scope, element, "value"), state.text(scope, element, "default"), words

    def _machine(self, scope: Scope, element: Element) -> None:
        state = self._state
        counts, words = state.condition(scope, element)
        if not counts:
            return
        attributes: dict[str, str | None] = {
            name: state.text(scope, element, name) for name in _MACHINE if name in element.attributes
        }
        name, address = attributes.get("name"), attributes.get("address")
        if not name or address is None:
            state.refused(scope, element, "it needs 'name' and 'address'")
            return
        default = (attributes.pop("default", None) or "false").lower()
        attributes["assignable"] = str(default != "never")
        certain = not words and not scope.conditions and HOLE not in name
        if state.machines.setdefault(name, attributes) != attributes and certain:
            state.refused(scope, element, f"another machine is named '{name}'")
        if default == "true":
            state.machine = shown(name)

    def _include(self, scope: Scope, inner: Scope, element: Element) -> None:
        state = self._state
        if not state.allows(scope, element.line, "includes"):
            return
        written = state.text(scope, element, "file")
        if written is None:
            state.refused(scope, element, "it has no 'file'")
            return
        passed = self._passed(scope, inner, element)
        file, reason = state.locate(scope, element.line, written, LaunchProblemKind.UNKNOWN_PART)
        location = state.location(scope, element.line)
        if file is not None and reason is None:
            reason = self._stopped(scope, inner, element, file)
        state.includes.append(
            LaunchInclude(
                written=shown(written),
                location=location,
                chain=scope.place.chain,
                repository=file.repository if file else None,
                path=file.path if file else None,
                condition=" and ".join(inner.conditions) or None,
                reason=reason,
            )
        )
        if file is None or reason is not None:
            return
        inner.place = Place(file, state.files.folder(file), (*scope.place.chain, location))
        inner.declared, inner.uncertain, inner.unmet = set(), set(), set()
        is_read = self._file(inner, file, element.line)
        if is_read and state.is_whole and not inner.replaces:
            for name, given in passed.items():
                if name not in inner.declared:
                    message = f"the argument '{name}' is passed to {inner.place.file.path}, which does not declare it"
                    self._state.problem(scope, given.location, LaunchProblemKind.UNDECLARED_ARGUMENT, message, name)

    def _passed(self, scope: Scope, inner: Scope, element: Element) -> dict[str, Given]:
        """Put the arguments that an include passes into the inner scope; return those that it names itself."""
        state = self._state
        inner.replaces = state.boolean(scope, element, "pass_all_args")
        given: dict[str, Given] = {}
        passing = Scope(inner.place, arguments=dict(scope.arguments) if inner.replaces else {}, replaces=inner.replaces)
        passing.declared = set(passing.arguments)
        for child in element.children:
            tag = child.tag.lower()
            if tag == "env":
                read_environment(state, scope, inner, child)
            elif tag == "arg":
                self._pass(scope, passing, child, given)
        inner.arguments = passing.arguments
        return given

    def _pass(self, scope: Scope, passing: Scope, element: Element, given: dict[str, Given]) -> None:
        state, written = self._state, self._written(scope, element)
        if written is None:
            return
        name, value, default, words = written
        if value is None and default is None:
            state.refused(scope, element, f"the argument '{name}' is passed without a value")
            return
        refused = passing.declare(name, value, default, certain=words is None)
        if refused:
            state.problem(scope, element.line, refused[0], refused[1], name)
        given[name] = Given(value or default or "", state.location(scope, element.line))

    def _stopped(self, scope: Scope, inner: Scope, element: Element, file: FilePath) -> str | None:
        """Return why an include is not followed, which is a problem: it would not end, or not soon."""
        state = self._state
        here = (file, tuple(sorted(inner.arguments.items())))
        if here in self._open:
            reason = f"{file.path} includes itself"
            unsure = any(HOLE in value for value in inner.arguments.values()) or inner.conditions
            kind = LaunchProblemKind.UNRESOLVED if unsure else LaunchProblemKind.CYCLE
            state.problem(scope, element.line, kind, reason, file.path)
            return reason
        if len(self._open) >= _MOST_DEPTH:
            reason = f"includes are nested deeper than {_MOST_DEPTH} levels"
            state.limit(scope, element.line, reason)
            return reason
        return None
