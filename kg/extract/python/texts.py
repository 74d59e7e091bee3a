"""Texts as Python makes them: `%`, `str.format`, `str(value)` and the methods of `str`.

Source: docs.python.org/3/library/string.html#format-string-syntax and stdtypes.html#printf-style-string-formatting.
What a replacement field makes of an unknown value stays a hole.
"""

from __future__ import annotations

import re
from dataclasses import replace
from string import Formatter
from typing import TYPE_CHECKING, Final

from kg.symbolic.operators import NULL, plain
from kg.symbolic.values import (
    Either,
    Mapping,
    Number,
    Sequence,
    Text,
    Truth,
    Unknown,
    Value,
    concatenate,
    join,
    number,
    over,
)

if TYPE_CHECKING:
    from collections.abc import Mapping as Names

_HOLE: Final = Unknown("part of it is not known")
_STRIPS: Final = frozenset({"strip", "lstrip", "rstrip"})
"""Methods that leave a text that is not known as it is."""
_METHODS: Final = _STRIPS | {
    "capitalize", "casefold", "count", "find", "index", "isalnum", "isalpha", "isdecimal", "isdigit", "islower",
    "isspace", "isupper", "lower", "partition", "removeprefix", "removesuffix", "replace", "rfind", "rpartition",
    "rsplit", "split", "splitlines", "swapcase", "title", "upper",
}  # fmt: skip
_LONGEST_TO_REPLACE: Final = 2_000
_LONGEST_FORMAT: Final = 6
_DIRECTIVE: Final = re.compile(r"%(?:\((?P<key>[^()]*)\))?(?P<flags>[#0\- +.\d*]*)(?P<kind>[a-zA-Z%])")
_SPECIFICATION: Final = re.compile(r"[-+ #0<>^=,]*\d{0,3}(?:\.\d{1,3})?[a-zA-Z%]?|.[<>^=]\d{0,3}")
"""A format of a width that a program can mean."""


def stringified(value: Value) -> Value:
    """Return what `str(value)` gives."""
    if isinstance(value, Either):
        return over((value,), stringified)
    if isinstance(value, Number) or (isinstance(value, Truth) and value.parameter is None) or value == NULL:
        return Text.of(str(plain(value)))
    return value if isinstance(value, Text | Unknown) else _HOLE


def percent(template: Value, value: Value) -> Value:
    """Return `template % value`."""
    items = value.items if isinstance(value, Sequence) else (value,)
    if any(isinstance(one, Either) for one in (template, *items)):
        whole = isinstance(value, Sequence)
        return over((template, *items), lambda one, *row: percent(one, Sequence(row) if whole else row[0]))
    if not isinstance(template, Text) or template.exact is None:
        return concatenate(template, _HOLE)
    pairs = value.items if isinstance(value, Mapping) else ()
    of_keys = {own.exact: item for own, item in pairs if isinstance(own, Text)}
    pieces: list[Value] = []
    waiting, end = iter(items), 0
    for match in _DIRECTIVE.finditer(template.exact):
        pieces.append(Text.of(template.exact[end : match.start()]))
        end = match.end()
        if match["kind"] == "%":
            pieces.append(Text.of("%"))
        else:
            given = next(waiting, None) if match["key"] is None else of_keys.get(match["key"])
            pieces.append(_converted(given, match["flags"], match["kind"]))
    return _carried(template, concatenate(*pieces, Text.of(template.exact[end:])))


def _converted(value: Value | None, flags: str, kind: str) -> Value:
    if value is not None and kind == "s" and not flags:
        return stringified(value)
    text = plain(value) if value is not None else None
    if text is None or len(flags) > _LONGEST_FORMAT:
        return _HOLE
    try:
        return Text.of(f"%{flags}{kind}" % text)
    except (ValueError, TypeError, OverflowError):
        return _HOLE


def braces(template: Value, positional: list[Value], named: Names[str, Value]) -> Value:
    """Return `template.format(*positional, **named)`."""
    everything = (template, *positional, *named.values())
    if any(isinstance(one, Either) for one in everything):
        count = len(positional)
        return over(
            everything,
            lambda one, *row: braces(one, list(row[:count]), dict(zip(named, row[count:], strict=True))),
        )
    if not isinstance(template, Text) or template.exact is None:
        return concatenate(template, _HOLE)
    try:
        fields = list(Formatter().parse(template.exact))
    except ValueError:
        return concatenate(_HOLE)
    pieces: list[Value] = []
    counter = iter(range(len(fields)))
    for literal, name, specification, conversion in fields:
        pieces.append(Text.of(literal))
        if name is not None:
            key = name or str(next(counter))
            value = named.get(key, _HOLE)
            if key.isdigit():
                value = positional[int(key)] if int(key) < len(positional) else _HOLE
            pieces.append(_specified(value, specification or "", conversion or ""))
    return _carried(template, concatenate(*pieces))


def _specified(value: Value, specification: str, conversion: str) -> Value:
    """Return what a replacement field makes of a value; with a specification, it is known only for known values."""
    if not specification and conversion in ("", "s"):
        return stringified(value)
    text = plain(value)
    if text is None or not _SPECIFICATION.fullmatch(specification):
        return _HOLE
    if conversion:
        text = repr(text) if conversion in ("r", "a") else str(text)
    try:
        return Text.of(format(text, specification))
    except (ValueError, OverflowError):
        return _HOLE


def _carried(template: Text, text: Value) -> Value:
    """Return `text` with the origin of the template."""
    return concatenate(replace(template, parts=("",)), text)


def method(of: Text, name: str, arguments: list[Value]) -> Value | None:
    """Return the result of a method of `str` that only reads it; None for other methods."""
    if name == "join" and len(arguments) == 1:
        return _joined(of, arguments[0])
    if name in ("encode", "decode"):
        return of
    if name not in _METHODS:
        return None
    if of.exact is None:
        copy = replace(of, parts=of.parts)
        return copy if name in _STRIPS else concatenate(Unknown("it is computed when the program runs", of.parameter))
    given = [plain(one) for one in arguments]
    if None in given or (name == "replace" and len(of.exact) > _LONGEST_TO_REPLACE):
        return concatenate(_HOLE) if name not in ("split", "rsplit") else None
    try:
        return _result(of, getattr(of.exact, name)(*given))
    except (ValueError, TypeError):
        return Unknown(f"`str.{name}` fails")


def _result(of: Text, computed: object) -> Value:
    if isinstance(computed, str):
        return replace(of, parts=(computed,))
    if isinstance(computed, bool):
        return Truth(computed, of.parameter)
    if isinstance(computed, list | tuple):
        return Sequence(tuple(_result(of, part) for part in computed))
    return number(int(computed), of.parameter) if isinstance(computed, int) else _HOLE


def _joined(separator: Text, items: Value) -> Value | None:
    if isinstance(items, Either):
        texts = [one for one in (_joined(separator, item) for item in items.items) if one is not None]
        return join(*texts) if texts else None
    if not isinstance(items, Sequence) or items.open:
        return None
    pieces: list[Value] = []
    for index, item in enumerate(items.items):
        pieces += [separator, stringified(item)] if index else [stringified(item)]
    return concatenate(*pieces)
