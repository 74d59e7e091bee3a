"""A table as files: Markdown, CSV, and a figure as SVG."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.errors import Place, UsageError
from kg.evaluate.figures import draw
from kg.evaluate.tables import as_csv, as_markdown

if TYPE_CHECKING:
    from pathlib import Path

    from kg.evaluate.tables import Table


def write(table: Table, folder: Path) -> tuple[Path, ...]:
    """Write `NAME.md`, `NAME.csv` and `NAME.svg` into a folder, made where there is none; return their paths.

    Raises:
        UsageError: KG003 when a file cannot be written.
    """
    texts = {
        folder / f"{table.name}.md": as_markdown(table),
        folder / f"{table.name}.csv": as_csv(table),
        folder / f"{table.name}.svg": draw(table),
    }
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for path, text in texts.items():
            path.write_text(text, "utf-8")
    except OSError as error:
        place = Place(str(error.filename or folder))
        raise UsageError("KG003", f"the table cannot be written: {error.strerror}", place=place) from None
    return tuple(texts)
