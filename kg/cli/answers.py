"""Query results on standard output: tables for people, the formats of `kg.query.formats` for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kg.cli.diagnostics import note
from kg.cli.output import Column, Linked, fitted, line_width, print_table, terminal, write, write_bytes
from kg.errors import QueryError
from kg.query.formats import ALIASES, GRAPH_FORMATS, SOLUTION_FORMATS, display, plain
from kg.query.formats import write as written
from kg.query.result import Boolean, Graph, Result, Solutions
from kg.query.writing import parquet
from kg.render.text import count, width
from kg.similar import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.cli.links import Links


def format_for(name: str) -> str:
    """Return the format for the setting `format`; `auto` is a table for people and TSV for programs.

    Raises QueryError: KG504 unknown format.
    """
    if name == "auto":
        return "table" if terminal() else "tsv"
    full = ALIASES.get(name, name)
    formats = ("table", *SOLUTION_FORMATS, parquet.NAME, *GRAPH_FORMATS)
    if full not in formats:
        near = did_you_mean(name, formats)
        raise QueryError("KG504", f"unknown format `{name}`", hint=near or f"The formats are {', '.join(formats)}.")
    return full


def answer(result: Result, name: str, *, automatic: bool = False, links: Links | None = None) -> None:
    """Write a result in a format of `format_for`; an `automatic` format becomes Turtle for a graph.

    Notes report the number of rows to people, and missing rows to everyone.
    """
    if name == "table" and isinstance(result, Solutions):
        table(result, links)
    elif name == "table" and isinstance(result, Boolean):
        write("yes" if result.value else "no")
    elif isinstance(result, Graph) and (automatic or name == "table"):
        write_bytes(written(result, "turtle"))
    elif name == parquet.NAME and terminal():
        hint = "Send it to a file: `kg query ... --format parquet > answer.parquet`."
        raise QueryError("KG504", "a terminal cannot show Parquet", hint=hint)
    else:
        write_bytes(written(result, name))
    if isinstance(result, Boolean):
        return
    rows = count(len(result.rows), "row") if isinstance(result, Solutions) else count(len(result.triples), "triple")
    if result.limit is not None:
        note(f"only the first {rows} shown; --limit 0 shows all")
    elif name == "table":
        note(f"{rows} in {result.seconds:.3f} s")


def is_empty(result: Result) -> bool:
    """Return whether a result is empty."""
    if isinstance(result, Solutions):
        return not result.rows
    return not (result.value if isinstance(result, Boolean) else result.triples)


def table(result: Solutions, links: Links | None = None) -> None:
    """Write rows as a table: numbers aligned right, `?file` and `?line` as one place with a link."""
    if not result.rows:
        return
    has_places = {"file", "line"} <= set(result.variables)
    joined = {name: result.variables.index(name) for name in ("file", "line")} if has_places else {}
    others = [index for index in range(len(result.variables)) if index not in joined.values()]
    columns = []
    for index in others:
        values = [plain(row[index]) for row in result.rows if row[index] is not None]
        numeric = all(isinstance(value, int | float) and not isinstance(value, bool) for value in values)
        columns.append(Column(result.variables[index], "number" if values and numeric else "text"))
    rows: list[list[object]] = [[display(row[index]) for index in others] for row in result.rows]
    if joined:
        columns.append(Column("file:line", "dim"))
        taken = sum(
            max([width(columns[i].title), *(width(str(row[i])) for row in rows)]) + 3 for i in range(len(others))
        )
        _add_places(rows, result, joined, line_width() - taken, links)
    print_table(columns, rows)


def _add_places(
    rows: list[list[object]], result: Solutions, at: Mapping[str, int], room: int, links: Links | None
) -> None:
    """Add the place of each row, if there is room."""
    places = [(display(row[at["file"]]), display(row[at["line"]])) for row in result.rows]
    shown = fitted([f"{file}:{line}" if line else file for file, line in places], room)
    for row, (file, line), text in zip(rows, places, shown, strict=True):
        address = links.find(file, int(line)) if links and line.isdigit() else None
        row.append(Linked(text, address))
