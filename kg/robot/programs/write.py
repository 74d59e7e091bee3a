"""Printer of the text form of programs; its output parses to the same tree."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Final

from kg.robot.programs import tree
from kg.robot.programs.parse import LEVELS
from kg.robot.programs.tokens import FUNCTIONS, bare_name, bare_phrase, quoted, quoted_name

_INDENT: Final = "  "
_LEVEL: Final = {operator: level for level, operators in enumerate(LEVELS) for operator in operators}
_NOT: Final = _LEVEL["not"]
_COMPARISON: Final = _LEVEL["="]
_SIGNED: Final = len(LEVELS)


def write(program: tree.Program, *, ids: bool = False) -> str:
    """Return a program as text; with `ids`, those of the statements are written after `@`."""
    lines: list[str] = []
    if program.comment or program.seconds is not None or program.name != tree.Program().name or not program.body:
        within = "" if program.seconds is None else f" within {_number(program.seconds)} s"
        lines += [*_comment(program.comment), f"program {quoted(program.name)}{within}"]
    lines += _Printer(ids=ids).sequence(program.body)
    return "".join(f"{line}\n" for line in lines)


def headline(statement: tree.Statement) -> str:
    """Return the first line of a statement as text."""
    return next(_Printer(ids=False).lines(statement))


def written(expression: tree.Expression) -> str:
    """Return an expression as text."""
    return _expression(expression, 0)


class _Printer:
    def __init__(self, *, ids: bool) -> None:
        self._ids = ids

    def sequence(self, body: Iterable[tree.Statement]) -> Iterator[str]:
        """Yield the lines of statements, each with its comment above."""
        for statement in body:
            yield from _comment(statement.comment)
            yield from self.lines(statement)

    def _within(self, body: Iterable[tree.Statement]) -> Iterator[str]:
        return (_INDENT + line for line in self.sequence(body))

    def _id(self, statement: tree.Statement) -> str:
        return f" @{quoted(statement.id)}" if self._ids and statement.id is not None else ""

    def lines(self, statement: tree.Statement) -> Iterator[str]:
        """Yield the lines of one statement."""
        match statement:
            case tree.Do() | tree.Break() | tree.Set() | tree.Wait() | tree.Log() | tree.Stop():
                return iter((_line(statement) + self._id(statement),))
            case tree.If():
                return self._if(statement)
            case tree.While():
                return self._loop(statement, f"while {written(statement.condition)}")
            case tree.Forever():
                return self._loop(statement, "forever")
            case tree.Repeat():
                return self._loop(statement, f"repeat {written(statement.times)} times")
            case tree.For():
                return self._loop(statement, _for(statement))
            case tree.WaitUntil():
                return self._wait_until(statement)
            case tree.Parallel():
                return self._parallel(statement)
            case tree.OnEvent():
                return self._on_event(statement)

    def _if(self, statement: tree.If) -> Iterator[str]:
        yield f"if {written(statement.condition)} then{self._id(statement)}"
        yield from self._within(statement.then)
        match statement.otherwise:
            case ():
                yield "end"
            case (tree.If(comment="") as chained,):
                first, *rest = self._if(chained)
                yield f"otherwise {first}"
                yield from rest
            case otherwise:
                yield "otherwise"
                yield from self._within(otherwise)
                yield "end"

    def _loop(self, statement: tree.Loop, head: str) -> Iterator[str]:
        yield head + self._id(statement)
        yield from self._within(statement.body)
        yield "end"

    def _wait_until(self, statement: tree.WaitUntil) -> Iterator[str]:
        line = f"wait until {written(statement.condition)}"
        if statement.seconds is not None:
            line += f" within {written(statement.seconds)}"
        if statement.otherwise is None:
            yield line + self._id(statement)
            return
        yield f"{line} otherwise{self._id(statement)}"
        yield from self._within(statement.otherwise)
        yield "end"

    def _parallel(self, statement: tree.Parallel) -> Iterator[str]:
        yield f"at the same time{self._id(statement)}"
        for number, branch in enumerate(statement.branches):
            if number:
                yield "also"
            yield from self._within(branch)
        yield "end"

    def _on_event(self, statement: tree.OnEvent) -> Iterator[str]:
        begin = "as soon as" if statement.end else "whenever"
        yield f"{begin} {written(statement.condition)}{self._id(statement)}"
        yield from self._within(statement.then)
        yield "during"
        yield from self._within(statement.body)
        yield "end"


def _comment(comment: str) -> Iterator[str]:
    if comment:
        yield from (f"# {line}" if line else "#" for line in comment.split("\n"))


def _line(statement: tree.Do | tree.Break | tree.Set | tree.Wait | tree.Log | tree.Stop) -> str:
    match statement:
        case tree.Do():
            return _do(statement)
        case tree.Set():
            return f"set {_name(statement.variable)} to {written(statement.value)}"
        case tree.Wait():
            return f"wait {written(statement.seconds)}"
        case tree.Log():
            return f"log {written(statement.message)}"
        case tree.Break():
            return "break"
        case tree.Stop():
            return "stop"


def _do(statement: tree.Do) -> str:
    line = statement.capability if bare_phrase(statement.capability) else f"do {quoted(statement.capability)}"
    arguments = [f"{_name(name)}: {written(value)}" for name, value in statement.arguments.items()]
    if arguments:
        line += f"  {', '.join(arguments)}"
    for word, time in (("for", statement.seconds), ("within", statement.within)):
        if time is not None:
            shown = written(time)
            line += f" {word} {shown if shown[0].isdigit() else f'({shown})'}"
    return line


def _for(statement: tree.For) -> str:
    if statement.of is not None:
        return f"for each {_name(statement.variable)} in {written(statement.of)}"
    parts = (("from", statement.start), ("to", statement.end), ("step", statement.step))
    limits = "".join(f" {word} {written(part)}" for word, part in parts if part is not None)
    return f"for {_name(statement.variable)}{limits}"


def _name(name: str) -> str:
    return name if bare_name(name) else quoted_name(name)


def _number(value: float) -> str:
    return repr(float(value)).removesuffix(".0")


def _expression(expression: tree.Expression, least: int) -> str:
    """Return an expression as text, in parentheses if its precedence is lower than `least`."""
    match expression:
        case tree.Written(value=bool() as value):
            return "true" if value else "false"
        case tree.Written(value=str() as value):
            return quoted(value)
        case tree.Written(value=value, unit=unit):
            number = _number(float(value))
            return f"{number} {unit}" if unit else number
        case tree.Variable():
            return _name(expression.name)
        case tree.Read():
            shown = expression.capability if bare_name(expression.capability) else quoted(expression.capability)
            return f"{_name(expression.parameter)} of {shown}"
        case tree.Unary():
            return _unary(expression, least)
        case tree.Binary():
            return _binary(expression, least)
        case tree.Position():
            return f"({', '.join(f'{name}: {written(one)}' for name, one in expression.parts().items())})"


def _unary(expression: tree.Unary, least: int) -> str:
    if expression.operator in FUNCTIONS:
        return f"{expression.operator}({written(expression.of)})"
    if expression.operator == "not":
        shown = f"not {_expression(expression.of, _NOT)}"
        return f"({shown})" if least > _NOT else shown
    number = isinstance(expression.of, tree.Written)
    return f"-({written(expression.of)})" if number else f"-{_expression(expression.of, _SIGNED)}"


def _binary(expression: tree.Binary, least: int) -> str:
    level = _LEVEL[expression.operator]
    left = _expression(expression.left, level + (level == _COMPARISON))
    shown = f"{left} {expression.operator} {_expression(expression.right, level + 1)}"
    return f"({shown})" if least > level else shown
