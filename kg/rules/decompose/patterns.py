"""Triple patterns that are together: joins, whose order is free, so paths come behind what binds their ends.

A path of length zero joins two ends that are the same term. Exact only where one end is a constant, which matches
itself, or bound to a subject or object of the graph by what is before (SPARQL 1.1, section 18.4, ZeroLengthPath);
a path between two open ends is left to the store's engine.

Paths as atoms: each step one, and "one or more" an auxiliary predicate that two or more rules derive.

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

from kg.rules import form, sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.blocks import pattern_text, reads
from kg.rules.decompose.parts import EMPTY, AuxiliaryRules, IndivisibleError, Names, Part, Scope, Work, same
from kg.rules.decompose.paths import Avoid, Closure, Link, Step, Steps, inverse, is_plain, key, normal
from kg.syntax.tree import Repeat, Sequence, TriplePattern

if TYPE_CHECKING:
    from kg.errors import Place

_START: Final = form.Variable(".from")
_MIDDLE: Final = form.Variable(".between")
_END: Final = form.Variable(".to")
_WORD: Final = re.compile(r"[^A-Za-z0-9]+")


class Walk:
    """Writes steps as atoms of one rule."""

    def __init__(self, auxiliary: AuxiliaryRules, names: Names, place: Place) -> None:
        self._auxiliary = auxiliary
        self._names = names
        self._place = place

    def along(self, part: Part, start: form.Pattern, steps: Steps, end: form.Pattern) -> Part | None:
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

    def _step(self, part: Part, start: form.Pattern, step: Step, end: form.Pattern) -> Part | None:
        if isinstance(step, Closure):
            return self._closure(part, start, step, end)
        if step.inverse:
            start, end = end, start
        if isinstance(step, Link):
            return part.then(form.Atom(start, step.predicate, end, place=self._place))
        return self._avoid(part, start, step, end)

    def _avoid(self, part: Part, start: form.Pattern, step: Avoid, end: form.Pattern) -> Part:
        """Add a triple with a predicate that is none of those named: a predicate is an IRI, so the test never fails."""
        predicate = self._names.like(form.Variable("predicate"))
        part = part.then(form.Atom(start, predicate, end, place=self._place))
        if not step.predicates:
            return part
        listed = ", ".join(map(str, step.predicates))
        return part.then(
            form.Filter(expressions.expression(f"{sparql.spelling(predicate)} NOT IN ({listed})", self._place))
        )

    def _closure(self, part: Part, start: form.Pattern, step: Closure, end: form.Pattern) -> Part | None:
        """Add an atom with the auxiliary predicate.

        A triple has no literal as subject. Where a step may begin at a literal (`^:p`), the closure is told from the
        other end, or from an end that is known to be no literal.
        """
        back = inverse(step)
        forth_exact = not _may_begin_at_literal(step) or _is_resource(start, part)
        if forth_exact and (predicate := self._predicate(step)):
            return part.then(form.Atom(start, predicate, end, place=self._place))
        back_exact = not _may_begin_at_literal(back) or _is_resource(end, part)
        if back_exact and isinstance(back, Closure) and (predicate := self._predicate(back)):
            return part.then(form.Atom(end, predicate, start, place=self._place))
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
            more = walk.along(
                EMPTY.then(form.Atom(_START, predicate, _MIDDLE, place=self._place)), _MIDDLE, steps, _END
            )
            if first is None or more is None:
                return None
            head = form.Atom(_START, predicate, _END, place=self._place)
            rules += [((head,), first.elements), ((head,), more.elements)]
        self._auxiliary[predicate.value] = rules
        return predicate


def _name(step: Closure) -> NamedNode:
    """Name a closure: readable words of its predicates, and a digest of all of it."""
    text = key((step,))
    words = [_WORD.sub("-", re.split(r"[/#:]", iri)[-1]).strip("-") for iri in re.findall(r"<([^>]*)>", text)]
    readable = "-or-".join(dict.fromkeys(word for word in words if word))[:60] or "any"
    return NamedNode(f"{form.AUXILIARY}{readable}-{sha256(text.encode()).hexdigest()[:12]}")


def _may_begin_at_literal(step: Step) -> bool:
    if isinstance(step, Closure):
        return any(_may_begin_at_literal(steps[0]) for steps in step.alternatives)
    return step.inverse


def _is_resource(end: form.Pattern, part: Part) -> bool:
    """Return whether what is at an end is certainly no literal and no triple term."""
    if isinstance(end, form.Variable):
        return end in part.subjects
    return not isinstance(end, Literal | Triple | form.TripleTerm)


def basic(work: Work, patterns: list[TriplePattern], part: Part, scope: Scope) -> list[Part]:
    """Return the parts of `part` joined with patterns."""
    parts = [part]
    waiting = [pattern for pattern in patterns if _waits(pattern)]
    for pattern in patterns:
        if pattern not in waiting:
            parts = [new for old in parts for new in _matches(work, pattern, old, scope) or []]
    return [done for old in parts for done in _waiting(work, waiting, old, scope)]


def _waiting(work: Work, patterns: list[TriplePattern], part: Part, scope: Scope) -> list[Part]:
    """Join patterns that need to know their ends, each as soon as they are known."""
    if not patterns:
        return [part]
    tried = ((pattern, _matches(work, pattern, part, scope)) for pattern in patterns)
    chosen, matches = next(((one, parts) for one, parts in tried if parts is not None), (patterns[0], None))
    rest = [pattern for pattern in patterns if pattern is not chosen]
    if matches is None:
        matches = [part.then(_block(work, chosen))]
    return [done for new in matches for done in _waiting(work, rest, new, scope)]


def _waits(pattern: TriplePattern) -> bool:
    """Return whether the knowledge about the ends of a pattern matters."""
    path = normal(pattern.predicate)
    return path.zero or any(isinstance(step, Closure) for steps in path.alternatives for step in steps)


def _matches(work: Work, pattern: TriplePattern, part: Part, scope: Scope) -> list[Part] | None:
    """Return the parts of a join with a pattern, one for each way through its path; None if it has no such form."""
    path = pattern.predicate
    normalised = normal(path)
    if scope.single and not is_plain(path) and not (isinstance(path, Repeat) and not normalised.zero):
        if isinstance(path, Repeat):
            return None
        raise IndivisibleError
    walk = Walk(work.auxiliary, work.names, work.place(pattern.span))
    ways = [walk.along(part, pattern.subject, steps, pattern.object) for steps in normalised.alternatives]
    parts = [way for way in ways if way is not None]
    if len(parts) < len(ways):
        return None
    if not normalised.zero:
        return parts
    still = _ends_equal(pattern, part)
    return None if still is None else [*still, *parts]


def _ends_equal(pattern: TriplePattern, part: Part) -> list[Part] | None:
    """Return the parts in which both ends of a pattern are one term, bound or constant; None if neither is."""
    subject, obj = pattern.subject, pattern.object
    for end, other in ((subject, obj), (obj, subject)):
        if isinstance(end, form.TripleTerm) or isinstance(other, form.TripleTerm):
            return None
        if isinstance(end, form.Variable):
            if end in part.nodes:
                return [_equal(part, end, other)]
        elif not isinstance(pattern.predicate, Sequence):
            # A sequence of paths is a join: its middle is not a constant, so it has to be in the graph.
            if isinstance(other, form.Variable):
                return [part.then(form.Values((other,), ((end,),)))]
            return [part] if end == other else []
    return None


def _equal(part: Part, bound: form.Variable, other: form.Pattern) -> Part:
    """Return the part in which a bound variable and another end are one term."""
    if not isinstance(other, form.Variable):
        return part.then(form.Values((bound,), ((other,),)))  # type: ignore[arg-type]  # no triple term
    if other == bound:
        return part.same_node(bound, bound)
    value = expressions.expression(sparql.spelling(bound))
    equal = form.Filter(same(other, value)) if other in part.bound else form.Assignment(other, value)
    return part.then(equal).same_node(other, bound)


def _block(work: Work, pattern: TriplePattern) -> form.EngineBlock:
    """Return a pattern that the store's engine evaluates by itself, which is how SPARQL joins it."""
    place = work.place(pattern.span)
    ends = [variable for end in (pattern.subject, pattern.object) for variable in form.variables_of(end)]
    unique = tuple(dict.fromkeys(ends))
    return form.EngineBlock(pattern_text(pattern), unique, (), reads([pattern]), monotone=True, place=place)
