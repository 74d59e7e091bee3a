"""The syntax tree of programs (onto-ros, section 4.1): statements and expressions, as JSON by msgspec.

The JSON tags `block` and `expression` name the type of a part. User interfaces use `id` to identify statements. Parts
that are invalid on their own are refused at construction, so every tree can be written as text.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import isfinite
from typing import Any, Final, Literal, TypeAlias

import msgspec

from kg.robot.programs.units import UNITS


class _Expression(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    pass


class Written(_Expression, frozen=True, tag_field="expression", tag="value"):
    """A literal: a number, with its unit if it has one, a text or a truth value."""

    value: float | bool | str
    unit: str | None = None

    def __post_init__(self) -> None:
        """Refuse (ValueError) an unknown unit, a unit of a non-number, and numbers that are not finite."""
        if isinstance(self.value, bool | str):
            if self.unit is not None:
                raise ValueError(f"`{self.value}` cannot have a unit")
        elif self.unit is not None and self.unit not in UNITS:
            raise ValueError(f"`{self.unit}` is not a unit")
        elif not isfinite(self.value):
            raise ValueError(f"`{self.value}` is not a number to work with")


class Variable(_Expression, frozen=True, tag_field="expression", tag="variable"):
    """The value of a variable."""

    name: str


class Read(_Expression, frozen=True, tag_field="expression", tag="read"):
    """The current value of a parameter of a readable capability; waits for the first message.

    Capabilities and parameters are named as in `kg.robot.capability`, or by their labels.
    """

    capability: str
    parameter: str


class Unary(_Expression, frozen=True, tag_field="expression", tag="unary"):
    """`not`, a minus sign, or a function of one value; `count` is the length of a list or text."""

    operator: Literal["not", "-", "absolute", "round", "count"]
    of: Expression


class Binary(_Expression, frozen=True, tag_field="expression", tag="binary"):
    """Arithmetic, a comparison or a connective; `contains` tests whether a list has an element.

    A text plus any value is their concatenation.
    """

    operator: Literal["+", "-", "*", "/", "<", "<=", "=", "!=", ">=", ">", "and", "or", "contains"]
    left: Expression
    right: Expression


class Position(_Expression, frozen=True, tag_field="expression", tag="place"):
    """A place on the robot's map with an orientation: lengths and an angle, in m and rad without units.

    The argument `at` of a capability sets the parameters that have the names of these members.
    """

    x: Expression
    y: Expression
    z: Expression | None = None
    heading: Expression | None = None

    def parts(self) -> dict[str, Expression]:
        """The components that are set, by name."""
        components = {"x": self.x, "y": self.y, "z": self.z, "heading": self.heading}
        return {name: one for name, one in components.items() if one is not None}


Expression: TypeAlias = Written | Variable | Read | Unary | Binary | Position


class _Statement(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    id: str | None = None
    comment: str = ""


class Do(_Statement, frozen=True, tag_field="block", tag="do"):
    """An executable capability with its arguments by name.

    `seconds` is the duration of a movement; without it, a continuous movement ends only with the enclosing part of the
    program. `within` is the timeout of a goal or service call.
    """

    capability: str
    arguments: dict[str, Expression] = {}
    seconds: Expression | None = None
    within: Expression | None = None


class If(_Statement, frozen=True, tag_field="block", tag="if"):
    """A conditional with two branches."""

    condition: Expression
    then: tuple[Statement, ...] = ()
    otherwise: tuple[Statement, ...] = ()


class While(_Statement, frozen=True, tag_field="block", tag="while"):
    """A loop while a condition holds."""

    condition: Expression
    body: tuple[Statement, ...] = ()


class Forever(_Statement, frozen=True, tag_field="block", tag="forever"):
    """An endless loop, until `break` or `stop`."""

    body: tuple[Statement, ...] = ()


class Repeat(_Statement, frozen=True, tag_field="block", tag="repeat"):
    """A loop with a number of repetitions."""

    times: Expression
    body: tuple[Statement, ...] = ()


class For(_Statement, frozen=True, tag_field="block", tag="for"):
    """A loop over numbers from one to another, both included, or over the elements of a list."""

    variable: str
    start: Expression | None = None
    end: Expression | None = None
    step: Expression | None = None
    of: Expression | None = None
    body: tuple[Statement, ...] = ()

    def __post_init__(self) -> None:
        """Refuse (ValueError) a loop with neither a range nor a list."""
        numbers = self.start is not None and self.end is not None
        if numbers == (self.of is not None) or (self.of is not None and (self.start or self.end or self.step)):
            raise ValueError("`for` needs either `start` and `end`, or `of`")


class Break(_Statement, frozen=True, tag_field="block", tag="break"):
    """Leaves the innermost loop."""


class Set(_Statement, frozen=True, tag_field="block", tag="set"):
    """Assigns a variable."""

    variable: str
    value: Expression


class Wait(_Statement, frozen=True, tag_field="block", tag="wait"):
    """Waits for some seconds of the robot's time."""

    seconds: Expression


class WaitUntil(_Statement, frozen=True, tag_field="block", tag="wait-until"):
    """Waits until a condition holds, or fails after some seconds; with `otherwise` that runs instead."""

    condition: Expression
    seconds: Expression | None = None
    otherwise: tuple[Statement, ...] | None = None


class Parallel(_Statement, frozen=True, tag_field="block", tag="parallel"):
    """Several sequences in parallel; ends when all have, and a failure of one cancels the others."""

    branches: tuple[tuple[Statement, ...], ...] = ()


class OnEvent(_Statement, frozen=True, tag_field="block", tag="on-event"):
    """While `body` runs, `then` runs each time that the condition becomes true.

    With `end` it runs once, after `body` is cancelled.
    """

    condition: Expression
    then: tuple[Statement, ...] = ()
    body: tuple[Statement, ...] = ()
    end: bool = False


class Log(_Statement, frozen=True, tag_field="block", tag="log"):
    """Emits a text."""

    message: Expression


class Stop(_Statement, frozen=True, tag_field="block", tag="stop"):
    """Ends the program and stops the robot."""


Loop: TypeAlias = While | Forever | Repeat | For
Statement: TypeAlias = Do | If | Loop | Break | Set | Wait | WaitUntil | Parallel | OnEvent | Log | Stop


class Program(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    """A program; `seconds` is its time limit on the robot's clock."""

    version: Literal[1] = 1
    name: str = "program"
    comment: str = ""
    seconds: float | None = None
    body: tuple[Statement, ...] = ()


BLOCKS_DEEP: Final = 50
"""Maximum nesting of statements."""
EXPRESSIONS_DEEP: Final = 40
"""Maximum nesting of expressions."""


def expressions_of(part: Expression | Statement) -> Iterator[tuple[str, Expression]]:
    """Yield the outermost expressions in a statement by path, without those of nested statements."""
    for name in part.__struct_fields__:
        value = getattr(part, name)
        for key, one in value.items() if isinstance(value, dict) else ((None, value),):
            if isinstance(one, Expression):
                yield name if key is None else f"{name}/{key}", one


def height(expression: Expression) -> int:
    """Return the nesting depth of an expression."""
    return 1 + max((height(inner) for _, inner in expressions_of(expression)), default=0)


def sequences_of(statement: Statement) -> tuple[tuple[str, tuple[Statement, ...]], ...]:
    """Return the sequences in a statement, by their part of the path."""
    if isinstance(statement, Parallel):
        return tuple((f"branches/{number}", branch) for number, branch in enumerate(statement.branches))
    names = (name for name in statement.__struct_fields__ if name in {"then", "otherwise", "body"})
    return tuple((name, getattr(statement, name) or ()) for name in names)


def statements(body: Iterable[Statement], path: str = "/body") -> Iterator[tuple[str, Statement]]:
    """Yield statements with their paths, each before those nested in it."""
    for number, statement in enumerate(body):
        here = f"{path}/{number}"
        yield here, statement
        for part, inner in sequences_of(statement):
            yield from statements(inner, f"{here}/{part}")


def parts_of(expression: Expression) -> Iterator[Expression]:
    """Yield an expression and its nested expressions."""
    yield expression
    for _, inner in expressions_of(expression):
        yield from parts_of(inner)


def reads_of(expression: Expression) -> Iterator[Read]:
    """Yield the readings in an expression."""
    return (part for part in parts_of(expression) if isinstance(part, Read))


def variables_of(expression: Expression) -> Iterator[str]:
    """Yield the names of the variables in an expression."""
    return (part.name for part in parts_of(expression) if isinstance(part, Variable))


def rewritten(program: Program, change: Callable[[dict[str, Any]], Any]) -> Program:
    """Return a program with each part, in its JSON form and the innermost first, replaced by the result of `change`."""

    def walk(part: Any) -> Any:
        if isinstance(part, list | tuple):
            return [walk(one) for one in part]
        return change({key: walk(value) for key, value in part.items()}) if isinstance(part, dict) else part

    return msgspec.convert(walk(msgspec.to_builtins(program)), Program)
