"""Conditions of `if()`, three-valued: true, false, or not known before configuring (None)."""

from __future__ import annotations

import operator
import re
from typing import TYPE_CHECKING, Final

from kg.extract.manifests.cmake_scope import Scope, matches, split_list

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


_TRUE: Final = frozenset({"1", "ON", "YES", "TRUE", "Y"})
_FALSE: Final = frozenset({"0", "OFF", "NO", "FALSE", "N", "IGNORE", "NOTFOUND", ""})
_UNARY: Final = frozenset({"EXISTS", "COMMAND", "DEFINED", "TARGET", "POLICY", "IS_DIRECTORY", "IS_ABSOLUTE", "TEST"})
_ORDER: Final[dict[str, Callable[[float, float], bool]]] = {
    "EQUAL": operator.eq,
    "LESS": operator.lt,
    "GREATER": operator.gt,
    "LESS_EQUAL": operator.le,
    "GREATER_EQUAL": operator.ge,
}
_TEXTS: Final = frozenset({"STREQUAL", "STRLESS", "STRGREATER", "MATCHES", "IN_LIST", "PATH_EQUAL"})
_BINARY: Final = frozenset(_ORDER) | _TEXTS | {f"VERSION_{name}" for name in _ORDER}
_DEEPEST: Final = 40


class Token:
    """An argument of a condition after expansion."""

    __slots__ = ("certain", "quoted", "text")

    def __init__(self, text: str, *, quoted: bool = False, certain: bool = True) -> None:
        self.text = text
        self.quoted = quoted
        self.certain = certain


def decide(tokens: Sequence[Token], scope: Scope) -> bool | None:
    """Return whether the condition holds in `scope`; None if it depends on unknown values, or is malformed."""
    if sum(token.text in {"(", "NOT"} for token in tokens) > _DEEPEST:
        return None
    parser = _Parser(tokens, scope)
    value = parser.either()
    return value if parser.position == len(tokens) else None


class _Parser:
    """Recursive descent over the precedence of if(): tests, comparisons, NOT, AND, OR."""

    def __init__(self, tokens: Sequence[Token], scope: Scope) -> None:
        self.tokens = tokens
        self.scope = scope
        self.position = 0

    def either(self) -> bool | None:
        value = self._both()
        while self._take("OR"):
            other = self._both()
            value = True if True in {value, other} else None if None in {value, other} else False
        return value

    def _both(self) -> bool | None:
        value = self._negated()
        while self._take("AND"):
            other = self._negated()
            value = False if False in {value, other} else None if None in {value, other} else True
        return value

    def _negated(self) -> bool | None:
        if self._take("NOT"):
            value = self._negated()
            return None if value is None else not value
        return self._primary()

    def _take(self, word: str) -> bool:
        if self.position < len(self.tokens):
            token = self.tokens[self.position]
            if token.text == word and not token.quoted:
                self.position += 1
                return True
        return False

    def _primary(self) -> bool | None:
        if self._take("("):
            value = self.either()
            self._take(")")
            return value
        if self.position >= len(self.tokens):
            return None
        token = self.tokens[self.position]
        following = self.tokens[self.position + 1 : self.position + 3]
        if token.text in _UNARY and not token.quoted and following:
            self.position += 2
            name = following[0].text
            defined = bool(self.scope.variables.get(name)) and name not in self.scope.uncertain
            return True if token.text == "POLICY" or (token.text == "DEFINED" and defined) else None
        if following and following[0].text in _BINARY and not following[0].quoted:
            self.position += 3
            return self._compare(token, following[0].text, following[1]) if len(following) > 1 else None
        self.position += 1
        return self._truth(token)

    def _truth(self, token: Token) -> bool | None:
        upper = token.text.upper()
        if not token.certain:
            return None
        if upper in _TRUE or (upper.isdecimal() and int(upper[:9]) != 0):
            return True
        if upper in _FALSE or upper.endswith("-NOTFOUND"):
            return False
        if token.quoted or token.text not in self.scope.variables or token.text in self.scope.uncertain:
            return False if token.quoted else None
        value = self.scope.variables[token.text].upper()
        return not (value in _FALSE or value.endswith("-NOTFOUND"))

    def _compare(self, left: Token, how: str, right: Token) -> bool | None:
        one, other = self._value(left), self._value(right)
        if how == "IN_LIST":
            certain = right.text in self.scope.variables and right.text not in self.scope.uncertain
            return one in split_list(self.scope.variables[right.text]) if one is not None and certain else None
        if one is None or other is None:
            return None
        if how == "MATCHES":
            return matches(right.text, one)
        if how.startswith("VERSION_"):
            return _compare_versions(one, how.removeprefix("VERSION_"), other)
        if how in _ORDER:
            try:
                return _ORDER[how](float(one), float(other))
            except ValueError:
                return None
        return {"STRLESS": one < other, "STRGREATER": one > other}.get(how, one == other)

    def _value(self, token: Token) -> str | None:
        """Return the text of an operand: the value of the variable it names, else itself; None when uncertain."""
        if not token.certain or token.text in self.scope.uncertain or self._is_libraries(token):
            return None
        return token.text if token.quoted else self.scope.variables.get(token.text, token.text)

    def _is_libraries(self, token: Token) -> bool:
        """Return whether an operand is a list of libraries that packages which are looked for export."""
        libraries = self.scope.variables.get("catkin_LIBRARIES")
        return bool(libraries) and token.text in (libraries, "catkin_LIBRARIES")


def _compare_versions(one: str, how: str, other: str) -> bool | None:
    versions = [[int(part[:9]) for part in re.findall(r"\d+", text)] for text in (one, other)]
    if not versions[0] or not versions[1]:
        return None
    width = max(map(len, versions))
    first, second = (version + [0] * (width - len(version)) for version in versions)
    return _ORDER[how](float(first > second), float(second > first))
