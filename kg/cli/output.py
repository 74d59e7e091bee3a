"""Data on standard output: JSON Lines, tables, text. No other module of the command line writes there."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any

from kg.cli.diagnostics import colored
from kg.render.text import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rich.console import Console, RenderableType
    from rich.table import Table

__all__ = [
    "Column",
    "console",
    "json_lines",
    "listing",
    "make_table",
    "print_table",
    "show",
    "terminal",
    "write",
    "write_bytes",
]

_UNBOUNDED = 100_000


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table: `kind` is text, number, name (bold) or dim; `fold` lets long cells take more lines."""

    title: str
    kind: str = "text"
    fold: bool = True


def terminal() -> bool:
    """Tell whether a person reads standard output."""
    return sys.stdout.isatty()


def write(text: str = "") -> None:
    """Write a line."""
    sys.stdout.write(text + "\n")


def write_bytes(data: bytes) -> None:
    """Write bytes as they are."""
    sys.stdout.flush()
    sys.stdout.buffer.write(data)
    sys.stdout.buffer.flush()


def json_lines(records: Iterable[Any]) -> None:
    """Write one JSON object a line."""
    import json  # noqa: PLC0415 - start-up time

    for record in records:
        sys.stdout.write(json.dumps(record, ensure_ascii=False, separators=(", ", ": ")) + "\n")


def console(stream: IO[str] | None = None) -> Console:
    """Return rich's console for a stream (default: standard output); off a terminal lines are never folded."""
    from rich.console import Console  # noqa: PLC0415 - start-up time

    stream = stream or sys.stdout
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
    columns: Sequence[Column],
    rows: Iterable[Sequence[object]],
    *,
    objects: Iterable[Any] | None = None,
) -> None:
    """Write a list: as JSON Lines when `objects` are given, as a table on a terminal, as TSV with a head elsewhere."""
    if objects is not None:
        json_lines(objects)
    elif terminal():
        print_table(columns, rows)
    else:
        for row in ([column.title for column in columns], *rows):
            write("\t".join("" if value is None else printable(str(value)) for value in row))


def show(*parts: RenderableType) -> None:
    """Write what rich draws, a part below the other; off a terminal no line ends in blanks."""
    target = console()
    if terminal():
        target.print(*parts, sep="\n")
        return
    with target.capture() as captured:
        target.print(*parts, sep="\n")
    for line in captured.get().splitlines():
        write(line.rstrip())


def print_table(columns: Sequence[Column], rows: Iterable[Sequence[object]], *, title: str | None = None) -> None:
    """Write a table for people."""
    show(make_table(columns, rows, title=title))


def make_table(columns: Sequence[Column], rows: Iterable[Sequence[object]], *, title: str | None = None) -> Table:
    """Return a table of printable cells; cells that are rich's own (links) pass as they are."""
    from rich.box import SIMPLE_HEAD  # noqa: PLC0415 - start-up time
    from rich.table import Table  # noqa: PLC0415 - start-up time

    table = Table(
        box=SIMPLE_HEAD, title=title, title_justify="left", pad_edge=False, show_edge=False, header_style="bold"
    )
    styles = {"name": "bold", "dim": "dim"}
    for column in columns:
        table.add_column(
            column.title,
            style=styles.get(column.kind),
            justify="right" if column.kind == "number" else "left",
            overflow="fold" if column.fold else "ellipsis",
            no_wrap=not column.fold,
        )
    for row in rows:
        table.add_row(*(_cell(value) for value in row))
    return table


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, int) and not isinstance(value, bool):
        return f"{value:,}"
    return printable(value) if isinstance(value, str) else value
