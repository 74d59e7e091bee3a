"""Texts made of values: f-strings, `str.format`, `%`.

Source: docs.python.org/3/library/string.html#format-string-syntax and stdtypes.html#printf-style-string-formatting.
"""

from __future__ import annotations

import re
from string import Formatter
from typing import TYPE_CHECKING, Final

from kg.extract.launch.ros2.python.operators import add, is_whole
from kg.extract.launch.ros2.python.texts import reason_of
from kg.extract.launch.ros2.python.values import Items, PathValue, Table, Unknown, Words

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.extract.launch.ros2.python.values import Value

__all__ = ["as_string", "format_braces", "format_percent", "formatted"]

_PERCENT: Final = re.compile(r"%(?:\((?P<key>\w+)\))?(?P<spec>[-+ #0]*\d*(?:\.\d+)?)(?P<kind>[%a-zA-Z])")
_SPEC: Final = re.compile(r"[-+ #0<>^=,]*\d{0,3}(?:\.\d{1,3})?[a-zA-Z%]?|.[<>^=]\d{0,3}")


def as_string(value: Value) -> Value:
    """Return `str(value)`."""
    if isinstance(value, str):
        return value
    if isinstance(value, PathValue):
        return value.text
    if isinstance(value, Words):
        return Unknown("a substitution is turned into a text before it is performed") if value.lazy else value
    if is_whole(value):
        return str(value)
    if isinstance(value, Items | Table | tuple):
        return Unknown("a container is turned into a text")
    return Unknown(reason_of(value))


def formatted(value: Value, spec: str | None, conversion: str = "") -> Value:
    """Return what a replacement field makes of a value."""
    if not spec and conversion in {"", "s"}:
        return as_string(value)
    if spec is None or not _SPEC.fullmatch(spec) or not isinstance(value, str | bool | int | float):
        return Unknown(f"a text is formatted of what is not known: {reason_of(value)}")
    try:
        return format(repr(value) if conversion in {"r", "a"} else str(value) if conversion else value, spec)
    except (ValueError, OverflowError):
        return Unknown("a format does not fit its value")


def format_braces(template: str, args: Sequence[Value], kwargs: Mapping[str, Value]) -> Value:
    """Return `template.format(*args, **kwargs)`."""
    result: Value = ""
    automatic = 0
    try:
        fields = list(Formatter().parse(template))
    except ValueError:
        return Unknown("the format is not valid")
    for literal, name, spec, conversion in fields:
        result = add(result, literal)
        if name is None:
            continue
        if name == "":
            name, automatic = str(automatic), automatic + 1  # noqa: PLW2901 - the name that stands for none
        value = kwargs.get(name, Unknown(f"the field `{name}` of a format"))
        if name.isdecimal() and len(name) < 4 and int(name) < len(args):  # noqa: PLR2004 - no list is that long
            value = args[int(name)]
        result = add(result, formatted(value, spec if "{" not in (spec or "") else None, conversion or ""))
    return result


def format_percent(template: str, operand: Value) -> Value:
    """Return `template % operand`."""
    values = list(operand) if isinstance(operand, tuple) else [operand]
    result: Value = ""
    end = 0
    for match in _PERCENT.finditer(template):
        result = add(result, template[end : match.start()])
        end = match.end()
        if match["kind"] == "%":
            result = add(result, "%")
            continue
        if match["key"]:
            found = operand.get(match["key"]) if isinstance(operand, Table) else None
            value = found if found is not None else Unknown(f"the field `{match['key']}` of a format")
        else:
            value = values.pop(0) if values else Unknown("a format has too few values")
        result = add(result, _percent(value, match["spec"], match["kind"]))
    return add(result, template[end:])


def _percent(value: Value, spec: str, kind: str) -> Value:
    if not spec and kind == "s":
        return as_string(value)
    if not isinstance(value, str | bool | int | float) or len(spec) > 6:  # noqa: PLR2004 - wider is no honest format
        return Unknown(reason_of(value))
    try:
        return f"%{spec}{kind}" % value
    except (ValueError, TypeError, OverflowError):
        return Unknown("a format does not fit its value")
