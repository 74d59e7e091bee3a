"""Expressions of programs as Python; numbers are in base units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.robot.programs.tree import Binary, Position, Read, Unary, Variable, Written
from kg.robot.programs.units import described, unit_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.programs.kinds import Kinds
    from kg.robot.programs.tree import Expression

__all__ = ["Expressions", "number"]

_LEVELS: Final = {"or": 0, "and": 1, "not": 2, "+": 4, "-": 4, "*": 5, "/": 5}
_COMPARISON: Final = 3
_SIGN: Final = 6
_ATOM: Final = 7
_SIGNS: Final = {"=": "==", "!=": "!="}


def number(value: Written) -> str:
    """Return a number as Python, in base units."""
    unit = unit_of(value.unit)
    if isinstance(value.value, bool | str):
        return repr(value.value)
    if unit.symbol.startswith("deg") and unit.symbol != "degC":
        return f"math.radians({value.value:g})"
    return repr(float(f"{value.value * unit.factor:.15g}"))


class Expressions:
    """Writes expressions, given how variables and what is sensed are written."""

    def __init__(self, kinds: Kinds, variable: Callable[[str], str], read: Callable[[Read], str]) -> None:
        """Keep what is asked for names."""
        self._kinds = kinds
        self._variable = variable
        self._read = read

    def of(self, expression: Expression, least: int = 0) -> str:
        """Return an expression, in parentheses when it binds less than `least`."""
        match expression:
            case Written():
                shown, level = self._written(expression)
            case Variable():
                shown, level = self._variable(expression.name), _ATOM
            case Read():
                shown, level = self._read(expression), _ATOM
            case Unary():
                shown, level = self._unary(expression)
            case Binary():
                shown, level = self._binary(expression)
            case Position():
                parts = (f"{name}={self.of(one)}" for name, one in expression.parts().items())
                shown, level = f"Place({', '.join(parts)})", _ATOM
        return f"({shown})" if level < least else shown

    @staticmethod
    def _written(value: Written) -> tuple[str, int]:
        if isinstance(value.value, str):
            return _quoted(value.value), _ATOM
        shown = number(value)
        return shown, _SIGN if shown.startswith("-") else _ATOM

    def _unary(self, expression: Unary) -> tuple[str, int]:
        inner = self.of(expression.of)
        match expression.operator:
            case "not":
                return f"not {self.of(expression.of, _LEVELS['not'])}", _LEVELS["not"]
            case "-":
                return f"-{self.of(expression.of, _SIGN + 1)}", _SIGN
            case "absolute":
                return f"abs({inner})", _ATOM
            case "count":
                return f"len({inner})", _ATOM
            case "round":
                return f"math.floor({self.of(expression.of, _LEVELS['+'])} + 0.5)", _ATOM

    def _binary(self, expression: Binary) -> tuple[str, int]:
        operator = expression.operator
        if operator == "contains":
            return (
                f"{self.of(expression.right, _COMPARISON + 1)} in {self.of(expression.left, _COMPARISON + 1)}",
                _COMPARISON,
            )
        if operator == "+" and self._kinds.of(expression, "").name == "text":
            return self.text(expression), _ATOM
        level = _LEVELS.get(operator, _COMPARISON)
        left = self.of(expression.left, level + (level == _COMPARISON))
        return f"{left} {_SIGNS.get(operator, operator)} {self.of(expression.right, level + 1)}", level

    def text(self, expression: Expression) -> str:
        """Return the expression for a value as people read it: numbers have their unit behind them."""
        if isinstance(expression, Written) and isinstance(expression.value, str):
            return _quoted(expression.value)
        parts = [self._part(one) for one in self._joined(expression)]
        if any("\\" in inside for _, inside in parts) or any('"' in inside for _, inside in parts):
            return " + ".join(whole for whole, _ in parts)
        return 'f"' + "".join(inside for _, inside in parts).replace("\n", "\\n") + '"'

    def _joined(self, expression: Expression) -> list[Expression]:
        """Return the parts of a text that is put together."""
        text = self._kinds.of(expression, "").name == "text"
        if text and isinstance(expression, Binary) and expression.operator == "+":
            return [*self._joined(expression.left), *self._joined(expression.right)]
        return [expression]

    def _part(self, expression: Expression) -> tuple[str, str]:
        """Return a part of a text as an expression of its own, and as it stands in an f-string."""
        if isinstance(expression, Written) and isinstance(expression.value, str):
            return _quoted(expression.value), expression.value.replace("{", "{{").replace("}", "}}")
        shown, kind = self.of(expression), self._kinds.of(expression, "")
        if kind.name == "number":
            unit = f" {described(kind.dimension)}" if kind.dimension else ""
            return f"f'{{{shown}:.6g}}{unit}'", f"{{{shown}:.6g}}{unit}"
        return (shown if kind.name == "text" else f"str({shown})"), f"{{{shown}}}"


def _quoted(text: str) -> str:
    shown = repr(text)
    return shown if shown[0] == '"' or '"' in shown else f'"{shown[1:-1]}"'
