"""Parts of rules as a line of text for people."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.errors import RuleError
from kg.rules.authoring.spelling import spell_term
from kg.rules.form import Aggregate, Assignment, Atom, EngineBlock, Exists, Filter, TripleTerm, Variable
from kg.rules.sparql import group, term
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.errors import Place
    from kg.rules.form import Element, Pattern, Rule

__all__ = ["element_place", "spell_element", "spell_head"]

_IRI: Final = re.compile(r"<([^<>\s]+)>")
_LONGEST: Final = 100


def spell_element(element: Element, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return an element of a body on one line, names shortened, its end left out when it is long."""
    if isinstance(element, Atom):
        return spell_head(element, prefixes) + (" (asserted)" if element.asserted else "")
    try:
        text = element.text if isinstance(element, EngineBlock) else group((element,))
    except RuleError:
        text = type(element).__name__
    short = " ".join(_IRI.sub(lambda found: spell_term(NamedNode(found[1]), prefixes), text).split())
    return short if len(short) <= _LONGEST else short[: _LONGEST - 1] + "…"


def spell_head(atom: Atom, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a triple with variables on one line."""
    return " ".join(_pattern(position, prefixes) for position in atom.positions)


def _pattern(pattern: Pattern, prefixes: Mapping[str, str]) -> str:
    if isinstance(pattern, Variable):
        return f"_:{pattern.name[1:]}" if pattern.name.startswith(".") else str(pattern)
    if isinstance(pattern, TripleTerm):
        return term(pattern)
    return spell_term(pattern, prefixes)


def element_place(element: Element, rule: Rule) -> Place:
    """Return the place of an element: its own, or that of its first part, else the rule's."""
    own = None
    if isinstance(element, Atom | EngineBlock):
        own = element.place
    elif isinstance(element, Filter | Assignment):
        own = element.expression.place
    elif isinstance(element, Exists | Aggregate) and element.body:
        own = element_place(element.body[0], rule)
    return own or rule.place
