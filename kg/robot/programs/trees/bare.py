"""Programs as behaviour trees say them: without units, with the names of the ontology.

Numbers are in base units, arguments in the units of their parameters, and variables have names that scripts allow.
"""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING, Final

import msgspec

from kg.robot.programs.kinds import constant
from kg.robot.programs.names import takes_place
from kg.robot.programs.tree import Binary, Do, For, Position, Read, Set, Unary, Variable, Written, expressions_of
from kg.robot.programs.units import unit_of

if TYPE_CHECKING:
    from kg.robot.capability import Capability
    from kg.robot.programs.kinds import Kinds
    from kg.robot.programs.names import Known
    from kg.robot.programs.tree import Expression, Statement

__all__ = ["COUNT", "MOST", "OWN", "Bare", "counted", "identifier", "reading"]


OWN: Final = "kg_"
"""Beginning of the names that an exported tree gives to values of its own."""
COUNT: Final = "count_of_"
"""Beginning of the names of ports that give how many elements a list has."""
_WORD: Final = re.compile(r"[^A-Za-z0-9_]")


def identifier(name: str) -> str:
    """Return the name of a variable as scripts allow it."""
    made = _WORD.sub("_", name)
    return made if made[:1].isalpha() or made[:1] == "_" else f"_{made}"


def reading(capability: str, parameter: str) -> str:
    """Return the name under which a tree keeps the value that was just read."""
    return f"{capability}_{parameter}"


class Bare:
    """Rewrites statements and expressions; RobotError KG832, KG834 for capabilities that are unknown."""

    def __init__(self, known: Known, kinds: Kinds) -> None:
        """`kinds` are those of the program, whose variables are known."""
        self._known = known
        self._kinds = kinds

    def head(self, statement: Statement) -> Statement:
        """Return a statement with its own expressions bare, not those of statements within it, without id and comment.

        A time is in seconds, the numbers of a loop are those that it counts.
        """
        made = msgspec.structs.replace(statement, id=None, comment="")
        if isinstance(statement, Do):
            capability = self._known.write(statement.capability)
            arguments = {
                name if takes_place(capability, name) else self._known.parameter(capability, name).name: self._argument(
                    capability, name, value
                )
                for name, value in statement.arguments.items()
            }
            made = msgspec.structs.replace(made, capability=capability.name, arguments=arguments)
        if isinstance(statement, Set | For):
            made = msgspec.structs.replace(made, variable=identifier(statement.variable))
        own = dict(expressions_of(made))
        given = {name: self.expression(one) for name, one in own.items() if "/" not in name}
        given |= {name: _rounded(given[name]) for name in ("seconds", "within") if name in given}
        return msgspec.structs.replace(made, **given)

    def _argument(self, capability: Capability, name: str, value: Expression) -> Expression:
        if takes_place(capability, name):
            return self.expression(value)
        parameter = self._known.parameter(capability, name)
        unit = unit_of(parameter.unit)
        made = self.expression(value)
        if self._kinds.of(value, "").dimension != unit.dimension or unit.factor == 1:
            return made
        return _folded(Binary(operator="/", left=made, right=Written(value=unit.factor)))

    def expression(self, expression: Expression) -> Expression:
        """Return an expression in base units; a place in metres and radians."""
        match expression:
            case Written():
                return self._written(expression)
            case Variable():
                return Variable(name=identifier(expression.name))
            case Read():
                return self._read(expression)
            case Unary():
                return _folded(Unary(operator=expression.operator, of=self.expression(expression.of)))
            case Binary():
                left, right = self.expression(expression.left), self.expression(expression.right)
                return _folded(Binary(operator=expression.operator, left=left, right=right))
            case Position():
                return Position(**{name: self.expression(one) for name, one in expression.parts().items()})

    @staticmethod
    def _written(value: Written) -> Written:
        if isinstance(value.value, bool | str):
            return value
        return Written(value=float(value.value) * unit_of(value.unit).factor)

    def _read(self, read: Read) -> Expression:
        capability = self._known.read(read.capability)
        parameter = self._known.parameter(capability, read.parameter)
        factor = unit_of(parameter.unit).factor
        made = Read(capability=capability.name, parameter=parameter.name)
        return made if factor == 1 else Binary(operator="*", left=made, right=Written(value=factor))


def _rounded(seconds: Expression) -> Expression:
    """Return a time without what calculations in milliseconds add behind the ninth digit."""
    value = seconds.value if isinstance(seconds, Written) else None
    numeric = value is not None and not isinstance(value, bool | str)
    return Written(value=round(value, 9)) if numeric and value is not None else seconds  # type: ignore[arg-type] # a number


def _folded(expression: Expression) -> Expression:
    """Return the number that an expression always is, else the expression."""
    always = constant(expression)
    return Written(value=always.value) if always and always.number and isfinite(always.value) else expression


MOST: Final = 1000
"""How many numbers a tree may list."""
_SLACK: Final = 1e-9
_DIGITS: Final = 12
"""Digits behind the point that a tree lists: 0.1 + 0.2 is 0.3 there."""


def counted(loop: For) -> list[float] | None:
    """Return the numbers that a bare loop counts, None where they depend on the run, are endless or too many."""
    start, end = constant(loop.start), constant(loop.end)
    step = constant(loop.step)
    if start is None or end is None or (loop.step is not None and step is None):
        return None
    width = 1.0 if step is None else abs(step.value)
    steps = abs(end.value - start.value) / width if width else float("inf")
    if not isfinite(steps) or steps >= MOST:
        return None
    way = width if end.value >= start.value else -width
    return [round(float(start.value + number * way), _DIGITS) for number in range(int(steps + _SLACK) + 1)]
