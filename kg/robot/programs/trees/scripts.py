"""Programs in the terms of behaviour trees, and the scripting language of BehaviorTree.CPP 4, written and parsed.

Bare statements and expressions have no units, and the names of the ontology: numbers are in base units, arguments in
the units of their parameters, and variables have valid names for scripts.
"""

from __future__ import annotations

import re
from math import isfinite
from typing import TYPE_CHECKING, Final, NamedTuple

import msgspec

from kg.robot.programs import tree
from kg.robot.programs.kinds import Kinds, constant
from kg.robot.programs.names import CapabilityIndex, takes_place
from kg.robot.programs.units import unit_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.robot.capability import Capability

OWN: Final = "kg_"
"""Prefix of the internal names of an exported tree."""
COUNT: Final = "count_of_"
"""Prefix of the ports with the length of a list."""
_WORD: Final = re.compile(r"[^A-Za-z0-9_]")


def identifier(name: str) -> str:
    """Return a variable's name as a valid identifier of scripts."""
    word = _WORD.sub("_", name)
    return word if word[:1].isalpha() or word[:1] == "_" else f"_{word}"


def reading(capability: str, parameter: str) -> str:
    """Return the name under which a tree stores the value just read."""
    return f"{capability}_{parameter}"


class Bare:
    """Rewrites statements and expressions to bare ones; RobotError KG832, KG834 for unknown capabilities."""

    def __init__(self, index: CapabilityIndex, kinds: Kinds) -> None:
        self._index = index
        self._kinds = kinds

    def head(self, statement: tree.Statement) -> tree.Statement:
        """Return a statement with its own expressions bare, without nested statements, id and comment.

        Durations are in seconds; the numbers of a loop are those that it counts.
        """
        bare = msgspec.structs.replace(statement, id=None, comment="")
        if isinstance(statement, tree.Do):
            capability = self._index.write(statement.capability)
            arguments = {
                self._index.argument(capability, name): self._argument(capability, name, value)
                for name, value in statement.arguments.items()
            }
            bare = msgspec.structs.replace(bare, capability=capability.name, arguments=arguments)
        if isinstance(statement, tree.Set | tree.For):
            bare = msgspec.structs.replace(bare, variable=identifier(statement.variable))
        own = dict(tree.expressions_of(bare))
        given = {name: self.expression(one) for name, one in own.items() if "/" not in name}
        for name in {"seconds", "within"} & given.keys():
            match given[name]:  # rounding removes errors of calculations in milliseconds
                case tree.Written(value=float() as seconds):
                    given[name] = tree.Written(value=round(seconds, 9))
        return msgspec.structs.replace(bare, **given)

    def _argument(self, capability: Capability, name: str, value: tree.Expression) -> tree.Expression:
        if takes_place(capability, name):
            return self.expression(value)
        parameter = self._index.parameter(capability, name)
        unit = unit_of(parameter.unit)
        bare = self.expression(value)
        if self._kinds.of(value, "").dimension != unit.dimension or unit.factor == 1:
            return bare
        return _folded(tree.Binary(operator="/", left=bare, right=tree.Written(value=unit.factor)))

    def expression(self, expression: tree.Expression) -> tree.Expression:
        """Return an expression in base units; a place in metres and radians."""
        match expression:
            case tree.Written(value=bool() | str()):
                return expression
            case tree.Written(value=value, unit=unit):
                return tree.Written(value=float(value) * unit_of(unit).factor)
            case tree.Variable():
                return tree.Variable(name=identifier(expression.name))
            case tree.Read():
                capability = self._index.read(expression.capability)
                parameter = self._index.parameter(capability, expression.parameter)
                factor = unit_of(parameter.unit).factor
                read = tree.Read(capability=capability.name, parameter=parameter.name)
                return read if factor == 1 else tree.Binary(operator="*", left=read, right=tree.Written(value=factor))
            case tree.Unary():
                return _folded(tree.Unary(operator=expression.operator, of=self.expression(expression.of)))
            case tree.Binary():
                left, right = self.expression(expression.left), self.expression(expression.right)
                return _folded(tree.Binary(operator=expression.operator, left=left, right=right))
            case tree.Position():
                return tree.Position(**{name: self.expression(one) for name, one in expression.parts().items()})


def _folded(expression: tree.Expression) -> tree.Expression:
    always = constant(expression)
    return tree.Written(value=always.value) if always and always.number and isfinite(always.value) else expression


MOST: Final = 1000
"""Maximum length of a list in a tree."""
_SLACK: Final = 1e-9
_DIGITS: Final = 12  # decimal places in a list, so that 0.1 + 0.2 is 0.3


def counted(loop: tree.For) -> list[float] | None:
    """Return the numbers that a bare loop counts; None if they depend on the run, are endless or too many."""
    start, end = constant(loop.start), constant(loop.end)
    step = constant(loop.step)
    if start is None or end is None or (loop.step is not None and step is None):
        return None
    width = 1.0 if step is None else abs(step.value)
    steps = abs(end.value - start.value) / width if width else float("inf")
    if not isfinite(steps) or steps >= MOST:
        return None
    way = width if end.value >= start.value else -width
    return [round(float(start.value + number * way), _DIGITS) for number in range(int(steps + _SLACK) + 1)]


_OPERATORS: Final = {"and": "&&", "or": "||", "=": "=="}
_OURS: Final = {theirs: ours for ours, theirs in _OPERATORS.items()}
_LEVELS: Final = (("||",), ("&&",), ("==", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*", "/"))
_TOKEN: Final = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<text>'[^']*')|(?P<name>[A-Za-z_@][A-Za-z0-9_]*)"
    r"|(?P<sign>:=|[+\-*/]=|==|!=|<=|>=|&&|\|\||[-+*/<>=!();?:&|^~.]))"
)
_ASSIGNING: Final = {":=": "", "=": "", "+=": "+", "-=": "-", "*=": "*", "/=": "/"}


class ScriptError(ValueError):
    """The reason why a script or a program cannot express something, as one clause."""


class Assignment(NamedTuple):
    """A variable and its new value."""

    name: str
    value: tree.Expression


def number(value: float) -> str:
    """Return a number as written in scripts and ports; zero has no sign."""
    return repr(float(value) + 0.0).removesuffix(".0")


def script(expression: tree.Expression) -> str:
    """Return a bare expression as a script; ScriptError if scripts cannot express it."""
    match expression:
        case tree.Written(value=bool() as value):
            return "true" if value else "false"
        case tree.Written(value=str() as value):
            if "'" in value or not value.isprintable():
                raise ScriptError(f"the text {value!r} contains a character that scripts cannot quote")
            return f"'{value}'"
        case tree.Written(value=float() | int() as value):
            return number(value) if value >= 0 else f"-{number(-value)}"
        case tree.Variable(name=name):
            return name
        case tree.Read(capability=capability, parameter=parameter):
            return reading(capability, parameter)
        case tree.Unary(operator="count", of=tree.Read(capability=capability, parameter=parameter)):
            return reading(capability, f"{COUNT}{parameter}")
        case tree.Unary(operator="not" | "-" as operator, of=of):
            return f"{'!' if operator == 'not' else '-'}{_inner(of)}"
        case tree.Binary(operator=operator, left=left, right=right) if operator != "contains":
            return f"{_inner(left)} {_OPERATORS.get(operator, operator)} {_inner(right)}"
        case tree.Unary(operator=operator) | tree.Binary(operator=operator):
            raise ScriptError(f"scripts have no `{operator}`")
        case _:
            raise ScriptError("scripts have no places")


def _inner(expression: tree.Expression) -> str:
    shown = script(expression)
    negative = isinstance(expression, tree.Written) and shown.startswith("-")
    return f"({shown})" if negative or isinstance(expression, tree.Unary | tree.Binary) else shown


def expression_of(code: str, names: Mapping[str, tree.Expression]) -> tree.Expression:
    """Return the expression in a script; `names` map to values read or computed before.

    Raises:
        ScriptError: invalid, or with operators that programs lack.
    """
    reader = _Reader(code, names)
    expression = reader.expression(0, 0)
    reader.end()
    return expression


def assignments(code: str, names: Mapping[str, tree.Expression]) -> list[Assignment]:
    """Return the assignments in a script; raises as `expression_of`."""
    reader = _Reader(code, names)
    result = []
    while not reader.at(""):
        name = reader.take("name")
        operator = _ASSIGNING.get(reader.sign)
        if operator is None:
            raise ScriptError(f"`{reader.sign or name}` does not assign a value")
        reader.take("sign")
        value = reader.expression(0, 0)
        if operator:
            value = tree.Binary(operator=operator, left=tree.Variable(name=name), right=value)  # type: ignore[arg-type] # of four
        result.append(Assignment(name, value))
        if not reader.at(";"):
            break
        reader.take("sign")
    reader.end()
    return result


class _Reader:
    def __init__(self, code: str, names: Mapping[str, tree.Expression]) -> None:
        self._names = names
        self._tokens: list[tuple[str, str]] = []
        at = 0
        while code[at:].strip():
            match = _TOKEN.match(code, at)
            if match is None or match.lastgroup is None:
                raise ScriptError(f"`{code[at:].strip()[:20]}` is not a script")
            self._tokens.append((match.lastgroup, match[match.lastgroup]))
            at = match.end()
        self._next = 0

    @property
    def _token(self) -> tuple[str, str]:
        return self._tokens[self._next] if self._next < len(self._tokens) else ("end", "")

    @property
    def sign(self) -> str:
        """The next sign, empty for anything else."""
        kind, text = self._token
        return text if kind == "sign" else ""

    def at(self, sign: str) -> bool:
        """Return whether a sign comes next; the empty one is the end."""
        return self._token in {("sign", sign), ("end", sign)}

    def take(self, kind: str) -> str:
        """Consume the next token, which has to be of a kind; ScriptError otherwise."""
        next_kind, text = self._token
        if next_kind != kind:
            raise ScriptError(f"`{text or 'the end of the script'}` is not a {kind}")
        self._next += 1
        return text

    def end(self) -> None:
        """Raise ScriptError if input is left."""
        if not self.at(""):
            raise ScriptError(f"programs have no `{self._token[1]}` as in this script")

    def expression(self, level: int, depth: int) -> tree.Expression:
        """Parse operators of a precedence level and above."""
        if depth > tree.EXPRESSIONS_DEEP:
            raise ScriptError(f"expressions are nested more than {tree.EXPRESSIONS_DEEP} deep")
        if level == len(_LEVELS):
            return self._single(depth)
        left = self.expression(level + 1, depth)
        while self.sign in _LEVELS[level]:
            operator = self.take("sign")
            right = self.expression(level + 1, depth)
            left = tree.Binary(operator=_OURS.get(operator, operator), left=left, right=right)  # type: ignore[arg-type] # one of ours
        return left

    def _single(self, depth: int) -> tree.Expression:
        kind, text = self._token
        self._next += 1
        match kind, text:
            case "sign", "!":
                return tree.Unary(operator="not", of=self._single(depth + 1))
            case "sign", "-":
                of = self._single(depth + 1)
                numeric = isinstance(of, tree.Written) and not isinstance(of.value, bool | str)
                return tree.Written(value=-of.value) if numeric else tree.Unary(operator="-", of=of)  # type: ignore[union-attr,operator] # a number
            case "sign", "(":
                inner = self.expression(0, depth + 1)
                if not self.at(")"):
                    raise ScriptError("a `)` is missing")
                self._next += 1
                return inner
            case "number", _:
                return tree.Written(value=float(text))
            case "text", _:
                return tree.Written(value=text[1:-1])
            case "name", "true" | "false":
                return tree.Written(value=text == "true")
            case "name", _:
                return self._names.get(text, tree.Variable(name=text))
        raise ScriptError(f"`{text or 'the end of the script'}` is not a value")
