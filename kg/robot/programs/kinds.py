"""Static typing of expressions: kinds of values, dimensions, and mismatches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, TypeAlias

from kg.errors import RobotError
from kg.robot.programs import values
from kg.robot.programs.tree import Binary, Expression, Position, Read, Unary, Variable, Written
from kg.robot.programs.units import PLAIN, UNITS, Dimension, described, divided, multiplied, unit_of
from kg.robot.programs.write import written
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.robot.capability import Parameter
    from kg.robot.programs.names import CapabilityIndex

Report: TypeAlias = "Callable[[str, RobotError], None]"
"""Receives the path of a part and its error."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of value, with the dimension of a number. `any` is unknown before the run."""

    name: Literal["number", "boolean", "text", "list", "place", "any"]
    dimension: Dimension = PLAIN

    def __str__(self) -> str:
        if self.name != "number":
            return _IN_WORDS.get(self.name, "anything")
        return f"a number in {described(self.dimension)}" if self.dimension else "a plain number"


_IN_WORDS: Final = {"boolean": "true or false", "text": "a text", "list": "a list", "place": "a place"}
ANY: Final = Kind("any")
BOOLEAN: Final = Kind("boolean")
PLACE: Final = Kind("place")
TEXT: Final = Kind("text")
TIME: Final = Kind("number", (("s", 1),))
_NUMBER: Final = Kind("number")


def of_parameter(parameter: Parameter) -> Kind:
    """Return the kind of a parameter's values."""
    if parameter.type in {"number", "integer"}:
        return Kind("number", unit_of(parameter.unit).dimension)
    return Kind("boolean" if parameter.type == "boolean" else "text" if parameter.type == "text" else "list")


def constant(expression: Expression | None) -> values.Quantity | None:
    """Return the value of a constant expression; None for others and for those without a value."""
    try:
        match expression:
            case Written():
                return values.written(expression)
            case Unary():
                of = constant(expression.of)
                return of and values.unary(expression.operator, of)
            case Binary() if expression.operator not in {"and", "or"}:
                left, right = constant(expression.left), constant(expression.right)
                return values.binary(expression.operator, left, right) if left and right else None
            case Position():
                parts = {name: constant(one) for name, one in expression.parts().items()}
                return values.place({name: one for name, one in parts.items() if one}) if all(parts.values()) else None
    except RobotError:
        return None
    return None


class Kinds:
    """The kinds of expressions, given those of variables; errors are reported at their path."""

    def __init__(self, index: CapabilityIndex, variables: Mapping[str, Kind], report: Report) -> None:
        self._index = index
        self._variables = variables
        self._report = report

    def of(self, expression: Expression, path: str) -> Kind:
        """Return the kind of an expression; `any` after reporting an error in it."""
        match expression:
            case Written(value=bool()):
                return BOOLEAN
            case Written(value=str()):
                return TEXT
            case Written():
                return Kind("number", unit_of(expression.unit).dimension)
            case Variable():
                return self._of_variable(expression.name, path)
            case Read():
                try:
                    capability = self._index.read(expression.capability)
                    return of_parameter(self._index.parameter(capability, expression.parameter))
                except RobotError as error:
                    self._report(path, error)
                    return ANY
            case Unary():
                return self._of_unary(expression, path)
            case Binary():
                return self._of_binary(expression, path)
            case Position():
                return self._of_place(expression, path)

    def _wrong(self, path: str, message: str, hint: str | None = None, code: str = "KG833") -> Kind:
        self._report(path, RobotError(code, message, hint=hint))
        return ANY

    def _of_variable(self, name: str, path: str) -> Kind:
        kind = self._variables.get(name)
        if kind is None:
            hint = (
                did_you_mean(name, self._variables)
                or f"Give it one before: `set {written(Variable(name=name))} to ...`; put text in quotes."
            )
            return self._wrong(path, f"the variable `{name}` has no value here", hint, "KG836")
        return kind

    def _of_place(self, place: Position, path: str) -> Kind:
        for name, part in place.parts().items():
            wanted = Kind("number", unit_of(values.PLACES[name]).dimension)
            kind = self.of(part, f"{path}/{name}")
            if kind not in {ANY, wanted, _NUMBER}:
                self._wrong(f"{path}/{name}", f"the {name} of a place must be {wanted}, but this is {kind}")
        return PLACE

    def _of_unary(self, expression: Unary, path: str) -> Kind:
        kind = self.of(expression.of, f"{path}/of")
        wanted = {"not": ("boolean",), "count": ("list", "text")}.get(expression.operator, ("number",))
        if kind != ANY and kind.name not in wanted:
            return self._wrong(f"{path}/of", f"`{expression.operator}` does not go with {kind}")
        return {"not": BOOLEAN, "count": _NUMBER}.get(expression.operator, kind)

    def _of_binary(self, expression: Binary, path: str) -> Kind:
        left = self.of(expression.left, f"{path}/left")
        right = self.of(expression.right, f"{path}/right")
        operator = expression.operator
        if operator in {"and", "or"}:
            for side, kind in (("left", left), ("right", right)):
                if kind not in {ANY, BOOLEAN}:
                    self._wrong(f"{path}/{side}", f"`{operator}` joins conditions, but this is {kind}")
            return BOOLEAN
        if operator == "contains":
            if left.name not in {"any", "list", "text"}:
                self._wrong(f"{path}/left", f"only a list or a text contains something, but this is {left}")
            return BOOLEAN
        if operator == "+" and TEXT in {left, right}:
            return TEXT
        if operator in {"=", "!="}:
            if ANY not in {left, right} and left.name != right.name:
                self._wrong(path, f"{left} never equals {right}")
            elif left.name == "number" == right.name:
                self._same(expression, left, right, path)
            return BOOLEAN
        return self._of_numbers(expression, left, right, path)

    def _of_numbers(self, expression: Binary, left: Kind, right: Kind, path: str) -> Kind:
        ordering = expression.operator in {"<", "<=", ">", ">="}
        sound = True
        for side, kind in (("left", left), ("right", right)):
            if kind.name not in {"any", "number"}:
                self._wrong(f"{path}/{side}", f"`{expression.operator}` needs numbers, but this is {kind}")
                sound = False
        if not sound or ANY in {left, right}:
            return BOOLEAN if ordering else ANY
        if expression.operator == "*":
            return Kind("number", multiplied(left.dimension, right.dimension))
        if expression.operator == "/":
            zero = constant(expression.right)
            if zero is not None and zero.value == 0:
                return self._wrong(f"{path}/right", "division by zero")
            return Kind("number", divided(left.dimension, right.dimension))
        kind = self._same(expression, left, right, path)
        return BOOLEAN if ordering else kind

    def _same(self, expression: Binary, left: Kind, right: Kind, path: str) -> Kind:
        if left == right or _zero(expression.right):
            return left
        if _zero(expression.left):
            return right
        hint = None
        for kind, other in ((left, expression.right), (right, expression.left)):
            if isinstance(other, Written) and other.unit is None and kind.dimension:
                units = [symbol for symbol, unit in UNITS.items() if unit.dimension == kind.dimension]
                hint = f"Write a unit after {other.value:g}: {', '.join(units) or described(kind.dimension)}."
        return self._wrong(path, f"`{expression.operator}` does not go with {left} and {right}", hint)


def _zero(expression: Expression) -> bool:
    return isinstance(expression, Written) and expression.value == 0 and not isinstance(expression.value, bool)
