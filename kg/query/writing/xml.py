"""Rows as SPARQL Query Results XML (W3C, second edition; triple terms and base directions as in SPARQL 1.2)."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import QueryError
from kg.query.writing.values import quoted_and_mark
from kg.store.serialization import forbidden_in_xml

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.query.result import Row
    from kg.store.terms import Term

_NAMESPACE: Final = "http://www.w3.org/2005/sparql-results#"
_DIRECTION: Final = ' its:dir="{}" xmlns:its="http://www.w3.org/2005/11/its" its:version="2.0"'
TAIL: Final = b"</results>\n</sparql>\n"


def head(variables: tuple[str, ...]) -> bytes:
    """Return the document up to the first row."""
    named = "".join(f'<variable name="{name}"/>' for name in variables)
    return f'<?xml version="1.0"?>\n<sparql xmlns="{_NAMESPACE}">\n<head>{named}</head>\n<results>\n'.encode()


def rows(variables: tuple[str, ...], batch: Sequence[Row]) -> bytes:
    """Return rows, one per line; QueryError KG504 for a text that XML cannot represent."""
    opened = [f'<binding name="{name}">' for name in variables]
    lines = []
    for row in batch:
        cells = [
            f"{binding}{_term(term)}</binding>" for binding, term in zip(opened, row, strict=True) if term is not None
        ]
        lines.append(f"<result>{''.join(cells)}</result>\n")
    return "".join(lines).encode()


def boolean(value: str) -> bytes:
    """Return the whole document for a boolean."""
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
