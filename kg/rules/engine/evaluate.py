"""Evaluates a set of rules to its fixpoint, stratum by stratum, each derivation tried once.

A stratum that is not recursive runs once. In a recursive one every rule runs over all there is, then in rounds: for
each atom that reads what the stratum derives, the rule runs with that atom on what the last round added, the atoms
before it on what was there before, those after it on everything (semi-naive evaluation).
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

from pyoxigraph import Literal, NamedNode

from kg.rules.dependencies import depends, mints
from kg.rules.engine.blocks import Blocks
from kg.rules.engine.equality import Closure, equalities
from kg.rules.engine.expressions import Expressions
from kg.rules.engine.facts import Facts, Keys, absorb
from kg.rules.engine.heads import Collector
from kg.rules.engine.limits import Clock, Limits
from kg.rules.engine.planning import plan
from kg.rules.engine.solve import Solver, State
from kg.rules.form import Atom, Rule, Variable, is_auxiliary
from kg.rules.stratify import Stratum, stratify
from kg.store.terms import spell

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from kg.rules.engine.plan import RulePlan
    from kg.rules.engine.terms import Dictionary

__all__ = ["Limits", "Outcome", "Program", "RuleReport", "evaluate"]


@dataclass(slots=True)
class RuleReport:
    """Report of a rule: `stratum` is its level, `derived` counts the triples that it was the first to derive."""

    rule: Rule
    stratum: int
    rounds: int = 0
    derived: int = 0
    seconds: float = 0.0
    matched: tuple[int, ...] = ()
    """For each element of the body the rows after it, over all rounds; 0: never reached, or nothing passed it.
    For each element of a rule of an equality how many pairs of equal terms were read."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The inferred triples that are not asserted, and the report of each rule, in the order they ran."""

    inferred: Facts
    reports: list[RuleReport] = field(default_factory=list)


class Program:
    """A set of rules, stratified; plans and values of expressions are cached for each dictionary it runs over."""

    def __init__(self, rules: Iterable[Rule], strata: Sequence[Stratum] = ()) -> None:
        """Raise `RuleError` KG202 for rules that cannot be stratified.

        `strata` are those of `rules`, where they are known already.
        """
        self.rules = tuple(rules)
        self.strata = strata or stratify(self.rules, bounded=True)
        self._bound: WeakKeyDictionary[Dictionary, _Bound] = WeakKeyDictionary()

    @property
    def levels(self) -> int:
        """Number of levels, each above those that it negates and counts."""
        return max((stratum.level for stratum in self.strata), default=0)

    def refuse_minting(self) -> None:
        """Raise `RuleError` KG204 when a rule makes terms from what it derives itself."""
        if any(stratum.recursive and any(map(mints, stratum.rules)) for stratum in self.strata):
            stratify(self.rules)  # raises with the rule and its cycle

    def plans(self, dictionary: Dictionary) -> Mapping[Rule, RulePlan]:
        """Return the plan of each rule over a dictionary, made on first use."""
        return self._over(dictionary).plans

    def state(self, dictionary: Dictionary, limits: Limits | None = None) -> State:
        """Return the shared state for evaluation over a dictionary, with a clock that begins now."""
        bound = self._over(dictionary)
        return State(dictionary, bound.expressions, bound.blocks, Clock(limits or Limits()), bound.hidden)

    def _over(self, dictionary: Dictionary) -> _Bound:
        bound = self._bound.get(dictionary)
        if bound is None:
            bound = self._bound[dictionary] = _Bound(self.rules, dictionary)
        return bound


class _Plans(dict["Rule", "RulePlan"]):
    """The plans of rules over a dictionary: a small change needs few."""

    def __init__(self, dictionary: Dictionary) -> None:
        super().__init__()
        self._dictionary = dictionary

    def __missing__(self, rule: Rule) -> RulePlan:
        self[rule] = rule_plan = plan(rule, self._dictionary)
        return rule_plan


class _Bound:
    """A program over one dictionary."""

    def __init__(self, rules: Sequence[Rule], dictionary: Dictionary) -> None:
        self.plans = _Plans(dictionary)
        self.expressions = Expressions(dictionary)
        self.blocks = Blocks(dictionary)
        atoms = (one for rule in rules for one in (*rule.head, *rule.body) if isinstance(one, Atom))
        predicates = {atom.predicate for atom in atoms}
        self.hidden = frozenset(
            dictionary.intern_term(predicate) for predicate in predicates if is_auxiliary(predicate)
        )


def evaluate(
    program: Program,
    dictionary: Dictionary,
    asserted: Facts,
    *,
    inferred: Facts | None = None,
    limits: Limits | None = None,
) -> Outcome:
    """Return the triples that the rules infer from `asserted`, which is not changed.

    `inferred` is what other rules inferred before: the rules read it, except where they read asserted triples only.

    Raises `RuleError`: KG204 where rules make terms in recursion and `limits` has no bound, KG205 at a limit.
    """
    limits = limits or Limits()
    if not limits.bounded:
        program.refuse_minting()
    run = _Run(program, dictionary, asserted, inferred or Facts(), limits)
    for stratum in program.strata:
        run.stratum(stratum)
    return Outcome(run.inferred, run.reports)


class _Run:
    """One evaluation: `_facts` has all triples so far, `inferred` the part that its rules added.

    `before` are triples that are known, but neither asserted nor inferred by this evaluation.
    """

    def __init__(
        self, program: Program, dictionary: Dictionary, asserted: Facts, before: Facts, limits: Limits
    ) -> None:
        self._state = program.state(dictionary, limits)
        self._plans = program.plans(dictionary)
        self._asserted = asserted
        self._facts = asserted.copy()
        absorb(self._facts, before)
        self._size = 0
        self.inferred = Facts(pages=asserted.pages)
        self.reports: list[RuleReport] = []

    def stratum(self, stratum: Stratum) -> None:
        """Evaluate a stratum to its fixpoint."""
        closures = _Closures(stratum, self._state)
        reports = [RuleReport(rule, stratum.level, matched=(0,) * len(rule.body)) for rule in stratum.rules]
        self.reports += reports
        rules = []
        for report in reports:
            if not closures.register(report):
                continue
            if not stratum.recursive and not self._possible(report.rule):
                report.rounds += 1
            else:
                plan = self._plans[report.rule]
                pivots = _pivots(plan, stratum.rules, self._state.dictionary) if stratum.recursive else ()
                rules.append(_Active(plan, report, tuple(pivots)))
        delta = Facts()
        for rule in rules:
            self._apply(rule, rule.plan.inputs(self._asserted, self._facts), delta)
        self._close(closures, delta, [self._facts, delta])
        while stratum.recursive and delta.predicates:
            # Only rules that read the changing triples more than once read the earlier ones.
            old = self._facts.copy() if any(len(rule.pivots) > 1 for rule in rules) else self._facts
            self._merge(delta)
            last, delta = delta, Facts()
            for rule in rules:
                for pivot in rule.pivots:
                    if pivot.touched(last):
                        self._apply(rule, self._changed(rule, pivot, last, old), delta)
            self._close(closures, delta, [delta] if delta.predicates else [])
        self._merge(delta)

    def _possible(self, rule: Rule) -> bool:
        """Return whether each atom of the outer body has any triples: most rules lack some, and need no plan."""
        find = self._state.dictionary.find
        for atom in rule.body:
            if not isinstance(atom, Atom) or not isinstance(atom.predicate, NamedNode):
                continue
            facts = self._asserted if atom.asserted else self._facts
            predicate = find(spell(atom.predicate))
            if predicate is None or predicate not in facts.predicates:
                return False
            if isinstance(atom.subject, Variable) and isinstance(atom.object, NamedNode | Literal):
                value = find(spell(atom.object))
                if value is None or not facts.has(predicate, value=value):
                    return False
        return True

    def _close(self, closures: _Closures, delta: Facts, fresh: list[Facts]) -> None:
        """Add to `delta` the triples that follow from equal terms; `fresh` was not examined before."""
        before = len(delta)
        closures.close(self._facts, delta, fresh, self._size)
        self._size += len(delta) - before
        self._state.clock.check(self._size)

    def _changed(self, rule: _Active, pivot: _Pivot, last: Facts, old: Facts) -> list[Facts]:
        """Return the triples that the sources read in a round: for the pivot, those new in the last one."""
        sources = rule.plan.inputs(self._asserted, self._facts)
        if pivot.block:
            return sources
        # Sources before the pivot read what was there before: a solution with two new triples is then found once.
        for other in rule.pivots:
            if other.number < pivot.number and not other.block:
                sources[other.number] = old
        sources[pivot.number] = last
        return sources

    def _apply(self, rule: _Active, sources: list[Facts], delta: Facts) -> None:
        """Run a rule and add to `delta` the triples not yet known."""
        begin = time.perf_counter()
        report, clock = rule.report, self._state.clock
        report.rounds += 1
        clock.rule, clock.round = rule.report.rule, report.rounds
        solver = Solver(self._state, sources)
        collector = Collector(rule.plan, self._state.dictionary)
        for table in solver.solutions(rule.plan.body, rule.plan.outputs):
            collector.add(table, rule.plan.heads)
            if clock.may_exceed(self._size + len(collector)):
                # The collector counts triples of several pieces, and known ones, more than once: count exactly.
                facts = collector.facts()
                clock.check(self._size + sum(self._new(predicate, keys, delta).size for predicate, keys in facts))
        for predicate, keys in collector.facts():
            new = self._new(predicate, keys, delta)
            delta.extend(predicate, new)
            report.derived += new.size
            self._size += new.size
        report.matched = tuple(rows + solver.matched.get(number, 0) for number, rows in enumerate(report.matched))
        report.seconds += time.perf_counter() - begin
        clock.check(self._size)
        if self._asserted.pages is not None:
            self._asserted.pages.release()

    def _new(self, predicate: int, keys: Keys, delta: Facts) -> Keys:
        return delta.missing(predicate, self._facts.missing(predicate, keys))

    def _merge(self, delta: Facts) -> None:
        for predicate, derived in delta:
            keys = self.inferred.paged(derived)
            self._facts.extend(predicate, keys)
            self.inferred.extend(predicate, keys)


class _Closures:
    """The equalities of a stratum, with the reports of their rules."""

    def __init__(self, stratum: Stratum, state: State) -> None:
        self._clock = state.clock
        relations = equalities(stratum.rules) if stratum.recursive else ()
        self._closures = [Closure(equality, state.dictionary, state.hidden) for equality in relations]
        self._rules = {rule for equality in relations for rule in equality.rules}
        self._reports: dict[Rule, RuleReport] = {}

    def register(self, report: RuleReport) -> bool:
        """Keep the report of a rule of an equality; return whether the rule is any other, and runs by itself."""
        if report.rule not in self._rules:
            return True
        self._reports[report.rule] = report
        return False

    def close(self, facts: Facts, delta: Facts, fresh: list[Facts], size: int) -> None:
        """Add to `delta` the triples that the equalities derive, each from its new input, until none adds more."""
        waiting = [fresh] * len(self._closures)
        before = len(delta)
        while any(waiting):
            for number, closure in enumerate(self._closures):
                given, waiting[number] = waiting[number], []
                if given:
                    new = self._closed(closure, [facts, delta], given, size + len(delta) - before)
                    waiting = [[*each, new] if n != number and len(new) else each for n, each in enumerate(waiting)]
                    for predicate, keys in new:
                        delta.extend(predicate, keys)

    def _closed(self, closure: Closure, parts: list[Facts], fresh: list[Facts], size: int) -> Facts:
        begin = time.perf_counter()
        reports = [self._reports[rule] for rule in closure.equality.rules]
        for report in reports:
            report.rounds += 1
        first = self._reports[closure.equality.transitivity[0]]
        self._clock.rule, self._clock.round = first.rule, first.rounds
        result = closure.close(parts, fresh, lambda least: self._clock.check(size + least))
        first.seconds += time.perf_counter() - begin
        for report in reports:
            report.derived = closure.derived[report.rule]
            report.matched = (closure.pairs,) * len(report.matched)
        return result


@dataclass(frozen=True, slots=True)
class _Pivot:
    """A source that reads what its stratum derives; `predicate` is None where that is a variable."""

    number: int
    predicate: int | None
    block: bool

    def touched(self, last: Facts) -> bool:
        """Whether the last round added anything that it may read."""
        return self.predicate is None or bool(last.keys(self.predicate).size)


@dataclass(frozen=True, slots=True)
class _Active:
    """A rule of the stratum that runs."""

    plan: RulePlan
    report: RuleReport
    pivots: tuple[_Pivot, ...]


def _pivots(plan: RulePlan, rules: Sequence[Rule], dictionary: Dictionary) -> Iterator[_Pivot]:
    """Yield the sources that read what the rules of the stratum derive; blocks of SPARQL last, once for all of them."""
    heads = [head for rule in rules for head in rule.head]
    blocks = []
    for number, source in enumerate(plan.sources):
        reads = source.reads
        if not source.positive or source.asserted:
            continue
        if not isinstance(reads, Atom):
            blocks.append(_Pivot(number, None, block=True))
        elif any(depends(reads, head) for head in heads):
            predicate = reads.predicate
            identifier = dictionary.intern_term(predicate) if isinstance(predicate, NamedNode) else None
            yield _Pivot(number, identifier, block=False)
    yield from blocks[:1]
