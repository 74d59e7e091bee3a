"""Where a change enters a rule: for each of its sources, what has to be looked at when that source changes.

A source of the outer body is read from the change itself, the others from the data before (what was derived from a
triple that goes) or after it (what can be derived from one that comes).

A source inside NOT, or an aggregate, says only which solutions of the outer body to look at again. The bodies around
it form a chain. The innermost is solved with the source read from the change; the values of the columns that it shares
with the body around it (of an aggregate: its keys) restrict that one, and so on outwards. In which data each body is
solved alternates: a triple that comes gives an inner body a new solution in the data after, which takes solutions
away from the negation's outer body, as it was before. A group that changes had a value before and has one after.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from kg.rules.engine.plan import Assign, Block, Body, Grouped, Match, Nested, Rows, Structure, Test

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.engine.plan import RulePlan, Step
    from kg.rules.engine.terms import Dictionary

__all__ = ["Link", "Pivot", "Reading", "pivots"]

Reading: TypeAlias = tuple[bool, ...]
"""For the outer body and each of a chain, from outside, whether it is solved in the data after the change."""


@dataclass(frozen=True, slots=True)
class Link:
    """One body of a chain. `body` lacks what it cannot know by itself; `shared` pairs its columns with outer ones."""

    body: Body
    shared: tuple[tuple[str, str], ...]
    grouped: bool
    negated: bool


@dataclass(frozen=True, slots=True)
class Pivot:
    """One source of a rule; `predicates` that it reads, None for any; `block`: it is a block of SPARQL.

    `subject` and `object` are the terms that an atom names. `coming` and `going` are the readings for triples that
    come and that go.
    """

    number: int
    predicates: frozenset[int] | None
    asserted: bool
    block: bool
    chain: tuple[Link, ...]
    coming: tuple[Reading, ...]
    going: tuple[Reading, ...]
    subject: int | None = None
    object: int | None = None


def pivots(plan: RulePlan, dictionary: Dictionary) -> tuple[Pivot, ...]:
    """Return a pivot for each source of a rule."""
    return tuple(_pivots(plan, plan.body, (), dictionary))


def _pivots(plan: RulePlan, body: Body, chain: tuple[Link, ...], dictionary: Dictionary) -> Iterator[Pivot]:
    for step in body.steps:
        if isinstance(step, Match | Block):
            source = plan.sources[step.number]
            coming, going = (tuple(_readings(chain, after=after)) for after in (True, False))
            predicates = _predicates(step, dictionary)
            terms = (step.subject, step.object) if isinstance(step, Match) else ()
            named = (term if isinstance(term, int) else None for term in terms)
            yield Pivot(step.number, predicates, source.asserted, isinstance(step, Block), chain, coming, going, *named)
        elif isinstance(step, Nested):
            shared = tuple((name, name) for name in sorted(step.shared))
            yield from _pivots(plan, step.body, (*chain, _link(step.body, shared, step)), dictionary)
        elif isinstance(step, Grouped):
            yield from _pivots(plan, step.body, (*chain, _link(step.body, step.keys, step)), dictionary)


def _predicates(step: Match | Block, dictionary: Dictionary) -> frozenset[int] | None:
    if isinstance(step, Match):
        return frozenset({step.predicate}) if isinstance(step.predicate, int) else None
    reads = step.block.reads
    return None if reads is None else frozenset(map(dictionary.intern_term, reads))


def _readings(chain: Sequence[Link], *, after: bool) -> Iterator[Reading]:
    """Yield the readings of a chain whose innermost body is solved in the data after (or before) the change."""
    if not chain:
        yield (after,)
        return
    *outer, last = chain
    around = {after, not after} if last.grouped else {after != last.negated}
    for version in sorted(around):
        for reading in _readings(outer, after=version):
            yield (*reading, after)


def _link(body: Body, shared: tuple[tuple[str, str], ...], step: Nested | Grouped) -> Link:
    kept, names = _solvable(body)
    inner = Body(kept, body.numbers, names)
    known = tuple(pair for pair in shared if pair[0] in names)
    return Link(inner, known, isinstance(step, Grouped), isinstance(step, Nested) and step.negated)


def _solvable(body: Body) -> tuple[tuple[Step, ...], frozenset[str]]:
    """Return the steps that need nothing from outside of the body, and the columns that they bind.

    What is left out would only have dropped rows, or bound what no other step of these needs.
    """
    names: set[str] = set()
    kept: list[Step] = []
    waiting = list(body.steps)
    while ready := [step for step in waiting if _needs(step) <= names]:
        kept += ready
        waiting = [step for step in waiting if not any(step is other for other in ready)]
        for step in ready:
            names |= _binds(step)
    return tuple(kept), frozenset(names)


def _needs(step: Step) -> frozenset[str]:
    if isinstance(step, Test | Assign):
        return frozenset(column for _, column in step.columns)
    if isinstance(step, Structure):
        return frozenset({step.term})
    return step.shared if isinstance(step, Nested) else frozenset()


def _binds(step: Step) -> frozenset[str]:
    if isinstance(step, Assign):
        return frozenset({step.name})
    return step.names if isinstance(step, Match | Structure | Rows | Grouped | Block) else frozenset()
