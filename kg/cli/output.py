"""Data on standard output: JSON Lines, tables, text. No other module of the command line writes there."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from shutil import get_terminal_size
from typing import Any

from kg.cli.diagnostics import colored, note
from kg.errors import Place, UsageError
from kg.lazily import lazily
from kg.render.text import json_text, printable, width

with lazily():
    from rich.console import Console, RenderableType
    from rich.table import Table
    from rich.text import Text

_GAP = 2  # spaces between two columns of a table
_UNBOUNDED = 100_000
_NARROWEST = 24  # least number of columns that text is folded to


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: `kind` is text, number, name (bold) or dim.

    `spare` columns are dropped on narrow terminals: the highest number first, and the last of equal ones.
    """

    title: str
    kind: str = "text"
    spare: int = 0


def numbers(*titles: str, spare: int = 0) -> list[Column]:
    """Return columns of numbers."""
    return [Column(title, "number", spare) for title in titles]


@dataclass(frozen=True, slots=True)
class Linked:
    """A cell with a link to `address`."""

    text: str
    address: str | None


def terminal() -> bool:
    """Return whether standard output is a terminal."""
    return sys.stdout.isatty()


def line_width() -> int:
    """Return the width of standard output in columns, unlimited if it is not a terminal."""
    return get_terminal_size().columns if terminal() else _UNBOUNDED


def write(text: str = "") -> None:
    """Write a line."""
    sys.stdout.write(text + "\n")


def write_bytes(data: bytes) -> None:
    """Write bytes unchanged."""
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


def save(path: str | Path, data: bytes) -> None:
    """Write bytes to a file; UsageError KG003 if it cannot be written."""
    try:
        Path(path).expanduser().write_bytes(data)
    except OSError as error:
        hint = "Check the path."
        raise UsageError("KG003", f"cannot be written: {error.strerror}", place=Place(str(path)), hint=hint) from error


def write_text(text: str, output: str | None) -> None:
    """Write a text to a file, else to standard output; UsageError KG003 if the file cannot be written."""
    if output is None or output == "-":
        write_bytes(text.encode())
    else:
        save(output, text.encode())


def json_lines(records: Iterable[Any]) -> None:
    """Write one JSON object per line."""
    for record in records:
        sys.stdout.write(json_line(record))


def json_value(value: Any, of_bytes: Callable[[bytes], object] = list) -> Any:
    """Return a value of a robot for JSON: null for numbers that are not finite, `of_bytes` of byte arrays."""
    if isinstance(value, dict):
        return {name: json_value(one, of_bytes) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [json_value(one, of_bytes) for one in value]
    if isinstance(value, bytes):
        return of_bytes(value)
    return None if isinstance(value, float) and not isfinite(value) else value


def json_line(record: Any) -> str:
    """Return a value as a line of JSON."""
    return json_text(record) + "\n"


def console() -> Console:
    """Return rich's console for standard output; lines are folded on terminals only."""
    stream = sys.stdout
    is_terminal = stream.isatty()
    return Console(
        file=stream,
        force_terminal=colored(stream) or None,
        no_color=not colored(stream),
        highlight=False,
        markup=False,
        emoji=False,
        soft_wrap=not is_terminal,
        width=None if is_terminal else _UNBOUNDED,
    )


def listing(
    columns: Sequence[Column], rows: Iterable[Sequence[object]], *, objects: Iterable[Any] | None = None
) -> None:
    """Write a list: as JSON Lines if `objects` are given, as a table on a terminal, else as TSV with a header."""
    if objects is not None:
        json_lines(objects)
    elif terminal():
        print_table(columns, rows)
    else:
        for row in ([column.title for column in columns], *rows):
            write("\t".join("" if value is None else printable(str(value)) for value in row))


def show(*parts: RenderableType) -> None:
    """Write rich renderables one after the other; without trailing whitespace if not to a terminal."""
    target = console()
    if terminal():
        target.print(*parts, sep="\n")
        return
    with target.capture() as captured:
        target.print(*parts, sep="\n")
    for line in captured.get().splitlines():
        write(line.rstrip())


def print_table(columns: Sequence[Column], rows: Iterable[Sequence[object]]) -> None:
    """Write a table for people, and report columns that did not fit."""
    every = list(rows)
    show(make_table(columns, every))
    visible = _fitting(columns, [[_cell(value) for value in row] for row in every])
    absent = [column.title for index, column in enumerate(columns) if index not in visible]
    if absent:
        note(f"hidden on a narrow terminal: {', '.join(absent)}")


def make_table(columns: Sequence[Column], rows: Iterable[Sequence[object]]) -> Table:
    """Return a table of printable cells, without the spare columns that do not fit."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - start-up time

    cells = [[_cell(value) for value in row] for row in rows]
    visible = _fitting(columns, cells)
    table = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True, show_edge=False, header_style="bold")
    styles = {"name": "bold", "dim": "dim"}
    for index in visible:
        column = columns[index]
        table.add_column(
            column.title,
            style=styles.get(column.kind),
            justify="right" if column.kind == "number" else "left",
            overflow="fold",
            no_wrap=column.kind in {"number", "name"},
        )
    for row in cells:
        drawn = [
            Text(cell.text, style=f"link {cell.address}" if cell.address else "") if isinstance(cell, Linked) else cell
            for cell in (row[index] for index in visible)
        ]
        table.add_row(*drawn)
    return table


def folded(words: Text, place: Text | None, first: Text, later: Text) -> list[Text]:
    """Return the rows of words and their place, folded to the line; places are never broken.

    The first row begins with `first`, each of the others with `later`.
    """
    columns = max(first.cell_len + _NARROWEST, line_width())
    fits = first.cell_len + words.cell_len <= columns
    rows = [words] if fits else list(words.wrap(console(), columns - later.cell_len))
    start = first if len(rows) == 1 else later
    if place and start.cell_len + rows[-1].cell_len + _GAP + place.cell_len > columns:
        rows.append(place)
    elif place:
        rows[-1] = Text.assemble(rows[-1], " " * _GAP, place)
    return [unfolded(Text.assemble(later if number else first, row)) for number, row in enumerate(rows)]


def unfolded(text: Text) -> Text:
    """Mark a text as one row, however wide, and return it."""
    text.no_wrap, text.overflow = True, "ignore"
    return text


def _fitting(columns: Sequence[Column], cells: Sequence[Sequence[str | Linked]]) -> list[int]:
    """Return the positions of the columns that fit on a line, or cannot be dropped."""
    texts = [[cell.text if isinstance(cell, Linked) else cell for cell in row] for row in cells]
    widths = [
        max([width(column.title), *(width(row[index]) for row in texts)]) + _GAP for index, column in enumerate(columns)
    ]
    visible = list(range(len(columns)))
    spare = [index for index, column in enumerate(columns) if column.spare]
    for index in sorted(spare, key=lambda index: (-columns[index].spare, -index)):
        if sum(widths[one] for one in visible) - _GAP <= line_width():
            break
        visible.remove(index)
    return visible


def _cell(value: object) -> str | Linked:
    if value is None:
        return ""
    if isinstance(value, Linked):
        return Linked(printable(value.text), value.address)
    if isinstance(value, int) and not isinstance(value, bool):
        return f"{value:,}"
    return printable(str(value))


def shortened(places: Sequence[str]) -> tuple[list[str], ...]:
    """Return places in full, without their common folders, and as file names only."""
    folders = [place.split("/")[:-1] for place in places]
    shared = 0
    for level in zip(*folders, strict=False):
        if len(set(level)) > 1:
            break
        shared += len(level[0]) + 1
    without = [f"…/{place[shared:]}" if shared else place for place in places]
    return list(places), without, [place.rpartition("/")[2] for place in places]


def fitted(places: Sequence[str], room: int) -> list[str]:
    """Return the longest form of places that fits a number of columns, else the shortest."""
    *longer, shortest = shortened(places)
    return next((form for form in longer if max(map(width, form), default=0) <= room), shortest)
