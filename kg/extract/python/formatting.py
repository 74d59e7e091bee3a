"""Strings made of strings, as Python makes them: literals, `%`, `str.format`, and methods of `str`.

Source: docs.python.org/3/library/string.html#format-string-syntax and stdtypes.html#printf-style-string-formatting.
What a replacement field makes of a value that is not known stays a hole.
"""

from __future__ import annotations

import ast
import warnings
from string import Formatter
from typing import TYPE_CHECKING, Final

from kg.extract.python.entities import Items, Table
from kg.extract.values import Number, Text, Truth, Unknown, concatenate

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.extract.python.entities import Thing
    from kg.extract.values import Value

__all__ = ["STRING_METHODS", "decode_literal", "format_braces", "format_percent", "formatted", "stringify"]

_HOLE: Final = Unknown("part of it is not known")
_INTEGER: Final = frozenset("diu")


def decode_literal(prefix: str, body: str) -> str:
    """Return the text of a string literal, `prefix` being the letters and quotes it begins with."""
    letters = prefix.rstrip("'\"").lower()
    if "r" in letters or "\\" not in body:
        return body
    quote = prefix[len(letters) :] or '"'
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            value = ast.literal_eval(f"{quote}{body}{quote}")
    except (SyntaxError, ValueError):
        return body
    return value if isinstance(value, str) else body


def stringify(value: Thing) -> Value:
    """Return what `str(value)` gives, or a value that becomes a hole; `None` does, for no name is meant to hold it."""
    if isinstance(value, Text):
        return value
    if isinstance(value, Number):
        return Text.of(str(value.value))
    if isinstance(value, Truth):
        return Text.of(str(value.value))
    return value if isinstance(value, Unknown) else _HOLE


def format_percent(template: Text, value: Thing) -> Text:
    """Return `template % value`."""
    known = template.known
    if known is None:
        return concatenate(template, _HOLE)
    arguments: list[Thing] = list(value.items) if isinstance(value, Items) else [value]
    pieces: list[Value] = []
    rest = known
    while "%" in rest:
        before, _, rest = rest.partition("%")
        pieces.append(Text.of(before))
        piece, rest = _directive(rest, arguments, value)
        pieces.append(piece)
    return _carry(template, concatenate(*pieces, Text.of(rest)))


def _directive(rest: str, arguments: list[Thing], whole: Thing) -> tuple[Value, str]:
    """Return what the directive at the start of `rest` (after `%`) gives, and the text behind it."""
    if rest.startswith("%"):
        return Text.of("%"), rest[1:]
    key = None
    if rest.startswith("(") and ")" in rest:
        key, _, rest = rest[1:].partition(")")
    flags = len(rest) - len(rest.lstrip("#0- +.123456789*"))
    directive, kind = rest[:flags], rest[flags : flags + 1]
    if key is not None:
        value = whole.get(Text.of(key)) if isinstance(whole, Table) else None
    else:
        value = arguments.pop(0) if arguments else None
    return _converted(value, directive, kind), rest[flags + 1 :]


def _converted(value: Thing | None, flags: str, kind: str) -> Value:
    if value is None or "*" in flags:
        return _HOLE
    if kind in _INTEGER:
        return Text.of(f"%{flags}d" % int(value.value)) if isinstance(value, Number) else _HOLE
    piece = stringify(value) if kind == "s" else _HOLE
    if not flags:
        return piece
    known = piece.known if isinstance(piece, Text) else None
    return _HOLE if known is None else Text.of(f"%{flags}s" % known)


def format_braces(template: Text, positional: Sequence[Thing], named: dict[str, Thing]) -> Text:
    """Return `template.format(*positional, **named)`."""
    known = template.known
    if known is None:
        return concatenate(template, _HOLE)
    try:
        fields = list(Formatter().parse(known))
    except ValueError:
        return concatenate(_HOLE)
    pieces: list[Value] = []
    counter = iter(range(len(fields)))
    for literal, name, spec, _ in fields:
        pieces.append(Text.of(literal))
        if name is not None:
            key = name or str(next(counter))
            pieces.append(formatted(_field(key, positional, named), spec or ""))
    return _carry(template, concatenate(*pieces))


def formatted(value: Thing, spec: str) -> Value:
    """Return what a replacement field with a format specification makes of a value: known only for known values."""
    if not spec:
        return stringify(value)
    known: str | float | int | None = None
    if isinstance(value, Text):
        known = value.known
    elif isinstance(value, Number):
        known = value.value
    if known is None or "{" in spec:
        return _HOLE
    try:
        return Text.of(format(known, spec))
    except (ValueError, OverflowError):
        return _HOLE


def _field(key: str, positional: Sequence[Thing], named: dict[str, Thing]) -> Thing:
    if key.isdigit():
        return positional[int(key)] if int(key) < len(positional) else _HOLE
    return named.get(key, _HOLE)


def _carry(template: Text, made: Text) -> Text:
    """Return `made` with what is known of the template's own origin."""
    return concatenate(Text(("",), template.resolution, template.parameter, template.reason), made)


def _strip(method: str) -> Callable[[str, list[str]], str]:
    def apply(text: str, given: list[str]) -> str:
        stripped: str = getattr(text, method)(*given[:1])
        return stripped

    return apply


STRING_METHODS: Final[dict[str, Callable[[str, list[str]], str]]] = {
    **{name: _strip(name) for name in ("strip", "lstrip", "rstrip", "removeprefix", "removesuffix")},
    "lower": lambda text, _: text.lower(),
    "upper": lambda text, _: text.upper(),
    "title": lambda text, _: text.title(),
    "capitalize": lambda text, _: text.capitalize(),
    "encode": lambda text, _: text,
    "decode": lambda text, _: text,
    "replace": lambda text, given: text.replace(given[0], given[1]) if len(given) > 1 else text,
}
"""Methods that give a string for a string that is known and arguments that are known."""
