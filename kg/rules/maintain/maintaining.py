"""Maintains inferred triples under changes of the asserted ones, at a cost in proportion to the change.

    state = Maintained(program, dictionary, asserted, inferred)
    change = state.apply(inserted, deleted)      # as often as there are changes

`inferred` is what `kg.rules.engine.evaluate` gave for `asserted`, auxiliary triples included. What rules infer after
each change is what evaluation from scratch would give, triple for triple; blank nodes too, which are made from the
solutions that they stand for. Rules with volatile functions (`RAND`, `NOW`) keep what they inferred first.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kg.rules.dependencies import volatile
from kg.rules.engine.equality import equalities
from kg.rules.engine.evaluate import Limits, evaluate
from kg.rules.engine.facts import Facts, absorb, common, lacking, merged
from kg.rules.maintain.deriving import MaintainedRule
from kg.rules.maintain.strata import LargeChangeError, Progress, Strata
from kg.rules.maintain.worlds import Delta, World

if TYPE_CHECKING:
    from kg.rules.engine.evaluate import Program
    from kg.rules.engine.terms import Dictionary
    from kg.rules.stratify import Stratum


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
        self._known = _together(asserted, inferred)
        shop = program.workshop(dictionary)
        self._shop = shop
        plans = program.plans(dictionary)
        self._volatile = any(map(volatile, program.rules))
        self._strata = Strata(
            ((stratum, [MaintainedRule(rule, plans, shop) for rule in stratum.rules]) for stratum in program.strata),
            self._equal,
        )

    def _equal(self, stratum: Stratum) -> list[int]:
        """Return the equality predicates of a stratum; none if evaluating again would change values."""
        if not stratum.recursive or self._volatile:
            return []
        return [self._dictionary.intern_term(equality.predicate) for equality in equalities(stratum.rules)]

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
        self._shop.clock = self._program.workshop(self._dictionary, limits).clock
        progress = self._asserting(lacking(inserted, self.asserted), common(lacking(deleted, inserted), self.asserted))
        try:
            self._strata.maintain(progress)
        except LargeChangeError:
            return self._evaluate_again(progress.after.asserted, limits)
        change = _change(progress)
        self.asserted, self._known = progress.after.asserted, progress.after.known
        self.inferred = self._inferred(change)
        return change

    def _evaluate_again(self, asserted: Facts, limits: Limits) -> Change:
        """Evaluate everything again, and return the change of the inferred triples."""
        most = limits.max_triples
        wider = limits if most is None else replace(limits, max_triples=most + len(self.inferred))
        inferred = evaluate(self._program, self._dictionary, asserted, limits=wider).inferred
        change = Change(lacking(inferred, self.inferred), lacking(self.inferred, inferred))
        self._shop.clock.check(len(change.added))
        self.asserted, self.inferred, self._known = asserted, inferred, _together(asserted, inferred)
        return change

    def _inferred(self, change: Change) -> Facts:
        """Return the inferred triples after a change; predicates without asserted triples share their arrays."""
        found = self.inferred.copy()
        for predicate in {*change.removed.predicates, *change.added.predicates}:
            if self.asserted.keys(predicate).size:
                found.discard(predicate, change.removed.keys(predicate))
                found.extend(predicate, change.added.keys(predicate))
            else:
                found.take_over(predicate, self._known)
        return found

    def _asserting(self, inserted: Facts, deleted: Facts) -> Progress:
        """Start with the change of asserted triples, without those already inferred."""
        before = World(self.asserted, self._known)
        after = before.copy()
        came = lacking(inserted, self._known)
        gone = deleted.copy()
        for predicate in {*deleted.predicates, *inserted.predicates}:
            after.asserted.discard(predicate, deleted.keys(predicate))
            after.asserted.extend(predicate, inserted.keys(predicate))
            if self.inferred.keys(predicate).size:
                after.known.discard(predicate, deleted.keys(predicate))
                after.known.extend(predicate, came.keys(predicate))
            else:
                after.known.take_over(predicate, after.asserted)
        patterns = self._strata.patterns
        arrived, left = (Delta(one, known, patterns.of(one)) for one, known in ((inserted, came), (deleted, gone)))
        return Progress(before, after, arrived, left, patterns, self._shop.clock)


def _change(progress: Progress) -> Change:
    """Return the inferred triples added and removed: the change of all triples without the asserted ones."""
    added = lacking(progress.came.known, progress.after.asserted)
    absorb(added, common(progress.gone.asserted, progress.after.known))
    removed = lacking(progress.gone.known, progress.gone.asserted)
    absorb(removed, lacking(progress.came.asserted, progress.came.known))
    return Change(added, removed)


def _together(asserted: Facts, inferred: Facts) -> Facts:
    """Return the union of two disjoint sets; predicates of only one share its arrays."""
    found = asserted.copy()
    for predicate, keys in inferred:
        if found.keys(predicate).size:
            found.replace(predicate, merged(found.keys(predicate), keys))
        else:
            found.take_over(predicate, inferred)
    return found
