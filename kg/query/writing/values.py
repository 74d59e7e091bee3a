"""Single terms as text, for people and programs."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.syntax.names import shorten

if TYPE_CHECKING:
    from kg.store.terms import Term

XSD: Final = "http://www.w3.org/2001/XMLSchema#"
STRING: Final = XSD + "string"
_INTEGERS: Final = frozenset({XSD + "integer", XSD + "int", XSD + "long", XSD + "nonNegativeInteger"})
_DECIMALS: Final = frozenset({XSD + "decimal", XSD + "double", XSD + "float"})
_WHOLE: Final = re.compile(r"[+-]?[0-9]+")


def plain(term: Term | None) -> str | int | float | bool | None:
    """Return the value of a term as in JSON: numbers and booleans as such, everything else as text.

    Numbers that JSON cannot represent, such as infinity, and malformed ones are text.
    """
    if not isinstance(term, Literal):
        return None if term is None else bare(term)
    datatype = term.datatype.value
    try:
        if datatype in _INTEGERS and _WHOLE.fullmatch(term.value):
            return int(term.value)
        if datatype in _DECIMALS and math.isfinite(number := float(term.value)):
            return number
    except ValueError:
        return term.value
    return term.value in {"true", "1"} if datatype == XSD + "boolean" else term.value


def display(term: Term | None) -> str:
    """Return a term for display: IRIs with known prefixes, literals as their text."""
    if isinstance(term, NamedNode):
        return shorten(term.value).strip("<>")
    if isinstance(term, Literal):
        return term.value
    return "" if term is None else turtle(term)


def bare(term: Term) -> str:
    """Return the IRI or the text of a literal; other terms as in `turtle`."""
    return term.value if isinstance(term, NamedNode | Literal) else turtle(term)


def turtle(term: Term) -> str:
    """Return a term in the syntax of Turtle and N-Triples; the engine omits the brackets of triple terms."""
    if isinstance(term, Triple):
        return f"<<( {turtle(term.subject)} {term.predicate} {turtle(term.object)} )>>"
    return str(term)


def quoted_and_mark(literal: Literal) -> tuple[str, str]:
    """Return the text of a literal in quotes, escaped as in N-Triples, and the suffix: `@en`, `^^<...>`.

    This takes one call of the engine; text, language, direction and datatype would take four.
    """
    text = str(literal)
    end = text.rindex('"') + 1
    return text[:end], text[end:]
