"""Matching the heads of rules with facts, and patterns with bindings."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from pyoxigraph import BlankNode, NamedNode, Triple

from kg.rules.form import Atom, Element, Pattern, Rule, Term, TripleTerm, Variable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping


def unify(atom: Atom, fact: Triple) -> dict[str, Term] | None:
    """Return the bindings of the head `atom` when it derives `fact`, None if it cannot.

    A blank node in a head stands for any blank node: which one, the solution of the body decides.
    """
    bindings: dict[str, Term] = {}
    if all(_match(pattern, term, bindings) for pattern, term in zip(atom.positions, fact, strict=True)):
        return bindings
    return None


def _match(pattern: Pattern, term: Term, bindings: dict[str, Term]) -> bool:
    if isinstance(pattern, Variable):
        return bindings.setdefault(pattern.name, term) == term
    if isinstance(pattern, TripleTerm):
        if not isinstance(term, Triple):
            return False
        return all(_match(inner, part, bindings) for inner, part in zip(pattern, term, strict=True))
    if isinstance(pattern, BlankNode):
        return isinstance(term, BlankNode)
    return pattern == term


def heads(rules: tuple[Rule, ...], fact: Triple) -> Iterator[tuple[Rule, dict[str, Term]]]:
    """Yield each rule with the bindings under which it derives `fact`, one for each atom of its head that fits."""
    for rule in rules:
        for atom in rule.head:
            bindings = unify(atom, fact)
            if bindings is not None:
                yield rule, bindings


def instance(atom: Atom, bindings: Mapping[str, Term]) -> Triple | None:
    """Return the fact of an atom under `bindings`; None if a variable is unbound, or if it is not a triple.

    A blank node of a head is itself, unless `bindings` say what it is, under its name with `_:` before it.
    """
    terms = [filled(pattern, bindings) for pattern in atom.positions]
    subject, predicate, value = terms
    if not isinstance(subject, NamedNode | BlankNode) or value is None or not isinstance(predicate, NamedNode):
        return None
    return Triple(subject, predicate, value)


def instances(body: Iterable[Element], bindings: Mapping[str, Term]) -> tuple[Triple, ...]:
    """Return the facts of the atoms of a body under `bindings`."""
    facts = (instance(element, bindings) for element in body if isinstance(element, Atom))
    return tuple(fact for fact in facts if fact is not None)


def filled(pattern: Pattern, bindings: Mapping[str, Term]) -> Term | None:
    """Return the term at a position of an atom under `bindings`; None if a variable in it is unbound."""
    if isinstance(pattern, Variable):
        return bindings.get(pattern.name)
    if isinstance(pattern, TripleTerm):
        parts = [filled(inner, bindings) for inner in pattern]
        if any(part is None for part in parts):
            return None
        subject, predicate, value = parts
        return Triple(cast("NamedNode | BlankNode", subject), cast("NamedNode", predicate), cast("Term", value))
    return bindings.get(str(pattern), pattern) if isinstance(pattern, BlankNode) else pattern
