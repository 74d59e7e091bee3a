"""A table of an evaluation on standard output, and as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.cli.diagnostics import note, say
from kg.cli.output import Column, listing
from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.evaluate.code_check import Miss

with lazily():
    from kg.evaluate.tables import Table, as_csv, as_objects, spelled
    from kg.evaluate.writing import write


def deliver(table: Table, *, json: bool, output: str | None) -> None:
    """Print a table (as JSON Lines with `json`), its notes to standard error, and write the requested files."""
    numeric = {name for at, name in enumerate(table.columns) if not any(isinstance(row[at], str) for row in table.rows)}
    columns = [Column(name, "number" if name in numeric else "text") for name in table.columns]
    rows = [[spelled(cell) for cell in row] for row in table.rows]
    listing(columns, rows, objects=as_objects(table) if json else None)
    for sentence in table.notes:
        note(sentence)
    if output:
        written = write(table, Path(output).expanduser())
        say(f"wrote {', '.join(path.name for path in written)} to {output}")


def misses_csv(missed: Iterable[Miss]) -> str:
    """Return the missed entries as CSV."""
    rows = tuple((one.measure, one.kind, one.address, one.text) for one in missed)
    return as_csv(Table("missed", "Missed", ("measure", "kind", "address", "source"), rows))
