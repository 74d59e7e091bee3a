"""What all parts of the interpreter of launch files share: the files, its problems, and how statements end."""

from __future__ import annotations

import ast
from abc import abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.corpus.files import FilePath
from kg.extract.launch.expressions.evaluate import Evaluator
from kg.extract.launch.expressions.values import Frame, Module, Table, Unknown, Value
from kg.extract.launch.ros2.context import place
from kg.facts import LaunchProblem, LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.extract.launch.files import Files
    from kg.extract.launch.ros2.actions import Action
    from kg.extract.launch.ros2.context import Context
    from kg.facts import Location

__all__ = ["Break", "Continue", "Machine", "Raised", "Return", "Signal"]


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


class Machine(Evaluator):
    """The state of one reading; `context` is that of the `OpaqueFunction` that is read now."""

    context: Context | None

    def __init__(self, files: Files, problems: list[LaunchProblem]) -> None:
        super().__init__()
        self.files = files
        self.problems = problems
        self.depth = 0

    @abstractmethod
    def run_block(self, body: Sequence[ast.stmt], frame: Frame) -> Signal:
        """Run statements."""

    @abstractmethod
    def member_of_module(self, module: str, name: str, near: Module) -> Value:
        """Return a name of another module, as seen from the module `near`."""

    @abstractmethod
    def module_named(self, dotted: str, near: Module) -> Value:
        """Return a module as imported in the module `near`."""

    @abstractmethod
    def star(self, module: str, near: Module) -> dict[str, Value]:
        """Return all names that a module exports."""

    @abstractmethod
    def within(self, context: Context, body: Callable[[], Value], location: Location) -> Sequence[Action]:
        """Return the actions of an `OpaqueFunction`, whose body is read in the context of the moment."""

    def location(self, node: ast.AST, frame: Frame) -> Location:
        """Return where a node stands."""
        return self.at(frame.module.file, getattr(node, "lineno", 1))

    def at(self, file: FilePath, line: int) -> Location:
        """Return a line of a file as a location."""
        return place(self.files, file, line)

    def made(self, table: Table) -> Value:
        """Return an entry that a `defaultdict` makes."""
        module = Module(FilePath("", ""), "")
        return self.invoke(table.factory, [], {}, ast.Constant(None), Frame(module, module.scope))

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
