"""Units for numbers of behaviour trees, which have none: those of what they are compared with or added to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import msgspec

from kg.robot.programs.check import kinds_of
from kg.robot.programs.tree import Binary, Program, Unary, Written
from kg.robot.programs.units import UNITS, described

if TYPE_CHECKING:
    from kg.robot.capability import Capabilities
    from kg.robot.programs.kinds import Kinds
    from kg.robot.programs.tree import Expression
    from kg.robot.programs.units import Dimension

__all__ = ["with_units"]

_ALIKE: Final = frozenset({"<", "<=", "=", "!=", ">=", ">", "+", "-"})


def with_units(program: Program, capabilities: Capabilities) -> Program:
    """Return a program in which plain numbers have the base unit of their neighbour."""
    kinds = kinds_of(program, capabilities)

    def walk(part: Any) -> Any:
        if isinstance(part, list | tuple):
            return [walk(one) for one in part]
        if not isinstance(part, dict):
            return part
        made = {key: walk(value) for key, value in part.items()}
        if part.get("expression") == "binary" and part["operator"] in _ALIKE:
            expression = _united(msgspec.convert(made, Binary), kinds)
            return msgspec.to_builtins(expression)
        return made

    return msgspec.convert(walk(msgspec.to_builtins(program)), Program)


def _united(expression: Binary, kinds: Kinds) -> Binary:
    left, right = kinds.of(expression.left, ""), kinds.of(expression.right, "")
    if left.name != "number" or right.name != "number" or bool(left.dimension) == bool(right.dimension):
        return expression
    dimension = left.dimension or right.dimension
    return msgspec.structs.replace(
        expression, left=_in(expression.left, dimension), right=_in(expression.right, dimension)
    )


def _in(expression: Expression, dimension: Dimension) -> Expression:
    unit = described(dimension)
    match expression:
        case Written(value=value, unit=None) if unit in UNITS and value and not isinstance(value, bool | str):
            return Written(value=value, unit=unit)
        case Unary(operator="-" | "absolute"):
            return msgspec.structs.replace(expression, of=_in(expression.of, dimension))
    return expression
