"""Tables of projects as CSV: rows with their lines, and cells parsed as numbers on demand."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from kg.errors import Place, SourceError
from kg.similar import did_you_mean

_UNKNOWN: Final = frozenset({"", "NA", "N/A", "-", "?"})
"""Texts of cells with an unknown number."""
_WHOLE: Final = re.compile(r"[+-]?[0-9]+")
_LARGEST_CELL: Final = 1 << 20


@dataclass(frozen=True, slots=True)
class Project:
    """A row: `cells` maps each column to its stripped text, `line` is the first line of the row."""

    cells: Mapping[str, str]
    line: int


@dataclass(frozen=True, slots=True)
class Dataset:
    """A table of projects; the first column, `key`, has no duplicates."""

    path: Path
    columns: tuple[str, ...]
    projects: tuple[Project, ...]

    @property
    def key(self) -> str:
        """The column with the names of the projects."""
        return self.columns[0]

    def need(self, columns: Iterable[str], place: Place | None = None) -> None:
        """Raise SourceError KG131 if one of the columns is missing; `place` is where it is required."""
        for column in columns:
            if column not in self.columns:
                hint = did_you_mean(column, self.columns) or f"Its columns are {', '.join(self.columns)}."
                raise SourceError(
                    "KG131",
                    f"{self.path.name} has no column `{column}`",
                    place=place or Place(str(self.path), 1),
                    hint=hint,
                )

    def number(self, project: Project, column: str) -> int | None:
        """Return the number in a cell, None if it is unknown (empty, NA).

        Raises SourceError: KG131 an invalid number.
        """
        text = project.cells[column]
        if text in _UNKNOWN:
            return None
        if not _WHOLE.fullmatch(text):
            raise SourceError(
                "KG131",
                f"`{column}` of {project.cells[self.key]} is {text!r}, which is not a whole number",
                place=Place(str(self.path), project.line),
                hint="Write a whole number, or NA where it is not known.",
            )
        return int(text)


def read_dataset(path: Path) -> Dataset:
    """Return the table in a CSV file (RFC 4180, UTF-8, with a header).

    Raises SourceError: KG101 an unreadable file, KG131 an invalid table, with the line.
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as stream:
            rows = list(_rows(stream, path))
    except OSError as error:
        raise SourceError("KG101", f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise SourceError("KG131", f"the file is not UTF-8: {error.reason}", place=Place(str(path))) from error
    if not rows:
        raise SourceError("KG131", "the file is empty", place=Place(str(path)))
    head, *body = rows
    columns = tuple(cell.strip() for cell in head[1])
    for column in columns:
        if not column or columns.count(column) > 1:
            what = f"duplicate column `{column}`" if column else "a column has no name"
            raise SourceError("KG131", f"{what} in the head", place=Place(str(path), 1))
    projects = tuple(_project(columns, cells, line, path) for line, cells in body)
    lines: dict[str, int] = {}
    for project in projects:
        key = project.cells[columns[0]]
        first = lines.setdefault(key, project.line)
        if first != project.line:
            raise SourceError("KG131", f"{key!r} is already in line {first}", place=Place(str(path), project.line))
    return Dataset(path, columns, projects)


def _rows(stream: Iterable[str], path: Path) -> Iterator[tuple[int, list[str]]]:
    """Yield the non-blank rows, each with its first line: cells may contain line breaks."""
    csv.field_size_limit(_LARGEST_CELL)
    reader = csv.reader(stream, strict=True)
    line = 1
    while True:
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            hint = 'Quote cells that contain commas, quotes or line breaks: "a, b". Double the quotes inside.'
            raise SourceError("KG131", f"this is not CSV: {error}", place=Place(str(path), line), hint=hint) from error
        if any(cell.strip() for cell in cells):
            yield line, cells
        line = reader.line_num + 1


def _project(columns: tuple[str, ...], cells: list[str], line: int, path: Path) -> Project:
    if len(cells) != len(columns):
        raise SourceError(
            "KG131",
            f"the row has {len(cells)} cells, the head {len(columns)}",
            place=Place(str(path), line),
            hint="Quote cells that contain a comma.",
        )
    return Project(dict(zip(columns, map(str.strip, cells), strict=True)), line)
