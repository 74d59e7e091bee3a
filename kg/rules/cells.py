"""Cells of a table in TSV as the spellings that a dump of the store has.

TSV (SPARQL 1.1 Query Results CSV and TSV Formats, section 4) may write numbers and booleans without quotes and data
type, and it leaves control characters in strings, which N-Triples escapes.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["cells"]

_XSD: Final = b"http://www.w3.org/2001/XMLSchema#"
_CONTROLS: Final = bytes([*range(9), 11, 12, *range(14, 32), 127])
"""What a string of TSV holds raw; tabs and ends of lines are escaped in both formats."""

_ESCAPED: Final = re.compile(rb"[\x00-\x1f\x7f]|\xef\xbf[\xbe\xbf]")
_INSIDE: Final = re.compile(rb'"(?:[^"\\]|\\.)*"|<[^<>]*>|(?<= )(?:[+-]?[0-9.]+|true|false)(?= \)>>)')
"""In a triple term: what is passed over, and a short form where the object stands."""


def cells(text: bytes, width: int) -> list[bytes]:
    """Return the cells of all rows, row by row, spelt as in N-Triples; each row has `width` cells, none empty."""
    found = text.replace(b"\n", b"\t").split(b"\t")
    found.pop()
    for repair in _repairs(text):
        for column in range(width):
            found[column::width] = map(repair, found[column::width])
    return found


def _repairs(text: bytes) -> list[Callable[[bytes], bytes]]:
    """Return what has to be done to the cells of a text; a look at it as a whole shows that for most it is nothing."""
    needed: list[Callable[[bytes], bytes]] = []
    regular = text.count(b"\t<") + text.count(b'\t"') + text.count(b"\t_")
    regular += text.count(b"\n<") + text.count(b'\n"') + text.count(b"\n_") + (text[:1] in {b"<", b'"', b"_"})
    if regular != text.count(b"\t") + text.count(b"\n"):
        needed.append(_long)
    if b"<<(" in text:
        needed.append(_triple)
    if len(text.translate(None, _CONTROLS)) != len(text) or b"\xef\xbf\xbe" in text or b"\xef\xbf\xbf" in text:
        needed.append(_escape)
    return needed


def _long(cell: bytes) -> bytes:
    if cell[:1] in {b"<", b'"', b"_"}:
        return cell
    if cell in {b"true", b"false"}:
        return b'"%s"^^<%sboolean>' % (cell, _XSD)
    return b'"%s"^^<%s%s>' % (cell, _XSD, b"decimal" if b"." in cell else b"integer")


def _triple(cell: bytes) -> bytes:
    return _INSIDE.sub(lambda match: _long(match[0]), cell) if cell.startswith(b"<<(") else cell


def _escape(cell: bytes) -> bytes:
    return cell if cell.startswith(b"<") and not cell.startswith(b"<<(") else _ESCAPED.sub(_character, cell)


def _character(match: re.Match[bytes]) -> bytes:
    short = {b"\b": b"\\b", b"\f": b"\\f"}.get(match[0])
    return short or b"\\u%04X" % ord(match[0].decode())
