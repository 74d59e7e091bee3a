"""What all parts of the evaluator share: the program, the bounds of its work, what it remembers, and each other."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Final

from kg.extract.values import Unknown

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from tree_sitter import Node

    from kg.extract.python.entities import (
        Alternatives,
        ArgumentsParsed,
        Choice,
        Frame,
        FunctionRef,
        Instance,
        Thing,
        Thunk,
    )
    from kg.extract.python.program import Program
    from kg.extract.python.unit import Binding, Scope, Unit

__all__ = ["COMPUTED", "Core"]

COMPUTED: Final = Unknown("it is computed when the program runs")
_STEPS: Final = 500


class Core(ABC):
    """The parts of the evaluator see one another through this."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.active: set[tuple[int, int]] = set()
        self.steps = 0
        self.limit = _STEPS
        self.cuts = 0
        self.memory: dict[tuple[tuple[int, int], frozenset[tuple[tuple[int, int], int]]], Alternatives] = {}
        self._decided: dict[tuple[int, int], bool | None] = {}
        self.main: Unit | None = None
        self._setters: dict[int, dict[str, list[Scope]]] = {}

    @abstractmethod
    def evaluate(self, node: Node, frame: Frame, choice: Choice) -> Alternatives:
        """Return what an expression can be."""

    @abstractmethod
    def thunk(self, thunk: Thunk, choice: Choice) -> Alternatives:
        """Return what an argument can be."""

    @abstractmethod
    def combined(
        self, thunks: Iterable[Thunk | Node], frame: Frame, choice: Choice
    ) -> list[tuple[list[Thing], Choice]]:
        """Return the combinations of the alternatives of several expressions."""

    @abstractmethod
    def frames_of(self, scope: Scope, instance: Instance | None) -> list[Frame]:
        """Return the known runs of a function, an open one when none is known."""

    @abstractmethod
    def returned(self, function: FunctionRef, call: Node | None, frame: Frame, choice: Choice) -> Alternatives:
        """Return what a call of a function of the build gives."""

    @abstractmethod
    def option(self, parsed: ArgumentsParsed, name: str) -> Thing:
        """Return the default of a command line option."""

    @abstractmethod
    def open_instance(self, klass: Scope) -> Instance:
        """Return an object of a class that was made nobody knows where."""

    @abstractmethod
    def bound(
        self, bindings: Sequence[Binding], position: int, frame: Frame, choice: Choice
    ) -> tuple[Alternatives, bool]:
        """Return what bindings that reach a place give, and whether one of them must hold there."""

    @abstractmethod
    def binding(self, binding: Binding, frame: Frame, choice: Choice) -> Alternatives:
        """Return what one binding gives to its name."""
