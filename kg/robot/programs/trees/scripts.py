"""Expressions in the scripting language of BehaviorTree.CPP 4, written and read."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, NamedTuple

from kg.robot.programs.tree import EXPRESSIONS_DEEP, Binary, Read, Unary, Variable, Written
from kg.robot.programs.trees.bare import COUNT, reading

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.programs.tree import Expression

__all__ = ["Assignment", "ScriptError", "assignments", "expression_of", "number", "script"]

_OPERATORS: Final = {"and": "&&", "or": "||", "=": "=="}
_OURS: Final = {theirs: ours for ours, theirs in _OPERATORS.items()}
_LEVELS: Final = (("||",), ("&&",), ("==", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*", "/"))
_TOKEN: Final = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<text>'[^']*')|(?P<name>[A-Za-z_@][A-Za-z0-9_]*)"
    r"|(?P<sign>:=|[+\-*/]=|==|!=|<=|>=|&&|\|\||[-+*/<>=!();?:&|^~.]))"
)
_ASSIGNING: Final = {":=": "", "=": "", "+=": "+", "-=": "-", "*=": "*", "/=": "/"}


class ScriptError(ValueError):
    """What a script cannot say, or a program cannot, in one clause."""


class Assignment(NamedTuple):
    """A variable and its new value."""

    name: str
    value: Expression


def number(value: float) -> str:
    """Return a number as scripts and ports have it; zero has no sign."""
    return repr(float(value) + 0.0).removesuffix(".0")


def script(expression: Expression) -> str:
    """Return a bare expression as a script; ScriptError for what scripts have no words for."""
    match expression:
        case Written(value=bool() as value):
            return "true" if value else "false"
        case Written(value=str() as value):
            if "'" in value or not value.isprintable():
                raise ScriptError(f"the text {value!r} contains a character that scripts cannot quote")
            return f"'{value}'"
        case Written(value=float() | int() as value):
            return number(value) if value >= 0 else f"-{number(-value)}"
        case Variable(name=name):
            return name
        case Read(capability=capability, parameter=parameter):
            return reading(capability, parameter)
        case Unary(operator="count", of=Read(capability=capability, parameter=parameter)):
            return reading(capability, f"{COUNT}{parameter}")
        case Unary(operator="not" | "-" as operator, of=of):
            return f"{'!' if operator == 'not' else '-'}{_inner(of)}"
        case Binary(operator=operator, left=left, right=right) if operator != "contains":
            return f"{_inner(left)} {_OPERATORS.get(operator, operator)} {_inner(right)}"
        case Unary(operator=operator) | Binary(operator=operator):
            raise ScriptError(f"scripts have no `{operator}`")
        case _:
            raise ScriptError("scripts have no places")


def _inner(expression: Expression) -> str:
    shown = script(expression)
    negative = isinstance(expression, Written) and shown.startswith("-")
    return f"({shown})" if negative or isinstance(expression, Unary | Binary) else shown


def expression_of(code: str, names: Mapping[str, Expression]) -> Expression:
    """Return the expression that a script is; `names` stand for what was read or computed before.

    Raises:
        ScriptError: it is none, or has operators that programs lack.
    """
    reader = _Reader(code, names)
    found = reader.expression(0, 0)
    reader.end()
    return found


def assignments(code: str, names: Mapping[str, Expression]) -> list[Assignment]:
    """Return the assignments of a script; raises as `expression_of`."""
    reader = _Reader(code, names)
    found = []
    while not reader.at(""):
        name = reader.take("name")
        operator = _ASSIGNING.get(reader.sign)
        if operator is None:
            raise ScriptError(f"`{reader.sign or name}` does not assign a value")
        reader.take("sign")
        value = reader.expression(0, 0)
        if operator:
            value = Binary(operator=operator, left=Variable(name=name), right=value)  # type: ignore[arg-type] # of four
        found.append(Assignment(name, value))
        if not reader.at(";"):
            break
        reader.take("sign")
    reader.end()
    return found


class _Reader:
    def __init__(self, code: str, names: Mapping[str, Expression]) -> None:
        self._names = names
        self._tokens: list[tuple[str, str]] = []
        at = 0
        while code[at:].strip():
            found = _TOKEN.match(code, at)
            if found is None or found.lastgroup is None:
                raise ScriptError(f"`{code[at:].strip()[:20]}` is not a script")
            self._tokens.append((found.lastgroup, found[found.lastgroup]))
            at = found.end()
        self._next = 0

    @property
    def _token(self) -> tuple[str, str]:
        return self._tokens[self._next] if self._next < len(self._tokens) else ("end", "")

    @property
    def sign(self) -> str:
        """The sign that comes next, empty for anything else."""
        kind, text = self._token
        return text if kind == "sign" else ""

    def at(self, sign: str) -> bool:
        """Tell whether a sign comes next; the empty one is the end."""
        return self._token in {("sign", sign), ("end", sign)}

    def take(self, kind: str) -> str:
        """Return what comes next, which has to be of a kind; ScriptError otherwise."""
        found, text = self._token
        if found != kind:
            raise ScriptError(f"`{text or 'the end of the script'}` is not a {kind}")
        self._next += 1
        return text

    def end(self) -> None:
        """Raise ScriptError when something is left."""
        if not self.at(""):
            raise ScriptError(f"programs have no `{self._token[1]}` as in this script")

    def expression(self, level: int, depth: int) -> Expression:
        """Read operators of a level and above."""
        if depth > EXPRESSIONS_DEEP:
            raise ScriptError(f"expressions are nested more than {EXPRESSIONS_DEEP} deep")
        if level == len(_LEVELS):
            return self._single(depth)
        left = self.expression(level + 1, depth)
        while self.sign in _LEVELS[level]:
            operator = self.take("sign")
            right = self.expression(level + 1, depth)
            left = Binary(operator=_OURS.get(operator, operator), left=left, right=right)  # type: ignore[arg-type] # one of ours
        return left

    def _single(self, depth: int) -> Expression:
        kind, text = self._token
        self._next += 1
        match kind, text:
            case "sign", "!":
                return Unary(operator="not", of=self._single(depth + 1))
            case "sign", "-":
                of = self._single(depth + 1)
                numeric = isinstance(of, Written) and not isinstance(of.value, bool | str)
                return Written(value=-of.value) if numeric else Unary(operator="-", of=of)  # type: ignore[union-attr,operator] # a number
            case "sign", "(":
                inner = self.expression(0, depth + 1)
                if not self.at(")"):
                    raise ScriptError("a `)` is missing")
                self._next += 1
                return inner
            case "number", _:
                return Written(value=float(text))
            case "text", _:
                return Written(value=text[1:-1])
            case "name", "true" | "false":
                return Written(value=text == "true")
            case "name", _:
                return self._names.get(text, Variable(name=text))
        raise ScriptError(f"`{text or 'the end of the script'}` is not a value")
