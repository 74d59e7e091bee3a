"""Maintains inferred triples under changes of the asserted ones, at a cost in proportion to the change.

    state = Maintained(program, dictionary, asserted, inferred)
    change = state.apply(inserted, deleted)      # as often as there are changes

`inferred` is what `kg.rules.engine.evaluate` gave for `asserted`, auxiliary triples included. What rules infer after
each change is what evaluation from scratch would give, triple for triple; blank nodes too, which are made from the
solutions that they stand for.

One stratum after a change: delete and rederive, then insert (Gupta, Mumick and Subrahmanian 1993, section 7).

1. Remove what was derived, in the data before, from a removed triple (unless it is asserted), repeatedly where the
   stratum is recursive. This removes too much, since a triple may have other derivations. Triples that follow in one
   step from data that certainly stays are therefore kept, which bounds the effect of one triple.
2. Put back the removed triples that still follow from the remaining data.
3. Add what follows from triples that were added or put back, round by round.

Triples under negation and aggregates belong to finished strata; `kg.rules.maintain.deriving` describes their effect.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from functools import cache
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.rules.engine.equality import equalities
from kg.rules.engine.evaluate import Limits, Program, evaluate
from kg.rules.engine.facts import Facts, absorb, common, difference, lacking, merged, take_out, union, unpack
from kg.rules.maintain.deriving import MaintainedRule
from kg.rules.maintain.patterns import Delta, Patterns, World

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from collections.abc import Set as AbstractSet

    from kg.rules.engine.limits import Clock
    from kg.rules.engine.solve import State
    from kg.rules.engine.terms import Dictionary

_ROWS_PER_TRIPLE: Final = 4
"""Joins of more rows than this, relative to all triples, cost more than evaluating everything again."""

_FEW_ROWS: Final = 1 << 16
"""Joins of fewer rows always cost less."""


class LargeChangeError(Exception):
    """A change reaches so many pairs of equal terms that evaluating everything again costs less."""


@dataclass(slots=True)
class Progress:
    """Progress of a change: the worlds before and after it, and the triples added and removed so far.

    `came` and `gone` are disjoint; of all triples, `gone` was known before and `came` was not.
    """

    before: World
    after: World
    came: Delta
    gone: Delta
    patterns: Patterns
    clock: Clock
    added: int = 0
    """Triples that rules added, for the limit on them."""

    @property
    def worlds(self) -> tuple[World, World]:
        """The worlds before and after."""
        return self.before, self.after


class Strata:
    """Rules maintained stratum by stratum, and the patterns they read and derive."""

    def __init__(self, program: Program, dictionary: Dictionary, state: State) -> None:
        plans = program.plans(dictionary)
        intern = cache(dictionary.intern_term)  # rules share most of their terms
        self._rules: list[MaintainedRule] = []
        self._deriving: defaultdict[int, list[int]] = defaultdict(list)
        self._strata: list[_Stratum] = []
        for stratum in program.strata:
            rules = [MaintainedRule(rule, plans, state, intern) for rule in stratum.rules]
            relations = equalities(stratum.rules) if stratum.recursive else ()
            equal = [intern(equality.predicate) for equality in relations]
            self._strata.append(_Stratum(len(self._rules), rules, equal, stratum.recursive))
            for number, rule in enumerate(rules, len(self._rules)):
                for one in rule.derives:
                    self._deriving[one].append(number)
            self._rules += rules
        self.patterns = Patterns(one for rule in self._rules for one in rule.reads | rule.derives)

    def maintain(self, progress: Progress) -> None:
        """Update the derived triples after a change of the asserted ones.

        Raises LargeChangeError: when evaluating everything again costs less.
        """
        for stratum in self._strata:
            if stratum.reached(progress):
                work = _Work(progress, self, stratum)
                work.take_away()
                work.add(work.put_back())

    def earlier(self, stratum: _Stratum, patterns: Iterable[int]) -> list[MaintainedRule]:
        """Return the rules of the strata before one that derive triples of any of the patterns."""
        numbers = {number for one in patterns for number in self._deriving.get(one, ()) if number < stratum.begin}
        return [self._rules[number] for number in sorted(numbers)]


class _Stratum:
    """One stratum; `begin` is the number of rules before it, `equal` the predicates of its equalities."""

    def __init__(
        self,
        begin: int,
        rules: Sequence[MaintainedRule],
        equal: Sequence[int],
        recursive: bool,  # noqa: FBT001 - a fact
    ) -> None:
        self.begin = begin
        self.rules = rules
        self.equal = equal
        self.recursive = recursive
        self._reads = frozenset[int]().union(*(rule.reads for rule in rules))
        self._derives = frozenset[int]().union(*(rule.derives for rule in rules))

    def reached(self, progress: Progress) -> bool:
        """Return whether a rule reads added or removed triples, or may derive removed ones itself."""
        came, gone = progress.came.patterns, progress.gone.patterns
        return not (self._reads.isdisjoint(came) and self._reads.isdisjoint(gone) and self._derives.isdisjoint(gone))


@dataclass(slots=True)
class _Work:
    """One stratum that a change reaches."""

    progress: Progress
    strata: Strata
    stratum: _Stratum
    lost: Facts = field(default_factory=Facts)
    """Derived triples removed so far."""
    _size: int = 0
    """Triples removed in the last round. While this number falls, other derivations are not searched for."""
    _base: World | None = None
    _rows: int = 0
    """Rows joined by transitivity so far."""

    @property
    def rules(self) -> Sequence[MaintainedRule]:
        """The rules of the stratum."""
        return self.stratum.rules

    @property
    def recursive(self) -> bool:
        """Whether the rules read their own derivations."""
        return self.stratum.recursive

    def take_away(self) -> None:
        """Remove triples that may have lost all derivations."""
        progress = self.progress
        if self.recursive:
            stays = self._supported(self._removed_here(progress.gone.facts))
            take_out(progress.gone.facts, stays)
            for predicate, keys in stays:
                progress.after.facts.extend(predicate, keys)
        frontier = self._record_lost(self._consequences(progress.came, progress.gone, after=False))
        while self.recursive and len(frontier):
            frontier = self._record_lost(self._consequences(None, self._delta(frontier), after=False))
        if self.recursive:
            self._discard_lost()

    def put_back(self) -> Facts:
        """Put back triples still derived from those left, and return them."""
        progress = self.progress
        back = Facts()
        lost = progress.patterns.of(self.lost)
        for rule in (*self.strata.earlier(self.stratum, lost), *self._deriving(lost)):
            self._put_back(self.lost, rule, back)
        for rule in self._deriving(progress.gone.patterns):
            self._put_back(progress.gone.facts, rule, back)
        missing = back if self.recursive else common(back, progress.gone.facts)
        take_out(self.lost, back)
        take_out(progress.gone.facts, back)
        for predicate, keys in missing:
            progress.after.facts.extend(predicate, keys)
        if not self.recursive:
            # Not recursive: only triples that stay lost have to be taken from the columns.
            self._discard_lost()
        return back

    def _put_back(self, candidates: Facts, rule: MaintainedRule, back: Facts) -> None:
        self._watch(rule)
        absorb(back, common(rule.supported(candidates, self.progress.after), candidates))

    def _deriving(self, patterns: AbstractSet[int]) -> Iterator[MaintainedRule]:
        """Yield the rules of the stratum that derive triples of any of the patterns."""
        return (rule for rule in self.rules if not rule.derives.isdisjoint(patterns))

    def _delta(self, frontier: Facts) -> Delta:
        """Return the triples added or removed in a round of a recursion."""
        return Delta(Facts(), frontier, self.progress.patterns.of(frontier))

    def _discard_lost(self) -> None:
        for predicate, keys in self.lost:
            self.progress.after.facts.discard(predicate, keys)

    def add(self, back: Facts) -> None:
        """Add the triples that follow from those added and from those put back."""
        progress = self.progress
        came = progress.came
        if self.recursive and len(back):
            came = Delta(came.asserted, came.facts.copy(), came.patterns | progress.patterns.of(back))
            absorb(came.facts, back)
        frontier = self._gain(self._consequences(came, progress.gone, after=True))
        while self.recursive and len(frontier):
            frontier = self._gain(self._consequences(self._delta(frontier), None, after=True))
        absorb(progress.gone.facts, self.lost)
        progress.gone.patterns |= progress.patterns.of(self.lost)

    def _consequences(self, came: Delta | None, gone: Delta | None, *, after: bool) -> Facts:
        result = Facts()
        self._weigh([delta.facts for delta in (came, gone) if delta], self.progress.worlds[after])
        changed = (came.patterns if came else set()) | (gone.patterns if gone else set())
        for rule in self.rules:
            if rule.reads.isdisjoint(changed):
                continue
            self._watch(rule)
            absorb(result, rule.consequences(came, gone, self.progress.worlds, after=after))
        return result

    def _weigh(self, changes: Iterable[Facts], world: World) -> None:
        """Raise `LargeChangeError` where transitivity would join more rows than evaluating everything again costs."""
        for predicate in self.stratum.equal:
            pairs = world.facts.keys(predicate)
            for change in changes:
                middle = unpack(change.keys(predicate))[1]
                begin, end = np.searchsorted(pairs, middle << 32), np.searchsorted(pairs, (middle + 1) << 32)
                self._rows += int((end - begin).sum())
        if self._rows > _FEW_ROWS + _ROWS_PER_TRIPLE * len(world.facts):
            raise LargeChangeError

    def _watch(self, rule: MaintainedRule) -> None:
        self.progress.clock.rule = rule.name
        self.progress.clock.check(self.progress.added)

    def _record_lost(self, facts: Facts) -> Facts:
        """Record the triples to remove, all but those asserted, and return them.

        Triples derived in the world before are already in it, which saves a search.
        """
        going = lacking(lacking(lacking(facts, self.progress.after.asserted), self.progress.gone.facts), self.lost)
        if self.recursive and len(going) > self._size:
            going = lacking(going, self._supported(going))
        self._size = len(going)
        for predicate, keys in going:
            self.lost.extend(predicate, keys)
        return going

    def _removed_here(self, gone: Facts) -> Facts:
        """Return the removed triples that this stratum may derive; earlier strata have put theirs back."""
        written = _written(self.rules)
        result = Facts()
        for predicate, keys in gone:
            if written is None or predicate in written:
                result.replace(predicate, keys)
        return result

    def _supported(self, candidates: Facts) -> Facts:
        """Return the candidates that follow in one step from asserted triples and those of other strata."""
        result = Facts()
        written = _written(self.rules)
        patterns = self.progress.patterns.of(candidates)
        for rule in self.strata.earlier(self.stratum, patterns):
            absorb(result, common(rule.supported(candidates, self.progress.after), candidates))
        for rule in self._deriving(patterns):
            if rule.grows(written):
                self._watch(rule)
                absorb(result, common(rule.supported(candidates, self._foundation(written)), candidates))
        return result

    def _foundation(self, written: frozenset[int] | None) -> World:
        """Return the world after without what this stratum may have derived."""
        if self._base is None:
            after = self.progress.after
            facts = after.asserted if written is None else after.facts.copy()
            for predicate in written or ():
                facts.take_over(predicate, after.asserted)
            self._base = World(after.asserted, facts)
        return self._base

    def _gain(self, facts: Facts) -> Facts:
        """Add the triples that are missing, and return them."""
        progress = self.progress
        new = lacking(facts, progress.after.facts)
        progress.came.patterns |= progress.patterns.of(new)
        for predicate, keys in new:
            progress.after.facts.extend(predicate, keys)
            progress.added += keys.size
            again = union(self.lost.remove(predicate, keys), progress.gone.facts.remove(predicate, keys))
            progress.came.facts.extend(predicate, difference(keys, again))
        return new


def _written(rules: Sequence[MaintainedRule]) -> frozenset[int] | None:
    """Return the predicates that rules derive, None for any."""
    written = [rule.writes for rule in rules]
    return None if None in written else frozenset[int]().union(*(predicates for predicates in written if predicates))


@dataclass(frozen=True, slots=True)
class Change:
    """Change of the inferred triples: those to add and those to remove, which are disjoint."""

    added: Facts = field(default_factory=Facts)
    removed: Facts = field(default_factory=Facts)


class Maintained:
    """A program, asserted triples, and those that the program infers, kept consistent.

    The arguments are not modified. `asserted` and `inferred` are the current sets; callers must not modify them.
    """

    def __init__(self, program: Program, dictionary: Dictionary, asserted: Facts, inferred: Facts) -> None:
        self.asserted = asserted
        self.inferred = inferred
        self._program = program
        self._dictionary = dictionary
        self._mints_safely = False
        self._facts = _together(asserted, inferred)
        self._state = program.state(dictionary)
        self._strata = Strata(program, dictionary, self._state)

    def apply(self, inserted: Facts, deleted: Facts, *, limits: Limits | None = None) -> Change:
        """Assert triples, retract others, and return the change of the inferred ones.

        A triple in both sets stays asserted. Inserting a known triple or deleting an unknown one has no effect.

        Raises:
            RuleError: KG204 where rules make terms in recursion and `limits` has no bound, KG205 at a limit
                (`max_triples` counts those that this change adds); everything is as it was before.
        """
        limits = limits or Limits()
        if not (limits.bounded or self._mints_safely):
            self._program.refuse_minting()
            self._mints_safely = True
        self._state.clock = self._program.state(self._dictionary, limits).clock
        progress = self._asserting(lacking(inserted, self.asserted), common(lacking(deleted, inserted), self.asserted))
        try:
            self._strata.maintain(progress)
        except LargeChangeError:
            return self._evaluate_again(progress.after.asserted, limits)
        change = _change(progress)
        self.asserted, self._facts = progress.after.asserted, progress.after.facts
        self.inferred = self._inferred(change)
        return change

    def _evaluate_again(self, asserted: Facts, limits: Limits) -> Change:
        """Evaluate everything again, and return the change of the inferred triples."""
        most = limits.max_triples
        wider = limits if most is None else replace(limits, max_triples=most + len(self.inferred))
        inferred = evaluate(self._program, self._dictionary, asserted, limits=wider).inferred
        change = Change(lacking(inferred, self.inferred), lacking(self.inferred, inferred))
        self._state.clock.check(len(change.added))
        self.asserted, self.inferred, self._facts = asserted, inferred, _together(asserted, inferred)
        return change

    def _inferred(self, change: Change) -> Facts:
        """Return the inferred triples after a change; predicates without asserted triples share their arrays."""
        result = self.inferred.copy()
        for predicate in {*change.removed.predicates, *change.added.predicates}:
            if self.asserted.keys(predicate).size:
                result.discard(predicate, change.removed.keys(predicate))
                result.extend(predicate, change.added.keys(predicate))
            else:
                result.take_over(predicate, self._facts)
        return result

    def _asserting(self, inserted: Facts, deleted: Facts) -> Progress:
        """Start with the change of asserted triples, without those already inferred."""
        before = World(self.asserted, self._facts)
        after = before.copy()
        came = lacking(inserted, self._facts)
        gone = deleted.copy()
        for predicate in {*deleted.predicates, *inserted.predicates}:
            after.asserted.discard(predicate, deleted.keys(predicate))
            after.asserted.extend(predicate, inserted.keys(predicate))
            if self.inferred.keys(predicate).size:
                after.facts.discard(predicate, deleted.keys(predicate))
                after.facts.extend(predicate, came.keys(predicate))
            else:
                after.facts.take_over(predicate, after.asserted)
        patterns = self._strata.patterns
        arrived, left = (Delta(one, facts, patterns.of(one)) for one, facts in ((inserted, came), (deleted, gone)))
        return Progress(before, after, arrived, left, patterns, self._state.clock)


def _change(progress: Progress) -> Change:
    """Return the inferred triples added and removed: the change of all triples without the asserted ones."""
    added = lacking(progress.came.facts, progress.after.asserted)
    absorb(added, common(progress.gone.asserted, progress.after.facts))
    removed = lacking(progress.gone.facts, progress.gone.asserted)
    absorb(removed, lacking(progress.came.asserted, progress.came.facts))
    return Change(added, removed)


def _together(asserted: Facts, inferred: Facts) -> Facts:
    """Return the union of two disjoint sets; predicates of only one share its arrays."""
    result = asserted.copy()
    for predicate, keys in inferred:
        if result.keys(predicate).size:
            result.replace(predicate, merged(result.keys(predicate), keys))
        else:
            result.take_over(predicate, inferred)
    return result
