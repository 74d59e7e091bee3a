"""Texts made of values: f-strings, `str.format`, `%`.

Python formats what is wholly known, within bounds; otherwise a text is put together field by field.
Source: docs.python.org/3/library/string.html#format-string-syntax and stdtypes.html#printf-style-string-formatting.
"""

from __future__ import annotations

import re
from string import Formatter
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions.joining import concatenate
from kg.extract.launch.expressions.texts import reason_of
from kg.extract.launch.expressions.values import Table, TextLike, Unknown, Words
from kg.extract.launch.expressions.whole import ExpressionError, UnsupportedError, apply, is_whole, refuse_over

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from kg.extract.launch.expressions.values import Value

__all__ = ["as_string", "format_braces", "format_percent", "formatted"]

_PERCENT: Final = re.compile(r"%(?:\((?P<key>\w+)\))?(?P<spec>[-+ #0]*\d{0,3}(?:\.\d{0,3})?)(?P<kind>[%a-zA-Z])")
_SPEC: Final = re.compile(r"(?:.?[<>^=])?[-+ #0,_]*\d{0,3}(?:\.\d{1,3})?[a-zA-Z%]?", re.DOTALL)
_FIELD: Final = re.compile(r"\w*")
_CONVERSIONS: Final[dict[str, Callable[[object], object]]] = {"": lambda value: value, "s": str, "r": repr, "a": ascii}


def as_string(value: Value) -> Value:
    """Return `str(value)`."""
    if isinstance(value, str):
        return value
    if isinstance(value, TextLike):
        return as_string(value.as_text())
    if isinstance(value, Words):
        return Unknown("a substitution is turned into a text before it is performed") if value.lazy else value
    return apply(str, [value]) if is_whole(value) else Unknown(reason_of(value))


def formatted(value: Value, spec: str | None, conversion: str = "") -> Value:
    """Return what a replacement field makes of a value; `spec` None is not known."""
    if not spec and conversion in {"", "s"} and spec is not None:
        return as_string(value)
    if spec is None or not is_whole(value):
        return Unknown(f"a text is formatted of what is not known: {reason_of(value)}")
    if not _SPEC.fullmatch(spec):
        raise UnsupportedError("the format of a text is not evaluated")
    return apply(format, [_CONVERSIONS[conversion](value), spec])


def format_braces(template: str, args: Sequence[Value], kwargs: Mapping[str, Value]) -> Value:
    """Return `template.format(*args, **kwargs)`."""
    try:
        fields = list(Formatter().parse(template))
    except ValueError as error:
        raise ExpressionError(f"ValueError: {error}") from None
    names = [name for _, name, _, _ in fields if name is not None]
    if "" in names and any(name.isdecimal() for name in names):
        raise ExpressionError("ValueError: a format has fields with and without numbers")
    given = {**{str(position): value for position, value in enumerate(args)}, **kwargs}
    result: Value = ""
    automatic = 0
    for literal, name, spec, conversion in fields:
        result = concatenate(result, literal)
        if name is None:
            continue
        if not _FIELD.fullmatch(name) or "{" in (spec or "") or (conversion or "") not in _CONVERSIONS:
            result = concatenate(result, Unknown(f"the field `{name}` of a format"))
            continue
        if name == "":
            name, automatic = str(automatic), automatic + 1  # noqa: PLW2901 - the name that stands for none
        value = given.get(name, Unknown(f"the field `{name}` of a format"))
        result = concatenate(result, formatted(value, spec or "", conversion or ""))
    return result


def format_percent(template: str, operand: Value) -> Value:
    """Return `template % operand`."""
    strange = "%" in _PERCENT.sub("", template)
    if is_whole(operand):
        if strange:
            raise UnsupportedError("the format of a text is not evaluated")
        values = (
            operand.values() if isinstance(operand, Table) else operand if isinstance(operand, tuple) else [operand]
        )
        longest = max((len(str(value)) for value in values), default=0)
        refuse_over(len(template) + (1 + longest) * template.count("%"))
        return apply(str.__mod__, [template, operand])
    if strange:
        return Unknown("the format of a text is not evaluated")
    waiting = list(operand) if isinstance(operand, tuple) else [operand]
    result: Value = ""
    end = 0
    for match in _PERCENT.finditer(template):
        result = concatenate(result, template[end : match.start()])
        end = match.end()
        if match["kind"] == "%":
            result = concatenate(result, "%")
            continue
        if match["key"]:
            found = operand.get(match["key"]) if isinstance(operand, Table) else None
            value = found if found is not None else Unknown(f"the field `{match['key']}` of a format")
        else:
            value = waiting.pop(0) if waiting else Unknown("a format has too few values")
        result = concatenate(result, _percent(value, match["spec"], match["kind"]))
    return concatenate(result, template[end:])


def _percent(value: Value, spec: str, kind: str) -> Value:
    if not spec and kind == "s":
        return as_string(value)
    return apply(str.__mod__, [f"%{spec}{kind}", (value,)]) if is_whole(value) else Unknown(reason_of(value))
