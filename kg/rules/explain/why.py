"""Why a fact holds: its proof trees, computed from the data on request.

Facts and the applications of rules that derive them form a hypergraph. It is opened from the fact asked for, one level
at a time; after each level the cheapest proofs of all facts opened so far are found as shortest hyperpaths are (Knuth,
"A generalization of Dijkstra's algorithm", 1977), which never lets a fact be its own premise, however rules recurse.
"""

from __future__ import annotations

import heapq
import itertools
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.errors import RuleError
from kg.rules.explain.derivations import derivations
from kg.rules.explain.proof import Derivation, Premise, Proof

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.rules.explain.view import View
    from kg.rules.form import Rule

    _Step: TypeAlias = tuple[int, int, Triple, Derivation | None]

_WIDTHS: Final = (4, 64, 4096)
"""How many applications of one rule are looked at for one fact; the next where these give no proof."""

_MOST_FACTS: Final = 20_000
_SHORTEST_FACTS: Final = 2_000
"""How many facts are opened at most: to find a proof, and to find the one with the fewest steps."""


@dataclass(slots=True)
class _Search:
    """The part of the hypergraph that was opened; `width` bounds the applications of one rule for one fact."""

    view: View
    rules: tuple[Rule, ...]
    width: int
    opened: dict[Triple, list[Derivation]] = field(default_factory=dict)
    asserted: dict[Triple, tuple[str, ...]] = field(default_factory=dict)
    proven: set[Triple] = field(default_factory=set)
    waiting: dict[Triple, list[tuple[Triple, set[Triple]]]] = field(default_factory=dict)
    """A fact without proof to what waits for it: the fact derived from it, and all that is missing for that."""

    def open(self, fact: Triple) -> None:
        """Look at one fact: where it is asserted, else how rules derive it."""
        graphs = self.view.asserted(fact)
        if graphs:
            self.asserted[fact] = graphs
            self._prove(fact)
        self.opened[fact] = [] if graphs else derivations(self.view, self.rules, fact, self.width)
        for each in self.opened[fact]:
            missing = {premise for premise in each.facts if premise not in self.proven}
            if not missing:
                self._prove(fact)
            for premise in missing:
                self.waiting.setdefault(premise, []).append((fact, missing))

    def _prove(self, fact: Triple) -> None:
        """Note that a fact has a proof, and so have those that waited for nothing else."""
        ready = [fact]
        while ready:
            premise = ready.pop()
            self.proven.add(premise)
            for user, missing in self.waiting.pop(premise, ()):
                missing.discard(premise)
                if not missing and user not in self.proven:
                    ready.append(user)

    def cheapest(self, without: Triple | None = None) -> dict[Triple, tuple[int, Derivation | None]]:
        """Return for each fact that has a proof the size of its smallest and the application that it ends with."""
        users: dict[Triple, list[tuple[Triple, Derivation]]] = {}
        missing: dict[int, int] = {}
        order = itertools.count()
        queue: list[_Step] = [(1, next(order), fact, None) for fact in self.asserted]
        for fact, ways in self.opened.items():
            for each in ways:
                missing[id(each)] = len(each.facts)
                if not each.facts:
                    queue.append((1, next(order), fact, each))
                for premise in each.facts:
                    users.setdefault(premise, []).append((fact, each))
        heapq.heapify(queue)
        best: dict[Triple, tuple[int, Derivation | None]] = {}
        while queue:
            size, _, fact, derivation = heapq.heappop(queue)
            if fact in best or fact == without:
                continue
            best[fact] = (size, derivation)
            for user, application in users.get(fact, ()):
                missing[id(application)] -= 1
                if not missing[id(application)] and user not in best:
                    total = 1 + sum(best[premise][0] for premise in application.facts)
                    heapq.heappush(queue, (total, next(order), user, application))
        return best

    def explore(self, goal: Triple, most: int, *, whole: bool = False) -> bool:
        """Open level after level until `goal` has a proof, or with `whole` all facts; return whether it has one."""
        level, seen = [goal], {goal}
        while level and len(self.opened) < most:
            for fact in level:
                if fact not in self.opened:
                    self.open(fact)
            if not whole and goal in self.proven:
                return True
            premises = (each for fact in level for derivation in self.opened[fact] for each in derivation.facts)
            level = [fact for fact in dict.fromkeys(premises) if fact not in seen]
            seen.update(level)
        return goal in self.proven


def why(view: View, rules: tuple[Rule, ...], fact: Triple, *, shortest: bool = False) -> Proof:
    """Return a proof of `fact`: one in which the fewest rules follow one another, with `shortest` one of fewest steps.

    Raises RuleError: KG226 when the store does not hold the fact, or no rule in force derives it.
    """
    search = _searched(view, rules, fact, shortest=shortest)
    return _proof(search, fact, search.cheapest())


def why_all(view: View, rules: tuple[Rule, ...], fact: Triple) -> tuple[Proof, ...]:
    """Return a proof for each way in which `fact` comes about, the smallest first; raises as `why` does."""
    search = _searched(view, rules, fact, shortest=True)
    if fact in search.asserted:
        return (_proof(search, fact, search.cheapest()),)
    best = search.cheapest(without=fact)
    ways = [each for each in search.opened[fact] if all(premise in best for premise in each.facts)]
    ways.sort(key=lambda each: sum(best[premise][0] for premise in each.facts))
    proofs = []
    for each in ways:
        premises: list[Premise] = [_proof(search, premise, best) for premise in each.facts]
        proofs.append(Proof(fact, (), None, each, (*premises, *each.conditions)))
    return tuple(proofs)


def _searched(view: View, rules: tuple[Rule, ...], fact: Triple, *, shortest: bool) -> _Search:
    if not view.graphs(fact):
        message = f"the store does not contain {_spelt(view, fact)}"
        raise RuleError("KG226", message, hint="`kg why-not` shows what is missing.")
    for width in _WIDTHS:
        search = _Search(view, rules, width)
        result = search.explore(fact, _MOST_FACTS)
        if result and shortest:
            search.explore(fact, _SHORTEST_FACTS, whole=True)
        if result:
            return search
    message = f"no active rule derives {_spelt(view, fact)}, although the graph of inferred facts contains it"
    raise RuleError("KG226", message, hint="Run `kg rules run`: rules have changed since it was inferred.")


def _spelt(view: View, fact: Triple) -> str:
    return " ".join(map(view.spelt, fact))


def _proof(search: _Search, fact: Triple, best: dict[Triple, tuple[int, Derivation | None]]) -> Proof:
    """Build the proof of a fact from the bottom: premises are smaller than what they prove."""
    needed, waiting = {fact}, [fact]
    while waiting:
        derivation = best[waiting.pop()][1]
        fresh = [premise for premise in derivation.facts if premise not in needed] if derivation else []
        needed.update(fresh)
        waiting.extend(fresh)
    proofs: dict[Triple, Proof] = {}
    for each in sorted(needed, key=lambda one: best[one][0]):
        derivation = best[each][1]
        if derivation is None:
            proofs[each] = Proof(each, search.asserted[each], search.view.evidence(each))
        else:
            premises: list[Premise] = [proofs[premise] for premise in derivation.facts]
            proofs[each] = Proof(each, (), None, derivation, (*premises, *derivation.conditions))
    return proofs[fact]
