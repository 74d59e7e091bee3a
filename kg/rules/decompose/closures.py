"""Paths as atoms: each step one, and "one or more" an auxiliary predicate that two or more rules derive.

    aux(x, y)  when  x step y
    aux(x, z)  when  aux(x, y) and y step z

The least fixpoint of these rules is the transitive closure, which is what `+` means (SPARQL 1.1, section 18.4, ALP).
The predicate is named after the steps, so that equal paths of all rules share it.
"""

from __future__ import annotations

import re
from hashlib import sha256
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode, Triple

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.names import Names
from kg.rules.decompose.parts import EMPTY, Part
from kg.rules.decompose.paths import Avoid, Closure, Link, Step, Steps, inverse, key
from kg.rules.form import AUXILIARY, Atom, Filter, TripleTerm, Variable

if TYPE_CHECKING:
    from kg.errors import Place
    from kg.rules.decompose.work import AuxiliaryRules
    from kg.rules.form import Pattern

_START: Final = Variable(".from")
_MIDDLE: Final = Variable(".between")
_END: Final = Variable(".to")
_WORD: Final = re.compile(r"[^A-Za-z0-9]+")


class Walk:
    """Writes steps as atoms of one rule."""

    def __init__(self, auxiliary: AuxiliaryRules, names: Names, place: Place) -> None:
        self._auxiliary = auxiliary
        self._names = names
        self._place = place

    def along(self, part: Part, start: Pattern, steps: Steps, end: Pattern) -> Part | None:
        """Return a part followed by steps from one term to another; None if atoms cannot express them.

        `part.subjects` are the variables that are not literals, those bound before the part among them.
        """
        here = start
        for number, step in enumerate(steps, 1):
            there = end if number == len(steps) else self._names.hidden()
            stepped = self._step(part, here, step, there)
            if stepped is None:
                return None
            part, here = stepped, there
        return part

    def _step(self, part: Part, start: Pattern, step: Step, end: Pattern) -> Part | None:
        if isinstance(step, Closure):
            return self._closure(part, start, step, end)
        if step.inverse:
            start, end = end, start
        if isinstance(step, Link):
            return part.then(Atom(start, step.predicate, end, place=self._place))
        return self._avoid(part, start, step, end)

    def _avoid(self, part: Part, start: Pattern, step: Avoid, end: Pattern) -> Part:
        """Add a triple with a predicate that is none of those named: a predicate is an IRI, so the test never fails."""
        predicate = self._names.like(Variable("predicate"))
        part = part.then(Atom(start, predicate, end, place=self._place))
        if not step.predicates:
            return part
        listed = ", ".join(map(str, step.predicates))
        return part.then(Filter(expressions.expression(f"{sparql.spelling(predicate)} NOT IN ({listed})", self._place)))

    def _closure(self, part: Part, start: Pattern, step: Closure, end: Pattern) -> Part | None:
        """Add an atom with the auxiliary predicate.

        A triple has no literal as subject. Where a step may begin at a literal (`^:p`), the closure is told from the
        other end, or from an end that is known to be no literal.
        """
        back = inverse(step)
        forth_exact = not _may_begin_at_literal(step) or _is_resource(start, part)
        if forth_exact and (predicate := self._predicate(step)):
            return part.then(Atom(start, predicate, end, place=self._place))
        back_exact = not _may_begin_at_literal(back) or _is_resource(end, part)
        if back_exact and isinstance(back, Closure) and (predicate := self._predicate(back)):
            return part.then(Atom(end, predicate, start, place=self._place))
        return None

    def _predicate(self, step: Closure) -> NamedNode | None:
        """Return the auxiliary predicate of a closure; its rules are created on first use."""
        predicate = _name(step)
        if predicate.value in self._auxiliary:
            return predicate
        rules = []
        for steps in step.alternatives:
            walk = Walk(self._auxiliary, Names(()), self._place)
            first = walk.along(EMPTY, _START, steps, _END)
            more = walk.along(EMPTY.then(Atom(_START, predicate, _MIDDLE, place=self._place)), _MIDDLE, steps, _END)
            if first is None or more is None:
                return None
            head = Atom(_START, predicate, _END, place=self._place)
            rules += [((head,), first.elements), ((head,), more.elements)]
        self._auxiliary[predicate.value] = rules
        return predicate


def _name(step: Closure) -> NamedNode:
    """Name a closure: readable words of its predicates, and a digest of all of it."""
    text = key((step,))
    words = [_WORD.sub("-", re.split(r"[/#:]", iri)[-1]).strip("-") for iri in re.findall(r"<([^>]*)>", text)]
    readable = "-or-".join(dict.fromkeys(word for word in words if word))[:60] or "any"
    return NamedNode(f"{AUXILIARY}{readable}-{sha256(text.encode()).hexdigest()[:12]}")


def _may_begin_at_literal(step: Step) -> bool:
    if isinstance(step, Closure):
        return any(_may_begin_at_literal(steps[0]) for steps in step.alternatives)
    return step.inverse


def _is_resource(end: Pattern, part: Part) -> bool:
    """Return whether what is at an end is certainly no literal and no triple term."""
    if isinstance(end, Variable):
        return end in part.subjects
    return not isinstance(end, Literal | Triple | TripleTerm)
