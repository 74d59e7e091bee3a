"""State of an evaluation: the settings in force at a place of a launch file, and the results so far.

Source: roslaunch's loader, whose rules are kept where they surprise: arguments are copied into groups and not back, a
remapping is replaced by a later one of the same name, and a private parameter of an include is in force behind the
include too, but only if one was in force before it.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import HOLE
from kg.facts import (
    LaunchInclude,
    LaunchParameter,
    LaunchPlugin,
    LaunchProblem,
    LaunchProblemKind,
    Location,
    Remap,
    StartedNode,
)
from kg.launch.files.access import MOST, Budget, Files, Match
from kg.launch.files.ros1.parameterfile import Leaf, canonical, global_namespace, join, shown, truth
from kg.launch.files.ros1.substitute import Note, Substituter
from kg.launch.files.xacro.plugins import Descriptions

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.corpus.files import FilePath
    from kg.launch.files.ros1.evaluate import Element


@dataclass(frozen=True, slots=True)
class Place:
    """A file that is being evaluated: the text of its folder, and the lines of the includes that led to it."""

    file: FilePath
    folder: str
    chain: tuple[Location, ...] = ()


@dataclass(frozen=True, slots=True)
class Private:
    """A parameter for the nodes that follow: its name as written, its leaves, and where it is."""

    name: str
    leaves: tuple[Leaf, ...]
    location: Location
    chain: tuple[Location, ...]
    reason: str | None = None


@dataclass(frozen=True, slots=True)
class Given:
    """An argument that an include passes."""

    value: str
    location: Location


@dataclass(slots=True)
class Scope:
    """A level of a launch file: the file itself, a group, or a node."""

    place: Place
    namespace: str = "/"
    parent: Scope | None = None
    arguments: dict[str, str] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    uncertain: set[str] = field(default_factory=set)
    """Arguments whose declaration depends on an unknown value: a second one is no fault."""
    unmet: set[str] = field(default_factory=set)
    """Arguments that are only declared if a variable of the environment says so, which it does not."""
    private: list[Private] = field(default_factory=list)
    environment: list[tuple[str, str]] = field(default_factory=list)
    conditions: tuple[str, ...] = ()
    replaces: bool = False
    """The file was included with all arguments: what it fixes replaces what is passed."""
    remaps: list[Remap] = field(default_factory=list)

    @property
    def folder(self) -> str:
        """The text of the folder of the file."""
        return self.place.folder

    def child(self, namespace: str | None = None) -> Scope:
        """Return a scope within this one."""
        return Scope(
            place=self.place,
            namespace=global_namespace(join(self.namespace, namespace)) if namespace else self.namespace,
            parent=self,
            arguments=dict(self.arguments),
            declared=set(self.declared),
            uncertain=set(self.uncertain),
            unmet=set(self.unmet),
            # The list itself, so that what an include adds stays behind it; an empty one is not shared by roslaunch.
            private=self.private or [],
            environment=list(self.environment),
            conditions=self.conditions,
        )

    def add_private(self, parameter: Private) -> None:
        """Set a parameter of the nodes that follow; one of the same name is replaced."""
        self.private[:] = [one for one in self.private if one.name != parameter.name]
        self.private.append(parameter)

    def add_remap(self, remap: Remap) -> None:
        """Set a remapping; one of the same name is replaced."""
        self.remaps[:] = [one for one in self.remaps if one.source != remap.source]
        self.remaps.append(remap)

    def all_remaps(self) -> list[Remap]:
        """Return the remappings in force, those of outer scopes first."""
        levels: list[list[Remap]] = []
        scope: Scope | None = self
        while scope is not None:
            levels.append(scope.remaps)
            scope = scope.parent
        remaps: dict[str, Remap] = {}
        for remap in (remap for level in reversed(levels) for remap in level):
            remaps.pop(remap.source, None)
            remaps[remap.source] = remap
        return list(remaps.values())

    def missing(self, name: str, note: Note) -> None:
        """Record that the argument `name` is read and has no value."""
        chain = self.place.chain
        if name in self.unmet:
            message = f"the argument '{name}' is only declared if a variable of the environment is set"
            note(LaunchProblemKind.UNRESOLVED, message, name)
        elif name not in self.declared:
            note(LaunchProblemKind.UNDECLARED_ARGUMENT, f"the argument '{name}' is read and not declared", name)
        elif chain:
            message = f"{self.place.file.path} needs the argument '{name}', which the include does not give"
            note(LaunchProblemKind.MISSING_ARGUMENT, message, name)

    def declare(
        self, name: str, value: str | None, default: str | None, *, certain: bool = True
    ) -> tuple[LaunchProblemKind, str] | None:
        """Declare an argument; return the error that roslaunch would report."""
        if name in self.declared and name not in self.uncertain and certain and not self.replaces:
            return LaunchProblemKind.MALFORMED, f"the argument '{name}' is declared twice"
        self.declared.add(name)
        self.unmet.discard(name)
        if not certain:
            self.uncertain.add(name)
            if value is not None or name not in self.arguments:
                self.arguments[name] = HOLE
            return None
        if value is not None:
            if name in self.arguments and name not in self.uncertain and not self.replaces:
                message = f"the argument '{name}' is given to a file that sets it itself"
                return LaunchProblemKind.UNDECLARED_ARGUMENT, message
            self.arguments[name] = value
        elif default is not None:
            self.arguments.setdefault(name, default)
        return None


_MOST_PROBLEMS: Final = 2000


class State:
    """Collects the parts of a configuration; exceeding the limits is a problem, and the rest is dropped."""

    def __init__(self, files: Files, root: FilePath, environment: Mapping[str, str]) -> None:
        self.files = files
        self.root = root
        self.nodes: list[StartedNode] = []
        self.parameters: list[LaunchParameter] = []
        self.late: list[LaunchParameter] = []
        """Parameters that nodes set when they start, from their command lines."""
        self.includes: list[LaunchInclude] = []
        self.problems: dict[LaunchProblem, None] = {}
        self.read: dict[FilePath, None] = {}
        self.machine: str | None = None
        """The default machine; a later one is in force to the end, whatever scope it stands in."""
        self.machines: dict[str, dict[str, str | None]] = {}
        self.plugins: dict[str, tuple[LaunchPlugin, ...]] = {}
        """Those in the robot descriptions that parameters hold."""
        self.descriptions = Descriptions(files, root, environment)
        self._substituter = Substituter(files, environment)
        self.unset = self._substituter.unset
        self.has_all_parameters = False
        """There are as many parameters as can be kept; no more are read."""
        self.is_whole = True
        """Nothing was left out because of a limit, so that what is not found is not there."""
        self._budget = Budget()

    def location(self, scope: Scope, line: int, file: FilePath | None = None) -> Location:
        """Return the location of a line of the file that is evaluated, or of another one."""
        repository, path = file or scope.place.file
        return Location(path, line, None if repository == self.root.repository else repository)

    def problem(
        self, scope: Scope, at: int | Location, kind: LaunchProblemKind, message: str, subject: str | None = None
    ) -> None:
        """Record a problem at a line of the file that is evaluated, or at another place."""
        location = self.location(scope, at) if isinstance(at, int) else at
        if len(self.problems) < _MOST_PROBLEMS:
            about = shown(subject) if subject is not None else None
            self.problems[LaunchProblem(kind, shown(message), location, scope.place.chain, about)] = None

    def refused(self, scope: Scope, element: Element, message: str) -> None:
        """Record that roslaunch takes no such element."""
        self.problem(scope, element.line, LaunchProblemKind.MALFORMED, f"<{element.tag}>: {message}")

    def text(self, scope: Scope, element: Element, attribute: str) -> str | None:
        """Return an attribute after substitution; None when the element has none of that name."""
        written = element.attributes.get(attribute)
        return written if written is None or "$" not in written else self.resolved(scope, element.line, written)

    def resolved(self, scope: Scope, line: int, written: str, most: int | None = None) -> str:
        """Return a text that is on a line after substitution."""

        def note(kind: LaunchProblemKind, message: str, subject: str | None = None) -> None:
            if kind is LaunchProblemKind.MISSING_ARGUMENT:
                place = replace(scope.place, chain=scope.place.chain[:-1])
                self.problem(replace(scope, place=place), scope.place.chain[-1], kind, message, subject)
            else:
                self.problem(scope, line, kind, message, subject)

        if most is None:
            return self._substituter.resolve(written, scope, note)
        return self._substituter.resolve(written, scope, note, most)

    def condition(self, scope: Scope, element: Element) -> tuple[bool, str | None]:
        """Return whether an element counts; if that is unknown, also its condition in the words of the file."""
        attributes = element.attributes
        if "if" not in attributes and "unless" not in attributes:
            return True, None
        if "if" in attributes and "unless" in attributes:
            self.refused(scope, element, "it has both 'if' and 'unless'")
        name = "if" if "if" in attributes else "unless"
        words = attributes[name] if name == "if" else f"not {attributes[name]}"
        text = self.text(scope, element, name) or ""
        if HOLE in text:
            return True, words
        try:
            return truth(text) is (name == "if"), None
        except ValueError as error:
            self.refused(scope, element, f"'{name}': {error}")
            return True, words

    def boolean(self, scope: Scope, element: Element, attribute: str) -> bool:
        """Return an attribute that is true or false; false when it is neither, which is a problem."""
        text = self.text(scope, element, attribute)
        if text is None or HOLE in text or (attribute == "clear_params" and not text):
            return False
        if text.lower() not in {"true", "false"}:
            self.refused(scope, element, f"'{attribute}' is neither true nor false: '{text}'")
        return text.lower() == "true"

    def allows(self, scope: Scope, line: int, what: str, amount: int = 1) -> bool:
        """Count something; return whether that is within the limit."""
        return self._budget.allows(lambda message: self.limit(scope, line, message), what, amount)

    def limit(self, scope: Scope, line: int, message: str) -> None:
        """Record that something is not read on."""
        self.is_whole = False
        self.problem(scope, line, LaunchProblemKind.LIMIT, message)

    def add_node(self, scope: Scope, node: StartedNode) -> None:
        """Add a node; where it is one too many, nothing more is read."""
        if self._budget.allows_node(lambda message: self.limit(scope, node.location.line, message), node):
            self.nodes.append(node)
        else:
            self.allows(scope, node.location.line, "elements", MOST["elements"])

    def add_leaf(
        self, name: str, leaf: Leaf, location: Location, chain: tuple[Location, ...], reason: str | None = None
    ) -> None:
        """Add a parameter below `name`, which is absolute or private to roslaunch."""
        if self.has_all_parameters:
            return
        for key in leaf.keys:
            name = join(name, key)
        absolute = shown(canonical(name))

        def cut(message: str) -> None:
            self.has_all_parameters, self.is_whole = True, False
            self.problems[LaunchProblem(LaunchProblemKind.LIMIT, message, location, chain)] = None

        if self._budget.allows(cut, "parameters") and self._budget.allows(cut, "places", 1 + len(chain)):
            self.plugins.pop(absolute, None)
            if leaf.plugins:
                self.plugins[absolute] = tuple(replace(one, parameter=absolute) for one in leaf.plugins)
            self.parameters.append(
                LaunchParameter(absolute, leaf.value, location, chain, leaf.type, leaf.reason or reason)
            )

    def locate(
        self, scope: Scope, line: int, text: str, unknown: LaunchProblemKind = LaunchProblemKind.UNRESOLVED
    ) -> tuple[FilePath | None, str | None]:
        """Return the file that a text names, or None and the reason: a problem, of the kind `unknown` for holes."""
        match = self.files.find(text)
        if HOLE in text:
            match = Match(None, unknown, f"the file {text} depends on an unknown value", text)
        if match.reason is None:
            return match.file, None
        self.problem(scope, line, match.kind, match.reason, match.subject)
        return None, shown(match.reason)

    def open(self, scope: Scope, line: int, file: FilePath) -> bytes | None:
        """Return the text of a file, which is recorded as read; None, and a problem, when it cannot be read."""
        data = self.files.read(file)
        if not self.allows(scope, line, "bytes of files", len(data or b"")):
            return None
        if data is None:
            self.limit(scope, line, f"the file {file.path} is not read: it is binary or too large")
        else:
            self.read[file] = None
        return data
