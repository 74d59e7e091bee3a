"""One call of a function that the reader knows: its arguments and where they stand."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kg.extract.launch.expressions.texts import to_text, written

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.extract.launch.expressions.evaluate import Evaluator
    from kg.extract.launch.expressions.values import Frame, Text, Value
    from kg.facts import Location

__all__ = ["Call"]


@dataclass(frozen=True, slots=True)
class Call:
    """A call of the function of the full name `path`, at the expression `node`, with evaluated arguments."""

    machine: Evaluator
    path: str
    node: ast.expr
    frame: Frame
    args: list[Value]
    kwargs: dict[str, Value]

    @property
    def location(self) -> Location:
        """Where the call stands."""
        return self.machine.location(self.node, self.frame)

    def has(self, name: str, position: int | None = None) -> bool:
        """Tell whether an argument is given and is not None."""
        return self.value(name, position) is not None

    def value(self, name: str, position: int | None = None, default: Value = None) -> Value:
        """Return an argument by name or position."""
        if name in self.kwargs:
            return self.kwargs[name]
        return self.args[position] if position is not None and position < len(self.args) else default

    def first(self, *names: str) -> Value:
        """Return the argument given by one of several names; None where there is none."""
        return next((self.kwargs[name] for name in names if self.kwargs.get(name) is not None), None)

    def text(self, name: str, position: int | None = None) -> Text | None:
        """Return an argument as a text; None where it is not given."""
        value = self.value(name, position)
        return None if value is None else to_text(value)

    def expression(self, name: str, position: int | None = None) -> ast.expr | None:
        """Return the expression of an argument; None where it is not written at the call itself."""
        if not isinstance(self.node, ast.Call):
            return None
        found = next((keyword.value for keyword in self.node.keywords if keyword.arg == name), None)
        if found is None and position is not None and position < len(self.node.args):
            return self.node.args[position]
        return found

    def place(self, name: str, position: int | None = None) -> Location:
        """Return where an argument stands; the call itself where that is not known."""
        found = self.expression(name, position)
        return self.machine.location(found, self.frame) if found is not None else self.location

    def words(self, name: str, position: int | None = None) -> str:
        """Return an argument in the words of the file."""
        return written(self.expression(name, position) or self.node)

    def again(self, function: Value, args: Sequence[Value]) -> Value:
        """Return what another function gives that is called from here."""
        return self.machine.invoke(function, args, {}, self.node, self.frame)
