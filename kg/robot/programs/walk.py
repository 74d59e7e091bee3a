"""Going through the tree of a program: the sequences and expressions of a statement, with their paths."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.robot.programs.tree import (
    Binary,
    Break,
    Do,
    For,
    Forever,
    If,
    Log,
    OnEvent,
    Parallel,
    Position,
    Read,
    Repeat,
    Set,
    Stop,
    Unary,
    Variable,
    Wait,
    WaitUntil,
    While,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.robot.programs.tree import Expression, Statement

__all__ = [
    "BLOCKS_DEEP",
    "EXPRESSIONS_DEEP",
    "expressions_of",
    "height",
    "parts_of",
    "reads_of",
    "sequences_of",
    "statements",
    "variables_of",
]

BLOCKS_DEEP: Final = 50
"""How many statements may stand within each other."""
EXPRESSIONS_DEEP: Final = 40
"""How many expressions may."""


def height(expression: Expression) -> int:
    """Return how many expressions may be nested."""
    match expression:
        case Unary():
            return 1 + height(expression.of)
        case Binary():
            return 1 + max(height(expression.left), height(expression.right))
        case Position():
            return 1 + max(height(one) for one in expression.parts().values())
        case _:
            return 1


def sequences_of(statement: Statement) -> tuple[tuple[str, tuple[Statement, ...]], ...]:
    """Return the sequences of statements within a statement, by the part of the path that leads to them."""
    match statement:
        case If():
            return ("then", statement.then), ("otherwise", statement.otherwise)
        case While() | Forever() | Repeat() | For():
            return (("body", statement.body),)
        case WaitUntil():
            return (("otherwise", statement.otherwise or ()),)
        case Parallel():
            return tuple((f"branches/{number}", branch) for number, branch in enumerate(statement.branches))
        case OnEvent():
            return ("then", statement.then), ("body", statement.body)
        case _:
            return ()


def statements(body: Iterable[Statement], path: str = "/body") -> Iterator[tuple[str, Statement]]:
    """Yield statements with their paths, each before those within it."""
    for number, statement in enumerate(body):
        here = f"{path}/{number}"
        yield here, statement
        for part, inner in sequences_of(statement):
            yield from statements(inner, f"{here}/{part}")


def expressions_of(statement: Statement) -> Iterator[tuple[str, Expression]]:
    """Yield the expressions of a statement, not those of statements within it, by the part of the path."""
    found: dict[str, Expression | None] = {}
    match statement:
        case Do():
            found = {f"arguments/{name}": value for name, value in statement.arguments.items()}
            found |= {"seconds": statement.seconds, "within": statement.within}
        case If() | While() | OnEvent():
            found = {"condition": statement.condition}
        case WaitUntil():
            found = {"condition": statement.condition, "seconds": statement.seconds}
        case Repeat():
            found = {"times": statement.times}
        case For():
            found = {"start": statement.start, "end": statement.end, "step": statement.step, "of": statement.of}
        case Set():
            found = {"value": statement.value}
        case Wait():
            found = {"seconds": statement.seconds}
        case Log():
            found = {"message": statement.message}
        case Forever() | Break() | Stop() | Parallel():
            pass
    yield from ((part, expression) for part, expression in found.items() if expression is not None)


def parts_of(expression: Expression) -> Iterator[Expression]:
    """Yield an expression and all that stand within it."""
    yield expression
    match expression:
        case Unary():
            yield from parts_of(expression.of)
        case Binary():
            yield from parts_of(expression.left)
            yield from parts_of(expression.right)
        case Position():
            for one in expression.parts().values():
                yield from parts_of(one)
        case _:
            pass


def reads_of(expression: Expression) -> Iterator[Read]:
    """Yield what an expression reads of the robot."""
    return (part for part in parts_of(expression) if isinstance(part, Read))


def variables_of(expression: Expression) -> Iterator[str]:
    """Yield the names of the variables in an expression."""
    return (part.name for part in parts_of(expression) if isinstance(part, Variable))
