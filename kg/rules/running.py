"""Runs a set of rules over a store and writes the difference to the triples inferred now.

    report = run(store, rule_set, names)                     # `kg rules run`

    runner = Runner(names, store.layout.cache)               # several runs in one process, or inside a transaction
    with store.write("kg build") as transaction:
        ...                                                  # sources change
        report = runner.run_within(transaction, rule_set)
    runner.remember(store.layout.current())

A limit that is reached (KG205) leaves the store as it is. A run that changes nothing makes no generation.
"""

from __future__ import annotations

import time
from collections import Counter
from dataclasses import replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Final

from kg.rules import memory as memories
from kg.rules.dependencies import volatile
from kg.rules.engine.evaluate import Limits
from kg.rules.filing import run_files
from kg.rules.inferring import Reasoner
from kg.rules.lines import lacking, lines
from kg.rules.recording import Names, activity
from kg.rules.reports import Difference, RunReport, Seconds
from kg.rules.written import Written
from kg.store import changes
from kg.store.changes import Changes
from kg.store.failure import translated

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.files import RuleSet
    from kg.rules.inferring import Outcome
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

__all__ = ["Names", "RunReport", "Runner", "run", "run_files"]

_FEW: Final = 2500
"""So many triples are added one by one; a bulk load costs as much before it begins."""

_AHEAD: Final = 16
"""The store may be so many generations ahead of what is saved."""

_REMOVAL: Final = 3
"""Where more than one in so many inferred triples goes, the graph is written anew."""


def run(  # noqa: PLR0913 - each is a decision of the caller
    store: EmbeddedStore,
    rule_set: RuleSet,
    names: Names,
    *,
    limits: Limits | None = None,
    incremental: bool = True,
    dry_run: bool = False,
    command: str = "kg rules run",
) -> RunReport:
    """Make the graph `names.inferred` what the rules infer from the other graphs, but for `names.builds`.

    Raises:
        RuleError: KG202, KG203, KG204 for rules that cannot run, KG205 at a limit; the store is as it was.
        StoreError: KG301 without data, KG302 while another process writes, KG304 when the disk is full.
    """
    runner = Runner(names, store.layout.cache)
    return runner.run(store, rule_set, limits=limits, incremental=incremental, dry_run=dry_run, command=command)


class Runner:
    """Runs rules repeatedly over one store; `cache` is the folder of its state for the next process."""

    def __init__(self, names: Names, cache: Path | None = None) -> None:
        self._names = names
        self._cache = cache
        self._reasoner = Reasoner(names, cache)
        self._saved: int | None = None
        """The generation of what was saved, if the same is inferred since; None where it is to be saved again."""

    def run(  # noqa: PLR0913 - each is a decision of the caller
        self,
        store: EmbeddedStore,
        rule_set: RuleSet,
        *,
        limits: Limits | None = None,
        incremental: bool = True,
        dry_run: bool = False,
        command: str = "kg rules run",
    ) -> RunReport:
        """Run the rules in a transaction of their own, or with `dry_run` without writing; errors as `run`."""
        if dry_run:
            outcome, _ = self._infer(store, rule_set, limits, incremental=incremental)
            self._reasoner.forget()
            return replace(_report(outcome, self._reasoner), dry_run=True)
        with store.write(command) as transaction:
            outcome, base = self._infer(store, rule_set, limits, incremental=incremental)
            report = self._write(transaction, outcome)
            generation = transaction.commit()
        self.remember(generation or base)
        return replace(report, generation=generation)

    def run_within(
        self,
        transaction: EmbeddedTransaction,
        rule_set: RuleSet,
        *,
        limits: Limits | None = None,
        incremental: bool = True,
    ) -> RunReport:
        """Run the rules over what a transaction has written by now, and write into it; `remember` after its end."""
        self.prepare(rule_set)
        changed = Changes.unknown()
        memory, base = self._reasoner.memory, transaction.base
        if incremental and memory is not None and memory.generation is not None and base is not None:
            changed = changes.since(transaction.layout, memory.generation, base)
            changed.follow(transaction.changes)
        written = transaction.changes if isinstance(transaction.changes, Written) else None
        outcome = self._reasoner.infer(transaction, changed, rule_set, limits or Limits(), written)
        report = self._write(transaction, outcome)
        ahead = base is None or self._saved is None or base - self._saved >= _AHEAD
        if ahead or outcome.mode == "full" or None in (changed.graphs or {}).values() or _lasting(report):
            self._saved = None
        return report

    def prepare(self, rule_set: RuleSet) -> None:
        """Load the memory of the last run of the same rules ahead of the next run."""
        before = self._reasoner.memory
        self._reasoner.take(rule_set)
        memory = self._reasoner.memory
        if memory is not None and memory is not before:
            self._saved = memory.generation

    def remember(self, generation: int | None, *, save: bool = True) -> None:
        """Keep the memory of the last run for the next one: it belongs to this generation of the store."""
        memory = self._reasoner.memory
        if memory is None or generation is None:
            return
        memory.generation = generation
        if save:
            self.save()

    def save(self) -> None:
        """Write the memory to the cache, for the next process.

        If little changed since it was saved, that process repeats the work instead.
        """
        memory = self._reasoner.memory
        if self._saved is None and self._cache is not None and memory is not None and memory.generation is not None:
            with translated(str(self._cache)):
                memories.save(self._cache, memory)
            self._saved = memory.generation

    def _infer(
        self, store: EmbeddedStore, rule_set: RuleSet, limits: Limits | None, *, incremental: bool
    ) -> tuple[Outcome, int]:
        with store.read() as snapshot:
            self._reasoner.take(rule_set)
            memory = self._reasoner.memory
            changed = Changes.unknown()
            if incremental and memory is not None and memory.generation is not None:
                changed = changes.since(store.layout, memory.generation, snapshot.generation)
            return self._reasoner.infer(snapshot, changed, rule_set, limits or Limits()), snapshot.generation

    def _write(self, transaction: EmbeddedTransaction, outcome: Outcome) -> RunReport:
        """Write the difference, and the record of the run if any."""
        begin = time.perf_counter()
        report = _report(outcome, self._reasoner)
        if report.added or report.removed:
            self._write_difference(transaction, outcome, report)
            self._record(transaction, outcome)
        seconds = replace(report.seconds, write=time.perf_counter() - begin)
        return replace(report, seconds=seconds)

    def _write_difference(self, transaction: EmbeddedTransaction, outcome: Outcome, report: RunReport) -> None:
        graph, dictionary = self._names.inferred, outcome.dictionary
        added, removed = report.change.added, report.change.removed
        if len(removed) * _REMOVAL > len(outcome.now) or not len(outcome.now):
            transaction.replace_graphs({graph: lines(outcome.then, dictionary)})
            return
        gone = b"".join(lines(removed, dictionary))
        if len(added) <= _FEW:
            transaction.patch_graph(graph, gone, b"".join(lines(added, dictionary)))
            return
        transaction.patch_graph(graph, gone, b"")
        transaction.load(graph, lines(added, dictionary))

    def _record(self, transaction: EmbeddedTransaction, outcome: Outcome) -> None:
        ended = datetime.now(UTC)
        derived: Counter[str] = Counter()
        for one in outcome.reports:
            derived[one.rule.name] += one.derived
        found = activity(self._names, _started(outcome, ended), ended, len(outcome.then), +derived)
        transaction.append(self._names.builds, found)


def _lasting(report: RunReport) -> bool:
    """Return whether a run should not be done again: it took long, or would not give the same."""
    changed = report.added + report.removed
    return changed > _FEW or (changed > 0 and any(map(volatile, report.applied)))


def _started(outcome: Outcome, ended: datetime) -> datetime:
    return datetime.fromtimestamp(ended.timestamp() - outcome.read - outcome.evaluate, UTC)


def _report(outcome: Outcome, reasoner: Reasoner) -> RunReport:
    change = Difference(outcome.dictionary, lacking(outcome.then, outcome.now), lacking(outcome.now, outcome.then))
    return RunReport(
        asserted=len(outcome.asserted),
        inferred=len(outcome.then),
        added=len(change.added),
        removed=len(change.removed),
        seconds=Seconds(outcome.read, outcome.evaluate),
        strata=reasoner.strata,
        mode=outcome.mode,
        rules=outcome.reports,
        change=change,
        applied=reasoner.rules,
    )
