"""Why a fact holds: its proof trees, computed from the data on request.

Facts and the applications of rules that derive them form a hypergraph. It is opened from the fact asked for, one level
at a time; after each level the cheapest proofs of all facts opened so far are found as shortest hyperpaths are (Knuth,
"A generalization of Dijkstra's algorithm", 1977), which never lets a fact be its own premise, however rules recurse.
"""

from __future__ import annotations

import heapq
import itertools
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.errors import Place, RuleError
from kg.query.guard import check
from kg.rules.decompose import decompose
from kg.rules.explain.derivations import bound_by, derivation_of, derivations
from kg.rules.explain.proof import Derivation, Premise, Proof
from kg.syntax.lexer import Kind, normalise, tokens
from kg.syntax.parser import parse_query, parse_rq

if TYPE_CHECKING:
    from pyoxigraph import Triple

    from kg.rules.explain.view import View
    from kg.rules.form import Rule

    _Step: TypeAlias = tuple[int, int, Triple, Derivation | None]
    from collections.abc import Mapping

    from kg.rules.explain.proof import Condition
    from kg.rules.form import Term

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


_NAME: Final = "query"
_ROW: Final = "<urn:kg:row>"
_WHOLE: Final = re.compile(
    r"(?<=\{)\s*SELECT\s+\*\s+WHERE(?=\s*\{)|(?<=\})\s*(?:LIMIT\s+\d+|ORDER\s+BY\s+\?\w+)(?=\s*\})"
)
"""What makes an inner SELECT of a group whose variables it all gives: a row's facts are those of the group."""
_UNBOUND: Final = "KG203"
"""Of a variable that only an inner SELECT knows."""
_REFUSED: Final = "KG209"
"""Of a part that rules do not have, such as a function of the time."""
_HINT: Final = "To explain a row of a query that groups or counts, query for the grouped rows."
_MERGING: Final = frozenset(
    {"AVG", "COUNT", "DISTINCT", "GROUP", "GROUP_CONCAT", "HAVING", "MAX", "MIN", "REDUCED", "SAMPLE", "SUM"}
)
"""Words outside of the WHERE clause that make one row of many solutions."""
_MOST: Final = 1000
"""So many solutions of a row are counted."""


@dataclass(frozen=True, slots=True)
class RowProof:
    """The proof of a row: proofs of the facts of one solution of the query, and the `conditions` that held.

    `solutions` is their number if the query makes one row of many by grouping, counting or DISTINCT; more than
    1,000 are not counted.
    """

    proofs: tuple[Proof, ...]
    conditions: tuple[Condition, ...]
    solutions: int = 1

    @property
    def remark(self) -> str | None:
        """A sentence with the number of solutions, None if this is the only one."""
        if self.solutions == 1:
            return None
        more = " or more" if self.solutions == _MOST else ""
        return f"this is one of {self.solutions:,}{more} solutions that make the row"


def why_row(view: View, rules: tuple[Rule, ...], text: str, row: Mapping[str, Term]) -> RowProof:
    """Return the proofs of the facts that the SELECT query `text` matched for a row.

    Raises:
        QueryError: KG502 or KG516 for a query that is refused.
        RuleError: KG201 for a query that is not a SELECT, KG226 when the row cannot be traced back.
    """
    text = _WHOLE.sub("", normalise(text))
    lexed = list(tokens(text))
    check(lexed, text)
    start = next((index for index, token in enumerate(lexed) if token.text.upper() == "SELECT"), None)
    if start is None:
        raise RuleError("KG201", "only rows of SELECT queries can be explained", place=Place(_NAME), hint=_HINT)
    where = parse_query(text, _NAME).group.span
    outside = (token.text.upper() for token in lexed[start:] if not where.start <= token.start < where.end)
    merged = not _MERGING.isdisjoint(outside)
    derivation, solutions = None, 0
    for part in _parts(text[: lexed[start].start], text[where.start : where.end]):
        names = bound_by(part.body)
        bound = {name: term for name, term in row.items() if name in names}
        for solution in view.solutions(part.body, names, bound, _MOST if merged else 1):
            derivation = derivation or derivation_of(view, part, solution)
            solutions += 1
        if derivation is not None and not merged:
            break
    if derivation is None:
        raise RuleError("KG226", "the row cannot be traced back to facts", hint=_HINT)
    proofs = tuple(why(view, rules, each) for each in derivation.facts)
    return RowProof(proofs, derivation.conditions, min(solutions, _MOST))


def _parts(prologue: str, where: str) -> tuple[Rule, ...]:
    """Return the WHERE clause of a SELECT query as rules whose head mentions all its variables."""
    names = {token.text[1:] for token in tokens(where) if token.kind is Kind.VARIABLE}
    head = " . ".join(f"{_ROW} {_ROW} ?{name}" for name in sorted(names))
    rule = f"{prologue}CONSTRUCT {{ {head} }} WHERE {where}"
    try:
        return decompose(parse_rq(rule, _NAME).rules[0], _NAME, _NAME, rule, alone=True)
    except RuleError as error:
        if error.code not in {_UNBOUND, _REFUSED}:
            raise
        why, hint = ("", _HINT) if error.code == _UNBOUND else (f": {error.message}", error.hint)
        raise RuleError("KG226", f"the row cannot be traced back to facts{why}", hint=hint) from error
