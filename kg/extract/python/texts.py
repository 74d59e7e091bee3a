"""Texts as Python makes them: `%`, `str.format`, `str(value)` and the methods of `str`.

Source: docs.python.org/3/library/string.html#format-string-syntax and stdtypes.html#printf-style-string-formatting.
What a replacement field makes of an unknown value stays a hole.
"""

from __future__ import annotations

from dataclasses import replace
from string import Formatter
from typing import TYPE_CHECKING, Final

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
    over,
)

if TYPE_CHECKING:
    from collections.abc import Callable
    from collections.abc import Mapping as Names

__all__ = ["braces", "method", "percent", "stringified"]

_HOLE: Final = Unknown("part of it is not known")
_INTEGER: Final = frozenset("diu")
_KEPT: Final = frozenset({"strip", "lstrip", "rstrip", "encode", "decode"})
"""Methods that leave a text that is not known as it is."""
_FEWEST_TO_REPLACE: Final = 2


def stringified(value: Value) -> Value:
    """Return what `str(value)` gives."""
    if isinstance(value, Either):
        return over((value,), stringified)
    if isinstance(value, Number):
        whole = value.value == int(value.value) and not any(mark in value.written for mark in ".eE")
        return Text.of(str(int(value.value)) if whole else str(value.value))
    if isinstance(value, Truth) and value.parameter is None:
        return Text.of(str(value.value))
    return value if isinstance(value, Text | Unknown) else _HOLE


def percent(template: Value, value: Value) -> Value:
    """Return `template % value`."""
    items = value.items if isinstance(value, Sequence) else (value,)
    if any(isinstance(one, Either) for one in (template, *items)):
        whole = isinstance(value, Sequence)
        return over((template, *items), lambda one, *row: percent(one, Sequence(row) if whole else row[0]))
    if not isinstance(template, Text) or template.known is None:
        return concatenate(template, _HOLE)
    pieces: list[Value] = []
    waiting, rest = list(items), template.known
    while "%" in rest:
        before, _, rest = rest.partition("%")
        pieces.append(Text.of(before))
        piece, rest = _directive(rest, waiting, value)
        pieces.append(piece)
    return _carried(template, concatenate(*pieces, Text.of(rest)))


def _directive(rest: str, waiting: list[Value], whole: Value) -> tuple[Value, str]:
    """Return what the directive at the start of `rest` (after `%`) gives, and the text behind it."""
    if rest.startswith("%"):
        return Text.of("%"), rest[1:]
    key = None
    if rest.startswith("(") and ")" in rest:
        key, _, rest = rest[1:].partition(")")
    flags = len(rest) - len(rest.lstrip("#0- +.123456789*"))
    directive, kind = rest[:flags], rest[flags : flags + 1]
    value: Value | None
    if key is not None:
        pairs = whole.items if isinstance(whole, Mapping) else ()
        value = next((held for own, held in pairs if isinstance(own, Text) and own.known == key), None)
    else:
        value = waiting.pop(0) if waiting else None
    return _converted(value, directive, kind), rest[flags + 1 :]


def _converted(value: Value | None, flags: str, kind: str) -> Value:
    if value is None or "*" in flags:
        return _HOLE
    if kind in _INTEGER:
        return Text.of(f"%{flags}d" % int(value.value)) if isinstance(value, Number) else _HOLE
    piece = stringified(value) if kind == "s" else _HOLE
    if not flags:
        return piece
    known = piece.known if isinstance(piece, Text) else None
    return _HOLE if known is None else Text.of(f"%{flags}s" % known)


def braces(template: Value, positional: list[Value], named: Names[str, Value]) -> Value:
    """Return `template.format(*positional, **named)`."""
    everything = (template, *positional, *named.values())
    if any(isinstance(one, Either) for one in everything):
        count = len(positional)
        return over(
            everything,
            lambda one, *row: braces(one, list(row[:count]), dict(zip(named, row[count:], strict=True))),
        )
    if not isinstance(template, Text) or template.known is None:
        return concatenate(template, _HOLE)
    try:
        fields = list(Formatter().parse(template.known))
    except ValueError:
        return concatenate(_HOLE)
    pieces: list[Value] = []
    counter = iter(range(len(fields)))
    for literal, name, specification, _ in fields:
        pieces.append(Text.of(literal))
        if name is not None:
            key = name or str(next(counter))
            value = named.get(key, _HOLE)
            if key.isdigit():
                value = positional[int(key)] if int(key) < len(positional) else _HOLE
            pieces.append(_specified(value, specification or ""))
    return _carried(template, concatenate(*pieces))


def _specified(value: Value, specification: str) -> Value:
    """Return what a replacement field makes of a value; with a specification, it is known only for known values."""
    if not specification:
        return stringified(value)
    known: str | float | None = None
    if isinstance(value, Text):
        known = value.known
    elif isinstance(value, Number):
        known = int(value.value) if value.value == int(value.value) and "." not in value.written else value.value
    if known is None or "{" in specification:
        return _HOLE
    try:
        return Text.of(format(known, specification))
    except (ValueError, OverflowError):
        return _HOLE


def _carried(template: Text, made: Value) -> Value:
    """Return `made` with the origin of the template."""
    return concatenate(replace(template, parts=("",)), made)


def method(of: Text, name: str, arguments: list[Value]) -> Value | None:
    """Return the result of a method of `str` that gives a text or a list of texts; None for other methods."""
    given = [one.known if isinstance(one, Text) else None for one in arguments]
    if name == "join" and len(arguments) == 1:
        return _joined(of, arguments[0])
    if name in ("split", "rsplit") and len(given) <= 1:
        separator = given[0] if given else None
        if of.known is None or separator == "" or (given and separator is None):
            return None
        return Sequence(tuple(replace(of, parts=(part,)) for part in of.known.split(separator)))
    if name not in _METHODS:
        return None
    if of.known is None:
        kept = replace(of, parts=of.parts)
        return kept if name in _KEPT else concatenate(Unknown("it is computed when the program runs", of.parameter))
    if None in given and name not in ("encode", "decode"):
        return concatenate(_HOLE)
    return replace(of, parts=(_METHODS[name](of.known, [one for one in given if one is not None]),))


def _joined(separator: Text, items: Value) -> Value | None:
    if isinstance(items, Either):
        found = [one for one in (_joined(separator, item) for item in items.items) if one is not None]
        return join(*found) if found else None
    if not isinstance(items, Sequence) or items.open:
        return None
    pieces: list[Value] = []
    for index, item in enumerate(items.items):
        pieces += [separator, stringified(item)] if index else [stringified(item)]
    return concatenate(*pieces)


def _called(name: str) -> Callable[[str, list[str]], str]:
    def apply(text: str, given: list[str]) -> str:
        result: str = getattr(text, name)(*given[:1])
        return result

    return apply


_METHODS: Final[dict[str, Callable[[str, list[str]], str]]] = {
    **{name: _called(name) for name in ("strip", "lstrip", "rstrip", "removeprefix", "removesuffix")},
    "lower": lambda text, _: text.lower(),
    "upper": lambda text, _: text.upper(),
    "title": lambda text, _: text.title(),
    "capitalize": lambda text, _: text.capitalize(),
    "encode": lambda text, _: text,
    "decode": lambda text, _: text,
    "replace": lambda text, given: text.replace(given[0], given[1]) if len(given) >= _FEWEST_TO_REPLACE else text,
}
"""Methods that give a text for a known text and known arguments."""
