"""Statements and expressions of programs as Python; numbers are in base units."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.errors import Place, RobotError
from kg.robot.programs import kinds, tree
from kg.robot.programs.converting.code import indented
from kg.robot.programs.names import CapabilityIndex, takes_place
from kg.robot.programs.units import described, unit_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from kg.robot.capability import Capability, Parameter
    from kg.robot.programs.converting.members import Members
    from kg.robot.programs.kinds import Kinds

_LEVELS: Final = {"or": 0, "and": 1, "not": 2, "+": 4, "-": 4, "*": 5, "/": 5}
_COMPARISON: Final = 3
_SIGN: Final = 6
_ATOM: Final = 7
_SIGNS: Final = {"=": "==", "!=": "!="}


def number(value: tree.Written) -> str:
    """Return a number as Python, in base units."""
    unit = unit_of(value.unit)
    if isinstance(value.value, bool | str):
        return repr(value.value)
    if unit.symbol.startswith("deg") and unit.symbol != "degC":
        return f"math.radians({value.value:g})"
    return repr(float(f"{value.value * unit.factor:.15g}"))


class Expressions:
    """Generator of expressions, given the code for variables and for readings."""

    def __init__(self, kinds: Kinds, variable: Callable[[str], str], read: Callable[[tree.Read], str]) -> None:
        self._kinds = kinds
        self._variable = variable
        self._read = read

    def of(self, expression: tree.Expression, least: int = 0) -> str:
        """Return an expression, in parentheses if its precedence is lower than `least`."""
        match expression:
            case tree.Written(value=str() as text):
                shown, level = _quoted(text), _ATOM
            case tree.Written():
                shown = number(expression)
                level = _SIGN if shown.startswith("-") else _ATOM
            case tree.Variable():
                shown, level = self._variable(expression.name), _ATOM
            case tree.Read():
                shown, level = self._read(expression), _ATOM
            case tree.Unary():
                shown, level = self._unary(expression)
            case tree.Binary():
                shown, level = self._binary(expression)
            case tree.Position():
                parts = (f"{name}={self.of(one)}" for name, one in expression.parts().items())
                shown, level = f"Place({', '.join(parts)})", _ATOM
        return f"({shown})" if level < least else shown

    def _unary(self, expression: tree.Unary) -> tuple[str, int]:
        inner = self.of(expression.of)
        match expression.operator:
            case "not":
                return f"not {self.of(expression.of, _LEVELS['not'])}", _LEVELS["not"]
            case "-":
                return f"-{self.of(expression.of, _SIGN + 1)}", _SIGN
            case "absolute":
                return f"abs({inner})", _ATOM
            case "count":
                return f"len({inner})", _ATOM
            case "round":
                return f"math.floor({self.of(expression.of, _LEVELS['+'])} + 0.5)", _ATOM

    def _binary(self, expression: tree.Binary) -> tuple[str, int]:
        operator = expression.operator
        if operator == "contains":
            return (
                f"{self.of(expression.right, _COMPARISON + 1)} in {self.of(expression.left, _COMPARISON + 1)}",
                _COMPARISON,
            )
        if operator == "+" and self._kinds.of(expression, "").name == "text":
            return self.text(expression), _ATOM
        level = _LEVELS.get(operator, _COMPARISON)
        left = self.of(expression.left, level + (level == _COMPARISON))
        return f"{left} {_SIGNS.get(operator, operator)} {self.of(expression.right, level + 1)}", level

    def text(self, expression: tree.Expression) -> str:
        """Return the expression that formats a value for people, with units after numbers."""
        if isinstance(expression, tree.Written) and isinstance(expression.value, str):
            return _quoted(expression.value)
        parts = [self._part(one) for one in self._joined(expression)]
        if any("\\" in inside for _, inside in parts) or any('"' in inside for _, inside in parts):
            return " + ".join(whole for whole, _ in parts)
        return 'f"' + "".join(inside for _, inside in parts).replace("\n", "\\n") + '"'

    def _joined(self, expression: tree.Expression) -> list[tree.Expression]:
        text = self._kinds.of(expression, "").name == "text"
        if text and isinstance(expression, tree.Binary) and expression.operator == "+":
            return [*self._joined(expression.left), *self._joined(expression.right)]
        return [expression]

    def _part(self, expression: tree.Expression) -> tuple[str, str]:
        """Return a part of a text as an expression of its own, and as it is written in an f-string."""
        if isinstance(expression, tree.Written) and isinstance(expression.value, str):
            return _quoted(expression.value), expression.value.replace("{", "{{").replace("}", "}}")
        shown, kind = self.of(expression), self._kinds.of(expression, "")
        if kind.name == "number":
            unit = f" {described(kind.dimension)}" if kind.dimension else ""
            return f"f'{{{shown}:.6g}}{unit}'", f"{{{shown}:.6g}}{unit}"
        return (shown if kind.name == "text" else f"str({shown})"), f"{{{shown}}}"


def _quoted(text: str) -> str:
    shown = repr(text)
    return shown if shown[0] == '"' or '"' in shown else f'"{shown[1:-1]}"'


class Code:
    """Generator of statements; `used` are the extra methods that they need."""

    def __init__(
        self,
        members: Members,
        index: CapabilityIndex,
        typed: kinds.Kinds,
        program: tree.Program,
        place: Callable[[str], Place] | None,
    ) -> None:
        """Create a generator; variables are attributes if parts run in parallel, else local."""
        self.used: set[str] = set()
        every = [statement for _, statement in tree.statements(program.body)]
        self._shared = any(isinstance(one, tree.Parallel | tree.OnEvent) for one in every)
        self._members = members
        self._index = index
        self._names = members.names
        self._place = place
        self._kinds = typed
        self._components = _assigned_components(every)
        self._given = _given(every, index, self._components)
        self._expressions = Expressions(typed, self._variable, self._read)

    def sequence(self, body: tuple[tree.Statement, ...], path: str) -> list[str]:
        """Return the lines of statements; RobotError KG839 at the first one without generated code."""
        lines = []
        for number, statement in enumerate(body):
            here = f"{path}/{number}"
            lines += [f"# {line}".rstrip() for line in statement.comment.split("\n") if statement.comment]
            try:
                lines += self._statement(statement, here)
            except RobotError as error:
                if error.place is not None or self._place is None:
                    raise
                raise RobotError(error.code, error.message, place=self._place(here), hint=error.hint) from error
        return lines or ["pass"]

    def _variable(self, name: str) -> str:
        variable = self._names.of("variable", name)
        return f"self.{variable}" if self._shared else variable

    def _read(self, read: tree.Read) -> str:
        capability = self._index.read(read.capability)
        return self._members.read(capability, self._index.parameter(capability, read.parameter))

    def _statement(self, statement: tree.Statement, path: str) -> list[str]:
        of = self._expressions.of
        match statement:
            case tree.Do():
                return [self._do(statement)]
            case tree.If():
                return self._if(statement, path)
            case tree.While():
                return [f"while {of(statement.condition)}:", *self._body(statement.body, f"{path}/body", loop=True)]
            case tree.Forever():
                return ["while True:", *self._body(statement.body, f"{path}/body", loop=True)]
            case tree.Repeat():
                always = kinds.constant(statement.times)
                times = str(int(always.value)) if always else f"round({of(statement.times)})"
                return [f"for _ in range({times}):", *self._body(statement.body, f"{path}/body")]
            case tree.For():
                return [self._for(statement), *self._body(statement.body, f"{path}/body")]
            case tree.Break():
                return ["break"]
            case tree.Set():
                return [f"{self._variable(statement.variable)} = {of(statement.value)}"]
            case tree.Wait():
                return [f"self.sleep({of(statement.seconds)})"]
            case tree.WaitUntil():
                return self._wait_until(statement, path)
            case tree.Parallel():
                return self._parallel(statement, path)
            case tree.OnEvent():
                return self._on_event(statement, path)
            case tree.Log():
                text = self._expressions.text(statement.message)
                return self._members.dialect.lines("log", text=text)
            case tree.Stop():
                return ['raise StoppedError("the program stopped itself")']

    def _body(self, body: tuple[tree.Statement, ...], path: str, *, loop: bool = False) -> list[str]:
        lines = self.sequence(body, path)
        lines = lines[1:] if not lines[0] else lines
        return indented(["self.check()", *lines] if loop and lines != ["pass"] else lines)

    def _if(self, statement: tree.If, path: str) -> list[str]:
        lines = [f"if {self._expressions.of(statement.condition)}:", *self._body(statement.then, f"{path}/then")]
        match statement.otherwise:
            case ():
                return lines
            case (tree.If(comment="") as chained,):
                first, *following = self._if(chained, f"{path}/otherwise/0")
                return [*lines, f"el{first}", *following]
            case otherwise:
                return [*lines, "else:", *self._body(otherwise, f"{path}/otherwise")]

    def _for(self, statement: tree.For) -> str:
        variable = self._variable(statement.variable)
        if statement.of is not None:
            return f"for {variable} in {self._expressions.of(statement.of)}:"
        parts = [one for one in (statement.start, statement.end, statement.step) if one is not None]
        whole = [_whole(one) for one in parts]
        if all(one is not None for one in whole):
            start, end, step = [one or 0 for one in whole] + [1] * (3 - len(whole))
            down = end < start
            numbers = [str(start), str(end + (-1 if down else 1))]
            step = -abs(step) if down else abs(step)
            return f"for {variable} in range({', '.join(numbers)}{f', {step}' if step != 1 else ''}):"
        self.used.add("counted")
        return f"for {variable} in counted({', '.join(self._expressions.of(one) for one in parts)}):"

    def _do(self, statement: tree.Do) -> str:
        capability = self._index.write(statement.capability)
        given = self._arguments(capability, statement)
        ordered = [one for one in capability.parameters if one.name in given]
        method, how = self._members.do(capability, self._given[capability.name])
        arguments = [f"{self._members.argument(one.name)}={given[one.name]}" for one in ordered]
        if how == "move":
            seconds = "math.inf" if statement.seconds is None else self._expressions.of(statement.seconds)
            arguments.insert(0, seconds)
        limit = statement.within or statement.seconds
        if how == "reach" and limit is not None:
            arguments.append(f"within={self._expressions.of(limit)}")
        return f"self.{method}({', '.join(arguments)})"

    def _arguments(self, capability: Capability, statement: tree.Do) -> dict[str, str]:
        """Return arguments by parameter; explicit arguments override those of a place."""
        arguments: dict[str, str] = {}
        for name, value in statement.arguments.items():
            if takes_place(capability, name):
                arguments = {**self._of_place(capability, value), **arguments}
            else:
                parameter = self._index.parameter(capability, name)
                arguments[parameter.name] = self._argument(parameter, value)
        return arguments

    def _of_place(self, capability: Capability, place: tree.Expression) -> dict[str, str]:
        parameters = {one.name: one for one in capability.parameters}
        if isinstance(place, tree.Position):
            parts = place.parts().items()
            return {name: self._argument(parameters[name], one) for name, one in parts if name in parameters}
        shown = self._expressions.of(place)
        return {name: f"{shown}.{name}" for name in self._components if name in parameters}

    def _argument(self, parameter: Parameter, value: tree.Expression) -> str:
        unit = unit_of(parameter.unit)
        shown = self._expressions.of(value)
        plain = self._kinds.of(value, "").dimension != unit.dimension
        if isinstance(value, tree.Written) and parameter.type == "integer" and not isinstance(value.value, bool | str):
            return str(round(value.value))
        if parameter.type == "integer":
            return f"round({shown})"
        return shown if plain or unit.factor == 1 else f"{self._expressions.of(value, 5)} / {unit.factor!r}"

    def _wait_until(self, statement: tree.WaitUntil, path: str) -> list[str]:
        condition = self._expressions.of(statement.condition)
        limit = "" if statement.seconds is None else f", {self._expressions.of(statement.seconds)}"
        wait = f"self.until(lambda: {condition}{limit})"
        if statement.otherwise is None:
            return [wait]
        handling = self._body(statement.otherwise, f"{path}/otherwise")
        return ["try:", f"    {wait}", "except TimeoutError:", *handling]

    def _part(self, wanted: str, body: tuple[tree.Statement, ...], path: str) -> tuple[str, list[str]]:
        """Return the name of a function for a part of the program, and its lines."""
        name = self._names.of("part", path, wanted)
        return name, [f"def {name}() -> None:", *self._body(body, path), ""]

    def _parallel(self, statement: tree.Parallel, path: str) -> list[str]:
        self.used.add("together")
        parts = [
            self._part("part", branch, f"{path}/branches/{number}") for number, branch in enumerate(statement.branches)
        ]
        lines = [line for _, part in parts for line in part]
        return ["", *lines, f"self.together({', '.join(name for name, _ in parts)})"]

    def _on_event(self, statement: tree.OnEvent, path: str) -> list[str]:
        method = "as_soon_as" if statement.end else "whenever"
        self.used.add(method)
        then, reaction = self._part("react", statement.then, f"{path}/then")
        body, work = self._part("work", statement.body, f"{path}/body")
        condition = self._expressions.of(statement.condition)
        return ["", *reaction, *work, f"self.{method}(lambda: {condition}, {then}, {body})"]


def _assigned_components(every: list[tree.Statement]) -> set[str]:
    """Return the components that any place in the program sets."""
    parts = (part for one in every for _, expression in tree.expressions_of(one) for part in tree.parts_of(expression))
    return {name for part in parts if isinstance(part, tree.Position) for name in part.parts()}


def _given(every: list[tree.Statement], index: CapabilityIndex, components: set[str]) -> dict[str, tuple[str, ...]]:
    """Return the parameters that a program passes to each capability anywhere, in their order."""
    by_name: dict[str, set[str]] = {}
    order: dict[str, tuple[Parameter, ...]] = {}
    for statement in every:
        if isinstance(statement, tree.Do):
            capability = index.write(statement.capability)
            order[capability.name] = capability.parameters
            given = by_name.setdefault(capability.name, set())
            for name in statement.arguments:
                given.update(components if takes_place(capability, name) else {index.parameter(capability, name).name})
    return {name: tuple(one.name for one in order[name] if one.name in given) for name, given in by_name.items()}


def _whole(expression: tree.Expression) -> int | None:
    if (
        not isinstance(expression, tree.Written)
        or isinstance(expression.value, bool | str)
        or expression.unit is not None
    ):
        return None
    return int(expression.value) if expression.value == int(expression.value) else None
