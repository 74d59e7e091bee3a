"""Texts that `fmt::format`, `boost::format`, `printf` and streams make in C++."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from kg.symbolic.values import (
    Either,
    Kind,
    Number,
    Object,
    Sequence,
    Text,
    Truth,
    Value,
    as_text,
    combinations,
    concatenate,
    join,
    over,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

_PRINTF: Final = re.compile(r"%([-+ #0]*\d*(?:\.\d+)?)(?:hh|h|ll|l|z|j|t)?([a-zA-Z])|%(\d+)%|%%")
_BRACES: Final = re.compile(r"\{(\w*)(?::([^{}]*))?\}")
_LONG: Final = re.compile(r"\d{4}")
"""A width that no name has."""
_WHOLE: Final = "diuxXo"
_LETTERS: Final = {"i": "d", "u": "d"}
_BASES: Final = {"hex": "x", "oct": "o", "dec": "d"}
_WIDEST: Final = 64
_FLAGS: Final[dict[str, dict[str, Any]]] = {
    **{name: {"base": base} for name, base in _BASES.items()},
    "uppercase": {"upper": True},
    "nouppercase": {"upper": False},
    "showbase": {"prefixed": True},
    "noshowbase": {"prefixed": False},
    "boolalpha": {"words": True},
    "noboolalpha": {"words": False},
    "fixed": {"notation": "f"},
    "scientific": {"notation": "e"},
    "defaultfloat": {"notation": "g"},
    "left": {"align": "<"},
    "right": {"align": ">"},
}
"""What manipulators of streams set."""
_TEXTS: Final = {"endl": "\n", "flush": "", "ends": ""}
WITH_ARGUMENT: Final = frozenset({"setw", "setfill", "setprecision", "setbase"})
MANIPULATORS: Final[dict[str, Value]] = {
    name: Object(Kind(("std", name)), native={"manipulator": Text.of(name)}) for name in (*_FLAGS, *_TEXTS)
}
"""Manipulators without an argument, by their names."""


def manipulator(name: str, values: list[Value]) -> Value:
    """Return a manipulator with an argument, such as `std::setw(2)`."""
    return Object(Kind(("std", name)), native={"manipulator": Text.of(name), "given": values[0]})


def formatted(pattern: Value, values: list[Value]) -> Value:
    """Return `fmt::format`, `boost::format` or `printf`-like formatting of texts."""
    if isinstance(pattern, Either) or any(isinstance(value, Either) for value in values):
        return join(*(formatted(row[0], list(row[1:])) for row in combinations((pattern, *values))))
    if not isinstance(pattern, Text) or pattern.exact is None:
        return Text.hole("the format is not known")
    braces = _BRACES.search(pattern.exact) is not None
    pieces: list[Value] = []
    position, following = 0, 0
    for match in (_BRACES if braces else _PRINTF).finditer(pattern.exact):
        pieces.append(Text.of(pattern.exact[position : match.start()]))
        position = match.end()
        if match.group() == "%%":
            pieces.append(Text.of("%"))
            continue
        place, first = (match[1], 0) if braces else (match[3], 1)
        at = int(place) - first if place and place.isdigit() else following
        following += 1
        value = values[at] if at < len(values) and (not place or place.isdigit()) else None
        if value is None:
            pieces.append(Text.hole("a value is put in at run time"))
        elif braces:
            pieces.append(_with(value, match[2] or ""))
        else:
            pieces.append(_printed(value, match[1] or "", match[2] or ""))
    pieces.append(Text.of(pattern.exact[position:]))
    return concatenate(*pieces)


def _with(value: Value, specification: str) -> Value:
    """Return a value as `{:...}` writes it; the syntax is that of Python."""
    if not specification:
        return value
    if _LONG.search(specification):
        return _hole(value)
    plain: str | float | None = None
    if isinstance(value, Number) and math.isfinite(value.value):
        plain = value.value if value.floating or specification[-1] not in "dxXobc" + "0123456789" else value.whole
    elif isinstance(value, Text):
        plain = value.exact
    try:
        return _of(value, format(plain, specification)) if plain is not None else _hole(value)
    except (ValueError, OverflowError):
        return _hole(value)


def _printed(value: Value, flags: str, letter: str) -> Value:
    """Return a value as `%...` writes it."""
    if isinstance(value, Text) and letter in "sc":
        exact = value.exact
        return value if not flags or exact is None or _LONG.search(flags) else _of(value, f"%{flags}s" % exact)
    if isinstance(value, Number) and math.isfinite(value.value) and letter and not _LONG.search(flags):
        if letter in _WHOLE:
            return _of(value, f"%{flags}{_LETTERS.get(letter, letter)}" % value.whole)
        if letter in "eEfFgG":
            return _of(value, f"%{flags}{letter}" % value.value)
    return value if not flags or letter not in _WHOLE else _hole(value)


def _of(value: Value, text: str) -> Text:
    """Return the text that is made of a value."""
    return replace(as_text(value), parts=(text,))


def _hole(value: Value) -> Text:
    """Return a value whose form is not known; the parameter that it is stays known."""
    text = as_text(value)
    return text if text.exact is None else Text.hole("it is formatted at run time", parameter=text.parameter)


@dataclass(frozen=True, slots=True)
class _Manner:
    """How a stream writes numbers and texts."""

    base: str = "d"
    upper: bool = False
    prefixed: bool = False
    words: bool = False
    notation: str = "g"
    align: str = ">"
    fill: str = " "
    width: int = 0
    precision: int | None = None
    known: bool = True


def streamed(stream: Object, values: Iterable[Value]) -> tuple[Value, Sequence]:
    """Return what a stream has after values were written to it, and the manipulators that stay."""
    text: Value = stream.native.get("text", Text.of(""))
    kept = stream.native.get("manner")
    manner, stays = _Manner(), list(kept.items) if isinstance(kept, Sequence) else []
    for one in stays:
        manner = _changed(manner, one)
    for value in values:
        name = _name(value)
        if name is None:
            text = concatenate(text, over((value,), lambda one, manner=manner: _written(one, manner)))
            manner = replace(manner, width=0)
            stays = [one for one in stays if _name(one) != "setw"]
        elif name in _TEXTS:
            text = concatenate(text, Text.of(_TEXTS[name]))
        else:
            stays.append(value)
            manner = _changed(manner, value)
    return text, Sequence(tuple(stays))


def _name(value: Value) -> str | None:
    named = value.native.get("manipulator") if isinstance(value, Object) else None
    return named.exact if isinstance(named, Text) else None


def _changed(manner: _Manner, value: Value) -> _Manner:
    """Return a manner after a manipulator."""
    name = _name(value) or ""
    if name in _FLAGS:
        return replace(manner, **_FLAGS[name])
    given = value.native.get("given") if isinstance(value, Object) else None
    if name == "setfill" and isinstance(given, Text) and given.exact is not None and len(given.exact) == 1:
        return replace(manner, fill=given.exact)
    if not isinstance(given, Number) or given.parameter is not None or not 0 <= given.value <= _WIDEST:
        return replace(manner, known=False)
    if name == "setbase":
        return replace(manner, base={16: "x", 8: "o"}.get(given.whole, "d"))
    return replace(manner, width=given.whole) if name == "setw" else replace(manner, precision=given.whole)


def _written(value: Value, manner: _Manner) -> Value:
    """Return a value as a stream writes it."""
    plain = manner in (_PLAIN, replace(_PLAIN, fill=manner.fill))
    if isinstance(value, Truth) and manner.words and value.parameter is None:
        text = "true" if value.value else "false"
    elif isinstance(value, Number) and math.isfinite(value.value) and not plain:
        text = _number(value, manner)
    elif isinstance(value, Text) and value.exact is not None and manner.width:
        text = value.exact
    else:
        return value
    return _of(value, f"{text:{manner.fill}{manner.align}{manner.width}}") if manner.known else _hole(value)


def _number(value: Number, manner: _Manner) -> str:
    if not value.floating:
        negative = value.value < 0 and manner.base != "d"
        text = format(value.whole % (1 << 32) if negative else value.whole, manner.base)
        text = {"x": "0x", "o": "0"}.get(manner.base, "") + text if manner.prefixed else text
    elif manner.notation == "g" and manner.precision is None:
        text = value.written
    else:
        text = format(value.value, f".{manner.precision if manner.precision is not None else 6}{manner.notation}")
    return text.upper() if manner.upper else text


_PLAIN: Final = _Manner()
