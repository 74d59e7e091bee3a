"""The tree of a program (onto-ros, section 4.1): statements and expressions, as JSON by msgspec, and going through it.

The tags `block` and `expression` say in JSON what a part is. `id` names a statement for faces; it means nothing.
What a part alone tells to be senseless is refused when it is made, so that every tree can be written as text.
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
    """A value as written: a number, with its unit if it has one, a text or a truth value."""

    value: float | bool | str
    unit: str | None = None

    def __post_init__(self) -> None:
        """Refuse (ValueError) a unit that is not known, or behind what is not a number, and numbers without end."""
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
    """What a read capability gives in one of its parameters now; it waits for the first message.

    Capabilities and parameters are named as in `kg.robot.capability`, or by their labels.
    """

    capability: str
    parameter: str


class Unary(_Expression, frozen=True, tag_field="expression", tag="unary"):
    """`not`, a minus sign, or a function of one value; `count` is that of a list's elements or a text's characters."""

    operator: Literal["not", "-", "absolute", "round", "count"]
    of: Expression


class Binary(_Expression, frozen=True, tag_field="expression", tag="binary"):
    """Arithmetic, a comparison or a connective; `contains` asks whether a list has an element.

    A text plus anything is the text with that written behind it.
    """

    operator: Literal["+", "-", "*", "/", "<", "<=", "=", "!=", ">=", ">", "and", "or", "contains"]
    left: Expression
    right: Expression


class Position(_Expression, frozen=True, tag_field="expression", tag="place"):
    """A place on the robot's map, and where to look there: lengths and an angle, in m and rad without units.

    The argument `at` of a capability takes one for those of its parameters that are called as these members.
    """

    x: Expression
    y: Expression
    z: Expression | None = None
    heading: Expression | None = None

    def parts(self) -> dict[str, Expression]:
        """Return what is said of it, by name."""
        said = {"x": self.x, "y": self.y, "z": self.z, "heading": self.heading}
        return {name: one for name, one in said.items() if one is not None}


Expression: TypeAlias = Written | Variable | Read | Unary | Binary | Position


class _Statement(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    id: str | None = None
    comment: str = ""


class Do(_Statement, frozen=True, tag_field="block", tag="do"):
    """A write capability with its arguments by name.

    `seconds` is how long a movement is kept up; without it a movement that has to be renewed ends only with the part
    of the program that it stands in. `within` is the time after which what ends by itself (a goal, a service) is given
    up as failed.
    """

    capability: str
    arguments: dict[str, Expression] = {}
    seconds: Expression | None = None
    within: Expression | None = None


class If(_Statement, frozen=True, tag_field="block", tag="if"):
    """One of two sequences."""

    condition: Expression
    then: tuple[Statement, ...] = ()
    otherwise: tuple[Statement, ...] = ()


class While(_Statement, frozen=True, tag_field="block", tag="while"):
    """A sequence as long as a condition holds."""

    condition: Expression
    body: tuple[Statement, ...] = ()


class Forever(_Statement, frozen=True, tag_field="block", tag="forever"):
    """A sequence again and again, until `break` or `stop`."""

    body: tuple[Statement, ...] = ()


class Repeat(_Statement, frozen=True, tag_field="block", tag="repeat"):
    """A sequence a number of times."""

    times: Expression
    body: tuple[Statement, ...] = ()


class For(_Statement, frozen=True, tag_field="block", tag="for"):
    """A sequence for each number from one to another, both included, or for each element of a list."""

    variable: str
    start: Expression | None = None
    end: Expression | None = None
    step: Expression | None = None
    of: Expression | None = None
    body: tuple[Statement, ...] = ()

    def __post_init__(self) -> None:
        """Refuse (ValueError) what is neither from one number to another nor over a list."""
        numbers = self.start is not None and self.end is not None
        if numbers == (self.of is not None) or (self.of is not None and (self.start or self.end or self.step)):
            raise ValueError("`for` needs either `start` and `end`, or `of`")


class Break(_Statement, frozen=True, tag_field="block", tag="break"):
    """Leaves the innermost loop."""


class Set(_Statement, frozen=True, tag_field="block", tag="set"):
    """Gives a variable a value."""

    variable: str
    value: Expression


class Wait(_Statement, frozen=True, tag_field="block", tag="wait"):
    """Waits so many seconds of the robot's time."""

    seconds: Expression


class WaitUntil(_Statement, frozen=True, tag_field="block", tag="wait-until"):
    """Waits until a condition holds, or fails after so many seconds; with `otherwise` that is done instead."""

    condition: Expression
    seconds: Expression | None = None
    otherwise: tuple[Statement, ...] | None = None


class Parallel(_Statement, frozen=True, tag_field="block", tag="parallel"):
    """Several sequences at a time; it ends when all have, and when one fails the others are cancelled."""

    branches: tuple[tuple[Statement, ...], ...] = ()


class OnEvent(_Statement, frozen=True, tag_field="block", tag="on-event"):
    """While `body` runs, `then` is done each time that the condition begins to hold.

    With `end` it is done once, and `body` is cancelled before it.
    """

    condition: Expression
    then: tuple[Statement, ...] = ()
    body: tuple[Statement, ...] = ()
    end: bool = False


class Log(_Statement, frozen=True, tag_field="block", tag="log"):
    """Tells whoever looks on."""

    message: Expression


class Stop(_Statement, frozen=True, tag_field="block", tag="stop"):
    """Ends the program and stops the robot."""


Statement: TypeAlias = (
    Do | If | While | Forever | Repeat | For | Break | Set | Wait | WaitUntil | Parallel | OnEvent | Log | Stop
)


class Program(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True, forbid_unknown_fields=True):
    """A program; `seconds` is the time on the robot's clock after which it is ended as failed."""

    version: Literal[1] = 1
    name: str = "program"
    comment: str = ""
    seconds: float | None = None
    body: tuple[Statement, ...] = ()


BLOCKS_DEEP: Final = 50
"""How many statements may stand within each other."""
EXPRESSIONS_DEEP: Final = 40
"""How many expressions may."""


def expressions_of(part: Expression | Statement) -> Iterator[tuple[str, Expression]]:
    """Yield the outermost expressions in a statement, but not in statements within it, or in an expression, by path."""
    for name in part.__struct_fields__:
        value = getattr(part, name)
        for key, one in value.items() if isinstance(value, dict) else ((None, value),):
            if isinstance(one, Expression):
                yield name if key is None else f"{name}/{key}", one


def height(expression: Expression) -> int:
    """Return how many expressions may be nested."""
    return 1 + max((height(inner) for _, inner in expressions_of(expression)), default=0)


def sequences_of(statement: Statement) -> tuple[tuple[str, tuple[Statement, ...]], ...]:
    """Return the sequences of statements within a statement, by the part of the path that leads to them."""
    if isinstance(statement, Parallel):
        return tuple((f"branches/{number}", branch) for number, branch in enumerate(statement.branches))
    names = (name for name in statement.__struct_fields__ if name in {"then", "otherwise", "body"})
    return tuple((name, getattr(statement, name) or ()) for name in names)


def statements(body: Iterable[Statement], path: str = "/body") -> Iterator[tuple[str, Statement]]:
    """Yield statements with their paths, each before those within it."""
    for number, statement in enumerate(body):
        here = f"{path}/{number}"
        yield here, statement
        for part, inner in sequences_of(statement):
            yield from statements(inner, f"{here}/{part}")


def parts_of(expression: Expression) -> Iterator[Expression]:
    """Yield an expression and all that stand within it."""
    yield expression
    for _, inner in expressions_of(expression):
        yield from parts_of(inner)


def reads_of(expression: Expression) -> Iterator[Read]:
    """Yield what an expression reads of the robot."""
    return (part for part in parts_of(expression) if isinstance(part, Read))


def variables_of(expression: Expression) -> Iterator[str]:
    """Yield the names of the variables in an expression."""
    return (part.name for part in parts_of(expression) if isinstance(part, Variable))


def rewritten(program: Program, change: Callable[[dict[str, Any]], Any]) -> Program:
    """Return a program each of whose parts, as JSON has it and the innermost first, is what `change` makes of it."""

    def walk(part: Any) -> Any:
        if isinstance(part, list | tuple):
            return [walk(one) for one in part]
        return change({key: walk(value) for key, value in part.items()}) if isinstance(part, dict) else part

    return msgspec.convert(walk(msgspec.to_builtins(program)), Program)
