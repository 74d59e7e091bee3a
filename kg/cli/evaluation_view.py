"""A table of an evaluation on standard output, and as files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from kg.cli.diagnostics import note, say
from kg.cli.output import Column, listing

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.evaluate.code_check import Miss
    from kg.evaluate.tables import Table


def deliver(table: Table, *, json: bool, output: str | None) -> None:
    """Print a table (as JSON Lines with `json`), its notes to standard error, and write the requested files."""
    from kg.evaluate.tables import as_objects, spelled  # noqa: PLC0415 - start-up time

    numeric = {name for at, name in enumerate(table.columns) if not any(isinstance(row[at], str) for row in table.rows)}
    columns = [Column(name, "number" if name in numeric else "text") for name in table.columns]
    rows = [[spelled(cell) for cell in row] for row in table.rows]
    listing(columns, rows, objects=as_objects(table) if json else None)
    for sentence in table.notes:
        note(sentence)
    if output:
        from kg.evaluate.writing import write  # noqa: PLC0415 - the same

        written = write(table, Path(output).expanduser())
        say(f"wrote {', '.join(path.name for path in written)} to {output}")


def misses_csv(missed: Iterable[Miss]) -> str:
    """Return the missed entries as CSV."""
    from kg.evaluate.tables import Table, as_csv  # noqa: PLC0415 - the branch that needs it

    rows = tuple((one.measure, one.kind, one.address, one.text) for one in missed)
    return as_csv(Table("missed", "Missed", ("measure", "kind", "address", "source"), rows))
