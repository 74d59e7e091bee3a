"""KG211: a class or property unknown to the ontologies, the store and all other rules."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.errors import Fix
from kg.rules.checks.finding import Finding
from kg.rules.checks.standard import STANDARD, is_standard, namespace_of
from kg.rules.checks.tokens import names, place_of_name
from kg.rules.form import Atom, atoms_of, is_auxiliary
from kg.similar import asked, similar
from kg.syntax.names import PREFIXES, shorten

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.rules.checks.finding import Context
    from kg.rules.files import RuleFile
    from kg.rules.form import Rule

__all__ = ["CODE", "TITLE", "check"]

CODE: Final = "KG211"
TITLE: Final = "unknown class or property"
_TYPE: Final = PREFIXES["rdf"] + "type"
_ELSEWHERE: Final = ("xsd", "sh", "skos", "prov", "dcterms", "schema")
_BUILT_IN: Final = tuple(PREFIXES[name] for name in _ELSEWHERE)
"""Vocabularies that everyone uses and whose ontologies the store does not hold."""


def check(file: RuleFile, context: Context) -> Iterator[Finding]:
    """Yield each class and property of a file that nothing defines, with the one that was probably meant."""
    heads = {iri for rule in context.rules.rules if rule.name != file.name for iri in _derived(rule)}
    own = {iri for rule in file.rules for iri in _derived(rule)}
    known = context.terms | heads
    foreign = {namespace_of(iri) for iri in context.terms}
    wanted = {iri: "property" if is_property else "class" for rule in file.rules for iri, is_property in _used(rule)}
    for iri, kind in wanted.items():
        namespace = namespace_of(iri)
        if namespace in STANDARD:
            if not is_standard(iri):
                terms = (namespace + name for name in STANDARD[namespace])
                yield _finding(file, iri, kind, f"unknown {kind} {shorten(iri)}", terms)
            continue
        if not context.terms or iri in known or iri.startswith(_BUILT_IN):
            continue
        if iri in own and (_read_in(file, iri) or namespace not in foreign):
            continue  # a term that the rule brings along
        message = f"no ontology defines the {kind} {shorten(iri)}, and the store does not have it"
        yield _finding(file, iri, kind, message, known)


def _finding(file: RuleFile, iri: str, kind: str, message: str, known: Iterable[str]) -> Finding:
    meant = _suggestions(iri, kind, known)
    hint = asked(map(shorten, meant)) or "Define it in an ontology, or correct the name."
    # Names in the strings of SHACL rules have no place of their own.
    named = any(found == iri for found, _ in names(file))
    fixes = tuple(Fix(shorten(each, file.prefixes or {})) for each in meant) if named else ()
    return Finding(CODE, "warning", file.name, message, place_of_name(file, iri), hint, fixes=fixes)


def _suggestions(iri: str, kind: str, known: Iterable[str]) -> list[str]:
    """Return similar terms: those of its kind, by the case of the first letter, come first."""
    namespace = namespace_of(iri)
    # Of terms of one name the one in the namespace that was written is meant.
    ordered = sorted(known, key=lambda term: (namespace_of(term) == namespace, term))
    locals_ = {term.removeprefix(namespace_of(term)): term for term in ordered}
    alike = [name for name in locals_ if name[:1].isupper() == (kind == "class")]
    found = similar(iri.removeprefix(namespace), alike)
    if found:
        return [locals_[name] for name in found]
    short = {shorten(term): term for term in ordered}
    return [short[each] for each in similar(shorten(iri), short)]


def _read_in(file: RuleFile, iri: str) -> bool:
    """Return whether a file both writes and reads a term, which makes it a term of its own."""
    return any(used == iri for rule in file.rules for atom, _ in atoms_of(rule.body) for used, _ in _terms(atom))


def _derived(rule: Rule) -> Iterator[str]:
    return (iri for atom in rule.head for iri, _ in _terms(atom))


def _used(rule: Rule) -> Iterator[tuple[str, bool]]:
    for atom in (*rule.head, *(atom for atom, _ in atoms_of(rule.body))):
        yield from _terms(atom)


def _terms(atom: Atom) -> Iterator[tuple[str, bool]]:
    """Yield the property of an atom, and the class if the atom is a type."""
    if isinstance(atom.predicate, NamedNode) and not is_auxiliary(atom.predicate):
        yield atom.predicate.value, True
        if atom.predicate.value == _TYPE and isinstance(atom.object, NamedNode):
            yield atom.object.value, False
