"""Terms and triples as people read them: prefixed names where prefixes are known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pyoxigraph import Literal, NamedNode, Triple

from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.rules.files import RuleFile
    from kg.rules.form import Term

__all__ = ["common_prefixes", "spell_term", "spell_triple"]


def common_prefixes(files: Iterable[RuleFile]) -> dict[str, str]:
    """Return the common prefixes, and those with the same meaning in all files that declare them."""
    meant: dict[str, set[str]] = {}
    for file in files:
        for name, iri in (file.prefixes or {}).items():
            meant.setdefault(name, set()).add(iri)
    return {**{name: next(iter(iris)) for name, iris in meant.items() if len(iris) == 1}, **PREFIXES}


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
