"""Names that differ in their first namespace alone, and of which each has the end that the other lacks.

A part of a system that is started in the namespace of another robot meets nobody there. Of systems with many robots,
each may lack the same: only a name with one possible partner counts, of the same type. One of the two namespaces has no
name at which anybody meets, or the two differ in numbers (`drone1`, `drone2`).
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

__all__ = ["elsewhere", "first_namespace"]

_NUMBERS: Final = re.compile("[0-9]+")
_GIVES: Final = frozenset({0})
_TAKES: Final = frozenset({1})


def elsewhere(
    ends: Mapping[str, set[int]], types: Mapping[str, set[str]], names: Iterable[str], met: set[str]
) -> Iterator[tuple[str, str]]:
    """Yield pairs of `names` that are likely one in the wrong namespace, the smaller name first.

    `ends` tells which ends (0 gives, 1 takes) a name has, `types` of which types; `met` are the first namespaces of
    names at which somebody meets.
    """
    found: defaultdict[tuple[str, int], list[str]] = defaultdict(list)
    for name in names:
        rest = name[1:].partition("/")[2]
        if rest and ends[name] in (_GIVES, _TAKES):
            found[rest, min(ends[name])].append(name)
    for (rest, side), given in found.items():
        taken = found.get((rest, 1), [])
        if side == 0 and len(given) == len(taken) == 1:
            one, other = given[0], taken[0]
            if not types[one].isdisjoint(types[other]) and _strange(first_namespace(one), first_namespace(other), met):
                yield min(one, other), max(one, other)


def first_namespace(name: str) -> str:
    """Return the first segment of an absolute name that has more than one; else nothing."""
    first, slash, _ = name[1:].partition("/")
    return first if slash else ""


def _strange(one: str, other: str, met: set[str]) -> bool:
    return one not in met or other not in met or _NUMBERS.sub("", one) == _NUMBERS.sub("", other)
