"""Substitution arguments: `$(find p)`, `$(arg x)`, `$(env X)`, `$(optenv X d)`, `$(anon x)`, `$(dirname)`, `$(eval e)`.

Source: wiki.ros.org/roslaunch/XML, "substitution args". As roslaunch has it, `$(eval` has to be the whole text, and
`$(find)` comes last and takes the path behind it, up to a space.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import lru_cache
from typing import Final, Protocol

from kg.extract.python.evaluation import (
    HOLE,
    MISSING,
    Dialect,
    ExpressionError,
    UnknownValueError,
    UnsupportedError,
    evaluate_text,
    is_builtin,
)
from kg.facts import LaunchProblemKind
from kg.launch.files.access import SCHEME, Files
from kg.launch.files.ros1.parameterfile import MOST_CHARACTERS, automatic

_PACKAGE: Final = re.compile(r"[\w.+-]{1,200}")
_COMMAND: Final = re.compile(r"\$\(([^$()]*)([$()]?)")
_EVAL: Final = "$(eval "
_TRUTH: Final[Mapping[str, object]] = {"true": True, "false": False}
_COMMANDS: Final = frozenset({"find", "env", "optenv", "dirname", "anon", "arg"})


class Note(Protocol):
    """Takes a problem of the text that is being computed."""

    def __call__(self, kind: LaunchProblemKind, message: str, subject: str | None = None) -> None:
        """Record an error, or an unknown part."""


class Surroundings(Protocol):
    """Context of the commands in a text."""

    arguments: dict[str, str]

    @property
    def folder(self) -> str:
        """The text of the folder of the file."""

    def missing(self, name: str, note: Note) -> None:
        """Record that an argument is read that has no value."""


class _SubstitutionError(Exception):
    """Roslaunch would refuse the text."""


class Substituter:
    """Computes texts for one configuration."""

    def __init__(self, files: Files, environment: Mapping[str, str]) -> None:
        self._files = files
        self._environment = environment
        self._packages: dict[str, bool] = {}
        self.unset: dict[str, None] = {}
        """The variables whose value, where one is given, counts more than the empty text without one."""

    def resolve(self, text: str, around: Surroundings, note: Note, most: int = MOST_CHARACTERS) -> str:
        """Return the text with its commands replaced; an unknown part is a `HOLE`, and recorded."""
        if "$" not in text:
            return text
        try:
            if text.startswith(_EVAL) and text.endswith(")"):
                return _Commands(self, around, note).evaluate(text[len(_EVAL) : -1])
            return _Commands(self, around, note).replaced(text, most)
        except _SubstitutionError as error:
            note(LaunchProblemKind.MALFORMED, str(error), text)
            return HOLE

    def environment(self, name: str, note: Note) -> str:
        """Return a variable of the environment that was given."""
        value = self._environment.get(name)
        if value is None:
            note(LaunchProblemKind.UNRESOLVED, f"the environment variable {name} is known only at run time", name)
        return HOLE if value is None else value

    def optional(self, name: str, default: str) -> str:
        """Return a variable of the environment, or the default."""
        value = self._environment.get(name, default)
        if not value:
            self.unset[name] = None
        return value

    def find(self, package: str, note: Note) -> str:
        """Return the text of a package's folder, also for one that is not known."""
        if package not in self._packages:
            self._packages[package] = bool(_PACKAGE.fullmatch(package)) and self._files.share(package) is not None
        if not self._packages[package]:
            message = f"the package '{package}' is neither in the build nor installed"
            note(LaunchProblemKind.UNKNOWN_PACKAGE, message, package)
        return f"{SCHEME}{package}"


class _Commands:
    """The commands of one text."""

    def __init__(self, owner: Substituter, around: Surroundings, note: Note) -> None:
        self._owner = owner
        self._around = around
        self._note = note

    def replaced(self, text: str, most: int) -> str:
        """Return the text with all commands replaced, `$(find)` after the others."""
        for last in (False, True):
            for command in _commands(text):
                words = [word for word in command.split(" ") if word]
                if not words or words[0] not in _COMMANDS:
                    raise _SubstitutionError(f"unknown substitution command $({command})")
                if (words[0] == "find") is last:
                    text = self._placed(text, command, words[0], words[1:]).replace(HOLE * 2, HOLE)
                if len(text) > most:
                    self._note(LaunchProblemKind.LIMIT, f"the text grows to more than {most} characters")
                    return HOLE
        return text

    def _placed(self, text: str, command: str, name: str, words: list[str]) -> str:
        written = f"$({command})"
        if name == "find":
            before, _, after = text.partition(written)
            path, space, rest = after.partition(" ")
            if path:  # it begins with a slash, whether it is written or not
                path = path.replace("\\", "/").lstrip("/")
                after = f"/{path}{space}{rest}"
            return f"{before}{self._find_package(_only(words, command))}{after}"
        return text.replace(written, self._value(name, words, command))

    def _value(self, name: str, words: list[str], command: str) -> str:
        if name == "dirname":
            return self._around.folder
        if name == "optenv":
            if not words:
                raise _SubstitutionError("$(optenv) does not name a variable")
            return self._owner.optional(words[0], " ".join(words[1:]))
        word = _only(words, command)
        if name == "anon":
            return self._anonymous(word)
        return self._argument(word) if name == "arg" else self._owner.environment(word, self._note)

    def _argument(self, name: str) -> str:
        value = self._around.arguments.get(name)
        if value is None:
            self._around.missing(name, self._note)
            return HOLE
        return value

    def _variable(self, name: str) -> object:
        """Return the value of a name in an expression: an argument, reported missing if Python lacks it too."""
        if name not in self._around.arguments and is_builtin(name):
            return MISSING
        return automatic(self._argument(name))

    def _anonymous(self, name: str) -> str:
        self._note(LaunchProblemKind.UNRESOLVED, f"$(anon {name}) is a name made up at run time", name)
        return f"{name}_{HOLE}"

    def _find_package(self, package: str) -> str:
        return self._owner.find(package, self._note)

    def evaluate(self, expression: str) -> str:
        """Return the value of `$(eval ...)` as text."""
        if "__" in expression:
            raise _SubstitutionError("$(eval ...) may not contain double underscores")
        functions: dict[str, Callable[..., object]] = {
            "arg": lambda name: automatic(self._argument(name)),
            "find": self._find_package,
            "env": lambda name: self._owner.environment(name, self._note),
            "optenv": lambda name, default="": self._owner.optional(name, default),
            "anon": self._anonymous,
            "dirname": lambda: self._around.folder,
        }
        try:
            dialect = Dialect(lambda name: _TRUTH.get(name, MISSING), self._variable, functions)
            return str(evaluate_text(expression, dialect))
        except UnknownValueError:
            return HOLE
        except UnsupportedError as error:
            self._note(LaunchProblemKind.UNRESOLVED, f"the expression is not evaluated: {error}", expression)
            return HOLE
        except ExpressionError as error:
            raise _SubstitutionError(f"the expression of $(eval) is wrong: {error}") from None


@lru_cache(maxsize=4096)
def _commands(text: str) -> tuple[str, ...]:
    """Return the content of each `$(...)` of a text, in order."""
    commands: list[str] = []
    for command, end in _COMMAND.findall(text):
        if not end:
            break
        if end != ")":
            raise _SubstitutionError(f"'{end}' inside a substitution")
        if command:
            commands.append(command)
    return tuple(commands)


def _only(words: list[str], command: str) -> str:
    if len(words) != 1:
        raise _SubstitutionError(f"$({command}) takes one word")
    return words[0]
