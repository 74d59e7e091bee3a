"""Conditions of package.xml format 3 (REP 149): `$ROS_VERSION == 2 and $ROS_DISTRO != humble`."""

from __future__ import annotations

import operator
import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

__all__ = ["holds"]

_TOKEN: Final = re.compile(
    r"""\s*(?:(?P<quoted>"[^"]*"|'[^']*')|(?P<word>[$\w.+-]+)|(?P<mark><=|>=|==|!=|<|>|\(|\)))"""
)
_COMPARE: Final[dict[str, Callable[[str, str], bool]]] = {
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
}
_MOST_TOKENS: Final = 200


def holds(condition: str | None, variables: Mapping[str, str]) -> bool:
    """Tell whether a condition may hold; a comparison with a variable not in `variables`, or malformed, may."""
    if not condition:
        return True
    tokens = _tokens(condition)
    if not tokens or len(tokens) > _MOST_TOKENS:
        return True
    value, rest = _alternatives(tokens, 0, variables)
    return value if rest == len(tokens) else True


def _tokens(condition: str) -> list[str]:
    found, position = [], 0
    while position < len(condition.rstrip()):
        match = _TOKEN.match(condition, position)
        if match is None:
            return []
        found.append(match[0].strip())
        position = match.end()
    return found


def _alternatives(tokens: list[str], start: int, variables: Mapping[str, str]) -> tuple[bool, int]:
    value, position = _conjunction(tokens, start, variables)
    while position < len(tokens) and tokens[position] == "or":
        other, position = _conjunction(tokens, position + 1, variables)
        value = value or other
    return value, position


def _conjunction(tokens: list[str], start: int, variables: Mapping[str, str]) -> tuple[bool, int]:
    value, position = _comparison(tokens, start, variables)
    while position < len(tokens) and tokens[position] == "and":
        other, position = _comparison(tokens, position + 1, variables)
        value = value and other
    return value, position


def _comparison(tokens: list[str], start: int, variables: Mapping[str, str]) -> tuple[bool, int]:
    if start < len(tokens) and tokens[start] == "(":
        value, position = _alternatives(tokens, start + 1, variables)
        return value, position + 1
    if start + 2 >= len(tokens) or tokens[start + 1] not in _COMPARE:
        return True, len(tokens) + 1
    left, right = _value(tokens[start], variables), _value(tokens[start + 2], variables)
    return left is None or right is None or _COMPARE[tokens[start + 1]](left, right), start + 3


def _value(token: str, variables: Mapping[str, str]) -> str | None:
    return variables.get(token[1:]) if token.startswith("$") else token.strip("\"'")
