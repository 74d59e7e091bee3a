"""Parts of rules as a line of text for people."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.errors import RuleError
from kg.rules.authoring.spelling import spell_term
from kg.rules.form import Atom, TripleTerm, Variable
from kg.rules.sparql import brief, term
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.rules.form import Element, Pattern

__all__ = ["spell_element", "spell_head"]

_LONGEST: Final = 100


def spell_element(element: Element, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return an element of a body on one line, names shortened, its end left out when it is long."""
    if isinstance(element, Atom):
        return spell_head(element, prefixes) + (" (asserted)" if element.asserted else "")
    try:
        text = brief(element, prefixes)
    except RuleError:
        text = type(element).__name__
    return text if len(text) <= _LONGEST else text[: _LONGEST - 1] + "…"


def spell_head(atom: Atom, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a triple with variables on one line."""
    return " ".join(_pattern(position, prefixes) for position in atom.positions)


def _pattern(pattern: Pattern, prefixes: Mapping[str, str]) -> str:
    if isinstance(pattern, Variable):
        return f"_:{pattern.name[1:]}" if pattern.name.startswith(".") else str(pattern)
    if isinstance(pattern, TripleTerm):
        return term(pattern)
    return spell_term(pattern, prefixes)
