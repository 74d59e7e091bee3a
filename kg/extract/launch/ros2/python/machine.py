"""What all parts of the interpreter share: the files, the bounds of its work, and the conditions it stands under."""

from __future__ import annotations

import ast
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.context import place
from kg.extract.launch.ros2.python.values import Items, Table, Unknown, guard
from kg.facts import LaunchProblem, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from kg.corpus.files import FilePath
    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action, Condition
    from kg.extract.launch.ros2.context import Context
    from kg.extract.launch.ros2.python.values import Module, Scope, Value
    from kg.facts import Location

__all__ = ["MAX_ITEMS", "MAX_TEXT", "Break", "Continue", "Frame", "Halt", "Machine", "Raised", "Return", "Signal"]

MAX_ITEMS: Final = 5_000
"""So many items a list may have."""
MAX_TEXT: Final = 200_000
"""So many characters a text may have that operations make."""
_MAX_STEPS: Final = 60_000
"""A hundred times what the largest launch file of Nav2 takes."""
_ITEMS_OF_A_STEP: Final = 20


class Halt(Exception):  # noqa: N818 - the end of the work, no error of anybody
    """The bound of the work is reached."""


@dataclass(frozen=True, slots=True)
class Return:
    """A function ends with a value."""

    value: Value


class Break:
    """A loop ends."""


class Continue:
    """The next iteration begins."""


class Raised:
    """An exception is raised."""


Signal = Return | Break | Continue | Raised | None
"""How a block of statements ends; None: its end was reached."""


@dataclass(slots=True, eq=False)
class Frame:
    """One run of a module, class body or function; `pending` are values that it may already have returned."""

    module: Module
    scope: Scope
    pending: list[tuple[Condition | None, Value]] = field(default_factory=list)


class Machine(ABC):
    """The state of one reading; `context` is that of the `OpaqueFunction` that is read now."""

    def __init__(self, files: Files, problems: list[LaunchProblem]) -> None:
        self.files = files
        self.problems = problems
        self.context: Context | None = None
        self.guards: list[Condition] = []
        self.steps = 0
        self.depth = 0
        self.kept: dict[int, tuple[Items | Table, list[Value] | Table]] = {}

    @abstractmethod
    def evaluate(self, node: ast.expr, frame: Frame) -> Value:
        """Return the value of an expression."""

    @abstractmethod
    def run_block(self, body: Sequence[ast.stmt], frame: Frame) -> Signal:
        """Run statements."""

    @abstractmethod
    def assign(self, target: ast.expr, value: Value, frame: Frame) -> None:
        """Bind a target of an assignment or loop."""

    @abstractmethod
    def invoke(
        self, function: Value, args: Sequence[Value], kwargs: Mapping[str, Value], node: ast.expr, frame: Frame
    ) -> Value:
        """Return what a call gives; `node` is where it stands."""

    @abstractmethod
    def member_of_module(self, module: str, name: str, near: Module) -> Value:
        """Return a name of another module, as seen from the module `near`."""

    @abstractmethod
    def attribute(self, receiver: Value, name: str) -> Value:
        """Return an attribute of a value."""

    @abstractmethod
    def module_named(self, dotted: str, near: Module) -> Value:
        """Return a module as imported in the module `near`."""

    @abstractmethod
    def star(self, module: str, near: Module) -> dict[str, Value]:
        """Return all names that a module exports."""

    @abstractmethod
    def within(self, context: Context, body: Callable[[], Value], location: Location) -> Sequence[Action]:
        """Return the actions of an `OpaqueFunction`, whose body is read in the context of the moment."""

    def restore(self) -> None:
        """Give the containers back what was in them before they were changed."""
        for container, before in self.kept.values():
            if isinstance(container, Items) and isinstance(before, list):
                container[:] = before
            elif isinstance(container, Table) and isinstance(before, Table):
                container.clear()
                container.update(before)
        self.kept.clear()

    def step(self) -> None:
        """Count a step of the work.

        Raises:
            Halt: when there were too many.
        """
        self.steps += 1
        if self.steps > _MAX_STEPS:
            raise Halt

    def weigh(self, value: Value) -> Value:
        """Return a value that was made at once, having counted the steps that its length is worth.

        Raises:
            Halt: when there were too many.
        """
        if isinstance(value, Items | tuple | str):
            self.steps += len(value) // _ITEMS_OF_A_STEP
            self.step()
        return value

    def location(self, node: ast.AST, frame: Frame) -> Location:
        """Return where a node stands."""
        return self.at(frame.module.file, getattr(node, "lineno", 1))

    def at(self, file: FilePath, line: int) -> Location:
        """Return a line of a file as a location."""
        return place(self.files, file, line)

    def items(self, values: Iterable[Value] = ()) -> Items:
        """Return a list that is made now."""
        made = Items(values, tuple(self.guards))
        self.weigh(made)
        return made

    def table(self) -> Table:
        """Return a dictionary that is made now."""
        return Table(tuple(self.guards))

    def guarded(self, value: Value, guards: tuple[Condition, ...]) -> Value:
        """Return a value as an item of a list made under `guards`: with the conditions that hold now besides."""
        for condition in reversed(self.guards):
            if not any(condition is other for other in guards):
                value = guard(condition, value)
        return value

    def keep(self, container: Items | Table) -> None:
        """Remember a container before it changes, since the body of an `OpaqueFunction` may be read again."""
        if self.context is not None and id(container) not in self.kept:
            copied = list(container) if isinstance(container, Items) else container.copy()
            self.kept[id(container)] = container, copied

    def append(self, items: Items, values: Iterable[Value]) -> None:
        """Add values to the end of a list.

        Raises:
            Halt: when the list is too long.
        """
        self.keep(items)
        items.extend(self.guarded(value, items.guards) for value in values)
        if len(items) > MAX_ITEMS:
            raise Halt

    def unresolved(self, reason: str, location: Location, subject: str | None = None) -> Unknown:
        """Note once that something cannot be known."""
        self.note(LaunchProblemKind.UNRESOLVED, reason, location, subject)
        return Unknown(reason)

    def note(self, kind: LaunchProblemKind, message: str, location: Location, subject: str | None = None) -> None:
        """Note a problem once; of the body of an `OpaqueFunction`, where it is executed."""
        if self.context is not None:
            self.context.problem(kind, message, subject, location)
            return
        problem = LaunchProblem(kind, message, location, subject=subject)
        if problem not in self.problems:
            self.problems.append(problem)


def written(node: ast.AST | None) -> str:
    """Return a node in the words of the file, in one line."""
    return " ".join(ast.unparse(node).split())[:200] if node is not None else ""
