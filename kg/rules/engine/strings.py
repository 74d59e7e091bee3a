"""Tests of text in filters (REGEX, CONTAINS, STRSTARTS, STRENDS) on the spellings of terms, without the store's engine.

Only tests with certainly the same meaning in both are decided: patterns of ASCII without look-around, shorthands or
flags, on strings without a type or a language, and on IRIs within STR. The rest is left open.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

OPEN: Final = -1
"""The filter is left to the engine for that term."""

_STRING: Final = r'"([^"\\\n]*(?:\\[\\"][^"\\\n]*)*)"'
_FORM: Final = re.compile(
    rf"\s*(REGEX|CONTAINS|STRSTARTS|STRENDS)\s*\(\s*(?:(STR)\s*\(\s*\?(\w+)\s*\)|\?(\w+))"
    rf"\s*,\s*(?:{_STRING}|\?(\w+))\s*\)\s*",
    re.IGNORECASE,
)
_SPELT: Final = re.compile(_STRING)
# Plain characters, escaped punctuation, simple classes of characters, the dot, groups, alternatives, anchors, and a few
# repetitions of one character: a group that repeats may take time without end here, which it does not there.
_PLAIN: Final = re.compile(
    r"(?:[A-Za-z0-9_ /:#,;=@~%&<>!'-]|\\[.*+?()|^$/\-]|\[\^?[A-Za-z0-9_/.-]+\]|\.|\((?!\?)|\)(?![*+?])|\|"
    r"|[*+?](?![*+?])|\^|\$)*"
)
_STRINGS: Final = re.compile(r'(?:"[^"\n]*"\n)*+"[^"\n]*"')
"""Strings without a type or a language, one on each line."""

_REPETITIONS: Final = 3


@dataclass(frozen=True, slots=True)
class TextTest:
    """One test: `variable` is its argument; `lexical`: STR is around it.

    What the argument is compared with is the value of the variable `other`; None where it is written in the test.
    """

    name: str
    variable: str
    lexical: bool
    other: str | None
    holds: Callable[[str], object] = bool

    def against(self, spelling: bytes) -> TextTest | None:
        """Return the test with a term for its `other` variable; None if only the engine can decide it."""
        found = _SPELT.fullmatch(spelling.decode())
        holds = _holding(self.name, re.sub(r"\\(.)", r"\1", found[1])) if found else None
        return None if holds is None else replace(self, other=None, holds=holds)

    def decide(self, spellings: Sequence[bytes]) -> NDArray[np.int8]:
        """Return for each term whether the test holds (1, 0), or `OPEN`."""
        text = b"\n".join(spellings).decode()
        if "\\" not in text and _STRINGS.fullmatch(text):
            holds = self.holds
            return np.array([bool(holds(line[1:-1])) for line in text.split("\n")], np.int8)
        return np.fromiter(map(self._decided, spellings), np.int8, len(spellings))

    def _decided(self, spelling: bytes) -> int:
        first = spelling[:1]
        if first == b'"':
            if spelling[-1:] != b'"' or b"\\" in spelling:
                return OPEN
            return bool(self.holds(spelling[1:-1].decode()))
        if first == b"<" and spelling[1:2] != b"<":
            return self.lexical and bool(self.holds(spelling[1:-1].decode()))
        return OPEN


@cache
def text_test(text: str) -> TextTest | None:
    """Return the test that the text of an expression is, None when it is none of these."""
    found = _FORM.fullmatch(text)
    if not found:
        return None
    name, lexical, inner, bare, argument, other = found.groups()
    test = TextTest(name.upper(), inner or bare, bool(lexical), other)
    return test if other else test.against(f'"{argument}"'.encode())


@lru_cache(maxsize=1024)
def _holding(name: str, argument: str) -> Callable[[str], object] | None:
    if name == "CONTAINS":
        return lambda value: argument in value
    if name == "STRSTARTS":
        return lambda value: value.startswith(argument)
    if name == "STRENDS":
        return lambda value: value.endswith(argument)
    return _pattern(argument)


def _pattern(argument: str) -> Callable[[str], object] | None:
    """Return the search for a pattern that two dialects of regular expressions read alike."""
    if not _PLAIN.fullmatch(argument) or "--" in argument:
        return None
    if sum(map(argument.count, "*+")) > _REPETITIONS:
        return None
    # `$` is the end of the text there; here it is also before a line feed at the end.
    ended = re.sub(r"(\\.|\[[^\]]*\])|\$", lambda part: part[1] or r"\Z", argument)
    try:
        return re.compile(ended).search
    except re.error:
        return None
