"""A table of figures, with those of the paper, and the forms in which it is kept: Markdown, CSV, objects for JSON.

The paper's figures stand in `corpus/rnkg.toml`, as far as they are known. A section of that file has the name of a
table (completeness, code, correctness, search) and figures from 0 to 1 by the words of its rows: `"topic" = 0.9`.
"""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from kg.render.text import printable
from kg.resources import table_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping


@dataclass(frozen=True, slots=True)
class Share:
    """A number out of a total; the total is None if nothing could be counted, and `interval` is set for a sample."""

    part: int
    whole: int
    interval: tuple[float, float] | None = None

    @property
    def value(self) -> float | None:
        """The share from 0 to 1; None without a total."""
        return self.part / self.whole if self.whole else None


@dataclass(frozen=True, slots=True)
class Score:
    """A figure with its interval; `signed` for a difference, which may be negative."""

    value: float
    interval: tuple[float, float]
    signed: bool = False


_UNKNOWN: Final = "-"

Cell = str | int | float | Share | Score | None
"""A cell of a table: text, a count, a figure from 0 to 1, a share, a score, or unknown."""


@dataclass(frozen=True, slots=True)
class Table:
    """Figures under headings; `name` is that of its files, `notes` are sentences below it."""

    name: str
    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    notes: tuple[str, ...] = ()


COLUMN: Final = "RNKG"


def with_paper(table: Table, keys: tuple[str, ...], figures: Mapping[str, float] | None = None) -> Table:
    """Return the table with a column of the paper's figures, matched by the texts of the columns `keys`.

    The table is unchanged if no figure is known; `figures` replaces those of the file.
    """
    if figures is None:
        figures = table_of("corpus", "rnkg.toml").get(table.name, {})
    places = [table.columns.index(key) for key in keys]
    column = [figures.get(" ".join(str(row[place]) for place in places)) for row in table.rows]
    if all(figure is None for figure in column):
        return table
    rows = tuple((*row, figure) for row, figure in zip(table.rows, column, strict=True))
    return replace(table, columns=(*table.columns, COLUMN), rows=rows)


def spelled(cell: Cell) -> str:
    """Return a cell formatted for people."""
    if cell is None:
        return _UNKNOWN
    if isinstance(cell, Share):
        if cell.value is None:
            return _UNKNOWN
        text = f"{100 * cell.value:.1f} % ({cell.part}/{cell.whole})"
        if cell.interval is None:
            return text
        return f"{text} [{100 * cell.interval[0]:.1f}, {100 * cell.interval[1]:.1f}]"
    if isinstance(cell, Score):
        return _score(cell)
    if isinstance(cell, float):
        return f"{cell:.3f}"
    return f"{cell:,}" if isinstance(cell, int) else cell


def _score(cell: Score) -> str:
    form = "+.3f" if cell.signed else ".3f"
    low, high = cell.interval
    return f"{cell.value:{form}} [{low:{form}}, {high:{form}}]"


def as_markdown(table: Table) -> str:
    """Return the table in Markdown, with its title and notes."""
    lines = [f"## {table.title}", "", _line(table.columns), _line("---" for _ in table.columns)]
    lines += [_line(spelled(cell) for cell in row) for row in table.rows]
    if table.notes:
        lines += ["", *table.notes]
    return "\n".join(lines) + "\n"


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def as_csv(table: Table) -> str:
    """Return the table as CSV (RFC 4180 except for line ends).

    A share fills the columns NAME, NAME part and NAME whole.
    """
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    objects = as_objects(table)
    columns = list(dict.fromkeys(key for row in objects for key in row))
    writer.writerow(columns)
    writer.writerows(
        ["" if row.get(column) is None else safe_cell(row[column]) for column in columns] for row in objects
    )
    return out.getvalue()


_FORMULA: Final = ("=", "+", "-", "@")
_LONGEST: Final = 10_000


def safe_cell(value: object) -> object:
    """Return a value as a cell that spreadsheets do not run as a formula; texts from sources may begin like one."""
    if not isinstance(value, str):
        return value
    text = printable(value)[:_LONGEST]
    return f"'{text}" if text.startswith(_FORMULA) else text


def as_objects(table: Table) -> list[dict[str, object]]:
    """Return the rows as plain values for JSON."""
    return [_object(dict(zip(table.columns, row, strict=True))) for row in table.rows]


def _object(row: Mapping[str, Cell]) -> dict[str, object]:
    cells: dict[str, object] = {}
    for name, cell in row.items():
        if not isinstance(cell, Share | Score):
            cells[name] = cell
            continue
        cells[name] = cell.value
        if isinstance(cell, Share):
            cells |= {f"{name} part": cell.part, f"{name} whole": cell.whole}
        if cell.interval is not None:
            cells |= {f"{name} low": cell.interval[0], f"{name} high": cell.interval[1]}
    return cells
