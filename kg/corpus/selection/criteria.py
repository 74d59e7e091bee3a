"""Selection criteria as data: a TOML file with the projects of a table to remove (`corpus/criteria.toml`)."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.errors import Place, UsageError
from kg.resources import folder
from kg.settings import toml_place
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from kg.corpus.selection.data import Dataset, Project

_FILE_KEYS: Final = ("project", "address", "closed", "figures", "criterion")
_KEYS: Final = ("name", "applies", "column", "is", "is_not", "least", "most", "says")
_TESTS: Final = ("is", "is_not", "least", "most")


@dataclass(frozen=True, slots=True)
class Criterion:
    """A condition that removes a project by one cell: its text, or a number out of bounds.

    `line` is its place in the file.
    """

    name: str
    column: str
    says: str
    line: int
    applies: bool = True
    equal: frozenset[str] | None = None
    unequal: frozenset[str] | None = None
    least: int | None = None
    most: int | None = None

    def removes(self, project: Project, dataset: Dataset) -> bool:
        """Return whether the project is removed; an unknown number removes nothing."""
        cell = project.cells[self.column]
        if self.equal is not None and cell in self.equal:
            return True
        if self.unequal is not None and cell not in self.unequal:
            return True
        if self.least is None and self.most is None:
            return False
        number = dataset.number(project, self.column)
        if number is None:
            return False
        return (self.least is not None and number < self.least) or (self.most is not None and number > self.most)


@dataclass(frozen=True, slots=True)
class Criteria:
    """A file of criteria: the columns of name and address, the columns to count, and the conditions.

    Each cell of the columns `closed` has to be empty or a value that a criterion names. `figures` maps the name of a
    figure to the columns added up for it.
    """

    path: Path
    project: str
    address: str
    closed: tuple[str, ...]
    figures: Mapping[str, tuple[str, ...]]
    criteria: tuple[Criterion, ...]


def default_criteria() -> Path:
    """Return the file of the criteria that come with `kg`."""
    return folder("corpus") / "criteria.toml"


def read_criteria(path: Path) -> Criteria:
    """Return the criteria in a file.

    Raises UsageError: KG130 the file is unreadable or invalid, with the line.
    """
    try:
        text = path.read_text("utf-8")
        content = tomllib.loads(text)
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("KG130", f"the file cannot be read: {error}", place=Place(str(path))) from None
    except tomllib.TOMLDecodeError as error:
        message, line, column = toml_place(str(error))
        raise UsageError("KG130", f"this is not TOML: {message}", place=Place(str(path), line, column)) from None
    return _Reader(path, text).criteria(content)


class _Reader:
    """Reads one file, keeping track of lines."""

    def __init__(self, path: Path, text: str) -> None:
        self.path = path
        lines = text.splitlines()
        self._lines = lines
        self._heads = [number for number, line in enumerate(lines, 1) if re.match(r"\s*\[\[\s*criterion\s*\]\]", line)]

    def criteria(self, content: dict[str, Any]) -> Criteria:
        for key in content:
            self._require_key(key, _FILE_KEYS, self._line(key))
        tables = content.get("criterion", [])
        if not isinstance(tables, list):
            raise self._error("`criterion` is a list of tables", self._line("criterion"), "Write [[criterion]].")
        figures = content.get("figures", {})
        if not isinstance(figures, dict):
            raise self._error("`figures` is a table", self._line("figures"), "Write [figures].")
        parsed = tuple(self._criterion(table, index) for index, table in enumerate(tables))
        for index, one in enumerate(parsed):
            if any(one.name == other.name for other in parsed[:index]):
                raise self._error(f"there are two criteria {one.name!r}", one.line, "Give one another name.")
        return Criteria(
            path=self.path,
            project=self._text(content, "project", self._line("project")),
            address=self._text(content, "address", self._line("address")),
            closed=tuple(self._texts(content.get("closed", []), "closed", self._line("closed"))),
            figures={name: tuple(self._texts(value, name, self._line(name))) for name, value in figures.items()},
            criteria=parsed,
        )

    def _criterion(self, table: Any, index: int) -> Criterion:
        line = self._heads[index] if index < len(self._heads) else None
        if not isinstance(table, dict):
            raise self._error("a criterion is a table", line, "Write [[criterion]].")
        for key in table:
            self._require_key(key, _KEYS, self._line(key, line))
        if not any(key in table for key in _TESTS):
            raise self._error("the criterion removes nothing", line, f"Give it one of {', '.join(_TESTS)}.")
        applies = table.get("applies", True)
        if not isinstance(applies, bool):
            raise self._error("`applies` must be true or false", self._line("applies", line), None)
        return Criterion(
            name=self._text(table, "name", line),
            column=self._text(table, "column", line),
            says=self._text(table, "says", line) if "says" in table else "",
            line=line or 1,
            applies=applies,
            equal=self._values(table, "is", line),
            unequal=self._values(table, "is_not", line),
            least=self._number(table, "least", line),
            most=self._number(table, "most", line),
        )

    def _require_key(self, key: str, keys: Sequence[str], line: int | None) -> None:
        if key not in keys:
            hint = did_you_mean(key, keys) or f"Keys are {', '.join(keys)}."
            raise self._error(f"unknown key `{key}`", line, hint)

    def _text(self, table: dict[str, Any], key: str, line: int | None) -> str:
        value = table.get(key)
        if not isinstance(value, str) or not value.strip():
            raise self._error(
                f"`{key}` is missing or not a string", self._line(key, line) or line, f'Write {key} = "...".'
            )
        return value.strip()

    def _texts(self, value: Any, key: str, line: int | None) -> list[str]:
        if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
            raise self._error(f"`{key}` is not a list of strings", line, f'Write {key} = ["..."].')
        return value

    def _values(self, table: dict[str, Any], key: str, line: int | None) -> frozenset[str] | None:
        return frozenset(self._texts(table[key], key, self._line(key, line))) if key in table else None

    def _number(self, table: dict[str, Any], key: str, line: int | None) -> int | None:
        value = table.get(key)
        if value is not None and (isinstance(value, bool) or not isinstance(value, int)):
            raise self._error(f"`{key}` is not a whole number", self._line(key, line), f"Write {key} = 100.")
        return value

    def _line(self, key: str, start: int | None = None) -> int | None:
        """Return the first line, from `start` on, that sets `key` or begins its table."""
        pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(key)}["']?\s*[\]=]""")
        numbered = enumerate(self._lines[(start or 1) - 1 :], start or 1)
        return next((number for number, line in numbered if pattern.match(line)), start)

    def _error(self, message: str, line: int | None, hint: str | None) -> UsageError:
        return UsageError("KG130", message, place=Place(str(self.path), line), hint=hint)
