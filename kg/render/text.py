"""Text for people: nothing from a source file or a query result may steer a terminal or break a page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final
from unicodedata import category, east_asian_width

from kg.lazily import lazily

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.errors import Place

with lazily():
    import json

NAME_UNKNOWN: Final = "(name not known)"
TYPE_UNKNOWN: Final = "(type not known)"
VALUE_UNKNOWN: Final = "(not known)"
"""What stands in the place of a name, a type or a value that is not known."""
_UNSAFE: Final = frozenset({"Cc", "Cf", "Cn", "Co", "Cs", "Zl", "Zp"})
_SPACES = str.maketrans({"\n": " ", "\r": " ", "\t": " "})


def printable(text: str) -> str:
    """Return `text` on one line, with control and direction characters shown as escapes instead of sent out."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(
        sign if category(sign) not in _UNSAFE else sign.encode("unicode_escape").decode()
        for sign in text.translate(_SPACES)
    )


def json_text(record: object) -> str:
    """Return a value as JSON on one line, without control and direction characters as they are."""
    return printable_json(json.dumps(record, ensure_ascii=False, separators=(", ", ": ")))


def printable_json(text: str) -> str:
    """Return JSON of the same value, with control and direction characters as escapes instead of as they are."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(sign if category(sign) not in _UNSAFE else _escape(sign) for sign in text)


def _escape(sign: str) -> str:
    units = sign.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[at : at + 2].hex()}" for at in range(0, len(units), 2))


def width(text: str) -> int:
    """Return how many columns `text` takes in a terminal."""
    return len(text) + sum(east_asian_width(sign) in "WF" for sign in text if not sign.isascii())


def some(texts: Sequence[str], most: int, separator: str = ", ") -> str:
    """Return the first `most` texts, and the number of the others."""
    more = f" and {len(texts) - most:,} more" if len(texts) > most else ""
    return separator.join(texts[:most]) + more


def count(number: int, noun: str, plural: str | None = None) -> str:
    """Return "1 node", "2,000 nodes" or "3 entities" (with `plural`)."""
    return f"{number:,} {noun if number == 1 else plural or noun + 's'}"


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
