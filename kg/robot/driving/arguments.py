"""Conversion and validation of arguments: texts and numbers become values of parameters, or are refused."""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg.errors import RobotError
from kg.robot.programs.units import convert
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability, Parameter

Given: TypeAlias = "float | bool | str | list[Any]"
"""The value of one parameter."""

_QUANTITY: Final = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*")
_TRUTH: Final = {
    **dict.fromkeys(("true", "yes", "on", "1"), True),
    **dict.fromkeys(("false", "no", "off", "0"), False),
}
_SLACK: Final = 1e-9
_MOST: Final = sys.float_info.max


def given(capability: Capability, arguments: Mapping[str, Any]) -> dict[str, Given]:
    """Return the values of parameters: those given, converted and checked, and the defaults of others.

    A number without a unit is in the unit of the parameter. A parameter that is not given and has no default is absent.

    Raises:
        RobotError: KG823 an unknown parameter, a value of another kind or unit, outside of the limits (it is never
            clamped), or not one of the choices.
    """
    parameters = {one.name: one for one in capability.parameters}
    for name in arguments:
        if name not in parameters:
            hint = did_you_mean(name, parameters) or f"`{capability.name}` takes: {', '.join(parameters) or 'nothing'}."
            raise RobotError("KG823", f"`{capability.name}` has no parameter `{name}`", hint=hint)
    defaults = {name: one.default for name, one in parameters.items() if one.default is not None}
    values = {**defaults, **arguments}
    return {name: _value(one, values[name]) for name, one in parameters.items() if name in values}


def missing(parameter: Parameter) -> RobotError:
    """Return the error KG823 about a parameter without a default that was not given."""
    return _refused(parameter, "it has to be given")


def _value(parameter: Parameter, value: Any) -> Given:
    if value is None:
        raise _refused(parameter, "it is given nothing")
    if parameter.type == "list":
        return _elements(parameter, value)
    if parameter.type == "boolean":
        return _truth(parameter, value)
    if parameter.type == "text":
        return _text(parameter, value)
    number = _number(parameter, value)
    if parameter.type == "number":
        return number
    if number != int(number):
        raise _refused(parameter, f"{number:g} is not a whole number")
    return int(number)


def _elements(parameter: Parameter, value: Any) -> list[Any]:
    if isinstance(value, str):
        return [_scalar(one.strip()) for one in value.split(",")]
    if not isinstance(value, list | tuple):
        raise _refused(parameter, f"{value!r} is not a list")
    return list(value)


def _scalar(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def _truth(parameter: Parameter, value: Any) -> bool:
    truth = _TRUTH.get(value.strip().lower()) if isinstance(value, str) else value
    if not isinstance(truth, bool):
        raise _refused(parameter, f"`{value}` is neither true nor false")
    return truth


def _text(parameter: Parameter, value: Any) -> str:
    if not isinstance(value, str):
        raise _refused(parameter, f"{value!r} is not text")
    if parameter.choices and value not in parameter.choices:
        hint = did_you_mean(value, parameter.choices) or f"It is one of: {', '.join(parameter.choices)}."
        raise _refused(parameter, f"`{value}` is not one of its choices", hint=hint)
    return value


def _number(parameter: Parameter, value: Any) -> float:
    number = _quantity(parameter, value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float) or not abs(number) <= _MOST:
        raise _refused(parameter, f"`{value}` is not a number")
    slack = _SLACK * max(1, abs(number))
    unit = f" {parameter.unit}" if parameter.unit else ""
    if parameter.minimum is not None and number < parameter.minimum - slack:
        raise _refused(parameter, f"{number:g}{unit} is less than {parameter.minimum:g}{unit}")
    if parameter.maximum is not None and number > parameter.maximum + slack:
        raise _refused(parameter, f"{number:g}{unit} is more than {parameter.maximum:g}{unit}")
    return float(number)


def _quantity(parameter: Parameter, text: str) -> float:
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise _refused(parameter, f"`{text}` is not a number")
    number, unit = float(match[1]), match[2]
    if unit is None:
        return number
    try:
        return convert(number, unit, parameter.unit)
    except LookupError:
        raise _refused(parameter, f"unknown unit `{unit}`") from None
    except ValueError as error:
        raise _refused(parameter, f"`{text}`: {error}") from None


def _refused(parameter: Parameter, why: str, *, hint: str | None = None) -> RobotError:
    if hint is None:
        hint = f"`{parameter.name}` is {in_words(parameter)}."
    return RobotError("KG823", f"`{parameter.name}`: {why}", hint=hint)


def in_words(parameter: Parameter) -> str:
    """Describe the values of a parameter: `a number in m/s, from -1 to 1, by default 0`."""
    kind = {"integer": "a whole number", "boolean": "true or false", "list": "a list"}.get(parameter.type)
    parts = [kind or f"a {parameter.type}"]
    if parameter.unit:
        parts[0] += f" in {parameter.unit}"
    if parameter.choices:
        parts[0] = f"one of {', '.join(parameter.choices)}"
    if parameter.minimum is not None and parameter.maximum is not None:
        parts.append(f"from {parameter.minimum:g} to {parameter.maximum:g}")
    elif parameter.minimum is not None or parameter.maximum is not None:
        word, bound = ("at least", parameter.minimum) if parameter.maximum is None else ("at most", parameter.maximum)
        parts.append(f"{word} {bound:g}")
    if parameter.default is not None:
        shown = parameter.default if isinstance(parameter.default, str | bool) else f"{parameter.default:g}"
        parts.append(f"by default {str(shown).lower() if isinstance(shown, bool) else shown}")
    return ", ".join(parts)
