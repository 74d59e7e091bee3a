"""Expressions in the text of a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.robot.programs.tree import Binary, Position, Read, Unary, Variable, Written
from kg.robot.programs.units import ALIASES, UNITS
from kg.robot.programs.walk import EXPRESSIONS_DEEP, height
from kg.robot.programs.words import FUNCTIONS, RESERVED
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from kg.errors import RobotError
    from kg.robot.programs.cursor import Cursor
    from kg.robot.programs.tree import Expression

__all__ = ["LEVELS", "expression"]

LEVELS: Final = (("or",), ("and",), ("not",), ("<", "<=", "=", "!=", ">=", ">", "contains"), ("+", "-"), ("*", "/"))
"""Operators from those that bind least to those that bind most; comparisons cannot be chained."""
_NOT: Final = 2
_COMPARISON: Final = 3
_PARTS: Final = ("x", "y", "z", "heading")
"""What is said of a place, in the order in which it is written."""


def expression(cursor: Cursor, path: str) -> Expression:
    """Read an expression; its parts get places below `path`."""
    places, cursor.places = cursor.places, {}
    try:
        return _level(cursor, path, 0, 0)
    finally:
        places.update(cursor.places)
        cursor.places = places


def _level(cursor: Cursor, path: str, depth: int, level: int) -> Expression:
    if depth > EXPRESSIONS_DEEP:
        raise _too_deep(cursor)
    if level == len(LEVELS):
        return _signed(cursor, path, depth)
    cursor.note(path)
    if level == _NOT:
        if not cursor.word("not"):
            return _level(cursor, path, depth, level + 1)
        cursor.take()
        return Unary(operator="not", of=_level(cursor, f"{path}/of", depth + 1, level))
    return _binary(cursor, path, depth, level)


def _binary(cursor: Cursor, path: str, depth: int, level: int) -> Expression:
    left = _level(cursor, path, depth, level + 1)
    begin = cursor.places[path]
    while cursor.sign(*LEVELS[level]) or cursor.word(*LEVELS[level]):
        _below(cursor, path, f"{path}/left")
        cursor.places[path] = begin
        operator: Any = cursor.take().value.lower()
        left = Binary(operator=operator, left=left, right=_level(cursor, f"{path}/right", depth + 1, level + 1))
        if height(left) > EXPRESSIONS_DEEP:
            raise _too_deep(cursor)
        if level == _COMPARISON and (cursor.sign(*LEVELS[level]) or cursor.word("contains")):
            raise cursor.refused(cursor.token, "comparisons cannot be chained", "Write `a < b and b < c`.")
    return left


def _too_deep(cursor: Cursor) -> RobotError:
    message = f"expressions are nested more than {EXPRESSIONS_DEEP} deep"
    return cursor.refused(cursor.token, message, "Use variables.")


def _below(cursor: Cursor, old: str, new: str) -> None:
    """Move the places of a part that turned out to stand below another."""
    for path in [path for path in cursor.places if path == old or path.startswith(f"{old}/")]:
        cursor.places[new + path[len(old) :]] = cursor.places.pop(path)


def _signed(cursor: Cursor, path: str, depth: int) -> Expression:
    cursor.note(path)
    if not cursor.sign("-"):
        return _atom(cursor, path, depth)
    cursor.take()
    if cursor.kind("number"):
        number = cursor.take()
        return Written(value=-_number(cursor, number.value), unit=number.unit)
    return Unary(operator="-", of=_level(cursor, f"{path}/of", depth + 1, len(LEVELS)))


def _atom(cursor: Cursor, path: str, depth: int) -> Expression:
    if cursor.kind("number"):
        return _with_unit(cursor)
    if cursor.kind("text"):
        return Written(value=cursor.take().value)
    if cursor.word("true", "false"):
        return Written(value=cursor.take().value.lower() == "true")
    if cursor.sign("(") and cursor.ahead().kind == "word" and cursor.ahead(2).value == ":":
        return _place(cursor, path, depth)
    if cursor.sign("("):
        return _in_parentheses(cursor, path, depth)
    if cursor.word(*FUNCTIONS) and cursor.ahead().value == "(":
        operator: Any = cursor.take().value.lower()
        return Unary(operator=operator, of=_in_parentheses(cursor, f"{path}/of", depth))
    name, words = _name(cursor)
    if cursor.word("of"):
        cursor.take()
        return Read(parameter=name, capability=_capability(cursor))
    if words > 1:
        hint = "What the robot senses is written `nearest of laserScanning`; quote a variable of several words."
        raise cursor.refused(cursor.ahead(-1), f"`{name}` is not a value", hint)
    return Variable(name=name)


def _in_parentheses(cursor: Cursor, path: str, depth: int) -> Expression:
    cursor.take()
    inner = _level(cursor, path, depth + 1, 0)
    if not cursor.sign(")"):
        raise cursor.expected("`)`")
    cursor.take()
    return inner


def _place(cursor: Cursor, path: str, depth: int) -> Position:
    begin = cursor.take()
    said: dict[str, Expression] = {}
    while not said or cursor.sign(","):
        if said:
            cursor.take()
            cursor.skip()
        name = cursor.token
        part = name.value.lower()
        if part in said or not cursor.word(*_PARTS):
            raise cursor.refused(name, f"{name} is not allowed here", "A place has an x, a y, and maybe z and heading.")
        cursor.take()
        if not cursor.sign(":"):
            raise cursor.expected(f"`:` behind `{part}`")
        cursor.take()
        said[part] = _level(cursor, f"{path}/{part}", depth + 1, 0)
    if not cursor.sign(")"):
        raise cursor.expected("`)`")
    cursor.take()
    if not {"x", "y"} <= said.keys():
        raise cursor.refused(begin, "a place needs its x and its y", "Write `(x: 2 m, y: 1.5 m, heading: 90 deg)`.")
    return Position(x=said["x"], y=said["y"], z=said.get("z"), heading=said.get("heading"))


def _with_unit(cursor: Cursor) -> Written:
    number = cursor.take()
    if number.unit is None and cursor.kind("word") and cursor.token.value.lower() not in RESERVED:
        unit = cursor.token
        raise cursor.refused(
            unit,
            f"`{unit.value}` is not a unit",
            did_you_mean(unit.value, [*UNITS, *ALIASES]) or "Units: " + ", ".join(UNITS),
        )
    return Written(value=_number(cursor, number.value), unit=number.unit)


def _number(cursor: Cursor, digits: str) -> float:
    number = float(digits)
    if number == float("inf"):
        raise cursor.refused(cursor.ahead(-1), f"`{digits}` is too large")
    return number


def _name(cursor: Cursor) -> tuple[str, int]:
    """Return a name in quotes, or the words up to one that means something, and how many they are."""
    if cursor.kind("name"):
        return cursor.take().value, 1
    words = _words(cursor)
    if not words:
        unequal = cursor.sign(">") and cursor.ahead(-1).value == "<"
        raise cursor.expected("a value", hint="Write `!=`." if unequal else None)
    return " ".join(words), len(words)


def _capability(cursor: Cursor) -> str:
    if cursor.kind("name", "text"):
        return cursor.take().value
    words = _words(cursor)
    if not words:
        raise cursor.expected("a capability of the robot", hint='Write it in quotes: `nearest of "scan with a laser"`.')
    return " ".join(words)


def _words(cursor: Cursor) -> list[str]:
    words = []
    while cursor.kind("word") and cursor.token.value.lower() not in RESERVED:
        words.append(cursor.take().value)
    return words
