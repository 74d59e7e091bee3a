"""Triple patterns that are together: joins, whose order is free, so paths come behind what binds their ends.

A path of length zero joins two ends that are the same term. Exact only where one end is a constant, which matches
itself, or bound to a subject or object of the graph by what is before (SPARQL 1.1, section 18.4, ZeroLengthPath);
a path between two open ends is left to the store's engine.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.rules import sparql
from kg.rules.decompose import expressions
from kg.rules.decompose.blocks import pattern_text, reads
from kg.rules.decompose.closures import Walk
from kg.rules.decompose.parts import IndivisibleError, same
from kg.rules.decompose.paths import Closure, is_plain, normal
from kg.rules.form import Assignment, EngineBlock, Filter, TripleTerm, Values, Variable, variables_of
from kg.syntax.tree import Repeat, Sequence

if TYPE_CHECKING:
    from kg.rules.decompose.parts import Part, Scope
    from kg.rules.decompose.work import Work
    from kg.rules.form import Pattern
    from kg.syntax.tree import TriplePattern


def basic(work: Work, patterns: list[TriplePattern], part: Part, scope: Scope) -> list[Part]:
    """Return the parts of `part` joined with patterns."""
    parts = [part]
    for pattern in patterns:
        if not _waits(pattern):
            parts = [new for old in parts for new in _matches(work, pattern, old, scope) or []]
    return [done for old in parts for done in _waiting(work, [p for p in patterns if _waits(p)], old, scope)]


def _waiting(work: Work, patterns: list[TriplePattern], part: Part, scope: Scope) -> list[Part]:
    """Join patterns that need to know their ends, each as soon as they are known."""
    if not patterns:
        return [part]
    chosen, found = patterns[0], None
    for pattern in patterns:
        found = _matches(work, pattern, part, scope)
        if found is not None:
            chosen = pattern
            break
    rest = [pattern for pattern in patterns if pattern is not chosen]
    if found is None:
        found = [part.then(_block(work, chosen))]
    return [done for new in found for done in _waiting(work, rest, new, scope)]


def _waits(pattern: TriplePattern) -> bool:
    """Return whether the knowledge about the ends of a pattern matters."""
    found = normal(pattern.predicate)
    return found.zero or any(isinstance(step, Closure) for steps in found.alternatives for step in steps)


def _matches(work: Work, pattern: TriplePattern, part: Part, scope: Scope) -> list[Part] | None:
    """Return the parts of a join with a pattern, one for each way through its path; None if it has no such form."""
    path = pattern.predicate
    found = normal(path)
    if scope.single and not is_plain(path) and not (isinstance(path, Repeat) and not found.zero):
        if isinstance(path, Repeat):
            return None
        raise IndivisibleError
    walk = Walk(work.auxiliary, work.names, work.place(pattern.span))
    ways = [walk.along(part, pattern.subject, steps, pattern.object) for steps in found.alternatives]
    parts = [way for way in ways if way is not None]
    if len(parts) < len(ways):
        return None
    if not found.zero:
        return parts
    still = _ends_equal(pattern, part)
    return None if still is None else [*still, *parts]


def _ends_equal(pattern: TriplePattern, part: Part) -> list[Part] | None:
    """Return the parts in which both ends of a pattern are one term, bound or constant; None if neither is."""
    subject, obj = pattern.subject, pattern.object
    for end, other in ((subject, obj), (obj, subject)):
        if isinstance(end, TripleTerm) or isinstance(other, TripleTerm):
            return None
        if isinstance(end, Variable):
            if end in part.nodes:
                return [_equal(part, end, other)]
        elif not isinstance(pattern.predicate, Sequence):
            # A sequence of paths is a join: its middle is not a constant, so it has to be in the graph.
            return _constant(part, end, other)
    return None


def _constant(part: Part, end: Pattern, other: Pattern) -> list[Part]:
    if isinstance(other, Variable):
        return [part.then(Values((other,), ((end,),)))]  # type: ignore[arg-type]  # no variable and no triple term
    return [part] if end == other else []


def _equal(part: Part, bound: Variable, other: Pattern) -> Part:
    """Return the part in which a bound variable and another end are one term."""
    if not isinstance(other, Variable):
        return part.then(Values((bound,), ((other,),)))  # type: ignore[arg-type]  # no triple term
    if other == bound:
        return part.same_node(bound, bound)
    value = expressions.expression(sparql.spelling(bound))
    known = other in part.bound
    return part.then(Filter(same(other, value)) if known else Assignment(other, value)).same_node(other, bound)


def _block(work: Work, pattern: TriplePattern) -> EngineBlock:
    """Return a pattern that the store's engine evaluates by itself, which is how SPARQL joins it."""
    place = work.place(pattern.span)
    ends = [variable for end in (pattern.subject, pattern.object) for variable in variables_of(end)]
    unique = tuple(dict.fromkeys(ends))
    return EngineBlock(pattern_text(pattern), unique, (), reads([pattern]), monotone=True, place=place)


def known(part: Part, scope: Scope) -> Part:
    """Return an empty part with the knowledge from before its group."""
    return replace(part, nodes=part.nodes | scope.near, subjects=part.subjects | scope.subjects)
