"""Reading a ROS 2 launch file in Python without running it: what `generate_launch_description()` returns.

The file is interpreted over values of which some are not known; nothing of it is executed, nothing but files of the
build is read, and the work is bounded. Sources: the packages `launch` and `launch_ros` of ROS 2.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Final

from kg.facts import LaunchProblem, LaunchProblemKind, Location
from kg.launch.files.ros2.actions import Action, Condition, Group
from kg.launch.files.ros2.context import HOLE, Context, place
from kg.launch.files.ros2.python import library
from kg.launch.files.ros2.python.entities import ENTITIES, NODES
from kg.launch.files.ros2.python.language import LaunchPython, parse
from kg.launch.files.ros2.python.machine import Halt, LaunchMachine
from kg.launch.files.ros2.python.values import (
    Instance,
    condition_of,
    entries_of,
    launch_text,
    reason_of,
    terms_of_way,
    text_of,
)
from kg.symbolic.descriptions import Descriptions
from kg.symbolic.effects import Framework
from kg.symbolic.operators import NULL, negated_term
from kg.symbolic.state import Arguments
from kg.symbolic.values import Closure, Either, Sequence, Text, TypeValue, Unknown, Value, Way, paths

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from collections.abc import Sequence as Items

    from kg.corpus.files import FilePath
    from kg.extract.python.modules import PythonUnit
    from kg.launch.files.access import Files

_MAX_DEPTH: Final = 100
_NO_VARIABLES: Final[Mapping[str, str | None]] = {}
_TOO_MUCH: Final = "the file needs more steps to be read than are allowed"


class _NoFramework(Framework):
    """No framework: nothing that a launch file does is worth less than anything else."""

    def progress(self) -> tuple[int, ...]:
        """Return a number that changes with each step."""
        return (self.machine.steps,)


class Reading:
    """The reading of one file; `context` is that of the `OpaqueFunction` that is read now."""

    def __init__(
        self, files: Files, file: FilePath, problems: list[LaunchProblem], environment: Mapping[str, str | None]
    ) -> None:
        self.files = files
        self.file = file
        self.problems = problems
        self.context: Context | None = None
        self.variables: dict[str, str | None] = {}
        """The variables of the environment that the description depends on; None for those that are not set."""
        self._environment = environment
        self.location = self.at(file, 1)
        self.language = LaunchPython(self)
        framework = _NoFramework(Descriptions("python"))
        self.machine = LaunchMachine(self.language, framework)
        self.language.machine = framework.machine = self.machine
        self.machine.start()
        self._terms: list[str] = []
        """The terms of the alternatives that are read now."""
        self._read: dict[int, tuple[Instance, list[Action]]] = {}

    # Places

    def at(self, file: FilePath, line: int) -> Location:
        """Return a line of a file as a location."""
        return place(self.files, file, line)

    def place_of(self, value: Value) -> Location | None:
        """Return the place of a value; None if it is unknown."""
        places = self.machine.places.get(id(value))
        return self.at(places[1], places[2][-1]) if places is not None and places[2] else None

    def places_of(self, value: Value, count: int, rest: Location) -> list[Location]:
        """Return the places of the items of a list; `rest` for those with an unknown place."""
        places = self.machine.places.get(id(value))
        if places is not None and len(places[2]) == count + 1:
            return [self.at(places[1], line) for line in places[2][:-1]]
        items = value.items if isinstance(value, Sequence) and len(value.items) == count else ()
        return [self.place_of(item) or rest for item in items] or [rest] * count

    def find(self, text: str) -> FilePath | None:
        """Return the file that a path names, if the build or an installed package has it."""
        return self.files.existing(text)

    def variable(self, name: str) -> str | None:
        """Return the value that a variable of the environment has while the description is read; None if unset."""
        return self.variables.setdefault(name, self._environment.get(name))

    # Values

    def exact(self, value: Value | None) -> str | None:
        """Return a text that is wholly known now; None for all else."""
        resolved = self.language.resolved(value) if value is not None else None
        return resolved.exact if isinstance(resolved, Text) else None

    def perform(self, value: Value) -> Value:
        """Return the text that a substitution gives now."""
        parts = launch_text(value)
        if self.context is None:
            return text_of(parts)  # in a context of the file's own, which has no configurations
        text = self.context.perform(parts)
        if HOLE not in text:
            return Text.of(text)
        variables = (part for part in parts if not isinstance(part, str) and part.kind == "var")
        name = "".join(map(str, next((one.arguments[0] for one in variables if one.arguments), ())))
        reason = f"the launch configuration `{name}` is not known" if name else reason_of(value)
        return library.with_holes(text, reason)

    def called(self, function: Value, arguments: list[Value], named: dict[str, Value] | None = None) -> Value:
        """Return the result of a function."""
        return self.language.calls.value(function, Arguments(arguments, named=named or {}))

    # Actions

    def actions(self, value: Value, location: Location, depth: int = 0) -> list[Action]:
        """Return the actions that a value stands for; `location` is where it is used."""
        self.machine.step()
        if value == NULL:
            return []
        if depth > _MAX_DEPTH:
            self.unresolved("actions are nested too deeply", location)
            return []
        if isinstance(value, Instance) and value.name in ENTITIES:
            if value.name not in NODES:
                return ENTITIES[value.name][1](self, value)
            if id(value) not in self._read:  # containers are known by the identity of their action
                self._read[id(value)] = value, ENTITIES[value.name][1](self, value)
            return self._read[id(value)][1]
        if isinstance(value, Sequence):
            items = zip(value.items, self.places_of(value, len(value.items), location), strict=True)
            return [action for item, where in items for action in self.actions(item, where, depth + 1)]
        if isinstance(value, Either):
            return [one for item, way in paths(value) for one in self._conditional(item, way, location, depth + 1)]
        self.note(LaunchProblemKind.UNKNOWN_PART, f"an action is not known: {reason_of(value)}", location)
        return []

    def _conditional(self, item: Value, way: Way, location: Location, depth: int) -> list[Action]:
        """Return the actions of an alternative; none if its conditions exclude it."""
        more = self.added(terms_of_way(way))
        if more is None:
            return []
        self._terms += more
        actions = self.actions(item, location, depth)
        del self._terms[len(self._terms) - len(more) :]
        return self.under(condition_of(more), actions)

    def added(self, terms: tuple[str, ...], given: tuple[str, ...] = ()) -> tuple[str, ...] | None:
        """Return the terms that those of the moment and `given` do not have; None if they exclude one."""
        before = {*self._terms, *given}
        if any(negated_term(term) in before for term in terms):
            return None
        return tuple(term for term in terms if term not in before)

    def under(self, condition: Condition | None, actions: list[Action]) -> list[Action]:
        """Return actions as a group under a condition."""
        if condition is None or not actions:
            return actions
        return [Group(location=actions[0].location, condition=condition, actions=tuple(actions), scoped=False)]

    def run_function(self, action: Instance, context: Context) -> list[Action]:
        """Return the actions of an `OpaqueFunction`, whose body is read in the context of the moment."""
        before, self.context = self.context, context
        self.machine.more()

        def body() -> Value:
            scope = library.create(self.language, "LaunchContext", {})
            scope.fields["launch_configurations"] = library.create(self.language, library.CONFIGURATIONS, {})
            given = action.fields.get("args", Sequence(()))
            rest = [item for item, _ in self.machine.items(given) or ()]
            named = {key.exact: one for key, one in entries_of(action.value("kwargs")) if isinstance(key, Text)}
            arguments = {name: one for name, one in named.items() if name is not None}
            return self.called(action.fields.get("function", NULL), [scope, *rest], arguments)

        try:
            return self.machine.tried(partial(self.bounded, body, action.location))
        finally:
            self.context = before

    def bounded(self, body: Callable[[], Value], location: Location) -> list[Action]:
        """Return the actions that a value stands for; none if it cannot be found within the bounds."""
        before, self.location = self.location, location
        try:
            return list(self.actions(body(), location))
        except Halt:
            self.note(LaunchProblemKind.LIMIT, _TOO_MUCH, location)
        except RecursionError:
            self.note(LaunchProblemKind.LIMIT, "the file is nested too deeply to be read", location)
        finally:
            self.location = before
        return []

    # Problems

    def unresolved(self, reason: str, location: Location) -> None:
        """Note once that something cannot be known."""
        self.note(LaunchProblemKind.UNRESOLVED, reason, location)

    def note(self, kind: LaunchProblemKind, message: str, location: Location) -> None:
        """Note a problem once; of the body of an `OpaqueFunction`, where it is executed."""
        if self.context is not None:
            self.context.problem(kind, message, None, location)
            return
        problem = LaunchProblem(kind, message, location)
        if problem not in self.problems:
            self.problems.append(problem)


_ENTRIES: Final = ("generate_launch_description", "generate_test_description")


def read_python(
    files: Files,
    file: FilePath,
    text: bytes,
    problems: list[LaunchProblem],
    environment: Mapping[str, str | None] = _NO_VARIABLES,
) -> tuple[Items[Action], Mapping[str, str | None]]:
    """Return the actions that a launch file describes, and the variables of the `environment` that they depend on.

    Errors and unknown parts are added to `problems`. Bodies of `OpaqueFunction`s are read when their actions are
    executed, and may add problems then.
    """
    reading = Reading(files, file, problems, environment)
    return _actions(reading, parse(file, text)), reading.variables


def _actions(reading: Reading, unit: PythonUnit) -> Items[Action]:
    file = reading.file
    if unit.error is not None:
        reading.note(LaunchProblemKind.MALFORMED, "it is not valid Python", reading.at(file, unit.error))
        return []
    names = [child for child in unit.root.named_children if child.type == "function_definition"]
    lines = (
        int(node.start_point[0]) + 1
        for node in names
        if (name := node.child_by_field_name("name")) is not None and (name.text or b"").decode() in _ENTRIES
    )
    location = reading.at(file, next(lines, 1))
    return reading.bounded(lambda: _described(reading, unit), location)


def _described(reading: Reading, unit: PythonUnit) -> Value:
    """Return the result of the file's function."""
    module = reading.language.module(unit)
    function = next((module.fields[name] for name in _ENTRIES if name in module.fields), None)
    if function is None:
        if any(one.type != "comment" for one in unit.root.named_children):  # not commented out as a whole
            message = f"the file has no function `{_ENTRIES[0]}`"
            reading.note(LaunchProblemKind.MALFORMED, message, reading.location)
        return NULL
    if not isinstance(function, Closure | TypeValue):
        return Unknown(f"`{_ENTRIES[0]}` is not a function that can be read")
    described = reading.called(function, [])
    test = isinstance(described, Sequence) and _ENTRIES[1] in module.fields and described.items
    return described.items[0] if test and isinstance(described, Sequence) else described
