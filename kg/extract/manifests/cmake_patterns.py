"""Regular expressions of CMake, run only where they cannot run for long."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Final

__all__ = ["keep_matching", "matches", "replace_all"]

_LONGEST: Final = 200
_MOST_STEPS: Final = 2_000_000
_NESTED: Final = re.compile(r"\)[+*?]|[+*?][+*?]")


@lru_cache(256)
def _compile(written: str) -> tuple[re.Pattern[str], int] | None:
    """Return the expression and how many repetitions it has; None for those that are too long, nested or malformed.

    In CMake's language braces are ordinary characters.
    """
    if len(written) > _LONGEST or _NESTED.search(written):
        return None
    try:
        return re.compile(re.sub(r"(?<!\\)([{}])", r"\\\1", written)), sum(written.count(mark) for mark in "+*?")
    except re.error:
        return None


def _usable(written: str, text: str) -> re.Pattern[str] | None:
    """Return the expression if matching `text` is bound to end soon: backtracking costs a power of the length."""
    compiled = _compile(written)
    if compiled is None or len(text) ** (compiled[1] + 1) > _MOST_STEPS:
        return None
    return compiled[0]


def matches(written: str, text: str) -> bool | None:
    """Tell whether the expression matches somewhere in `text`; None where it is not run."""
    pattern = _usable(written, text)
    return None if pattern is None else pattern.search(text) is not None


def replace_all(written: str, replacement: str, text: str) -> str:
    r"""Return `text` with each match replaced, `\1` standing for groups; unchanged where the expression is not run."""
    pattern = _usable(written, text)
    if pattern is None:
        return text

    def fill(match: re.Match[str]) -> str:
        return re.sub(r"\\(\d)", lambda number: _group(match, int(number[1])), replacement)

    return pattern.sub(fill, text)


def keep_matching(written: str, items: list[str], *, wanted: bool) -> list[str]:
    """Return the items that the expression matches, or those that it does not; all where it is not run."""
    return [item for item in items if matches(written, item) in {wanted, None}]


def _group(match: re.Match[str], number: int) -> str:
    return (match[number] or "") if number <= len(match.groups()) else ""
