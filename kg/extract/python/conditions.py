"""Conditions as far as they are certain: what `if` rests on arguments, defaults and constants that never change."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.extract.python.core import Core
from kg.extract.python.entities import (
    Nothing,
    Thunk,
    plain,
)
from kg.extract.python.syntax import code, strip_parentheses
from kg.extract.values import Number, Text, Truth

if TYPE_CHECKING:
    from collections.abc import Iterable

    from tree_sitter import Node

    from kg.extract.python.entities import Choice, Frame, Thing

__all__ = ["Conditions"]

_LITERALS: Final = frozenset({"string", "integer", "float", "true", "false", "none"})
_MAX_STEPS_TO_LITERAL: Final = 8


class Conditions(Core):
    """The part of the evaluator that decides conditions."""

    def possible(self, arms: Iterable[tuple[int, int]], frame: Frame, choice: Choice) -> bool:
        """Tell whether branches can be taken, as far as their conditions rest on arguments that are known."""
        for start, number in arms:
            node = frame.scope.unit.ifs.get(start)
            condition = node.child_by_field_name("condition") if node is not None else None
            if condition is None:
                continue
            key = (condition.id, frame.id)
            if key not in self._decided:
                self._decided[key] = None
                self._decided[key] = self.decide(condition, frame, choice)
            decided = self._decided[key]
            if decided is not None and decided != (number == 0):
                return False
        return True

    def decide(self, condition: Node, frame: Frame, choice: Choice) -> bool | None:
        """Return the truth of a condition about names that have one value in this frame; None when not known."""
        condition, negated = strip_parentheses(condition), False
        while condition.type == "not_operator":
            inner = condition.child_by_field_name("argument")
            if inner is None:
                return None
            condition, negated = strip_parentheses(inner), not negated
        if condition.type == "comparison_operator":
            decided = self.compare(condition, frame, choice)
        else:
            decided = _truthiness(self.certain(condition, frame, choice))
        return None if decided is None else decided is not negated

    def compare(self, node: Node, frame: Frame, choice: Choice) -> bool | None:
        """Return the truth of `a == b`, `a != b`, `a is b`, `a is not b`."""
        operator = " ".join(child.type for child in node.children if not child.is_named)
        if node.named_child_count != 2 or operator not in ("==", "!=", "is", "is not", "is  not"):  # noqa: PLR2004 - two sides
            return None
        left, right = (self.certain(side, frame, choice) for side in node.named_children)
        if left is None or right is None:
            return None
        if isinstance(left, Nothing) or isinstance(right, Nothing):
            same = isinstance(left, Nothing) and isinstance(right, Nothing)
        elif plain(left) is None or plain(right) is None:
            return None
        else:
            same = plain(left) == plain(right)
        return same if operator in ("==", "is") else not same

    def certain(self, node: Node, frame: Frame, choice: Choice) -> Thing | None:
        """Return the one value of a literal, or of a name that stands for one; None for anything that may change."""
        for _ in range(_MAX_STEPS_TO_LITERAL):
            if node.type != "identifier":
                break
            if code(node) == "__name__":
                return Text.of("__main__" if frame.scope.unit is self.main else frame.scope.unit.file.path)
            thunk = self.only_value(code(node), frame)
            if thunk is None or thunk.node is None or thunk.frame is None:
                return None
            node, frame = thunk.node, thunk.frame
        return self.evaluate(node, frame, choice)[0][0] if node.type in _LITERALS else None

    def only_value(self, name: str, frame: Frame) -> Thunk | None:
        """Return the expression that gives a name its only value: an argument, a default or one assignment."""
        scope = frame.scope
        bindings = scope.bindings.get(name, ())
        if scope.kind == "function" and name in scope.parameters.positional:
            if bindings or frame.open:
                return None
            default = scope.parameters.defaults.get(name)
            around = frame.lexical or self.program.module_frame(scope.unit)
            return frame.arguments.get(name) or (Thunk(default, around) if default is not None else None)
        if not bindings and scope.kind != "module":
            module = self.program.module_frame(scope.unit)
            assigned_elsewhere = any(name in other.globals for other in scope.unit.scopes)
            return None if assigned_elsewhere else self.only_value(name, module)
        if len(bindings) != 1 or bindings[0].kind != "assign" or bindings[0].arms or bindings[0].path:
            return None
        return Thunk(bindings[0].value, frame)


def _truthiness(value: Thing | None) -> bool | None:
    if isinstance(value, Nothing):
        return False
    if isinstance(value, Text | Number | Truth):
        return bool(plain(value))
    return None
