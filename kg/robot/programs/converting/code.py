"""Names and pieces of Python code: what programs and robots call things, and what files hold below their headings."""

from __future__ import annotations

import keyword
import re
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Final, Literal

if TYPE_CHECKING:
    from kg.robot.capability import Way

_TAKEN: Final = frozenset(
    {"self", "math", "signal", "sys", "time", "threading", "rospy", "rclpy", "actionlib"}
    | {"message", "goal", "found", "one", "main"}
)
_WORD_ENDS: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|[^A-Za-z0-9]+")
_ARTICLES: Final = {"topic": "a topic", "service": "a service", "action": "an action"}


def snake(text: str) -> str:
    """Return a text as the name of a function or variable."""
    made = "_".join(part.lower() for part in _WORD_ENDS.split(text) if part) or "thing"
    return f"_{made}" if made[0].isdigit() else made


def camel(text: str) -> str:
    """Return a text as the name of a class."""
    made = "".join(part.capitalize() for part in snake(text).split("_"))
    return made if made[:1].isalpha() else f"Program{made}"


def plain(text: str) -> str:
    """Return a text as it can stand in a docstring or comment: on one line, without quotes and backslashes."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


def indented(lines: list[str], by: int = 1) -> list[str]:
    """Return lines that stand further to the right."""
    return [f"{'    ' * by}{line}" if line else "" for line in lines]


class Names:
    """Gives each thing a name of its own, which is not a word of Python."""

    def __init__(self, *taken: str) -> None:
        """`taken` are names that are given already."""
        self._taken = {*_TAKEN, *taken}
        self._given: dict[tuple[str, str], str] = {}

    def of(self, kind: str, text: str, wanted: str | None = None) -> str:
        """Return the name of a thing of a kind, the same each time; `wanted` is what it is made from."""
        if (kind, text) not in self._given:
            self._given[kind, text] = self._free(snake(text if wanted is None else wanted))
        return self._given[kind, text]

    def _free(self, name: str) -> str:
        found, number = name, 2
        while found in self._taken or keyword.iskeyword(found) or keyword.issoftkeyword(found):
            found, number = f"{name}_{number}", number + 1
        self._taken.add(found)
        return found


class Pieces:
    """The pieces of code in a file of this folder, each below a line `#= NAME`; `$word` stands for what is given."""

    def __init__(self, file: str) -> None:
        text = (Path(__file__).parent / f"{file}.txt").read_text(encoding="utf-8")
        _, *pieces = (piece.partition("\n") for piece in text.split("#= "))
        self._pieces = {name: code.strip("\n") for name, _, code in pieces}

    def names(self) -> list[str]:
        """Return the names of the pieces in their order."""
        return list(self._pieces)

    def text(self, name: str, /, **words: object) -> str:
        """Return a piece; a word of several lines is put where it stands in a line of its own."""
        return Template(self._pieces[name]).substitute(words)

    def lines(self, name: str, /, **words: object) -> list[str]:
        """Return the lines of a piece, none of an empty one."""
        return self.text(name, **words).split("\n") if self._pieces[name] else []


COMMON: Final = Pieces("node")


class Dialect(Pieces):
    """What depends on the library: `rospy` for ROS 1, `rclpy` for ROS 2."""

    def __init__(self, library: Literal["rospy", "rclpy"]) -> None:
        super().__init__(library)
        self.ros = 1 if library == "rospy" else 2

    def of_way(self, piece: str, way: Way, /, **words: object) -> list[str]:
        """Return a piece for a way, of those that differ by its kind: `client of` that of a service or an action."""
        package, _, kind = way.type.partition("/")
        name = piece if piece in self.names() else f"{piece} {_ARTICLES[way.kind]}"
        return self.lines(name, package=package, kind=kind, name=way.name, **words)
