"""Applications of rules that derive a fact, read off the store: their heads match it, bindings fill their patterns."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from pyoxigraph import BlankNode, NamedNode, Triple

from kg.rules.explain.proof import Condition, Derivation
from kg.rules.form import (
    Aggregate,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Pattern,
    Rule,
    Term,
    TripleTerm,
    Variable,
    bound_in,
    is_auxiliary,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.rules.explain.view import View

_SAMPLE = 5
_BREADTH = 1000


def bound_by(body: Sequence[Element]) -> list[str]:
    """Return the names of the variables that a body binds, sorted."""
    optional = {variable for element in body if isinstance(element, EngineBlock) for variable in element.optional}
    return sorted(variable.name for variable in bound_in(body) | optional)


def derivations(view: View, rules: tuple[Rule, ...], fact: Triple, limit: int) -> list[Derivation]:
    """Return applications of rules that derive `fact`, up to `limit` for each rule; those closest to asserted first."""
    unique: dict[tuple[str, tuple[Triple, ...]], Derivation] = {}
    for rule, bindings in heads(rules, fact):
        for solution in view.solutions(rule.body, bound_by(rule.body), bindings, limit):
            derivation = derivation_of(view, rule, solution)
            if derivation and fact not in derivation.facts:
                unique.setdefault((str(rule), derivation.facts), derivation)

    def order(one: Derivation) -> tuple[int, int, str]:
        return sum(not view.asserted(fact) for fact in one.facts), len(one.facts), str(one.rule)

    return sorted(unique.values(), key=order)


def derivation_of(view: View, rule: Rule, solution: dict[str, Term]) -> Derivation | None:
    """Return the application under a solution; None if a fact is only in graphs that rules do not read."""
    facts: list[Triple] = []
    conditions: list[Condition] = []
    for element in rule.body:
        if isinstance(element, Atom):
            fact = instance(element, solution)
            if fact is not None and is_auxiliary(fact.predicate):
                facts += _way(view, fact)
                continue
            if fact is None or not (view.asserted(fact) if element.asserted else view.graphs(fact)):
                return None
            facts.append(fact)
        elif isinstance(element, Exists) and not element.negated:
            # The facts of one solution of the inner body.
            for inner in view.solutions(element.body, bound_by(element.body), solution, 1):
                facts += instances(element.body, inner)
        else:
            conditions.append(_condition(view, element, solution))
    named = {name: term for name, term in solution.items() if not name.startswith(".")}
    return Derivation(rule, named, tuple(dict.fromkeys(facts)), tuple(conditions))


def _way(view: View, fact: Triple) -> tuple[Triple, ...]:
    """Return the triples along a path of any length that an auxiliary fact stands for."""

    def step(body: tuple[Element, ...], here: Term) -> Iterator[tuple[Term, tuple[Triple, ...]]]:
        for solution in view.solutions(body, bound_by(body), {".from": here}, _BREADTH):
            yield solution[".to"], instances(body, solution)

    return view.closures.way(fact.predicate.value, fact.subject, fact.object, step)


def _condition(view: View, element: Element, solution: Mapping[str, Term]) -> Condition:
    if not isinstance(element, Aggregate):
        return Condition(view.brief(element))
    keys = {key.name: solution[key.name] for key in element.keys if key.name in solution}
    members = view.solutions(element.body, bound_by(element.body), keys, _BREADTH)
    facts = [fact for member in members[:_SAMPLE] for fact in instances(element.body, member)]
    values = ", ".join(
        f"{column.function}({'*' if column.expression is None else column.expression.text}) = "
        f"{view.label(solution[column.variable.name])}"
        for column in element.columns
        if column.variable.name in solution
    )
    return Condition(values, tuple(dict.fromkeys(facts)), len(members))


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
