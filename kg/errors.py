"""The base error of `kg` and its subclasses by cause.

Every error that users see has a code, a place and a hint. `kg.codes` lists the codes.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, TypeVar

from kg.codes import CATALOGUE, CodeEntry

__all__ = [
    "CATALOGUE",
    "CodeEntry",
    "Exit",
    "Fix",
    "GraphError",
    "KgError",
    "Place",
    "QueryError",
    "RobotError",
    "RuleError",
    "SourceError",
    "StoreError",
    "UnknownNameError",
    "UsageError",
    "choices",
    "guarded",
]

_Result = TypeVar("_Result")
_MOST_CHOICES: Final = 8
_NAME_OR_SIGN: Final = re.compile(r"[?$]?[\w:.-]+|\S")


class Exit(IntEnum):
    """Exit codes of the process, stable for scripts."""

    OK = 0
    FOUND = 1
    """Success with findings, or nothing found."""
    USAGE = 2
    """Invalid command, option or setting."""
    SOURCE = 3
    """Unreadable source."""
    STORE = 4
    """The store is missing, busy, damaged or full."""
    QUERY = 5
    """A query was refused or failed."""
    TIMEOUT = 6
    """A deadline or another limit stopped the work."""
    INTERNAL = 70
    """A defect in `kg`."""
    INTERRUPTED = 130
    """Ctrl-C."""


@dataclass(frozen=True, slots=True)
class Place:
    """A file with an optional line and column, both counted from one.

    `excerpt` is the text of that line for places outside files (a query typed by hand). `end_line` and `end_column`
    are the position after the last wrong character, if known.
    """

    path: str
    line: int | None = None
    column: int | None = None
    excerpt: str | None = None
    end_line: int | None = None
    end_column: int | None = None

    def __str__(self) -> str:
        return ":".join(str(part) for part in (self.path, self.line, self.column) if part is not None)

    def span(self, line: str | None = None) -> tuple[int, int, int, int] | None:
        """Return the start and the end of the error as lines and columns; None for a place without a column.

        Without a known end, the error ends with the name or sign at its start, in `line` or else in the excerpt.
        """
        if self.line is None or self.column is None:
            return None
        if self.end_line is not None and self.end_column is not None:
            return self.line, self.column, self.end_line, self.end_column
        match = _NAME_OR_SIGN.match(line or self.excerpt or "", self.column - 1)
        return self.line, self.column, self.line, match.end() + 1 if match else self.column + 1


@dataclass(frozen=True, slots=True)
class Fix:
    """An edit that fixes an error: `text` replaces the characters at `place`, by default those of the error itself.

    A place with an end is a range; with equal start and end it is an insertion. `title` is empty if "replace by"
    describes the edit.
    """

    text: str
    place: Place | None = None
    title: str = ""


class KgError(Exception):
    """Base class of all errors that `kg` raises deliberately.

    `code` is a key of `CATALOGUE`. `message` describes the error with its values, `place` locates it, and `hint` is the
    fix for this case. `fixes` are alternative edits that do what the hint says, the likeliest first.
    """

    exit_code: Exit = Exit.INTERNAL

    def __init__(
        self,
        code: str,
        message: str,
        *,
        place: Place | None = None,
        hint: str | None = None,
        fixes: Iterable[Fix] = (),
    ) -> None:
        """Create the error; `LookupError` for a code missing from the catalogue."""
        if code not in CATALOGUE:
            raise LookupError(code)
        super().__init__(message)
        self.code = code
        self.message = message
        self.place = place
        self.hint = hint
        self.fixes = tuple(fixes)

    def __str__(self) -> str:
        where = f"{self.place}: " if self.place else ""
        return f"{where}{self.code}: {self.message}"


class UsageError(KgError):
    """Invalid command line, setting or name."""

    exit_code = Exit.USAGE


class UnknownNameError(UsageError):
    """Nothing of this name was found."""

    exit_code = Exit.FOUND


class SourceError(KgError):
    """Unreadable source (folder, repository, list of sources)."""

    exit_code = Exit.SOURCE


class StoreError(KgError):
    """The store is missing, in use by another process, damaged, or not writable."""

    exit_code = Exit.STORE


class QueryError(KgError):
    """A query is malformed, refused by a guard, or failed."""

    exit_code = Exit.QUERY


class GraphError(KgError):
    """Unusable RDF input (an ontology, an import)."""

    exit_code = Exit.FOUND


class RobotError(KgError):
    """A running robot, or a program for one, fails. An invalid address is a usage error."""

    exit_code = Exit.FOUND

    def __init__(self, code: str, message: str, *, place: Place | None = None, hint: str | None = None) -> None:
        """Create the error; `LookupError` for a code missing from the catalogue."""
        super().__init__(code, message, place=place, hint=hint)
        if code == "KG801":
            self.exit_code = Exit.USAGE


class RuleError(KgError):
    """Unusable rule or set of rules."""

    exit_code = Exit.FOUND


def choices(lines: Sequence[str]) -> str:
    """Return a hint with one line for each choice: the first ones, and the number of the others."""
    more = [f"... and {len(lines) - _MOST_CHOICES} more"] if len(lines) > _MOST_CHOICES else []
    return "\n".join([*lines[:_MOST_CHOICES], *more])


def guarded(do: Callable[[], _Result], instead: Callable[[str], _Result]) -> _Result:
    """Return the result of `do`, or that of `instead` for the description of an unexpected exception.

    For independent parts of a build: a defect of `kg` in one must not affect the others. The description contains the
    place in `kg`: `KeyError: 'x' (values.py:7 in read)`.
    """
    try:
        return do()
    except Exception as error:  # noqa: BLE001 - reports any exception
        return instead(_words(error))


def _words(error: Exception) -> str:
    words, trace = f"{type(error).__name__}: {error}", error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return words
    code = trace.tb_frame.f_code
    return f"{words} ({code.co_filename.rpartition('/')[2]}:{trace.tb_lineno} in {code.co_name})"
