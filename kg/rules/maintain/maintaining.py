"""Keeps what rules infer true while what is asserted changes, at a cost in proportion to the change.

    state = Maintained(program, dictionary, asserted, inferred)
    change = state.apply(inserted, deleted)      # as often as there are changes

`inferred` is what `kg.rules.engine.evaluate` gave for `asserted`, auxiliary triples included. What rules infer after
each change is what evaluation from scratch would give, triple for triple; blank nodes too, which are made from the
solutions that they stand for. Rules with volatile functions (`RAND`, `NOW`) keep what they inferred first.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.rules.engine.evaluate import Limits
from kg.rules.engine.facts import Facts, merged
from kg.rules.maintain.deriving import Delta, MaintainedRule, World
from kg.rules.maintain.sets import absorb, common, lacking
from kg.rules.maintain.strata import Progress, maintain_stratum

if TYPE_CHECKING:
    from kg.rules.engine.evaluate import Program
    from kg.rules.engine.terms import Dictionary

__all__ = ["Change", "Maintained", "maintain"]


@dataclass(frozen=True, slots=True)
class Change:
    """What becomes of the inferred triples: those to add and those to take out, which share nothing."""

    added: Facts = field(default_factory=Facts)
    removed: Facts = field(default_factory=Facts)


class Maintained:
    """A program, what is asserted, and what the program infers from it, kept in step.

    The sets given are not changed; `asserted` and `inferred` are those in force, not to be changed by others.
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
        self._rules = [[MaintainedRule(plans[rule], shop) for rule in stratum.rules] for stratum in program.strata]

    def apply(self, inserted: Facts, deleted: Facts, *, limits: Limits | None = None) -> Change:
        """Assert triples, take back others, and return what becomes of the inferred ones.

        A triple in both sets stays asserted. What is asserted already, or was not, changes nothing.

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
        if len(progress.came.asserted) or len(progress.gone.asserted):
            earlier: list[MaintainedRule] = []
            for stratum, rules in zip(self._program.strata, self._rules, strict=True):
                maintain_stratum(stratum, rules, earlier, progress)
                earlier += rules
        change = self._change(progress)
        self.asserted, self._known = progress.after.asserted, progress.after.known
        self.inferred = self.inferred.copy()
        for predicate, keys in change.removed:
            self.inferred.discard(predicate, keys)
        for predicate, keys in change.added:
            self.inferred.extend(predicate, keys)
        return change

    def _asserting(self, inserted: Facts, deleted: Facts) -> Progress:
        """Begin with the change of what is asserted; what is inferred already does not come."""
        before = World(self.asserted, self._known)
        after = before.copy()
        came = lacking(inserted, self._known)
        for predicate, keys in deleted:
            after.asserted.discard(predicate, keys)
            after.known.discard(predicate, keys)
        for predicate, keys in inserted:
            after.asserted.extend(predicate, keys)
        for predicate, keys in came:
            after.known.extend(predicate, keys)
        return Progress(before, after, Delta(inserted, came), Delta(deleted, deleted.copy()), self._shop.clock)

    def _change(self, progress: Progress) -> Change:
        """Tell which inferred triples come and go: those that are known and not asserted."""
        added = lacking(progress.came.known, progress.after.asserted)
        absorb(added, common(progress.gone.asserted, progress.after.known))
        removed = common(progress.gone.known, self.inferred)
        absorb(removed, common(progress.came.asserted, self.inferred))
        return Change(added, removed)


def maintain(  # noqa: PLR0913, PLR0917 - a state and a change, of two sets each
    program: Program,
    dictionary: Dictionary,
    asserted: Facts,
    inferred: Facts,
    inserted: Facts,
    deleted: Facts,
    *,
    limits: Limits | None = None,
) -> Change:
    """Return what becomes of the inferred triples when `inserted` is asserted and `deleted` is not any more.

    `asserted` and `inferred` are the state before, and stay as they are. For several changes `Maintained` is cheaper.

    Raises:
        RuleError: as `Maintained.apply`.
    """
    return Maintained(program, dictionary, asserted, inferred).apply(inserted, deleted, limits=limits)


def _together(asserted: Facts, inferred: Facts) -> Facts:
    """Return two sets that share nothing as one; predicates that only one has keep their arrays."""
    found = asserted.copy()
    for predicate, keys in inferred:
        if found.keys(predicate).size:
            found.replace(predicate, merged(found.keys(predicate), keys))
        else:
            found.take_over(predicate, inferred)
    return found
