"""Paths to fields of messages: `linear.x`, `markers[].id`, `yaw(pose.pose.orientation)`, `first(markers).id`.

    path  = ( name | call ) { "." name | "[]" | "[" index "]" }
    call  = function "(" argument { "," argument } ")"
    argument = path | number

`[]` takes what follows of each element of a list. Numbers are written as in Python.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final, TypeAlias

from kg.errors import RobotError

__all__ = ["Argument", "Call", "Each", "Element", "Field", "Path", "parse"]


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a message; of the message itself where there is nothing before it."""

    of: Path | None
    name: str

    def __str__(self) -> str:
        return self.name if self.of is None else f"{self.of}.{self.name}"


@dataclass(frozen=True, slots=True)
class Each:
    """The elements of a list; what follows is taken of each."""

    of: Path

    def __str__(self) -> str:
        return f"{self.of}[]"


@dataclass(frozen=True, slots=True)
class Element:
    """One element of a list, counted from 0, from the end where the index is negative."""

    of: Path
    index: int

    def __str__(self) -> str:
        return f"{self.of}[{self.index}]"


@dataclass(frozen=True, slots=True)
class Call:
    """A function of a path, with numbers or further paths behind it."""

    function: str
    arguments: tuple[Argument, ...]

    def __str__(self) -> str:
        return f"{self.function}({','.join(str(one) for one in self.arguments)})"


Path: TypeAlias = Field | Each | Element | Call
Argument: TypeAlias = Path | float

_TOKEN: Final = re.compile(
    r"\s*(?:(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|(?P<name>[A-Za-z_]\w*)|(?P<sign>[.,()\[\]]))",
    re.ASCII,
)
_DEEPEST: Final = 16


def parse(text: str) -> Path:
    """Return the path that a text is; RobotError KG826 with the place where it is none."""
    parser = _Parser(text)
    path = parser.path(0)
    parser.end()
    return path


class _Parser:
    """A text that is read from the left."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0

    def path(self, depth: int) -> Path:
        """Read a path."""
        if depth > _DEEPEST:
            raise self._wrong(f"at most {_DEEPEST} functions in each other")
        name = self._take("name")
        if name is None:
            raise self._wrong("the name of a field or function")
        found: Path = self._call(name, depth) if self._sign("(") else Field(None, name)
        while True:
            if self._sign("."):
                following = self._take("name")
                if following is None:
                    raise self._wrong("the name of a field")
                found = Field(found, following)
            elif self._sign("["):
                found = self._list(found)
            else:
                return found

    def _list(self, found: Path) -> Path:
        index = self._take("number")
        if not self._sign("]"):
            raise self._wrong("`]`")
        if index is None:
            return Each(found)
        if not index.lstrip("+-").isdecimal():
            raise self._wrong("a whole number as an index")
        return Element(found, int(index))

    def _call(self, name: str, depth: int) -> Call:
        arguments: list[Argument] = [self._argument(depth + 1)]
        while self._sign(","):
            arguments.append(self._argument(depth + 1))
        if not self._sign(")"):
            raise self._wrong("`,` or `)`")
        return Call(name, tuple(arguments))

    def _argument(self, depth: int) -> Argument:
        number = self._take("number")
        return self.path(depth) if number is None else float(number)

    def end(self) -> None:
        """Raise RobotError KG826 unless all is read."""
        if self._text[self._at :].strip():
            raise self._wrong("the end")

    def _take(self, group: str) -> str | None:
        found = _TOKEN.match(self._text, self._at)
        if found is None or found[group] is None:
            return None
        self._at = found.end()
        return str(found[group])

    def _sign(self, sign: str) -> bool:
        found = _TOKEN.match(self._text, self._at)
        if found is None or found["sign"] != sign:
            return False
        self._at = found.end()
        return True

    def _wrong(self, expected: str) -> RobotError:
        rest = self._text[self._at :].strip()[:20]
        where = f"before `{rest}`" if rest else "at the end"
        return RobotError("KG826", f"the path `{self._text[:200]}` lacks {expected} {where}")
