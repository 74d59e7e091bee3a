"""Conditions as alternatives: a case is a list of filters that must all hold, and one of the cases must.

A condition over the values of a path is a filter with EXISTS. Its negation needs no more than that: that no value has
one of several cases is one NOT EXISTS for each of them.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Final, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.rules.notations.shacl.paths import Branch

Cases: TypeAlias = list[list[str]]
"""Alternatives; each is a list of elements of a SPARQL group, in no order."""

MAX_CASES: Final = 256

TRUE: Final[Cases] = [[]]
FALSE: Final[Cases] = []


def every(parts: Iterable[Cases]) -> Cases:
    """Return that all hold; `OverflowError` when that has more than `MAX_CASES` alternatives."""
    result = TRUE
    for part in parts:
        if len(result) * len(part) > MAX_CASES:
            raise OverflowError
        result = [[*left, *(one for one in right if one not in left)] for left, right in product(result, part)]
    return result


def some(parts: Iterable[Cases]) -> Cases:
    """Return that one holds at least."""
    result: Cases = []
    for part in parts:
        if [] in part:
            return TRUE
        result += [case for case in part if case not in result]
    return result


def exists(pattern: str, cases: Cases) -> Cases:
    """Return that the pattern has a solution in which one of the cases holds."""
    return [[f"FILTER EXISTS {{ {group(pattern, case)} }}"] for case in cases]


def none(pattern: str, cases: Cases) -> Cases:
    """Return that the pattern has no solution in which one of the cases holds."""
    return [[f"FILTER NOT EXISTS {{ {group(pattern, case)} }}" for case in cases]]


def matched(pattern: str, *, wanted: bool) -> Cases:
    """Return that the pattern has a solution, or that it has none."""
    return (exists if wanted else none)(pattern, TRUE)


def for_all(values: Iterable[Branch], each: Callable[[str, bool], Cases], *, wanted: bool) -> Cases:
    """Return that all values pass a test, or that one does not; `each` tells of a term whether it does, or does not."""
    parts = []
    for branch in values:
        if branch.pattern:
            parts.append((none if wanted else exists)(branch.pattern, each(branch.term, False)))
        else:
            parts.append(each(branch.term, wanted))
    return every(parts) if wanted else some(parts)


def group(pattern: str, case: list[str]) -> str:
    """Return what is between the braces of a group with a pattern and filters."""
    return " ".join(part for part in (pattern, *case) if part)


def check(expression: str, *, wanted: bool, safe: bool = False) -> Cases:
    """Return that an expression is true, or that it is not; `safe`: it is never in error."""
    if wanted:
        return [[f"FILTER({expression})"]]
    return [[f"FILTER(!({expression}))" if safe else f"FILTER(!COALESCE({expression}, false))"]]
