"""KG211: a class or property that neither the ontologies nor the store nor another rule know."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.query.prefixes import PREFIXES, shorten
from kg.query.similar import did_you_mean
from kg.rules.checks.finding import Finding
from kg.rules.checks.tokens import place_of_name
from kg.rules.form import AUXILIARY, Atom, atoms_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile
    from kg.rules.form import Rule

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG211"
TITLE: Final = "unknown class or property"
_TYPE: Final = PREFIXES["rdf"] + "type"
_ELSEWHERE: Final = ("rdf", "rdfs", "owl", "xsd", "sh", "skos", "prov", "dcterms", "schema")
_BUILT_IN: Final = tuple(PREFIXES[name] for name in _ELSEWHERE)
"""Vocabularies that everyone uses and whose ontologies the store does not hold."""


def check(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield each class and property of a file that nothing defines, with the one that was probably meant."""
    if not context.terms:
        return
    heads = {iri for rule in context.rules.rules if rule.name != file.name for iri in _derived(rule)}
    own = {iri for rule in file.rules for iri in _derived(rule)}
    known = context.terms | heads
    foreign = {_namespace(iri) for iri in context.terms}
    wanted = {iri: "property" if is_property else "class" for rule in file.rules for iri, is_property in _used(rule)}
    for iri, kind in wanted.items():
        if iri in known or iri.startswith(_BUILT_IN):
            continue
        if iri in own and (_read_in(file, iri) or _namespace(iri) not in foreign):
            continue  # a term that the rule brings along
        short = {shorten(term): term for term in known}
        hint = did_you_mean(shorten(iri), short) or "Define it in an ontology, or correct the name."
        message = f"no ontology defines the {kind} {shorten(iri)}, and the store does not have it"
        yield Finding(CODE, "warning", file.name, message, place_of_name(file, iri), hint)


def _namespace(iri: str) -> str:
    return iri[: max(iri.rfind("#"), iri.rfind("/")) + 1]


def _read_in(file: RuleFile, iri: str) -> bool:
    """Tell whether a file derives a term for itself: what it both writes and reads is a term of its own."""
    return any(used == iri for rule in file.rules for atom, _ in atoms_of(rule.body) for used, _ in _terms(atom))


def _derived(rule: Rule) -> Iterator[str]:
    return (iri for atom in rule.head for iri, _ in _terms(atom))


def _used(rule: Rule) -> Iterator[tuple[str, bool]]:
    for atom in (*rule.head, *(atom for atom, _ in atoms_of(rule.body))):
        yield from _terms(atom)


def _terms(atom: Atom) -> Iterator[tuple[str, bool]]:
    """Yield the property of an atom, and the class where it says what something is."""
    if isinstance(atom.predicate, NamedNode) and not atom.predicate.value.startswith(AUXILIARY):
        yield atom.predicate.value, True
        if atom.predicate.value == _TYPE and isinstance(atom.object, NamedNode):
            yield atom.object.value, False
