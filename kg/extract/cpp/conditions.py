"""Conditions of the preprocessor, as far as the version of ROS and the macros of the file decide them.

Packages for both versions of ROS name it in macros that no standard fixes: `ROS_VERSION`, `__ROS_VERSION` or
`ROS_AVAILABLE` with a number, `ROS1`, `USE_ROS2` or `BUILDING_ROS1` defined or not.
"""

from __future__ import annotations

import operator
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

_VERSION: Final = re.compile(rb"(?:\w*_)?ROS_?(?:VERSION|AVAILABLE|EDITION|VERSION_MAJOR)_*", re.IGNORECASE)
_FLAG: Final = re.compile(
    rb"(?:\w*_)?ROS_?([12])(?:_(?:AVAILABLE|BUILD|BUILDING|ENABLED|FOUND|SUPPORT|VERSION))?_*", re.IGNORECASE
)
_DIRECTIVE: Final = re.compile(rb"\s*#\s*(\w+)(.*)", re.DOTALL)
_LEFT_OUT: Final = re.compile(rb"//.*|/\*.*?\*/|\\\r?\n", re.DOTALL)
_TOKEN: Final = re.compile(rb"\w+|&&|\|\||[=!<>]=|[()!<>]|\S")
_MOST_TOKENS: Final = 200
"""A longer condition is not read: its brackets could be deeper than Python can follow."""
_MOST_DIGITS: Final = 18
_MOST_MACROS: Final = 10
"""So many macros in a row can stand for each other."""
_COMPARISONS: Final[dict[bytes, Callable[[int, int], bool]]] = {
    b"==": operator.eq,
    b"!=": operator.ne,
    b"<": operator.lt,
    b"<=": operator.le,
    b">": operator.gt,
    b">=": operator.ge,
}


@dataclass(slots=True)
class Macros:
    """What is known of macros at a place of a file."""

    ros: int
    """The version of ROS."""
    guards: frozenset[bytes] = frozenset()
    """The macros that the file itself defines without a value, anywhere; their names say nothing about ROS."""
    absent: frozenset[bytes] = frozenset()
    """The macros that the build does not define."""
    texts: dict[bytes, bytes | None] = field(default_factory=dict)
    """What the file has certainly defined before the place; None for macros that it has certainly undefined."""


def holds(directive: bytes, macros: Macros) -> bool | None:
    """Return whether the side after a directive is compiled, if no side before it is.

    Args:
        directive: the line of `#if`, `#ifdef`, `#ifndef`, `#elif` or `#else`.
        macros: what is known of macros there.

    Returns:
        None if something else decides it.
    """
    match = _DIRECTIVE.match(directive)
    if match is None:
        return None
    kind, condition = match[1], _LEFT_OUT.sub(b" ", match[2])
    if kind == b"else":
        return True
    tokens = _TOKEN.findall(condition)
    if len(tokens) > _MOST_TOKENS:
        return None
    reading = _Reading(tokens, macros)
    if kind in (b"ifdef", b"ifndef"):
        defined = reading.is_defined(condition.strip())
        return defined if kind == b"ifdef" or defined is None else not defined
    return reading.whole()


class _Reading:
    """A condition that is read from left to right, in logic with an unknown truth (Kleene)."""

    def __init__(self, tokens: list[bytes], macros: Macros) -> None:
        self._tokens = tokens
        self._macros = macros
        self._at = 0

    def whole(self) -> bool | None:
        """Return the truth of the condition; None if a part of it is unknown that decides, or cannot be read."""
        value = self._either()
        return value if self._at == len(self._tokens) else None

    def is_defined(self, name: bytes) -> bool | None:
        """Return whether a macro is defined."""
        if name in self._macros.texts:
            return self._macros.texts[name] is not None
        if name in self._macros.guards:
            return None
        if name in self._macros.absent:
            return False
        if flag := _FLAG.fullmatch(name):
            return int(flag[1]) == self._macros.ros
        return True if _VERSION.fullmatch(name) else None

    def _next(self) -> bytes:
        return self._tokens[self._at] if self._at < len(self._tokens) else b""

    def _take(self) -> bytes:
        token = self._next()
        self._at += 1
        return token

    def _either(self) -> bool | None:
        return self._joined(b"||", self._both, decisive=True)

    def _both(self) -> bool | None:
        return self._joined(b"&&", self._one, decisive=False)

    def _joined(self, sign: bytes, part: Callable[[], bool | None], *, decisive: bool) -> bool | None:
        """Return the truth of parts with a sign between them, of which one that is `decisive` decides."""
        values = [part()]
        while self._next() == sign:
            self._take()
            values.append(part())
        return decisive if decisive in values else None if None in values else not decisive

    def _one(self) -> bool | None:
        token = self._take()
        if token == b"!":
            truth = self._one()
            return None if truth is None else not truth
        if token == b"(":
            truth = self._either()
            return truth if self._take() == b")" else None
        if token == b"defined":
            bracket = self._next() == b"(" and self._take()
            truth = self.is_defined(self._take())
            return truth if not bracket or self._take() == b")" else None
        value = self._value(token)
        if self._next() not in _COMPARISONS:
            return None if value is None else value != 0
        compared, other = _COMPARISONS[self._take()], self._value(self._take())
        return None if value is None or other is None else compared(value, other)

    def _value(self, token: bytes) -> int | None:
        """Return the number that a word of a condition stands for."""
        for _ in range(_MOST_MACROS):
            text = self._macros.texts.get(token)
            if text is None:
                break
            token = text.strip(b"( )")
        if token.isdigit():
            return int(token) if len(token) <= _MOST_DIGITS else None
        if token in (b"true", b"false"):
            return int(token == b"true")
        if token in self._macros.texts or token in self._macros.guards:
            return None
        if token in self._macros.absent:
            return 0
        if flag := _FLAG.fullmatch(token):
            return int(int(flag[1]) == self._macros.ros)
        return self._macros.ros if _VERSION.fullmatch(token) else None
