"""Infer triples from the graphs of a store, starting from the results of the last run.

The triples read and inferred last are kept (`kg.rules.memory`). Of the graphs that changed since, patches are applied
or the graph is read again; the inferences are maintained (`kg.rules.maintain`), unless much changed.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, Final

import numpy as np

from kg.rules import memory as memories
from kg.rules.columns import EVERYTHING, read, read_columns, union_of, wanted
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import Facts, distinct
from kg.rules.engine.terms import Dictionary
from kg.rules.lines import lacking, stored
from kg.rules.maintain import Maintained
from kg.rules.memory import Memory
from kg.rules.patches import patched, stated

if TYPE_CHECKING:
    from pathlib import Path

    from pyoxigraph import NamedNode

    from kg.rules.columns import Tables, Wanted
    from kg.rules.engine.evaluate import Limits, RuleReport
    from kg.rules.files import RuleSet
    from kg.rules.form import Rule
    from kg.rules.recording import Names
    from kg.rules.written import Written
    from kg.store.changes import Changes

__all__ = ["Outcome", "Reasoner"]

_LARGE: Final = 4
"""Where more than one in so many asserted triples changed, everything is evaluated anew."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Result of inference: `now` is the content of the graph, `then` the content to write; wall time in seconds."""

    dictionary: Dictionary
    asserted: Facts
    now: Facts
    then: Facts
    mode: str
    reports: tuple[RuleReport, ...]
    read: float
    evaluate: float


class Reasoner:
    """One set of rules at a time, over one store; `memory` is its state, with its generation."""

    def __init__(self, names: Names, cache: Path | None) -> None:
        self.memory: Memory | None = None
        self._names = names
        self._cache = cache
        self._taken: RuleSet | None = None
        self._digest = ""
        self._program = Program(())
        self._what = EVERYTHING
        self._maintained: Maintained | None = None

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules taken."""
        return self._program.rules

    @property
    def strata(self) -> int:
        """How many strata the rules have."""
        return self._program.levels

    def take(self, rule_set: RuleSet) -> None:
        """Set the rules, and load the memory of their last run; KG202, KG203 for rules that cannot run."""
        digest = self._digest if rule_set is self._taken else _digest(rule_set, self._names)
        self._taken = rule_set
        if digest != self._digest:
            self._program = Program(rule_set.rules, rule_set.strata)
            self._what = wanted(rule_set.rules)
            self._digest = digest
            self.forget()
        if self.memory is not None and self.memory.generation is None:
            self.forget()
        if self.memory is None and self._cache is not None:
            self.memory = memories.load(self._cache, digest)

    def forget(self) -> None:
        """Drop the memory of the last run."""
        self.memory, self._maintained = None, None

    def infer(
        self, source: Tables, changes: Changes, rule_set: RuleSet, limits: Limits, written: Written | None = None
    ) -> Outcome:
        """Return the inferences of the rules set; `changes` are those since the generation of the memory.

        `written` is what was written since the store was empty, where that is known.
        The memory is then of this outcome, and of no generation until it is given one. Raises RuleError: KG204, KG205.
        """
        excluded = {self._names.inferred, self._names.builds}
        graphs = [*(graph for graph in source.graphs() if graph not in excluded), None]
        if self.memory is None or changes.graphs is None:
            return self._anew(source, graphs, rule_set, limits, written)
        return self._evaluate_again(self.memory, source, graphs, changes, rule_set, limits)

    def _anew(
        self,
        source: Tables,
        graphs: list[NamedNode | None],
        rule_set: RuleSet,
        limits: Limits,
        written: Written | None,
    ) -> Outcome:
        begin = time.perf_counter()
        self.forget()
        dictionary, parts = written.take(self._what, graphs) if written is not None else (Dictionary(), {})
        parts |= read(source, self._what, [graph for graph in graphs if graph not in parts], dictionary)
        data = self._data(rule_set, dictionary)
        asserted = union_of([*parts.values(), data])
        now = self._read_inferred(source, dictionary)
        return self._full(Memory(None, self._digest, dictionary, parts, asserted), data, now, begin, limits)

    def _full(self, memory: Memory, data: Facts, now: Facts, begin: float, limits: Limits) -> Outcome:
        middle = time.perf_counter()
        found = evaluate(self._program, memory.dictionary, memory.asserted, limits=limits)
        memory.inferred = found.inferred
        then = _shown(memory, data)
        self.memory, self._maintained = memory, None
        seconds = (middle - begin, time.perf_counter() - middle)
        return Outcome(memory.dictionary, memory.asserted, now, then, "full", tuple(found.reports), *seconds)

    def _evaluate_again(  # noqa: PLR0913, PLR0917 - all that evaluation depends on
        self,
        memory: Memory,
        source: Tables,
        graphs: list[NamedNode | None],
        changes: Changes,
        rule_set: RuleSet,
        limits: Limits,
    ) -> Outcome:
        begin = time.perf_counter()
        data = self._data(rule_set, memory.dictionary)
        now = self._held_since(memory, data, source, changes)
        parts, touched = _Rereading(memory, source, self._what).graphs(graphs, changes)
        asserted = memory.asserted.copy()
        for predicate in touched:
            columns = [part.keys(predicate) for part in (*parts.values(), data)]
            asserted.replace(predicate, distinct(np.concatenate(columns)))
        inserted, deleted = lacking(asserted, memory.asserted), lacking(memory.asserted, asserted)
        following = Memory(None, self._digest, memory.dictionary, parts, asserted, memory.inferred)
        if (len(inserted) + len(deleted)) * _LARGE > len(asserted):
            return self._full(following, data, now, begin, limits)
        middle = time.perf_counter()
        if len(inserted) or len(deleted):
            following.inferred = self._maintain(memory, inserted, deleted, limits)
        then = _shown(following, data)
        self.memory = following
        seconds = (middle - begin, time.perf_counter() - middle)
        return Outcome(memory.dictionary, asserted, now, then, "incremental", (), *seconds)

    def _maintain(self, memory: Memory, inserted: Facts, deleted: Facts, limits: Limits) -> Facts:
        if self._maintained is None:
            self._maintained = Maintained(self._program, memory.dictionary, memory.asserted, memory.inferred)
        self._maintained.apply(inserted, deleted, limits=limits)
        return self._maintained.inferred

    def _held_since(self, memory: Memory, data: Facts, source: Tables, changes: Changes) -> Facts:
        """Return the content of the graph of inferred triples, updated from that of the memory."""
        known = _shown(memory, data)
        patches = (changes.graphs or {}).get(self._names.inferred.value, [])
        if patches is None:
            return self._read_inferred(source, memory.dictionary)
        return patched(known, patches, EVERYTHING, memory.dictionary)[0] if patches else known

    def _read_inferred(self, source: Tables, dictionary: Dictionary) -> Facts:
        """Return what the graph of inferred triples holds: usually what these rules may infer and nothing else."""
        graph = self._names.inferred
        if graph not in source.graphs():
            return Facts()
        found = read_columns(source, self._what, [graph], dictionary)[1]
        if len(found) == int(source.table("SELECT (COUNT(*) AS ?n) { ?s ?p ?o }", graph)):
            return found
        return read_columns(source, EVERYTHING, [graph], dictionary)[1]

    def _data(self, rule_set: RuleSet, dictionary: Dictionary) -> Facts:
        return stated(rule_set.data, dictionary)


@dataclass(frozen=True, slots=True)
class _Rereading:
    """Reads what changed of the graphs of a memory."""

    memory: Memory
    source: Tables
    what: Wanted

    def graphs(
        self, graphs: list[NamedNode | None], changes: Changes
    ) -> tuple[dict[NamedNode | None, Facts], set[int]]:
        """Return the columns of all graphs, and the predicates of which triples may have come or gone."""
        parts: dict[NamedNode | None, Facts] = {}
        touched: set[int] = set()
        known = changes.graphs or {}
        again = [graph for graph in graphs if graph not in self.memory.graphs or known.get(_name(graph), ()) is None]
        fresh = read(self.source, self.what, again, self.memory.dictionary)
        for graph in graphs:
            before = self.memory.graphs.get(graph, Facts())
            if graph in fresh:
                parts[graph] = fresh[graph]
                touched |= _differing(before, fresh[graph])
            elif known.get(_name(graph)):
                patches = known[_name(graph)] or []
                parts[graph], named = patched(before, patches, self.what, self.memory.dictionary)
                touched |= named
            else:
                parts[graph] = before
        for gone in self.memory.graphs.keys() - parts.keys():
            touched.update(self.memory.graphs[gone].predicates)
        return parts, touched


def _name(graph: NamedNode | None) -> str:
    return "" if graph is None else graph.value


def _differing(before: Facts, after: Facts) -> set[int]:
    predicates = {*before.predicates, *after.predicates}
    return {one for one in predicates if not np.array_equal(before.keys(one), after.keys(one))}


def _shown(memory: Memory, data: Facts) -> Facts:
    """Return the triples for the graph: those inferred, and those of rule files that no graph states."""
    found = stored(memory.inferred, memory.dictionary)
    for predicate, keys in lacking(data, union_of(memory.graphs.values())) if len(data) else ():
        found.add(predicate, keys)
    return found


def _digest(rule_set: RuleSet, names: Names) -> str:
    """Return the digest of a set of rules and of the graphs that it leaves out."""
    return blake2b(f"{names} {rule_set.digest}".encode(), digest_size=16).hexdigest()
