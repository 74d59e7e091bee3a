"""How well a candidate fits what was typed: as its beginning, that of one of its parts, in it, or spread over it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["WORST", "matcher"]

WORST: Final = 4
_SHORTEST: Final = 2
"""Fewer characters are not looked for spread over a name."""
_SIGNS: Final = re.compile(r"\A[^a-z0-9]+")
_HUMP: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])")


def matcher(typed: str) -> Callable[[str], int | None]:
    """Return the function that tells how well a name fits what was typed; None when it does not.

    0 is the name itself, 1 its beginning (be it behind a slash), 2 the beginning of a part (behind a slash, a dot, an
    underscore or a hump), 3 anywhere in it, 4 its characters in this order, the first at the beginning of a part.
    """
    wanted = typed.lower()
    if not wanted:
        return lambda _: 1
    part = re.compile(r"(?:^|[^a-z0-9])" + re.escape(wanted))
    spread = re.compile(r"(?:^|[^a-z0-9])" + ".*?".join(map(re.escape, wanted)), re.DOTALL)

    def fit(name: str) -> int | None:
        lower = name.lower()
        if wanted not in lower:
            return WORST if len(wanted) >= _SHORTEST and spread.search(_parts(name)) else None
        if lower == wanted:
            return 0
        if lower.startswith(wanted) or _SIGNS.sub("", lower, count=1).startswith(wanted):
            return 1
        return 2 if part.search(lower) or wanted in _beginnings(name) else 3

    def _beginnings(name: str) -> set[str]:
        return {name[match.start() : match.start() + len(wanted)].lower() for match in _HUMP.finditer(name)}

    return fit


def _parts(name: str) -> str:
    """Return a name in lower case with its humps apart."""
    return _HUMP.sub(" ", name).lower()
