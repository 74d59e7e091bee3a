"""Texts of descriptions: `${expression}` and `$(find p)`, `$(arg x)`, ..., evaluated without running anything.

Source: wiki.ros.org/xacro, "Math expressions" and "Rospack commands"; xacro's own rule is kept that a text of one
expression has the type of its value, while any other text is joined.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.launch.expressions import BUILTINS, MATHEMATICS, ExpressionError, evaluate_expression
from kg.extract.launch.ros1.texts import HOLE, MOST_CHARACTERS
from kg.extract.launch.xacro.table import NotKnownError, Table
from kg.facts import LaunchProblemKind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from kg.extract.launch.ros1.substitute import Note, Substituter

__all__ = ["Around", "Texts", "shown_value"]

_TOKEN: Final = re.compile(r"\$\$+(?=[{(])|\$\{[^}]*\}|\$\([^)]*\)|[^$]+|\$")
_NAME: Final = re.compile(r"[^\W\d]\w*")
_PYTHON: Final[Mapping[str, object]] = {
    **MATHEMATICS,
    **{f"math.{name}": value for name, value in MATHEMATICS.items()},
    **{f"python.{name}": value for name, value in BUILTINS.items()},
}


@dataclass(slots=True)
class Around:
    """What the commands of a text refer to: the arguments of the description, and the folder of its file."""

    arguments: dict[str, str]
    folder: str

    def missing(self, name: str, note: Note) -> None:
        """Record that an argument is read that has no value."""
        note(LaunchProblemKind.UNRESOLVED, f"the description reads the argument '{name}', which has no value", name)


class Texts:
    """Evaluates the texts of one description; `loads` reads a file of YAML for `xacro.load_yaml`."""

    def __init__(self, substituter: Substituter, around: Around, loads: Callable[[str], object]) -> None:
        self.around = around
        self.why: dict[str, None] = {}
        """What is not known, in words."""
        self.early: Callable[[], Table] | None = None
        """Returns what is defined only later; asked where a name is not known."""
        self._substituter = substituter
        self._functions: dict[str, Callable[..., object]] = {
            **BUILTINS,
            "load_yaml": loads,
            "xacro.load_yaml": loads,
            "xacro.arg": self._argument,
            "xacro.dotify": lambda value: value,
            **dict.fromkeys((f"xacro.{name}" for name in ("message", "warning", "error", "print_location")), _nothing),
        }

    def value(self, text: str, table: Table) -> object:
        """Return the value of a text in a scope; what is not known in it is a `HOLE`."""
        if "$" not in text:
            return text
        parts: list[object] = []
        size = 0
        for token in _TOKEN.findall(text):
            parts.append(self._part(token, table))
            size += len(shown_value(parts[-1]))
            if size > MOST_CHARACTERS:
                return HOLE
        if len(parts) == 1:
            return parts[0]
        return "".join(map(shown_value, parts)).replace(HOLE * 2, HOLE)

    def text(self, text: str, table: Table) -> str:
        """Return a text as it is printed."""
        return shown_value(self.value(text, table))

    def _part(self, token: str, table: Table) -> object:
        if token.startswith("${"):
            return self._expression(token[2:-1], table)
        if token.startswith("$("):
            return self._command(self.text(token[2:-1], table))
        return token[1:] if token.startswith("$$") else token

    def _expression(self, written: str, table: Table) -> object:
        expression = self.text(written, table).strip()
        if _NAME.fullmatch(expression) and expression in table:
            try:
                return table[expression]
            except NotKnownError:
                return HOLE
        if HOLE in expression:
            return HOLE
        try:
            return evaluate_expression(expression, _Names(table, self._functions, self.early), self._functions)
        except NotKnownError:
            return HOLE
        except ExpressionError as error:
            self.why.setdefault(str(error))
            return HOLE

    def _command(self, words: str) -> str:
        if HOLE in words:
            return HOLE
        return self._substituter.resolve(f"$({words})", self.around, self._note)

    def _note(self, kind: LaunchProblemKind, message: str, subject: str | None = None) -> None:  # noqa: ARG002 - a `Note`
        self.why.setdefault(message)

    def _argument(self, name: str) -> object:
        if name not in self.around.arguments:
            raise NotKnownError
        return self.around.arguments[name]


class _Names(Mapping[str, object]):
    """The names that an expression can use: properties, also those of namespaces and dictionaries, and constants."""

    def __init__(self, table: Table, functions: Mapping[str, object], early: Callable[[], Table] | None) -> None:
        self._table = table
        self._functions = functions
        self._early = early

    def _scope(self, name: str) -> Table | None:
        """Return the scope that has a property: the one that is in force, else that of later definitions."""
        if name in self._table:
            return self._table
        if self._early is None or name in self._functions or name in _PYTHON:
            return None
        later = self._early()
        return later if name in later else None

    def __iter__(self) -> Iterator[str]:
        """Yield the names of constants; those of properties are looked up only."""
        return iter(_PYTHON)

    def __len__(self) -> int:
        """Return how many constants there are."""
        return len(_PYTHON)

    def __contains__(self, name: object) -> bool:
        """Tell whether a name, which may have dots, is known."""
        return isinstance(name, str) and (
            name in _PYTHON or (name not in self._functions and self._scope(name.partition(".")[0]) is not None)
        )

    def __getitem__(self, name: str) -> object:
        """Return a value; `NotKnownError` where it, or a part of it, is not known."""
        first, *rest = name.split(".")
        scope = self._scope(first)
        if scope is None:
            return _PYTHON[name]
        value = scope[first]
        for key in rest:
            value = value[key] if isinstance(value, dict | Table) else _missing(name)
        if isinstance(value, Table) or (isinstance(value, str) and HOLE in value):
            raise NotKnownError
        return value


def shown_value(value: object) -> str:
    """Return a value as Python prints it, which is what xacro writes."""
    if isinstance(value, str):
        return value
    try:
        return str(value)
    except ValueError:  # an integer of more digits than Python prints
        return HOLE


def _missing(name: str) -> object:
    raise KeyError(name)


def _nothing(*_: object) -> str:
    return ""
