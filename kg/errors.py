"""The one error of `kg` and its subclasses by cause.

Every error that reaches a person carries a code, the place it is about and the way out. The codes stand in `kg.codes`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from enum import IntEnum
from typing import Final

from kg.codes import CATALOGUE, CodeEntry

__all__ = [
    "CATALOGUE",
    "CodeEntry",
    "Exit",
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
]

_NAME_OR_SIGN: Final = re.compile(r"[?$]?[\w:.-]+|\S")


class Exit(IntEnum):
    """What the process returns; a contract with scripts."""

    OK = 0
    FOUND = 1
    """It worked and there is something to report, or what was asked for was not found."""
    USAGE = 2
    """The command, an option or a setting is wrong."""
    SOURCE = 3
    """A source could not be read at all."""
    STORE = 4
    """The store is missing, busy, damaged or full."""
    QUERY = 5
    """A query was refused or failed."""
    TIMEOUT = 6
    """A deadline or a limit ended the work."""
    INTERNAL = 70
    """A defect in `kg`."""
    INTERRUPTED = 130
    """Ctrl-C."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is: a file with an optional line and column, both counted from one.

    `excerpt` is the text of that line, for places that no file can be read for (a query typed by hand). `end_line` and
    `end_column` are those behind the last character of what is wrong, where that is known.
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
        """Return the line and the column of what is wrong, and those behind it; None for a place without a column.

        Where its end is not known it is that of the name or sign there, in `line` or else in the excerpt.
        """
        if self.line is None or self.column is None:
            return None
        if self.end_line is not None and self.end_column is not None:
            return self.line, self.column, self.end_line, self.end_column
        found = _NAME_OR_SIGN.match(line or self.excerpt or "", self.column - 1)
        return self.line, self.column, self.line, found.end() + 1 if found else self.column + 1


class KgError(Exception):
    """The base of all errors that `kg` raises on purpose.

    `code` is a key of `CATALOGUE`, `message` says what is wrong with the values in it, `place` where,
    `hint` what to do about it here and now.
    """

    exit_code: Exit = Exit.INTERNAL

    def __init__(self, code: str, message: str, *, place: Place | None = None, hint: str | None = None) -> None:
        """Raise `LookupError` for a code that the catalogue does not have."""
        if code not in CATALOGUE:
            raise LookupError(code)
        super().__init__(message)
        self.code = code
        self.message = message
        self.place = place
        self.hint = hint

    def __str__(self) -> str:
        where = f"{self.place}: " if self.place else ""
        return f"{where}{self.code}: {self.message}"


class UsageError(KgError):
    """The command line, a setting or a name typed by the user is wrong."""

    exit_code = Exit.USAGE


class UnknownNameError(UsageError):
    """What was asked for by name is not there."""

    exit_code = Exit.FOUND


class SourceError(KgError):
    """A source (folder, repository, list of sources) cannot be read at all."""

    exit_code = Exit.SOURCE


class StoreError(KgError):
    """The store is missing, held by another process, damaged, or cannot be written."""

    exit_code = Exit.STORE


class QueryError(KgError):
    """A query is malformed, refused by a guard, or failed."""

    exit_code = Exit.QUERY


class GraphError(KgError):
    """RDF that was given to `kg` (an ontology, an import) cannot be used."""

    exit_code = Exit.FOUND


class RobotError(KgError):
    """A running robot, or a program for one, does not do what it should; an address that is none is a wrong command."""

    exit_code = Exit.FOUND

    def __init__(self, code: str, message: str, *, place: Place | None = None, hint: str | None = None) -> None:
        """Raise `LookupError` for a code that the catalogue does not have."""
        super().__init__(code, message, place=place, hint=hint)
        if code == "KG801":
            self.exit_code = Exit.USAGE


class RuleError(KgError):
    """A rule, or a set of rules, cannot be used as it is written."""

    exit_code = Exit.FOUND
