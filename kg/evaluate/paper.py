"""The figures of the paper's tables, as far as they are known (`corpus/rnkg.toml`), as a column beside ours.

A section of that file has the name of a table (completeness, code, correctness, search) and figures from 0 to 1 by the
words of its rows: `"topic" = 0.9`. A table without figures there has no column of the paper.
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.resources import folder

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.evaluate.tables import Table

COLUMN: Final = "RNKG"


def beside(table: Table, keys: tuple[str, ...], figures: Mapping[str, float] | None = None) -> Table:
    """Return the table with a column of the paper's figures, by the texts of the columns `keys`.

    The table stays as it is where no figure is known; `figures` replaces those of the file.
    """
    if figures is None:
        figures = tomllib.loads((folder("corpus") / "rnkg.toml").read_text("utf-8")).get(table.name, {})
    places = [table.columns.index(key) for key in keys]
    column = [figures.get(" ".join(str(row[place]) for place in places)) for row in table.rows]
    if all(figure is None for figure in column):
        return table
    rows = tuple((*row, figure) for row, figure in zip(table.rows, column, strict=True))
    return replace(table, columns=(*table.columns, COLUMN), rows=rows)
