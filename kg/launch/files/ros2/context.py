"""State of the execution of a ROS 2 launch file, and the results so far.

Source: `launch.LaunchContext`. There the namespace, the global remappings and the global parameters are launch
configurations of reserved names; here they have fields of their own, and are saved and restored together with them.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from kg.facts import (
    LaunchArgument,
    LaunchInclude,
    LaunchParameter,
    LaunchPlugin,
    LaunchProblem,
    LaunchProblemKind,
    Location,
    Remap,
    StartedNode,
)
from kg.holes import ANONYMOUS
from kg.launch.files.access import SCHEME, Budget, Files
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kg.corpus.files import FilePath
    from kg.launch.files.ros2.actions import Text
    from kg.launch.files.ros2.parameters import Entry
    from kg.launch.files.ros2.substitute import Generated

with lazily():
    from kg.launch.files.ros2.substitute import perform

HOLE: Final = ANONYMOUS
"""Stands in a text for a part that cannot be known."""


@dataclass(frozen=True, slots=True)
class GlobalFile:
    """A parameter file that `SetParametersFromFile` names for all nodes that come after; `path` is performed."""

    path: str
    location: Location
    chain: tuple[Location, ...] = ()
    reason: str | None = None
    """Why it is not known whether it counts."""


@dataclass(slots=True)
class Scope:
    """The state that a scoped group restores at its end; a text with `{}` is partly unknown."""

    configurations: dict[str, str] = field(default_factory=dict)
    environment: dict[str, str | None] = field(default_factory=dict)
    """Variables set; None for those that were unset. All others are unknown."""
    unread: bool = False
    """Whether a file was included that is not in the build; it may have set any configuration."""
    namespace: str | None = None
    remaps: tuple[Remap, ...] = ()
    parameters: tuple[LaunchParameter | GlobalFile, ...] = ()

    def copy(self) -> Scope:
        """Return a scope that can change without this one."""
        return replace(self, configurations=dict(self.configurations), environment=dict(self.environment))


@dataclass(slots=True)
class Results:
    """Results of executing a configuration; problems, arguments and files each once, in the order found."""

    nodes: list[StartedNode] = field(default_factory=list)
    includes: list[LaunchInclude] = field(default_factory=list)
    arguments: dict[str, LaunchArgument] = field(default_factory=dict)
    problems: dict[LaunchProblem, None] = field(default_factory=dict)
    files: dict[FilePath, None] = field(default_factory=dict)
    generated: dict[str, Generated] = field(default_factory=dict)
    """Files that are made when the configuration runs, by name."""
    given: dict[object, dict[int, tuple[Entry, tuple[str, LaunchParameter, LaunchParameter]]]] = field(
        default_factory=dict
    )
    """What nodes are given of each entry of a parameter file, since many nodes are given the same files."""
    containers: dict[int, str] = field(default_factory=dict)
    """The absolute names of containers by the identity of the action that starts them."""
    printed: tuple[LaunchPlugin, ...] = ()
    """The plugins of the robot description that the text performed last is."""
    described: dict[tuple[str, Location, tuple[Location, ...]], tuple[LaunchPlugin, ...]] = field(default_factory=dict)
    """The plugins of descriptions by name and place of the parameters that hold them."""
    budget: Budget = field(default_factory=Budget)
    defaults: dict[str, dict[str, Location]] = field(default_factory=dict)
    """The defaults that were taken for variables of the environment, each with the first place."""
    undeclared: set[tuple[str, str, tuple[Location, ...]]] = field(default_factory=set)
    """Undeclared configurations that are read, each with the file and the includes that led to it."""

    def reads_first(self, name: str, path: str, chain: tuple[Location, ...]) -> bool:
        """Record that a file reads an undeclared configuration; return whether that is its first reading."""
        before = len(self.undeclared)
        self.undeclared.add((name, path, chain))
        return len(self.undeclared) > before


class Context:
    """The state of the execution: `scope` has the current settings, `found` the results.

    `file` is the launch file that is executed, `chain` the lines of the includes that led to it, outermost first,
    `location` the place of the action that is executed, `conditions` the words of the conditions around it that
    cannot be known.
    """

    def __init__(self, files: Files, file: FilePath, given: Mapping[str, str], environment: Mapping[str, str]) -> None:
        """Begin with the root file, the arguments `given` to it and the variables of the environment that are known."""
        self.files = files
        self.file = file
        self.initial = dict(environment)
        self.scope = Scope(dict(given), dict(environment))
        self.results = Results()
        self.chain: tuple[Location, ...] = ()
        self.stack: tuple[FilePath, ...] = (file,)
        self.location = place(files, file, 1)
        self.conditions: tuple[str, ...] = ()

    def perform(self, text: Text) -> str:
        """Return a text with its substitutions performed now; what cannot be known is `{}`, with a problem."""
        return perform(self, text)

    def resolved(self, text: Text) -> str | None:
        """Return a text performed now; None where a part of it is not known."""
        performed = self.perform(text)
        return None if HOLE in performed else performed

    def quietly(self, text: Text) -> str:
        """Return a text performed, without recording problems: for display only."""
        before = dict(self.results.problems), set(self.results.undeclared)
        try:
            return self.perform(text)
        finally:
            self.results.problems, self.results.undeclared = before

    def configuration(self, name: str) -> str | None:
        """Return the value of a launch configuration, with `{}` for parts not known; None where nothing sets it."""
        return self.scope.configurations.get(name)

    def environment(self, name: str) -> str | None:
        """Return the value of a variable of the environment; None where it is not known or unset."""
        return self.scope.environment.get(name)

    @property
    def namespace(self) -> str:
        """The namespace that is pushed, absolute."""
        return self.scope.namespace or "/"

    def problem(
        self, kind: LaunchProblemKind, message: str, subject: str | None = None, location: Location | None = None
    ) -> None:
        """Record an error or an unknown part, at the action being executed unless a `location` is given."""
        self.results.problems.setdefault(LaunchProblem(kind, message, location or self.location, self.chain, subject))

    def limit(self, message: str) -> None:
        """Record that something exceeds a limit."""
        self.problem(LaunchProblemKind.LIMIT, message)

    def allows(self, what: str, amount: int = 1) -> bool:
        """Count something; return whether that is within the limit."""
        return self.results.budget.allows(self.limit, what, amount)

    def unresolved(self, message: str, subject: str | None = None) -> str:
        """Record an unknown part, and return its placeholder."""
        self.problem(LaunchProblemKind.UNRESOLVED, message, subject)
        return HOLE

    @contextmanager
    def at(self, location: Location) -> Iterator[None]:
        """Set `location` as the place of the current action."""
        before, self.location = self.location, location
        try:
            yield
        finally:
            self.location = before

    @contextmanager
    def inside(self, file: FilePath) -> Iterator[None]:
        """Execute `file`, included by the current action, in the body; its settings stay."""
        before = self.file, self.chain, self.stack, self.location
        self.chain, self.file, self.stack = (*self.chain, self.location), file, (*self.stack, file)
        self.location = place(self.files, file, 1)
        try:
            yield
        finally:
            self.file, self.chain, self.stack, self.location = before


def place(files: Files, file: FilePath, line: int) -> Location:
    """Return a line of a file as a location: without repository in the configuration's own source."""
    own = file.repository == files.reader.repository
    return Location(file.path, line, None if own else file.repository)


def read(context: Context, text: str) -> tuple[FilePath, bytes] | None:
    """Return the file that a text names, and its content; None, and a problem, where it cannot be read."""
    generated = context.results.generated.get(text)
    if generated is not None:
        return generated.file, generated.content
    file = find(context, text)
    if file is None:
        return None
    content = context.files.read(file)
    if content is None:
        unreadable(context, file)
        return None
    context.results.files.setdefault(file)
    return file, content


def unreadable(context: Context, file: FilePath) -> None:
    """Note that a file is there and cannot be read."""
    context.problem(LaunchProblemKind.LIMIT, f"`{file.path}` is too large, or no text", file.path)


def find(context: Context, text: str) -> FilePath | None:
    """Return the file that a text names; None, and a problem, if it is missing or unknown."""
    if HOLE in text:
        return None
    file = context.files.at(text)
    if file is None:
        package = text.removeprefix(SCHEME).partition("/")[0]
        if not text.startswith(SCHEME):
            context.problem(LaunchProblemKind.UNRESOLVED, f"`{text}` is not a file of a package", text)
        elif context.files.share(package) is None:
            message = f"the package `{package}` is neither in the build nor installed"
            context.problem(LaunchProblemKind.UNKNOWN_PACKAGE, message, package)
        return None
    found = context.files.existing(text)
    if found is None:
        absent = context.files.absent(file, text)
        context.problem(absent.kind, absent.reason or "", text)
    return found
