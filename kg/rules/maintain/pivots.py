"""Pivots of a rule: for each source of triples, what to evaluate when that source changes.

A source of the outer body is read from the change itself. The others are read from the data before (consequences of
a removed triple) or after it (consequences of an added one).

A source inside NOT, or an aggregate, only selects solutions of the outer body to evaluate again. The bodies around
it form a chain. The innermost is solved with the source read from the change; the values of the columns that it shares
with the body around it (of an aggregate: its keys) restrict that one, and so on outwards. The data in which
bodies are solved alternates: an added triple gives a negated body a new solution in the data after, which removes
solutions of the outer body in the data before. A changed group has one value before and another after.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from kg.rules.engine.plan import Assign, Block, Body, Grouped, Match, Nested, RulePlan, Step, Structure, Test, binds
from kg.rules.maintain.patterns import pattern

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.engine.terms import Dictionary

_Inner: TypeAlias = Nested | Grouped

Reading: TypeAlias = tuple[bool, ...]
"""For the outer body and each of a chain, from outside, whether it is solved in the data after the change."""


@dataclass(frozen=True, slots=True)
class Link:
    """One body of a chain. `body` lacks steps that need outer variables and those not joined with the change.

    `shared` pairs its columns with outer ones.
    """

    body: Body
    shared: tuple[tuple[str, str], ...]
    grouped: bool
    negated: bool


@dataclass(frozen=True, slots=True)
class Pivot:
    """One source of a rule; `predicates` that it reads, None for any; `block`: whether it is a block of SPARQL.

    `patterns` are those of the triples that it reads. `coming` and `going` are the readings for added and for removed
    triples.
    """

    number: int
    predicates: frozenset[int] | None
    patterns: frozenset[int]
    asserted: bool
    block: bool
    chain: tuple[Link, ...]
    coming: tuple[Reading, ...]
    going: tuple[Reading, ...]


def pivots(plan: RulePlan, dictionary: Dictionary) -> tuple[Pivot, ...]:
    """Return a pivot for each source of a rule."""
    return tuple(_pivots(plan, plan.body, (), dictionary))


def _pivots(plan: RulePlan, body: Body, around: tuple[_Inner, ...], dictionary: Dictionary) -> Iterator[Pivot]:
    for step in body.steps:
        if isinstance(step, Match | Block):
            chain = _chain(around, step)
            coming, going = (tuple(_readings(chain, after=after)) for after in (True, False))
            predicates = _predicates(step, dictionary)
            value = step.object if isinstance(step, Match) else None
            patterns = frozenset(pattern(one, value) for one in predicates or {None})
            asserted, block = plan.sources[step.number].asserted, isinstance(step, Block)
            yield Pivot(step.number, predicates, patterns, asserted, block, chain, coming, going)
        elif isinstance(step, Nested | Grouped):
            yield from _pivots(plan, step.body, (*around, step), dictionary)


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


def _chain(around: Sequence[_Inner], source: Match | Block) -> tuple[Link, ...]:
    """Return the bodies around a source, the outermost first."""
    chain: list[Link] = []
    carried: tuple[Step, ...] = (source,)
    names = source.names
    for inner in reversed(around):
        link = _link(inner, carried, names)
        chain.insert(0, link)
        carried, names = (), frozenset(outer for _, outer in link.shared)
    return tuple(chain)


def _link(inner: _Inner, carried: tuple[Step, ...], names: frozenset[str]) -> Link:
    """Return the restriction of the body around an inner one, if some columns have few known values."""
    steps, names = _connected(_solvable(inner.body), carried, names)
    pairs = inner.keys if isinstance(inner, Grouped) else tuple((name, name) for name in sorted(inner.shared))
    shared = tuple(pair for pair in pairs if pair[0] in names)
    negated = isinstance(inner, Nested) and inner.negated
    return Link(Body(steps, inner.body.numbers, names), shared, isinstance(inner, Grouped), negated)


def _connected(
    steps: Sequence[Step], carried: tuple[Step, ...], names: frozenset[str]
) -> tuple[tuple[Step, ...], frozenset[str]]:
    """Return the steps that join with those `carried` or with the columns `names`, and all their columns.

    A step that shares only a filter with them would form a Cartesian product with the change.
    """
    waiting = [step for step in steps if not any(step is other for other in carried)]
    while joined := [step for step in waiting if binds(step) and (_needs(step) | binds(step)) & names]:
        carried += tuple(joined)
        waiting = [step for step in waiting if not any(step is other for other in joined)]
        names = names.union(*(_needs(step) | binds(step) for step in joined))
    return (*carried, *(step for step in waiting if not binds(step) and _needs(step) <= names)), names


def _solvable(body: Body) -> tuple[Step, ...]:
    """Return the steps that need no variable from outside the body.

    The other steps only drop rows, or bind columns that none of these steps needs.
    """
    names: set[str] = set()
    solvable: list[Step] = []
    waiting = list(body.steps)
    while ready := [step for step in waiting if _needs(step) <= names]:
        solvable += ready
        waiting = [step for step in waiting if not any(step is other for other in ready)]
        names = names.union(*map(binds, ready))
    return tuple(solvable)


def _needs(step: Step) -> frozenset[str]:
    if isinstance(step, Test | Assign):
        return frozenset(column for _, column in step.columns)
    if isinstance(step, Structure):
        return frozenset({step.term})
    return step.shared if isinstance(step, Nested) else frozenset()
