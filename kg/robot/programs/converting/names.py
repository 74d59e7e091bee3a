"""Names in code: what programs and robots call things, as Python does."""

from __future__ import annotations

import keyword
import re
from typing import Final

__all__ = ["Names", "camel", "plain", "snake"]

_TAKEN: Final = frozenset(
    {"self", "math", "signal", "sys", "time", "threading", "rospy", "rclpy", "actionlib"}
    | {"message", "goal", "found", "one", "main"}
)
_WORD_ENDS: Final = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|[^A-Za-z0-9]+")


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
