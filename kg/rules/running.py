"""Runs rules over a store, or over files of RDF, and writes the difference to the triples inferred before.

    report = Runner(names, store.layout.cache).run(store, rule_set)     # `kg rules run`

    runner = Runner(names, store.layout.cache)               # several runs in one process, or inside a transaction
    with store.write("kg build") as transaction:
        ...                                                  # sources change
        report = runner.run_within(transaction, rule_set)
    runner.remember(store.layout.current())

    report = run_files(files, output, rule_set)              # without a store

A limit that is reached (KG205) leaves the store as it is. A run that changes nothing makes no generation.

The triples read and inferred last are kept (`kg.rules.memory`). Of the graphs that changed since, patches are applied
or the graph is read again; the inferences are maintained (`kg.rules.maintain`), unless much changed.
"""

from __future__ import annotations

import time
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from itertools import chain
from typing import TYPE_CHECKING, Final

import numpy as np
from pyoxigraph import NamedNode, RdfFormat

from kg.errors import UsageError
from kg.rules import memory as memories
from kg.rules.columns import (
    EVERYTHING,
    Tables,
    by_predicate,
    graph_name,
    lines,
    patched,
    read,
    read_columns,
    rows_of,
    stated,
    stored,
    union_of,
)
from kg.rules.engine.evaluate import Limits, Program, RuleReport, evaluate
from kg.rules.engine.facts import EMPTY, NOTHING, Facts, Keys, Packed, absorb, gathered, lacking, union
from kg.rules.engine.pages import Pages
from kg.rules.engine.terms import Dictionary
from kg.rules.maintain import Maintained
from kg.rules.memory import Memory
from kg.rules.recording import Names, activity
from kg.rules.reports import Difference, RunReport, Seconds
from kg.rules.written import Written
from kg.store import changes
from kg.store.allocator import give_back
from kg.store.changes import Changes
from kg.store.failure import translated
from kg.store.files import format_of, opened, quads_of
from kg.store.layout import Layout, write_atomically
from kg.store.terms import parts_of_lines

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from kg.rules.files import RuleSet
    from kg.store.embedded import EmbeddedStore
    from kg.store.transaction import EmbeddedTransaction

_FEW: Final = 2500
"""So many triples are added one by one; a bulk load costs as much before it begins."""

_AHEAD: Final = 16
"""The store may be so many generations ahead of what is saved."""

_REMOVAL: Final = 3
"""Where more than one in so many inferred triples goes, the graph is written anew."""

_LARGE: Final = 4
"""Where more than one in so many asserted triples changed, everything is evaluated anew."""


class Runner:
    """Runs rules repeatedly over one store; `cache` is the folder of its state for the next process."""

    def __init__(self, names: Names, cache: Path | None = None) -> None:
        self._names = names
        self._cache = cache
        self._reasoner = Reasoner(names, cache)
        self._saved: int | None = None
        """The generation of what was saved, if the same is inferred since; None where it is to be saved again."""

    def run(
        self,
        store: EmbeddedStore,
        rule_set: RuleSet,
        *,
        limits: Limits | None = None,
        incremental: bool = True,
        dry_run: bool = False,
    ) -> RunReport:
        """Make the graph `names.inferred` what the rules infer from the other graphs, but for `names.builds`.

        The rules run in a transaction of their own, or with `dry_run` without writing.

        Raises:
            RuleError: KG202, KG203, KG204 for rules that cannot run, KG205 at a limit; the store is as it was.
            StoreError: KG301 without data, KG302 while another process writes, KG304 when the disk is full.
        """
        if dry_run:
            outcome, _ = self._infer(store, rule_set, limits, incremental=incremental)
            self._reasoner.forget()
            return replace(_report(outcome, self._reasoner), dry_run=True)
        with store.write("kg rules run") as transaction:
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
        changed = self._changes(transaction.layout, transaction.base, incremental=incremental)
        changed.follow(transaction.changes)
        written = transaction.changes if isinstance(transaction.changes, Written) else None
        outcome = self._reasoner.infer(transaction, changed, rule_set, limits or Limits(), written)
        report = self._write(transaction, outcome)
        base = transaction.base
        ahead = base is None or self._saved is None or base - self._saved >= _AHEAD
        # The next process does small work again; this run took long enough that it should not.
        lasting = report.added + report.removed > _FEW
        if ahead or outcome.mode == "full" or None in (changed.graphs or {}).values() or lasting:
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
            changed = self._changes(store.layout, snapshot.generation, incremental=incremental)
            return self._reasoner.infer(snapshot, changed, rule_set, limits or Limits()), snapshot.generation

    def _changes(self, layout: Layout, generation: int | None, *, incremental: bool) -> Changes:
        """Return the changes from the memory of the last run to a generation; unknown ones without `incremental`."""
        memory = self._reasoner.memory
        if not incremental or memory is None or memory.generation is None or generation is None:
            return Changes.unknown()
        return changes.since(layout, memory.generation, generation)

    def _write(self, transaction: EmbeddedTransaction, outcome: Outcome) -> RunReport:
        """Write the difference, and the record of the run if any."""
        begin = time.perf_counter()
        if outcome.mode == "full":
            give_back()
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
        started = ended - timedelta(seconds=outcome.read + outcome.evaluate)
        derived: Counter[str] = Counter()
        for one in outcome.reports:
            derived[one.rule.name] += one.derived
        text = activity(self._names, started, ended, len(outcome.then), +derived)
        transaction.append(self._names.builds, text)


def _report(outcome: Outcome, reasoner: Reasoner) -> RunReport:
    change = Difference(outcome.dictionary, lacking(outcome.then, outcome.now), lacking(outcome.now, outcome.then))
    return RunReport(
        asserted=len(outcome.asserted),
        inferred=len(outcome.then),
        added=len(change.added),
        removed=len(change.removed),
        seconds=Seconds(outcome.read, outcome.evaluate),
        strata=reasoner.program.levels,
        mode=outcome.mode,
        rules=outcome.reports,
        change=change,
        applied=reasoner.program.rules,
    )


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
    """Infers with one set of rules at a time (`program`) over one store; `memory` is its state, with its generation."""

    def __init__(self, names: Names, cache: Path | None) -> None:
        self.memory: Memory | None = None
        self.program = Program(())
        self._names = names
        self._cache = cache
        self._taken: RuleSet | None = None
        self._digest = ""
        self._maintained: Maintained | None = None

    def take(self, rule_set: RuleSet) -> None:
        """Set the rules, and load the memory of their last run; KG202, KG203 for rules that cannot run."""
        digest = self._digest if rule_set is self._taken else self._names.digest(rule_set)
        self._taken = rule_set
        if digest != self._digest:
            self.program = Program(rule_set.rules, rule_set.strata)
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
        graphs = self._names.read_by_rules(source.graphs())
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
        dictionary, parts = written.take(graphs) if written is not None else (self._dictionary(), {})
        parts |= read(source, EVERYTHING, [graph for graph in graphs if graph not in parts], dictionary)
        data = stated(rule_set.data, dictionary)
        asserted = union_of([*parts.values(), data], dictionary.pages)
        now = self._read_inferred(source, dictionary)
        return self._full(
            Memory(None, self._digest, self._names, dictionary, parts, asserted), data, now, begin, limits
        )

    def _dictionary(self) -> Dictionary:
        """Return a dictionary without terms, which keeps most of them in a file of the cache."""
        if self._cache is not None:
            with suppress(OSError):  # a dry run on a store that can only be read
                return Dictionary(pages=Pages(self._cache))
        return Dictionary()

    def _full(self, memory: Memory, data: Facts, now: Facts, begin: float, limits: Limits) -> Outcome:
        middle = time.perf_counter()
        result = evaluate(self.program, memory.dictionary, memory.asserted, limits=limits)
        memory.inferred = result.inferred
        then = memory.written = _visible(memory, data)
        self.memory, self._maintained = memory, None
        seconds = (middle - begin, time.perf_counter() - middle)
        return Outcome(memory.dictionary, memory.asserted, now, then, "full", tuple(result.reports), *seconds)

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
        data = stated(rule_set.data, memory.dictionary)
        now = self._updated_inferred(memory, source, changes)
        parts, touched = _read_again(memory, source, graphs, changes)
        asserted = memory.asserted.copy()
        again: dict[int, list[Keys]] = {predicate: [] for predicate in touched}
        for predicate, keys in chain(*parts.values(), data):
            if predicate in again:
                again[predicate].append(keys)
        for predicate, pieces in again.items():
            asserted.replace(predicate, union(*pieces))
        inserted, deleted = lacking(asserted, memory.asserted), lacking(memory.asserted, asserted)
        following = Memory(None, self._digest, self._names, memory.dictionary, parts, asserted, memory.inferred)
        if (len(inserted) + len(deleted)) * _LARGE > len(asserted):
            return self._full(following, data, now, begin, limits)
        middle = time.perf_counter()
        if len(inserted) or len(deleted):
            if self._maintained is None:
                self._maintained = Maintained(self.program, memory.dictionary, memory.asserted, memory.inferred)
            self._maintained.apply(inserted, deleted, limits=limits)
            following.inferred = self._maintained.inferred
        then = following.written = _visible(following, data)
        self.memory = following
        seconds = (middle - begin, time.perf_counter() - middle)
        return Outcome(memory.dictionary, asserted, now, then, "incremental", (), *seconds)

    def _updated_inferred(self, memory: Memory, source: Tables, changes: Changes) -> Facts:
        """Return the content of the graph of inferred triples, updated from that of the memory."""
        cached = memory.written
        patches = (changes.graphs or {}).get(self._names.inferred.value, [])
        if patches is None:
            return self._read_inferred(source, memory.dictionary)
        return patched(cached, patches, memory.dictionary)[0] if patches else cached

    def _read_inferred(self, source: Tables, dictionary: Dictionary) -> Facts:
        """Return what the graph of inferred triples holds."""
        graph = self._names.inferred
        return read_columns(source, EVERYTHING, [graph], dictionary) if graph in source.graphs() else Facts()


def _read_again(
    memory: Memory, source: Tables, graphs: list[NamedNode | None], changes: Changes
) -> tuple[dict[NamedNode | None, Packed], set[int]]:
    """Return the columns of all graphs, and the predicates of which triples may have come or gone.

    Graphs of unknown changes are read, others are patched.
    """
    parts: dict[NamedNode | None, Packed] = {}
    touched: set[int] = set()
    changed = changes.graphs or {}
    again = [graph for graph in graphs if graph not in memory.graphs or changed.get(graph_name(graph), ()) is None]
    fresh = read(source, EVERYTHING, again, memory.dictionary)
    for graph in graphs:
        before = memory.graphs.get(graph, NOTHING)
        if graph in fresh:
            parts[graph], after, earlier = fresh[graph], dict(fresh[graph]), dict(before)
            predicates = earlier.keys() | after.keys()
            touched |= {one for one in predicates if not np.array_equal(earlier.get(one, EMPTY), after.get(one, EMPTY))}
        elif patches := changed.get(graph_name(graph)):
            facts, named = patched(before, patches, memory.dictionary)
            parts[graph] = Packed.of(facts)
            touched |= named
        else:
            parts[graph] = before
    for gone in memory.graphs.keys() - parts.keys():
        touched.update(dict(memory.graphs[gone]))
    return parts, touched


def _visible(memory: Memory, data: Facts) -> Facts:
    """Return the triples for the graph: those inferred, and those of rule files that no graph states."""
    result = stored(memory.inferred, memory.dictionary)
    if len(data):
        absorb(result, lacking(data, union_of(memory.graphs.values())))
    return result


def run_files(
    files: Sequence[Path], output: Path | None, rule_set: RuleSet, *, limits: Limits | None = None
) -> RunReport:
    """Write what the rules infer from files of RDF to `output`, sorted by predicate; None writes nothing.

    The ending of a file names its format; N-Triples are read fastest. Of quads the graph is left out.

    Terms are what they would be in a store (`kg.store.terms`). Blank nodes of a single file keep their labels; those
    of several files get new ones, since each file has labels of its own.

    Raises:
        RuleError: KG202, KG203, KG204 for rules that cannot run, KG205 at a limit; `output` is as it was.
        UsageError: KG003 for a file whose ending names no format.
        SourceError: KG101 when a file cannot be opened.
        GraphError: KG601 with the line when it is not valid.
    """
    begin = time.perf_counter()
    program = Program(rule_set.rules)
    dictionary = Dictionary()
    columns: dict[int, list[NDArray[np.int64]]] = {}
    for file in files:
        for predicate, keys in by_predicate(_rows(file, dictionary, rename=len(files) > 1)):
            columns.setdefault(predicate, []).append(keys)
    given, asserted = gathered(columns), stated(rule_set.data, dictionary)
    data = lacking(asserted, given)
    absorb(asserted, given)
    read = time.perf_counter()
    result = evaluate(program, dictionary, asserted, limits=limits or Limits())
    inferred = stored(result.inferred, dictionary)
    absorb(inferred, data)
    evaluated = time.perf_counter()
    if output is not None:
        with translated(str(output)):
            write_atomically(output, b"".join(lines(inferred, dictionary)), durable=False)
    seconds = Seconds(read - begin, evaluated - read, time.perf_counter() - evaluated)
    change = Difference(dictionary, inferred, Facts())
    size = len(inferred)
    reports = tuple(result.reports)
    return RunReport(len(asserted), size, size, 0, seconds, program.levels, "full", reports, change, program.rules)


def _rows(file: Path, dictionary: Dictionary, *, rename: bool) -> NDArray[np.int64]:
    """Return the triples of a file as rows of identifiers."""
    kind = rdf_format(file)
    if kind == RdfFormat.N_TRIPLES:
        with opened(file) as content:
            parts = parts_of_lines(content.read())
        if parts is not None:
            return dictionary.intern_all(parts).reshape(-1, 3)
    return rows_of(quads_of(file, kind, rename=rename), dictionary)


def rdf_format(file: Path) -> RdfFormat:
    """Return the format that the ending of a file names; UsageError KG003 for one that names none."""
    result = format_of(file)
    if result is None:
        hint = "The endings are .nt, .ttl, .nq, .trig, .n3, .rdf, .xml and .jsonld."
        raise UsageError("KG003", f"the ending of {file} names no format of RDF", hint=hint)
    return result
