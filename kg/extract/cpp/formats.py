"""Texts that `fmt::format`, `boost::format` and `printf` make in C++."""

from __future__ import annotations

import re
from typing import Final

from kg.symbolic.values import Either, Text, Value, combinations, concatenate, join

_PRINTF: Final = re.compile(r"%[-+ #0]*\d*(?:\.\d+)?(?:hh|h|ll|l|z|j|t)?[a-zA-Z]|%\d+%|%%")
_BRACES: Final = re.compile(r"\{[^{}]*\}")


def formatted(pattern: Value, values: list[Value]) -> Value:
    """Return `fmt::format`, `boost::format` or `printf`-like formatting of texts."""
    if isinstance(pattern, Either) or any(isinstance(value, Either) for value in values):
        return join(*(formatted(row[0], list(row[1:])) for row in combinations((pattern, *values))))
    if not isinstance(pattern, Text) or pattern.exact is None:
        return Text.hole("the format is not known")
    regular = _BRACES if _BRACES.search(pattern.exact) else _PRINTF
    pieces: list[Value] = []
    position, left = 0, iter(values)
    for match in regular.finditer(pattern.exact):
        pieces.append(Text.of(pattern.exact[position : match.start()]))
        position = match.end()
        if match.group() == "%%":
            pieces.append(Text.of("%"))
            continue
        pieces.append(next(left, Text.hole("a value is put in at run time")))
    pieces.append(Text.of(pattern.exact[position:]))
    return concatenate(*pieces)
