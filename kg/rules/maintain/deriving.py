"""Consequences of a change by one rule, in the data before it or after it.

Most rules that a small change reaches have no solution with it: another atom of the body finds no triple for the terms
that changed. That is decided from the text of the rule, since planning such a rule costs more.

A source of the outer body is read from the change itself. The others are read from the data before (consequences of
a removed triple) or after it (consequences of an added one).

A source inside NOT, or an aggregate, only selects solutions of the outer body to evaluate again. The bodies around
it form a chain. The innermost is solved with the source read from the change; the values of the columns that it shares
with the body around it (of an aggregate: its keys) restrict that one, and so on outwards. The data in which
bodies are solved alternates: an added triple gives a negated body a new solution in the data after, which removes
solutions of the outer body in the data before. A changed group has one value before and another after.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from pyoxigraph import BlankNode, NamedNode

from kg.rules.engine import matching
from kg.rules.engine.facts import Facts, absorb, unpack
from kg.rules.engine.heads import Collector
from kg.rules.engine.plan import (
    Assign,
    Block,
    Body,
    Grouped,
    Head,
    Match,
    Nested,
    Rows,
    RulePlan,
    Step,
    Structure,
    Test,
    binds,
)
from kg.rules.engine.solve import Solver, State
from kg.rules.engine.tables import UNIT, Table, concatenate, distinct_rows
from kg.rules.form import Aggregate, Atom, Element, EngineBlock, Exists, Pattern, Rule, Term, TripleTerm, Variable
from kg.rules.maintain.patterns import Delta, World, pattern

if TYPE_CHECKING:
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


_FEW: Final = 32
"""Larger changes are not checked triple by triple."""


class _Atom(NamedTuple):
    """An atom with a constant predicate: identifiers of terms, names of variables, None for a triple term."""

    subject: int | str | None
    predicate: int
    object: int | str | None


class Join:
    """The atoms of the outer body of a rule, and those of EXISTS and NOT EXISTS directly in it.

    `patterns` returns the patterns that an element reads. A change of what any other element reads is not checked.
    """

    def __init__(
        self, body: Sequence[Element], patterns: Callable[[Element], Iterable[int]], intern: Callable[[Term], int]
    ) -> None:
        self._intern = intern
        self._outer: list[_Atom] = []
        self._places: list[tuple[_Atom, frozenset[str] | None]] = []
        """Atoms that may read a changed triple, with the outer variables in scope; None for atoms of the outer body."""
        self._others: set[int] = set()
        for element in body:
            if isinstance(element, Exists):
                # Variables that the outer body binds later are others.
                scope = frozenset(node for atom in self._outer for node in atom if isinstance(node, str))
                for inner in element.body:
                    if (atom := self._atom(inner)) is not None:
                        self._places.append((atom, scope))
                    else:
                        self._others.update(patterns(inner))
            elif (atom := self._atom(element)) is not None:
                self._outer.append(atom)
                self._places.append((atom, None))
            else:
                self._others.update(patterns(element))

    def _atom(self, element: Element) -> _Atom | None:
        """Return an element as an atom with a constant predicate, None for any other."""
        if not isinstance(element, Atom) or not isinstance(element.predicate, NamedNode):
            return None
        predicate = self._intern(element.predicate)
        return _Atom(self._node(element.subject), predicate, self._node(element.object))

    def _node(self, node: Pattern) -> int | str | None:
        if isinstance(node, Variable):
            return node.name
        return None if isinstance(node, TripleTerm) else self._intern(node)

    def possible(self, changes: Sequence[Delta], worlds: tuple[World, World]) -> bool:
        """Return whether a solution, before or after, may have a triple of the changes; True if unknown."""
        if any(not self._others.isdisjoint(change.patterns) for change in changes):
            return True
        parts = [part for change in changes for part in (change.facts, change.asserted)]
        if sum(map(len, parts)) > _FEW:
            return True
        triples: dict[int, set[int]] = {}
        for part in parts:
            for predicate, keys in part:
                triples.setdefault(predicate, set()).update(keys.tolist())
        facts = [world.facts for world in worlds]
        for atom, scope in self._places:
            for key in triples.get(atom.predicate, ()):
                if self._joined(atom, scope, divmod(key, 1 << 32), facts):
                    return True
        return False

    def _joined(
        self, atom: _Atom, scope: frozenset[str] | None, triple: tuple[int, int], facts: Sequence[Facts]
    ) -> bool:
        """Return whether each other atom of the outer body has triples where `atom` matches a triple."""
        bound: dict[int | str, int] = {}
        for node, term in zip((atom.subject, atom.object), triple, strict=True):
            if node is not None and (node if isinstance(node, int) else bound.setdefault(node, term)) != term:
                return False
        if scope is not None:
            bound = {name: term for name, term in bound.items() if name in scope}
        for other in self._outer:
            subject, value = _term(other.subject, bound), _term(other.object, bound)
            if other is not atom and not any(one.has(other.predicate, subject, value) for one in facts):
                return False
        return True


def _term(node: int | str | None, bound: dict[int | str, int]) -> int | None:
    """Return the term that a node of an atom has, None for any."""
    return node if isinstance(node, int) or node is None else bound.get(node)


class MaintainedRule:
    """A rule with its pivots; `before` and `after` are the worlds that it is solved in.

    A rule is planned when a change first reaches it. `intern` returns the identifier of a term.
    """

    def __init__(self, rule: Rule, plans: Mapping[Rule, RulePlan], state: State, intern: Callable[[Term], int]) -> None:
        self.name = str(rule)
        self.reads = frozenset(_patterns(rule.body, intern))
        """The patterns of what it reads."""
        self.derives = frozenset(_patterns(rule.head, intern, head=True))
        """The patterns of what it derives."""
        self._rule = rule
        self._plans = plans
        self._state = state
        self._intern = intern

    @cached_property
    def plan(self) -> RulePlan:
        """The plan of evaluation."""
        return self._plans[self._rule]

    @cached_property
    def writes(self) -> frozenset[int] | None:
        """The predicates of derived triples, None for any."""
        written = {head.predicate for head in self.plan.heads}
        predicates = frozenset(predicate for predicate in written if isinstance(predicate, int))
        return predicates if len(predicates) == len(written) else None

    @cached_property
    def _pivots(self) -> tuple[Pivot, ...]:
        return pivots(self.plan, self._state.dictionary)

    @cached_property
    def _join(self) -> Join:
        return Join(self._rule.body, lambda element: _patterns([element], self._intern), self._intern)

    @cached_property
    def _open(self) -> frozenset[str]:
        """The columns that a solution may leave unbound; restricting them from outside would bind them."""
        steps = self.plan.body.steps
        inner = [step.names for step in steps if isinstance(step, Grouped | Block)]
        outer = [step.names for step in steps if isinstance(step, Match | Structure | Rows)]
        assigned = {step.name for step in steps if isinstance(step, Assign)}
        return frozenset().union(*inner).difference(*outer, assigned)

    @cached_property
    def _asserted(self) -> tuple[bool, ...]:
        return tuple(source.asserted for source in self.plan.sources)

    @cached_property
    def _needed(self) -> list[Match]:
        steps = self.plan.body.steps
        return [step for step in steps if isinstance(step, Match) and isinstance(step.predicate, int)]

    def grows(self, written: frozenset[int] | None) -> bool:
        """Return whether the rule is monotone in the predicates `written` (None is any)."""
        inner = [pivot for pivot in self._pivots if (pivot.chain or pivot.block) and not pivot.asserted]
        return not any(written is None or pivot.predicates is None or pivot.predicates & written for pivot in inner)

    def supported(self, candidates: Facts, world: World) -> Facts:
        """Return the triples derived in a world, restricted to those of the candidates; sometimes a superset."""
        result = Facts()
        sources = self._sources(world)
        for head in self.plan.heads:
            for seeds in _seeds(head, candidates, self._state.hidden):
                bound = seeds.keeping(seeds.columns.keys() - self._open)
                absorb(result, self._derived(sources, distinct_rows(bound) if bound.columns else UNIT))
        return result

    def consequences(
        self, came: Delta | None, gone: Delta | None, worlds: tuple[World, World], *, after: bool
    ) -> Facts:
        """Return what the rule derives from added or removed triples, in the world before or `after` the change.

        Removed triples of the outer body are joined in the world before, added ones in the world after.
        """
        result = Facts()
        # Once the pivots are computed, checking the text of the rule first saves nothing.
        planned = "_pivots" in self.__dict__
        if not (planned or self._join.possible([delta for delta in (came, gone) if delta], worlds)):
            return result
        for pivot in self._pivots:
            for delta, readings in ((came, pivot.coming), (gone, pivot.going)):
                if delta is None or pivot.patterns.isdisjoint(delta.patterns):
                    continue
                if pivot.block:
                    return self._derived(self._sources(worlds[after]), UNIT)  # a block of SPARQL cannot be restricted
                change = delta.asserted if pivot.asserted else delta.facts
                for reading in readings:
                    if reading[0] == after:
                        absorb(result, self._reached(pivot, change, reading, worlds))
        return result

    def _reached(self, pivot: Pivot, change: Facts, reading: Reading, worlds: tuple[World, World]) -> Facts:
        """Return the triples derived in the outer world of the reading, restricted by the inner bodies of the chain."""
        outer = self._sources(worlds[reading[0]])
        if not pivot.chain:
            outer[pivot.number] = change
            if not self._meets(pivot.number, outer):
                return Facts()
        elif not self._possible(outer):
            return Facts()
        seeds = UNIT
        for depth in range(len(pivot.chain), 0, -1):
            link = pivot.chain[depth - 1]
            sources = self._sources(worlds[reading[depth]])
            if depth == len(pivot.chain):
                sources[pivot.number] = change
            names = frozenset(inner for inner, _ in link.shared)
            tables = list(Solver(self._state, sources).solutions(link.body, names, seeds))
            if not any(table.rows for table in tables):
                return Facts()
            inside = distinct_rows(concatenate(tables, names))
            seeds = Table({outer: inside.columns[inner] for inner, outer in link.shared}, inside.rows)
        return self._derived(outer, seeds)

    def _sources(self, world: World) -> list[Facts]:
        return [world.asserted if asserted else world.facts for asserted in self._asserted]

    def _derived(self, sources: Sequence[Facts], seeds: Table) -> Facts:
        if not self._possible(sources):
            return Facts()
        plan = self.plan
        collector = Collector(plan, self._state.dictionary)
        for table in Solver(self._state, sources).solutions(plan.body, plan.outputs, seeds):
            collector.add(table.keeping(plan.outputs), plan.heads)
        return collector.facts()

    def _meets(self, number: int, sources: Sequence[Facts]) -> bool:
        """Return whether some triple of a source can join with each atom next to its own.

        Most rules that a small change reaches end here, at far less cost than solving the body.
        """
        terms = len(self._state.dictionary)
        pivot = next((step for step in self._needed if step.number == number), None)
        if pivot is None:
            return True
        table = matching.match(UNIT, pivot, matching.Reading(sources[number], terms, pivot.names))
        for place, step in enumerate(self._needed):
            if step is not pivot and not step.names.isdisjoint(table.columns):
                table = matching.match(table, step, matching.Reading(sources[step.number], terms, frozenset()))
                if not table.rows:
                    self._needed.insert(0, self._needed.pop(place))
                    return False
        return table.rows > 0

    def _possible(self, sources: Sequence[Facts]) -> bool:
        """Return whether each atom of the outer body has any triples.

        Most rules that a small change reaches lack some. The atom without triples is checked first next time.
        """
        for place, step in enumerate(self._needed):
            subject = step.subject if isinstance(step.subject, int) else None
            value = step.object if isinstance(step.object, int) else None
            if not sources[step.number].has(int(step.predicate), subject, value):
                self._needed.insert(0, self._needed.pop(place))
                return False
        return True


def _patterns(elements: Iterable[Element], intern: Callable[[Term], int], *, head: bool = False) -> Iterator[int]:
    """Yield the patterns of the triples in elements of a body, or in the atoms of a `head`."""
    for element in elements:
        if isinstance(element, Atom):
            predicate, value = element.predicate, element.object
            # A blank node of a body is a term of the data, one of a head is a new node.
            fresh = head and isinstance(value, BlankNode)
            yield pattern(
                intern(predicate) if isinstance(predicate, NamedNode) else None,
                None if fresh or isinstance(value, Variable | TripleTerm) else intern(value),
            )
        elif isinstance(element, EngineBlock):
            for read in element.reads or (None,):
                yield pattern(intern(read) if read is not None else None, None)
        elif isinstance(element, Exists | Aggregate):
            yield from _patterns(element.body, intern)


def _seeds(head: Head, candidates: Facts, hidden: frozenset[int]) -> Iterator[Table]:
    """Yield tables that bind the variables of a head to the candidates that it may derive.

    Blank nodes and triple terms of a head are made from the solution and bind nothing.
    """
    if isinstance(head.predicate, int):
        chosen = [head.predicate] if candidates.keys(head.predicate).size else []
    else:
        chosen = [predicate for predicate in candidates.predicates if predicate not in hidden]
    for predicate in chosen:
        subjects, objects = unpack(candidates.keys(predicate))
        table = Table({".subject": subjects, ".object": objects}, subjects.size)
        columns = {}
        for node, name in ((head.subject, ".subject"), (head.object, ".object")):
            if isinstance(node, int):
                table = table.take(table.columns[name] == node)
            elif isinstance(node, str):
                columns[node] = name
        if isinstance(head.subject, str) and head.subject == head.object:
            table = table.take(table.columns[".subject"] == table.columns[".object"])
        if table.rows:
            yield _named(table, columns, head, predicate)


def _named(table: Table, columns: dict[str, str], head: Head, predicate: int) -> Table:
    """Rename columns as in the head, and drop duplicate rows."""
    result = Table({node: table.columns[name] for node, name in columns.items()}, table.rows)
    if isinstance(head.predicate, str):
        if head.predicate in columns:
            result = result.take(result.columns[head.predicate] == predicate)
        result = result.plus(
            {head.predicate: (result.columns.get(head.predicate, table.columns[".subject"]) * 0) + predicate}
        )
    return distinct_rows(result)
