"""A source line with its error underlined for terminals, cut to the same span everywhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.render.text import printable, width

if TYPE_CHECKING:
    from kg.errors import Place

_LONGEST: Final = 160


def marked(place: Place, line: str) -> tuple[str, str]:
    """Return as much of the line of a place as fits, and the blanks and carets below it; no carets without a column."""
    position = (place.column or 1) - 1
    start = max(0, min(position - _LONGEST // 2, len(line) - _LONGEST))
    mark = "..." if start else ""
    end = "..." if len(line) > start + _LONGEST else ""
    shown = mark + printable(line[start : start + _LONGEST]) + end
    span = place.span(line)
    if span is None:
        return shown, ""
    _, _, end_line, end_column = span
    behind = end_column - 1 if end_line == place.line else len(line)
    before = width(mark + printable(line[start:position].ljust(position - start)))
    return shown, " " * before + "^" * max(1, width(printable(line[position : min(behind, start + _LONGEST)])))
