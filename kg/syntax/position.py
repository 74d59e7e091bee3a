"""Conversion of offsets in a text to lines and columns, counted in characters from one."""

from __future__ import annotations

from kg.errors import Place
from kg.syntax.lexer import Kind, tokens


def place_at(text: str, offset: int, path: str, end: int | None = None) -> Place:
    """Return the place of the character at `offset` in `text`; with `end`, of all characters before that offset."""
    begin = text.rfind("\n", 0, offset) + 1
    last = text.find("\n", offset)
    line, column = _line_and_column(text, offset)
    end_line, end_column = (None, None) if end is None else _line_and_column(text, max(offset, end))
    return Place(path, line, column, text[begin : last if last >= 0 else None], end_line, end_column)


def place_of_variable(text: str, name: str, start: int, end: int, path: str) -> Place:
    """Return the place of the first use of a variable between two offsets of a normalised text, or else of `start`."""
    used = (token for token in tokens(text[start:end]) if token.kind is Kind.VARIABLE and token.text[1:] == name)
    token = next(used, None)
    return (
        place_at(text, start, path) if token is None else place_at(text, start + token.start, path, start + token.end)
    )


def _line_and_column(text: str, offset: int) -> tuple[int, int]:
    return text.count("\n", 0, offset) + 1, offset - text.rfind("\n", 0, offset)


def place_of(text: str, line: int, column: int, path: str) -> Place:
    """Return the place of `line` and `column` with the text of that line."""
    lines = text.split("\n")
    return Place(path, line, column, lines[line - 1] if line <= len(lines) else None)


def offset_of(text: str, line: int, column: int) -> int:
    """Return the offset of a line and a column, both counted from one."""
    offset = 0
    for _ in range(line - 1):
        offset = text.index("\n", offset) + 1
    return offset + column - 1
