"""One stratum after a change: delete and rederive, then insert (Gupta, Mumick and Subrahmanian 1993, section 7).

1. Whatever was derived, in the data before, from a triple that went, is taken away (unless it is asserted), and so on
   where the stratum is recursive. This takes away too much: a triple may have other derivations. So that one triple
   does not take everything with it, what follows in one step from data that certainly stays is left where it is.
2. What was taken away and still is derived from the data that is left is put back.
3. What follows from triples that came, or that were put back, is added, round by round.

Triples under negation and aggregates belong to strata that are finished; `kg.rules.maintain.pivots` says what they do.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kg.rules.engine.facts import Facts, difference, union
from kg.rules.maintain.deriving import Delta, MaintainedRule, World
from kg.rules.maintain.sets import absorb, common, lacking, take_out

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kg.rules.engine.limits import Clock
    from kg.rules.stratify import Stratum

__all__ = ["Progress", "maintain_stratum"]


@dataclass(slots=True)
class Progress:
    """How far a change has come: the worlds before and after it, and what came and went so far.

    `came` and `gone` share nothing; of everything, `gone` was known before and `came` was not.
    """

    before: World
    after: World
    came: Delta
    gone: Delta
    clock: Clock
    added: int = 0
    """Triples that rules added, for the limit on them."""

    @property
    def worlds(self) -> tuple[World, World]:
        """Before and after."""
        return self.before, self.after


@dataclass(slots=True)
class _Work:
    """One stratum; `earlier` are the rules of the strata before it."""

    progress: Progress
    rules: Sequence[MaintainedRule]
    earlier: Sequence[MaintainedRule]
    recursive: bool
    lost: Facts = field(default_factory=Facts)
    """What was derived by then and has been taken away."""
    _size: int = 0
    """How much was lost in the last round: where less is lost from round to round, no triple is looked at closely."""
    _base: World | None = None

    def take_away(self) -> None:
        """Take away what may have no derivation any more."""
        progress = self.progress
        if self.recursive:
            stays = self._founded(progress.gone.known)
            take_out(progress.gone.known, stays)
            for predicate, keys in stays:
                progress.after.known.extend(predicate, keys)
        frontier = self._lose(self._consequences(progress.came, progress.gone, after=False))
        while self.recursive and len(frontier):
            frontier = self._lose(self._consequences(None, Delta(Facts(), frontier), after=False))
        if self.recursive:
            self._discard_lost()

    def put_back(self) -> Facts:
        """Put back what is still derived from what is left, and return it."""
        progress = self.progress
        back = Facts()
        for candidates, rules in ((self.lost, (*self.earlier, *self.rules)), (progress.gone.known, self.rules)):
            if not len(candidates):
                continue
            for rule in rules:
                if not rule.may_derive(candidates):
                    continue
                self._watch(rule)
                absorb(back, common(rule.supported(candidates, progress.after), candidates))
        missing = back if self.recursive else common(back, progress.gone.known)
        take_out(self.lost, back)
        take_out(progress.gone.known, back)
        for predicate, keys in missing:
            progress.after.known.extend(predicate, keys)
        if not self.recursive:
            # Nothing here reads what it derives itself: only what stays lost has to be taken from the columns.
            self._discard_lost()
        return back

    def _discard_lost(self) -> None:
        for predicate, keys in self.lost:
            self.progress.after.known.discard(predicate, keys)

    def add(self, back: Facts) -> None:
        """Add what follows from what came and from what was put back."""
        progress = self.progress
        came = progress.came
        if self.recursive and len(back):
            came = Delta(came.asserted, came.known.copy())
            absorb(came.known, back)
        frontier = self._gain(self._consequences(came, progress.gone, after=True))
        while self.recursive and len(frontier):
            frontier = self._gain(self._consequences(Delta(Facts(), frontier), None, after=True))
        absorb(progress.gone.known, self.lost)

    def _consequences(self, came: Delta | None, gone: Delta | None, *, after: bool) -> Facts:
        found = Facts()
        for rule in self.rules:
            self._watch(rule)
            absorb(found, rule.consequences(came, gone, self.progress.worlds, after=after))
        return found

    def _watch(self, rule: MaintainedRule) -> None:
        self.progress.clock.rule = rule.name
        self.progress.clock.check(self.progress.added)

    def _lose(self, found: Facts) -> Facts:
        """Note the triples that are to be taken away: all but those asserted, and return them.

        What rules derive in the world before is known there, so that nobody has to look for it among all.
        """
        going = lacking(lacking(lacking(found, self.progress.after.asserted), self.progress.gone.known), self.lost)
        if self.recursive and len(going) > self._size:
            going = lacking(going, self._founded(going))
        self._size = len(going)
        for predicate, keys in going:
            self.lost.extend(predicate, keys)
        return going

    def _founded(self, candidates: Facts) -> Facts:
        """Return the candidates that follow in one step from what is asserted and what other strata derived."""
        found = Facts()
        written = _written(self.rules)
        for rule in self.earlier:
            if rule.may_derive(candidates):
                absorb(found, common(rule.supported(candidates, self.progress.after), candidates))
        for rule in self.rules:
            if rule.may_derive(candidates) and rule.grows(written):
                self._watch(rule)
                absorb(found, common(rule.supported(candidates, self._foundation(written)), candidates))
        return found

    def _foundation(self, written: frozenset[int] | None) -> World:
        """Return the world after without what this stratum may have derived."""
        if self._base is None:
            after = self.progress.after
            known = after.asserted if written is None else after.known.copy()
            for predicate in written or ():
                known.take_over(predicate, after.asserted)
            self._base = World(after.asserted, known)
        return self._base

    def _gain(self, found: Facts) -> Facts:
        """Add triples, those that are not there, and return them."""
        progress = self.progress
        new = lacking(found, progress.after.known)
        for predicate, keys in new:
            progress.after.known.extend(predicate, keys)
            progress.added += keys.size
            again = union(self.lost.remove(predicate, keys), progress.gone.known.remove(predicate, keys))
            progress.came.known.extend(predicate, difference(keys, again))
        return new


def _written(rules: Sequence[MaintainedRule]) -> frozenset[int] | None:
    """Return the predicates that rules derive, None for any."""
    written = [rule.writes for rule in rules]
    return None if None in written else frozenset[int]().union(*(known for known in written if known))


def maintain_stratum(
    stratum: Stratum, rules: Sequence[MaintainedRule], earlier: Sequence[MaintainedRule], progress: Progress
) -> None:
    """Bring what the `rules` of a stratum derive up to date with what came and went before it."""
    work = _Work(progress, rules, earlier, stratum.recursive)
    work.take_away()
    work.add(work.put_back())
