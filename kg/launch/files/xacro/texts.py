"""Texts of descriptions: `${expression}` and `$(find p)`, `$(arg x)`, ..., evaluated without running anything.

Source: wiki.ros.org/xacro, "Math expressions" and "Rospack commands"; xacro's own rule is kept that a text of one
expression has the type of its value, while any other text is joined.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.extract.python.evaluation import (
    HOLE,
    MISSING,
    Dialect,
    ExpressionError,
    UnknownValueError,
    UnsupportedError,
    evaluate_text,
    failure,
    is_builtin,
)
from kg.facts import LaunchProblemKind
from kg.launch.files.access import SCHEME, Files, Match
from kg.launch.files.ros1.parameterfile import MOST_CHARACTERS, read_value, shown
from kg.launch.files.xacro.scopes import Table

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kg.corpus.files import FilePath
    from kg.launch.files.ros1.substitute import Note, Substituter


class Loading:
    """Finds and reads files; `read` are those that were read, in their order."""

    def __init__(self, files: Files) -> None:
        self.read: dict[FilePath, None] = {}
        self._files = files

    def data(self, file: FilePath) -> bytes | None:
        """Return the text of a file as UTF-8; None if it is missing, too large or binary."""
        data = self._files.read(file)
        if data is not None:
            self.read[file] = None
        return data

    def find(self, written: str, folder: str) -> Match:
        """Return the file that a text names from a folder."""
        text = written if written.startswith(("/", SCHEME)) or "://" in written else f"{folder}/{written}"
        if HOLE in text or any(mark in text for mark in "*?["):
            return Match(None, reason=f"which file {shown(text)} is, is not known", subject=text)
        return self._files.find(text)

    def yaml(self, written: str, folder: str) -> object:
        """Return a file of YAML as dictionaries; `UnknownValueError` if none can be read."""
        file = self.find(written, folder).file
        data = self.data(file) if file is not None else None
        try:
            content = read_value(data.decode()) if data is not None else None
        except ValueError:
            content = None
        if not isinstance(content, dict):
            raise UnknownValueError
        return content


_TOKEN: Final = re.compile(r"\$\$+(?=[{(])|\$\{[^}]*\}|\$\([^)]*\)|[^$]+|\$")
_NAME: Final = re.compile(r"[^\W\d]\w*")
_MODULES: Final[Mapping[str, str]] = {"math": "math", "python": "builtins"}


@dataclass(slots=True)
class Around:
    """Context of the commands in a text: the arguments of the description, and the folder of its file."""

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
            "load_yaml": loads,
            "xacro.load_yaml": loads,
            "xacro.arg": self._argument,
            "xacro.dotify": lambda value: value,
            **dict.fromkeys((f"xacro.{name}" for name in ("message", "warning", "error", "print_location")), _nothing),
        }

    def value(self, text: str, table: Table) -> object:
        """Return the value of a text in a scope; unknown parts are a `HOLE`."""
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
            except UnknownValueError:
                return HOLE
        if HOLE in expression:
            return HOLE
        dialect = Dialect(
            lambda name: table[name] if name in table else MISSING,  # noqa: SIM401 - a scope is not a dictionary
            self._defined_later,
            self._functions,
            _MODULES,
            _member,
        )
        try:
            return evaluate_text(expression, dialect)
        except UnknownValueError:
            return HOLE
        except (ExpressionError, UnsupportedError) as error:
            self.why.setdefault(failure(expression, error))
            return HOLE

    def _defined_later(self, name: str) -> object:
        later = self.early() if self.early is not None and not is_builtin(name) else None
        return later[name] if later is not None and name in later else MISSING

    def _command(self, words: str) -> str:
        if HOLE in words:
            return HOLE
        return self._substituter.resolve(f"$({words})", self.around, self._note)

    def _note(self, kind: LaunchProblemKind, message: str, subject: str | None = None) -> None:  # noqa: ARG002 - a `Note`
        self.why.setdefault(message)

    def _argument(self, name: str) -> object:
        if name not in self.around.arguments:
            raise UnknownValueError
        return self.around.arguments[name]


def _member(holder: object, name: str) -> object:
    """Return a property of a namespace, or an entry of a dictionary."""
    if isinstance(holder, Table) or (isinstance(holder, dict) and name in holder):
        return holder[name]
    return MISSING


def shown_value(value: object) -> str:
    """Return a value as Python prints it, which is what xacro writes."""
    if isinstance(value, str):
        return value
    try:
        return str(value)
    except ValueError:  # an integer of more digits than Python prints
        return HOLE


def _nothing(*_: object) -> str:
    return ""
