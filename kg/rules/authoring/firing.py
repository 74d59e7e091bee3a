"""Apply rules once to all known triples: the triples of each rule, and the rows after each element of its body."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kg.rules.engine.blocks import Blocks
from kg.rules.engine.expressions import Expressions
from kg.rules.engine.heads import Collector
from kg.rules.engine.limits import Clock, Limits
from kg.rules.engine.planning import plan
from kg.rules.engine.solve import Solver, State
from kg.rules.form import Element, Rule, is_auxiliary

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.rules.engine.facts import Facts
    from kg.rules.engine.plan import Step
    from kg.rules.engine.tables import Table
    from kg.rules.engine.terms import Dictionary


@dataclass(slots=True)
class Passage:
    """The rows before and after one element of a body, and its seconds; `order` in which it was run."""

    order: int
    rows_in: int = 0
    rows_out: int = 0
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class Firing:
    """One rule applied once: the triples of each triple of its head, and the passages by number of element."""

    rule: Rule
    heads: tuple[Facts, ...]
    passages: dict[int, Passage]
    seconds: float


class _Watched(Solver):
    """A solver that records each element."""

    def __init__(self, state: State, sources: Sequence[Facts]) -> None:
        super().__init__(state, sources)
        self.passages: dict[int, Passage] = {}

    def _after(self, table: Table, step: Step, rest: tuple[Step, ...], outputs: frozenset[str], *, bag: bool) -> Table:
        begin = time.perf_counter()
        before = self.matched.get(step.element, 0)
        result = super()._after(table, step, rest, outputs, bag=bag)
        passage = self.passages.setdefault(step.element, Passage(len(self.passages)))
        passage.rows_in += table.rows
        passage.rows_out += self.matched.get(step.element, 0) - before
        passage.seconds += time.perf_counter() - begin
        return result


def _state_of(rules: Iterable[Rule], dictionary: Dictionary) -> State:
    """Return the state shared by applications of rules over one dictionary."""
    predicates = {atom.predicate for rule in rules for atom in rule.head}
    hidden = frozenset(dictionary.intern_term(predicate) for predicate in predicates if is_auxiliary(predicate))
    return State(dictionary, Expressions(dictionary), Blocks(dictionary), Clock(Limits()), hidden)


def fire(rules: Iterable[Rule], dictionary: Dictionary, asserted: Facts, facts: Facts) -> Iterator[Firing]:
    """Yield the firing of each rule applied to `facts`, which includes `asserted`."""
    every = list(rules)
    state = _state_of(every, dictionary)
    for rule in every:
        begin = time.perf_counter()
        state.clock.rule = str(rule)
        rule_plan = plan(rule, dictionary)
        solver = _Watched(state, rule_plan.inputs(asserted, facts))
        collectors = [Collector(rule_plan, dictionary) for _ in rule_plan.heads]
        for table in solver.solutions(rule_plan.body, rule_plan.outputs):
            for collector, head in zip(collectors, rule_plan.heads, strict=True):
                collector.add(table, [head])
        heads = tuple(collector.facts() for collector in collectors)
        yield Firing(rule, heads, solver.passages, time.perf_counter() - begin)


def holds(rule: Rule, body: tuple[Element, ...], dictionary: Dictionary, asserted: Facts, facts: Facts) -> bool:
    """Return whether a part of the body of a rule has a solution."""
    rule_plan = plan(replace(rule, head=(), body=body), dictionary)
    solver = Solver(_state_of([rule], dictionary), rule_plan.inputs(asserted, facts))
    return any(table.rows for table in solver.solutions(rule_plan.body, frozenset()))
