"""Why a fact does not hold: for each rule that could derive it, the first part of its body that fails."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import SequenceMatcher
from typing import TYPE_CHECKING, Final

from kg.rules import form
from kg.rules.explain.derivations import bound_by, filled, heads, instance, instances
from kg.rules.explain.proof import Attempt, WhyNot
from kg.similar import similar

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from pyoxigraph import Triple

    from kg.rules.explain.view import View

_FEW: Final = 3
_CANDIDATES: Final = 500
_NO_VALUE: Final = 0.1
_ALIKE: Final = 0.4
"""Names less alike than this are not worth mentioning."""


def nearest(
    view: View, atom: form.Atom, solutions: Sequence[dict[str, form.Term]]
) -> tuple[dict[str, form.Term], tuple[str, ...]]:
    """Return the solution under which `atom` comes closest to something that is there, and sentences about that."""
    ranked = [
        (score, text, solution)
        for solution in solutions
        for score, text in _alternatives(view, *(filled(position, solution) for position in atom.positions))
    ]
    ranked.sort(key=lambda each: -each[0])
    if not ranked:
        return solutions[0], ()
    return ranked[0][2], tuple(dict.fromkeys(text for _, text, _ in ranked))[:_FEW]


def _alternatives(
    view: View, subject: form.Term | None, predicate: form.Term | None, value: form.Term | None
) -> Iterator[tuple[float, str]]:
    """Yield existing alternatives to a missing triple, with their similarity (1: the same)."""
    if predicate is None:
        return
    name = view.spelt(predicate)
    if subject is not None:
        objects = view.objects(subject, predicate, _CANDIDATES)
        for other in objects:
            yield _likeness(view, value, other), f"{view.label(subject)} has {name} {view.label(other)}"
        if not objects:
            yield _NO_VALUE, f"{view.label(subject)} has no {name}"
    if value is not None:
        for other in view.subjects(predicate, value, _CANDIDATES):
            yield _likeness(view, subject, other), f"{view.label(other)} has {name} {view.label(value)}"


def _likeness(view: View, wanted: form.Term | None, other: form.Term) -> float:
    """Compare the labels of both, and the last parts of their names; return the higher similarity."""
    if wanted is None:
        return 1.0
    pairs = ((view.label(wanted), view.label(other)), (_last(wanted), _last(other)))
    return max(SequenceMatcher(None, *pair).ratio() for pair in pairs)


def _last(term: form.Term) -> str:
    text = str(term).rstrip(">/#")
    return text[max(text.rfind("/"), text.rfind("#")) + 1 :]


def instead(view: View, fact: Triple) -> tuple[str, ...]:
    """Return sentences about what the store has instead of a fact: other values, a property of a similar name."""
    if view.graphs(fact):
        return ("the store holds it: `kg why` explains it",)
    properties = {view.spelt(each) for each in view.predicates(fact.subject, _CANDIDATES)}
    if not properties:
        return (f"the store has no facts about {view.spelt(fact.subject)}",)
    ranked = sorted(_alternatives(view, fact.subject, fact.predicate, fact.object), key=lambda each: -each[0])
    texts = [text for score, text in ranked[:_FEW] if score > _ALIKE]
    wanted = view.spelt(fact.predicate)
    if wanted not in properties:
        texts += [f"did you mean {name}?" for name in similar(wanted, properties, 1)]
    return tuple(dict.fromkeys(texts))


_SAMPLES: Final = 20
"""How many solutions of what holds are looked at to find the nearest match of what fails."""

_DEPTH: Final = 3
_LATE: Final = 10


def why_not(view: View, rules: tuple[form.Rule, ...], fact: Triple, *, depth: int = _DEPTH) -> WhyNot:
    """Return how far each rule comes that could derive `fact`; `depth` bounds how far missing premises are followed."""
    return _Inquiry(view, rules).about(fact, depth)


@dataclass(frozen=True, slots=True)
class _Inquiry:
    view: View
    rules: tuple[form.Rule, ...]

    def about(self, fact: Triple, depth: int) -> WhyNot:
        attempts = [self._attempt(rule, bindings, depth) for rule, bindings in heads(self.rules, fact)]
        unique = {(str(each.rule), each.text): each for each in attempts}
        ordered = sorted(unique.values(), key=lambda each: (-len(each.matched), str(each.rule)))
        return WhyNot(fact, tuple(ordered), instead(self.view, fact))

    def _attempt(self, rule: form.Rule, bindings: dict[str, form.Term], depth: int) -> Attempt:
        """Extend the matching part of the body element by element, until no solution is left."""
        order = _ordered(rule.body, bindings)
        solutions: list[dict[str, form.Term]] = [dict(bindings)]
        for index, element in enumerate(order):
            so_far = order[: index + 1]
            following = self.view.solutions(so_far, bound_by(so_far), bindings, _SAMPLES)
            if not following:
                return self._failure(rule, order[:index], element, solutions, depth)
            solutions = following
        text = "everything that the rule asks for holds; rules have not been run since"
        return Attempt(rule, _named(solutions[0]), instances(order, solutions[0]), None, text)

    def _failure(
        self,
        rule: form.Rule,
        before: Sequence[form.Element],
        element: form.Element,
        solutions: list[dict[str, form.Term]],
        depth: int,
    ) -> Attempt:
        chosen, deeper = solutions[0], None
        others: tuple[str, ...] = ()
        if isinstance(element, form.Atom):
            chosen, others = nearest(self.view, element, solutions)
            missing = instance(element, chosen)
            # The first premise of a rule that fits every property explains little.
            general = not before and any(isinstance(atom.predicate, form.Variable) for atom in rule.head)
            if missing is not None and depth > 1 and not element.asserted and not general:
                deeper = self.about(missing, depth - 1) if any(True for _ in heads(self.rules, missing)) else None
        elif isinstance(element, form.Exists) and element.negated:
            inner = self.view.solutions(element.body, bound_by(element.body), chosen, 1)
            blocking = (fact for solution in inner for fact in instances(element.body, solution))
            others = tuple(f"there is {self.view.sentence(fact)}" for fact in blocking)
        text = self._missing(element, chosen)
        return Attempt(rule, _named(chosen), instances(before, chosen), element, text, others, deeper)

    def _missing(self, element: form.Element, solution: Mapping[str, form.Term]) -> str:
        if isinstance(element, form.Atom):
            subject, predicate, value = (self._shown(position, solution) for position in element.positions)
            return f"no {subject} {predicate} {value}"
        bound = [each for each in sorted(form.mentions(element), key=str) if each.name in solution]
        values = ", ".join(f"{each} = {self.view.label(solution[each.name])}" for each in bound)
        suffix = f" where {values}" if values else ""
        if isinstance(element, form.Filter):
            return f"{self.view.brief(element)} is not true{suffix}"
        return f"{self.view.brief(element)} fails{suffix}"

    def _shown(self, position: form.Pattern, solution: Mapping[str, form.Term]) -> str:
        term = filled(position, solution)
        if term is None:
            return str(position) if isinstance(position, form.Variable) and not position.name.startswith(".") else "[]"
        return self.view.label(term) if isinstance(position, form.Variable) else self.view.spelt(term)


def _named(solution: Mapping[str, form.Term]) -> dict[str, form.Term]:
    return {name: term for name, term in solution.items() if not name.startswith(".")}


def _ordered(body: Sequence[form.Element], bindings: Mapping[str, form.Term]) -> list[form.Element]:
    """Return a body with the atoms first that have the most positions bound, as one would look at it by hand.

    Everything else keeps its place behind what binds its variables.
    """
    waiting, bound = list(body), {form.Variable(name) for name in bindings}
    order: list[form.Element] = []

    def free(element: form.Element) -> int:
        return len(form.binds(element) - bound) if isinstance(element, form.Atom) else _LATE

    while waiting:
        ready = [element for element in waiting if _ready(element, waiting, bound)]
        chosen = min(ready or waiting[:1], key=free)
        waiting.remove(chosen)
        order.append(chosen)
        bound |= form.binds(chosen)
    return order


def _ready(element: form.Element, waiting: Sequence[form.Element], bound: set[form.Variable]) -> bool:
    """Return whether nothing that is before an element and is still waiting binds what it needs."""
    if isinstance(element, form.Atom | form.Values | form.Aggregate):
        return True
    before = waiting[: waiting.index(element)]
    later = {variable for other in before for variable in form.binds(other)} - bound
    return not later & form.mentions(element)
