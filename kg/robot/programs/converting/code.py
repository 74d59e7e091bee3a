"""Building blocks of generated Python code: identifiers, and templates from files."""

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
    words = "_".join(part.lower() for part in _WORD_ENDS.split(text) if part) or "thing"
    return f"_{words}" if words[0].isdigit() else words


def camel(text: str) -> str:
    """Return a text as the name of a class."""
    words = "".join(part.capitalize() for part in snake(text).split("_"))
    return words if words[:1].isalpha() else f"Program{words}"


def plain(text: str) -> str:
    """Return a text for a docstring or comment: on one line, without quotes and backslashes."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())


def indented(lines: list[str], by: int = 1) -> list[str]:
    """Return lines with more indentation."""
    return [f"{'    ' * by}{line}" if line else "" for line in lines]


class Names:
    """Allocator of unique Python identifiers."""

    def __init__(self, *taken: str) -> None:
        self._taken = {*_TAKEN, *taken}
        self._given: dict[tuple[str, str], str] = {}

    def of(self, kind: str, text: str, wanted: str | None = None) -> str:
        """Return the name of a thing of a kind, the same each time; it is derived from `wanted`."""
        if (kind, text) not in self._given:
            self._given[kind, text] = self._free(snake(text if wanted is None else wanted))
        return self._given[kind, text]

    def _free(self, name: str) -> str:
        candidate, number = name, 2
        while candidate in self._taken or keyword.iskeyword(candidate) or keyword.issoftkeyword(candidate):
            candidate, number = f"{name}_{number}", number + 1
        self._taken.add(candidate)
        return candidate


class Pieces:
    """The templates in a file of this folder, each below a line `#= NAME`; `$word` is a placeholder."""

    def __init__(self, file: str) -> None:
        text = (Path(__file__).parent / f"{file}.txt").read_text(encoding="utf-8")
        _, *pieces = (piece.partition("\n") for piece in text.split("#= "))
        self._pieces = {name: code.strip("\n") for name, _, code in pieces}

    def names(self) -> list[str]:
        """The names of the templates in their order."""
        return list(self._pieces)

    def text(self, name: str, /, **words: object) -> str:
        """Return a template with its placeholders replaced; further lines of a value are indented like the first."""
        return Template(self._pieces[name]).substitute(words)

    def lines(self, name: str, /, **words: object) -> list[str]:
        """Return the lines of a template; none if it is empty."""
        return self.text(name, **words).split("\n") if self._pieces[name] else []


COMMON: Final = Pieces("node")


class Dialect(Pieces):
    """The code that depends on the library: `rospy` for ROS 1, `rclpy` for ROS 2."""

    def __init__(self, library: Literal["rospy", "rclpy"]) -> None:
        super().__init__(library)
        self.ros = 1 if library == "rospy" else 2

    def of_way(self, piece: str, way: Way, /, **words: object) -> list[str]:
        """Return the template for a kind of interface, such as `client of` for a service or an action."""
        package, _, kind = way.type.partition("/")
        name = piece if piece in self.names() else f"{piece} {_ARTICLES[way.kind]}"
        return self.lines(name, package=package, kind=kind, name=way.name, **words)
