"""From an offset in a text to its line and column, counted in characters from one, and to the line itself."""

from __future__ import annotations

from kg.errors import Place

__all__ = ["place_at", "place_of"]


def place_at(text: str, offset: int, path: str) -> Place:
    """Return the place of the character at `offset` in `text`."""
    begin = text.rfind("\n", 0, offset) + 1
    end = text.find("\n", offset)
    return Place(path, text.count("\n", 0, offset) + 1, offset - begin + 1, text[begin : end if end >= 0 else None])


def place_of(text: str, line: int, column: int, path: str) -> Place:
    """Return the place of `line` and `column` with the text of that line."""
    lines = text.split("\n")
    return Place(path, line, column, lines[line - 1] if line <= len(lines) else None)
