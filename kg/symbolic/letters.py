"""Texts as lists of letters: their elements, a letter that is set, and letters as numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.symbolic.values import Number, Text, Value, number

if TYPE_CHECKING:
    from collections.abc import Callable

_LONGEST: Final = 64
"""How many letters of a text are looked at one by one."""
_LAST: Final = 0x10FFFF
_PAIR: Final = 2
_CHANGED: Final = "its letters are changed when the program runs"


def letters(of: Value) -> list[Value] | None:
    """Return the letters of a known text; None for other values."""
    exact = of.exact if isinstance(of, Text) and of.parameter is None else None
    return [Text.of(letter) for letter in exact] if exact is not None and len(exact) <= _LONGEST else None


def with_letter(of: Text, key: Value, value: Value) -> Text:
    """Return a text in which a letter is set."""
    exact, index = of.exact, key.whole if isinstance(key, Number) else -1
    if exact is None or not isinstance(value, Text) or value.exact is None or not 0 <= index < len(exact):
        return Text.hole(_CHANGED)
    return replace(of, parts=(exact[:index] + value.exact + exact[index + 1 :],), own=False)


def mapped(of: Text, change: Callable[[Value], Value]) -> Text:
    """Return a text with each of its known letters changed; what is not known of it stays."""
    known = {letter for part in of.parts if isinstance(part, str) for letter in part}
    results = {letter: change(Text.of(letter)) for letter in sorted(known)}
    exact = {letter: one.exact for letter, one in results.items() if isinstance(one, Text) and one.exact is not None}
    if len(exact) < len(results):
        return Text.hole(_CHANGED)
    changed = ("".join(exact[letter] for letter in part) if isinstance(part, str) else part for part in of.parts)
    return replace(of, parts=tuple(changed), own=False)


def computed(sign: str, row: tuple[Value, ...]) -> Value | None:
    """Return the letter that is some places after or before another, or the places between two; None for others."""
    places: list[int] = []
    numbers: list[Number] = []
    for value in row:
        if type(value) is Number:
            numbers.append(value)
        elif type(value) is Text and (exact := value.exact) is not None and len(exact) == 1:
            places.append(ord(exact))
        else:
            return None
    if len(places) == 1 and (sign == "+" or type(row[0]) is Text):
        steps = sum(value.whole for value in numbers)
        result = places[0] + (steps if sign == "+" else -steps)
        parameter = next((value.parameter for value in numbers if value.parameter), None)
        return Text.of(chr(result), parameter=parameter) if 0 < result <= _LAST else None
    return number(places[0] - places[1]) if sign == "-" and len(places) == len(row) == _PAIR else None
