"""Rows in each of their formats, in batches: head, rows, tail.

Sources: SPARQL 1.1 Query Results JSON Format; CSV and TSV Formats; XML in `xml`. Triple terms and base directions are
written as in SPARQL 1.2. `markdown` is a table; `jsonl` has one object per row, with plain values for literals that are
numbers, booleans or strings.
"""

from __future__ import annotations

import csv
import io
import re
from html import escape
from typing import TYPE_CHECKING, Final, NamedTuple

import msgspec
from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import QueryError
from kg.query.writing.values import XSD, bare, display, plain, quoted_and_mark, turtle
from kg.store.serialization import forbidden_in_xml

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from kg.query.result import Row
    from kg.store.terms import Term


_INTEGER: Final = f'"^^<{XSD}integer>'
_INTEGER_CHARS: Final = len(_INTEGER)
_BOOLEANS: Final = frozenset(f'"{value}"^^<{XSD}boolean>' for value in ("true", "false"))
_BOOLEAN_CHARS: Final = len(f'"^^<{XSD}boolean>')
_WHOLE: Final = re.compile(r"[+-]?[0-9]+")
_encode: Final = msgspec.json.Encoder().encode


class RowFormat(NamedTuple):
    """A format of rows: head, a batch of rows for their variables, separator between batches, tail."""

    head: Callable[[tuple[str, ...]], bytes]
    rows: Callable[[tuple[str, ...], Sequence[Row]], bytes]
    separator: bytes = b""
    tail: bytes = b""


def _json_head(variables: tuple[str, ...]) -> bytes:
    return b'{"head":{"vars":' + _encode(variables) + b'},"results":{"bindings":[\n'


def _json_rows(variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    names = [_encode(name) + b":" for name in variables]
    lines = []
    for row in batch:
        cells = [name + _json_term(term) for name, term in zip(names, row, strict=True) if term is not None]
        lines.append(b"{" + b",".join(cells) + b"}")
    return b",\n".join(lines)


def _json_term(term: Term) -> bytes:
    if isinstance(term, NamedNode):
        return b'{"type":"uri","value":' + _encode(term.value) + b"}"
    if isinstance(term, Literal):
        value, mark = quoted_and_mark(term)
        # The engine's quoted text uses the escapes of canonical N-Triples, which are valid in JSON.
        return b'{"type":"literal","value":' + value.encode() + (_json_mark(mark) if mark else b"") + b"}"
    if isinstance(term, Triple):
        parts = {"subject": term.subject, "predicate": term.predicate, "object": term.object}
        inner = b",".join(_encode(key) + b":" + _json_term(part) for key, part in parts.items())
        return b'{"type":"triple","value":{' + inner + b"}}"
    return b'{"type":"bnode","value":' + _encode(term.value) + b"}"


def _json_mark(mark: str) -> bytes:
    if mark[0] == "^":
        return b',"datatype":' + _encode(mark[3:-1])
    language, _, direction = mark[1:].partition("--")
    return b',"xml:lang":' + _encode(language) + (b',"its:dir":' + _encode(direction) if direction else b"")


def _jsonl_rows(variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    return b"".join(_encode(dict(zip(variables, map(plain, row), strict=True))) + b"\n" for row in batch)


def _csv_lines(lines: Sequence[Sequence[str]]) -> bytes:
    output = io.StringIO()
    csv.writer(output, lineterminator="\r\n").writerows(lines)
    return output.getvalue().encode()


def _csv_rows(_variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    return _csv_lines([["" if term is None else bare(term) for term in row] for row in batch])


def _tsv_head(variables: tuple[str, ...]) -> bytes:
    return ("\t".join(f"?{name}" for name in variables) + "\n").encode()


def _tsv_rows(_variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    # The engine's serialization of a term escapes tabs and line ends.
    lines = ("\t".join(["" if term is None else _short(term) for term in row]) for row in batch)
    return "".join(line + "\n" for line in lines).encode()


def _short(term: Term) -> str:
    """Return a term in Turtle, with integers and booleans in their short form."""
    if not isinstance(term, Literal):
        return turtle(term)
    text = str(term)
    value, mark = text[1:-_INTEGER_CHARS], text[-_INTEGER_CHARS:]
    if mark == _INTEGER and _WHOLE.fullmatch(value):
        return value
    return text[1:-_BOOLEAN_CHARS] if text in _BOOLEANS else text


def _markdown_head(variables: tuple[str, ...]) -> bytes:
    return ("| " + " | ".join(variables) + " |\n|" + " --- |" * len(variables) + "\n").encode()


def _markdown_rows(_variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    return "".join("| " + " | ".join(map(_cell, row)) + " |\n" for row in batch).encode()


def _cell(term: Term | None) -> str:
    text = display(term).replace("\\", "\\\\").replace("|", "\\|")
    return text if text.isprintable() else " ".join(text.splitlines())


_NAMESPACE: Final = "http://www.w3.org/2005/sparql-results#"
_DIRECTION: Final = ' its:dir="{}" xmlns:its="http://www.w3.org/2005/11/its" its:version="2.0"'


def _xml_head(variables: tuple[str, ...]) -> bytes:
    named = "".join(f'<variable name="{name}"/>' for name in variables)
    return f'<?xml version="1.0"?>\n<sparql xmlns="{_NAMESPACE}">\n<head>{named}</head>\n<results>\n'.encode()


def _xml_rows(variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    """Return rows, one per line; QueryError KG504 for a text that XML cannot represent."""
    opened = [f'<binding name="{name}">' for name in variables]
    lines = []
    for row in batch:
        cells = [
            f"{binding}{_term(term)}</binding>" for binding, term in zip(opened, row, strict=True) if term is not None
        ]
        lines.append(f"<result>{''.join(cells)}</result>\n")
    return "".join(lines).encode()


def _xml_boolean(value: str) -> bytes:
    body = f"<head></head>\n<boolean>{value}</boolean>\n"
    return f'<?xml version="1.0"?>\n<sparql xmlns="{_NAMESPACE}">\n{body}</sparql>\n'.encode()


def _term(term: Term) -> str:
    if isinstance(term, NamedNode):
        return f"<uri>{escape(term.value, quote=False)}</uri>"
    if isinstance(term, Literal):
        quoted, mark = quoted_and_mark(term)
        value = term.value if "\\" in quoted else quoted[1:-1]
        reason = forbidden_in_xml(value)
        if reason:
            raise QueryError("KG504", f"xml cannot represent a text of a row: {reason}", hint="Use json, csv or tsv.")
        text = escape(value, quote=False).replace("\r", "&#13;")  # XML parsers read a bare one as a line feed
        return f"<literal{_marks(mark)}>{text}</literal>"
    if isinstance(term, Triple):
        parts = {"subject": term.subject, "predicate": term.predicate, "object": term.object}
        return "<triple>" + "".join(f"<{key}>{_term(part)}</{key}>" for key, part in parts.items()) + "</triple>"
    return f"<bnode>{escape(term.value, quote=False)}</bnode>"


def _marks(mark: str) -> str:
    if not mark:
        return ""
    if mark[0] == "^":
        return f' datatype="{escape(mark[3:-1], quote=False)}"'
    language, _, direction = mark[1:].partition("--")
    return f' xml:lang="{language}"' + (_DIRECTION.format(direction) if direction else "")


ROWS: Final = {
    "json": RowFormat(_json_head, _json_rows, b",\n", b"\n]}}\n"),
    "xml": RowFormat(_xml_head, _xml_rows, tail=b"</results>\n</sparql>\n"),
    "csv": RowFormat(lambda variables: _csv_lines([variables]), _csv_rows),
    "tsv": RowFormat(_tsv_head, _tsv_rows),
    "markdown": RowFormat(_markdown_head, _markdown_rows),
    "jsonl": RowFormat(lambda _: b"", _jsonl_rows),
}
"""Formats of rows."""

BOOLEANS: Final[dict[str, Callable[[str], bytes]]] = {
    "json": lambda value: f'{{"head":{{}},"boolean":{value}}}\n'.encode(),
    "xml": _xml_boolean,
    "csv": lambda value: f"{value}\r\n".encode(),
    "tsv": lambda value: f"{value}\n".encode(),
    "markdown": lambda value: f"{value}\n".encode(),
    "jsonl": lambda value: f"{value}\n".encode(),
}
"""Formats of booleans, given as `true` or `false`."""
