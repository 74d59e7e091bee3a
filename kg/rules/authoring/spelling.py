"""Terms, triples and parts of rules as people read them: prefixed names where prefixes are known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.errors import RuleError
from kg.rules.form import Atom, Element, Pattern, Term, TripleTerm, Variable
from kg.rules.sparql import brief
from kg.rules.sparql import term as written
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.rules.files import RuleFile

_LONGEST: Final = 100


def common_prefixes(files: Iterable[RuleFile]) -> dict[str, str]:
    """Return the common prefixes, and those with the same meaning in all files that declare them."""
    meanings: dict[str, set[str]] = {}
    for file in files:
        for name, iri in file.prefixes.items():
            meanings.setdefault(name, set()).add(iri)
    return {**{name: next(iter(iris)) for name, iris in meanings.items() if len(iris) == 1}, **PREFIXES}


def spell_term(term: Term, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a term as Turtle spells it with these prefixes."""
    if isinstance(term, NamedNode):
        return shorten(term.value, prefixes)
    if isinstance(term, Literal) and '"^^<' in str(term):
        quoted, _, _ = str(term).rpartition("^^")
        return f"{quoted}^^{shorten(term.datatype.value, prefixes)}"
    if isinstance(term, Triple):
        return f"<<( {spell_triple(term, prefixes)} )>>"
    return str(term)


def spell_triple(triple: Triple, prefixes: Mapping[str, str] = PREFIXES) -> str:
    """Return a triple as Turtle spells it, without the full stop."""
    return " ".join(spell_term(term, prefixes) for term in triple)


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

    def spelt(pattern: Pattern) -> str:
        if isinstance(pattern, Variable):
            return f"_:{pattern.name[1:]}" if pattern.name.startswith(".") else str(pattern)
        return written(pattern) if isinstance(pattern, TripleTerm) else spell_term(pattern, prefixes)

    return " ".join(map(spelt, atom.positions))
