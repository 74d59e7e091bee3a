"""Values at run time: numbers in base units with their dimension, texts, truth values, lists."""

from __future__ import annotations

import math
import operator as operators
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from kg.errors import RobotError
from kg.robot.programs.units import PLAIN, Dimension, described, divided, multiplied, unit_of

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.robot.capability import Parameter
    from kg.robot.programs.tree import Written

PLACES: Final = MappingProxyType({"x": "m", "y": "m", "z": "m", "heading": "rad"})
"""The units of the components of a place."""
_TIME: Final[Dimension] = (("s", 1),)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A value; a number is in base units (m, s, rad, kg, ...) and `dimension` is its dimension.

    A place is a dict of numbers, in the units of `PLACES`.

    None is a value that the robot does not provide, such as the nearest tag when none is visible: it equals nothing
    else, and no other comparison with it holds.
    """

    value: Any
    dimension: Dimension = PLAIN

    @property
    def number(self) -> bool:
        """Whether it is a number."""
        return isinstance(self.value, int | float) and not isinstance(self.value, bool)


def written(value: Written) -> Quantity:
    """Return the value of a literal."""
    if isinstance(value.value, bool | str):
        return Quantity(value.value)
    unit = unit_of(value.unit)
    return Quantity(value.value * unit.factor, unit.dimension)


def place(components: Mapping[str, Quantity]) -> Quantity:
    """Return a place from its components; RobotError KG833 for one that is not a length or an angle."""
    numbers = {}
    for name, quantity in components.items():
        wanted = unit_of(PLACES[name]).dimension
        if not quantity.number or quantity.dimension not in {PLAIN, wanted}:
            raise RobotError(
                "KG833", f"the {name} of a place must be in {described(wanted)}, but this is {shown(quantity)}"
            )
        numbers[name] = float(quantity.value)
    return Quantity(numbers)


def of_place(quantity: Quantity) -> dict[str, Quantity]:
    """Return the components of a place; RobotError KG833 for other values."""
    if not isinstance(quantity.value, dict):
        raise RobotError("KG833", f"{shown(quantity)} is not a place")
    return {name: Quantity(value, unit_of(PLACES[name]).dimension) for name, value in quantity.value.items()}


def of_parameter(parameter: Parameter, value: Any) -> Quantity:
    """Return a value reported by a robot, in the parameter's unit."""
    unit = unit_of(parameter.unit)
    if isinstance(value, int | float) and not isinstance(value, bool):
        return Quantity(value * unit.factor, unit.dimension)
    return Quantity(value)


def for_parameter(parameter: Parameter, quantity: Quantity) -> Any:
    """Return a value in the unit of a parameter; a plain number is taken to be in it already.

    Raises:
        RobotError: KG833 another kind or dimension.
    """
    unit = unit_of(parameter.unit)
    if parameter.type in {"number", "integer"} and not quantity.number:
        raise RobotError("KG833", f"`{parameter.name}` must be a number, but this is {shown(quantity)}")
    if not quantity.number or quantity.dimension == PLAIN != unit.dimension:
        return quantity.value
    if quantity.dimension != unit.dimension:
        wanted, given = described(unit.dimension), described(quantity.dimension)
        raise RobotError("KG833", f"`{parameter.name}` must be in {wanted}, but {shown(quantity)} is in {given}")
    value = quantity.value / unit.factor
    return round(value) if parameter.type == "integer" and value == round(value) else value


def truth(quantity: Quantity) -> bool:
    """Return whether a condition holds; RobotError KG833 for other values."""
    if not isinstance(quantity.value, bool):
        raise RobotError("KG833", f"{shown(quantity)} is neither true nor false")
    return quantity.value


def seconds(quantity: Quantity) -> float:
    """Return a duration in seconds; RobotError KG833 for other values, KG835 for a negative one."""
    if not quantity.number or quantity.dimension not in {PLAIN, _TIME}:
        raise RobotError("KG833", f"{shown(quantity)} is not a time")
    if not 0 <= quantity.value < math.inf:
        raise RobotError("KG835", f"{shown(quantity)} is not a time to wait")
    return float(quantity.value)


def shown(quantity: Quantity) -> str:
    """Return a value formatted for people."""
    if quantity.value is None:
        return "nothing"
    if isinstance(quantity.value, dict):
        return f"({', '.join(f'{name}: {_part(name, value)}' for name, value in quantity.value.items())})"
    if isinstance(quantity.value, bool):
        return "true" if quantity.value else "false"
    if not quantity.number:
        return str(quantity.value)
    unit = f" {described(quantity.dimension)}" if quantity.dimension else ""
    return f"{quantity.value:.6g}{unit}"


def _part(name: str, value: float) -> str:
    """Return a component of a place formatted for people; the orientation in degrees."""
    return f"{math.degrees(value):.6g} deg" if PLACES[name] == "rad" else f"{value:.6g} {PLACES[name]}"


def unary(operator: str, of: Quantity) -> Quantity:
    """Return the result of an operator or function of one value; RobotError KG833 if it has none."""
    if operator == "not":
        return Quantity(not truth(of))
    if operator == "count":
        if not isinstance(of.value, str | list | tuple):
            raise RobotError("KG833", f"{shown(of)} has nothing to count")
        return Quantity(float(len(of.value)))
    if not of.number:
        raise RobotError("KG833", f"{shown(of)} is not a number")
    return Quantity(_OF_ONE[operator](of.value), of.dimension)


def _rounded(value: float) -> float:
    return float(math.floor(value + 0.5)) if math.isfinite(value) else value


_OF_ONE: Final[dict[str, Callable[[float], float]]] = {"-": operators.neg, "absolute": abs, "round": _rounded}
_ORDER: Final = {"<": operators.lt, "<=": operators.le, ">": operators.gt, ">=": operators.ge}


def binary(operator: str, left: Quantity, right: Quantity) -> Quantity:
    """Return the result of a binary operator except `and` and `or`; RobotError KG833, KG838 if it has none."""
    if operator in {"=", "!="}:
        same = left.value == right.value and (left.dimension == right.dimension or _fitting(left, right))
        return Quantity(same == (operator == "="))
    if operator in {*_ORDER, "contains"} and any(one.value is None for one in (left, right)):
        return Quantity(value=False)
    if operator == "contains":
        if not isinstance(left.value, str | list | tuple):
            raise RobotError("KG833", f"{shown(left)} is not a list")
        return Quantity(shown(right) in left.value if isinstance(left.value, str) else right.value in left.value)
    if operator == "+" and (isinstance(left.value, str) or isinstance(right.value, str)):
        return Quantity(shown(left) + shown(right))
    for one in (left, right):
        if not one.number:
            raise RobotError("KG833", f"{shown(one)} is not a number, which `{operator}` needs")
    return _of_numbers(operator, left, right)


def _of_numbers(operator: str, left: Quantity, right: Quantity) -> Quantity:
    if operator == "*":
        return Quantity(left.value * right.value, multiplied(left.dimension, right.dimension))
    if operator == "/":
        if right.value == 0:
            raise RobotError("KG838", f"{shown(left)} cannot be divided by zero")
        return Quantity(left.value / right.value, divided(left.dimension, right.dimension))
    if not _fitting(left, right):
        units = f"{described(left.dimension)} and {described(right.dimension)}"
        raise RobotError("KG833", f"`{operator}` does not go with {units}")
    if operator in _ORDER:
        return Quantity(_ORDER[operator](left.value, right.value))
    dimension = left.dimension or right.dimension
    return Quantity(left.value + right.value if operator == "+" else left.value - right.value, dimension)


def _fitting(left: Quantity, right: Quantity) -> bool:
    """Return whether two numbers have the same dimension; zero fits every unit."""
    return left.dimension == right.dimension or any(one == Quantity(0.0) for one in (left, right))
