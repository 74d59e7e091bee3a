"""Rules on one process, and on the parts of a divided graph, in processes that inherit the columns by fork.

This is the cheapest division there can be: parts are not moved, and processes load no code. Only what they infer is
sent, and interned. On a cluster, parts are moved and processes start with empty memory.
"""

from __future__ import annotations

import multiprocessing
import resource
import time
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.graph.vocabulary import RNKG
from kg.pipeline.reasoning import division, rules_over
from kg.rules.columns import EVERYTHING, by_predicate, lines, read, union_of
from kg.rules.engine.evaluate import Program, evaluate
from kg.rules.engine.facts import Facts, Packed, absorb, distinct, lacking
from kg.rules.engine.terms import Dictionary
from kg.rules.partitions import verdicts
from kg.rules.recording import Names
from kg.rules.stratify import edges
from kg.settings import load
from kg.store.embedded import EmbeddedStore
from kg.store.layout import Layout
from kg.store.terms import parts_of_lines

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from multiprocessing.connection import Connection
    from pathlib import Path

    from pyoxigraph import NamedNode

    from kg.rules.form import Rule

_FORK: Final = multiprocessing.get_context("fork")


@dataclass(slots=True)
class _Time:
    """Wall time and processor time with child processes, in seconds."""

    wall: float = 0.0
    processor: float = 0.0

    def __str__(self) -> str:
        return f"{self.wall:.2f} / {self.processor:.2f}"


@contextmanager
def _timed() -> Iterator[_Time]:
    found, wall, processor = _Time(), time.perf_counter(), _processor()
    yield found
    found.wall, found.processor = time.perf_counter() - wall, _processor() - processor


def _processor() -> float:
    uses = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(use.ru_utime + use.ru_stime for use in uses)


def compare(folder: Path, numbers: Sequence[int]) -> None:
    """Print what running the rules of a store takes in one process, and divided into so many parts."""
    settings = load({"store": str(folder)}, environment={})
    with EmbeddedStore(Layout(folder)).read() as snapshot:
        with _timed() as dividing:
            parts, asserted_only = division(settings, snapshot)
        rules = rules_over(settings, snapshot)
        dictionary = Dictionary()
        graphs = Names.of(settings.base, RNKG).read_by_rules(snapshot.graphs())
        columns = read(snapshot, EVERYTHING, graphs, dictionary)
    local = [one.is_local for one in verdicts(rules.rules, parts, asserted_only)]
    first = _divisible(rules.rules, local)
    asserted = union_of(columns.values())
    with _timed() as alone:
        whole = evaluate(Program(rules.rules, rules.strata), dictionary, asserted)
    spent = {one.rule: one.seconds for one in whole.reports}
    share = sum(spent[one] for one in first) / sum(spent.values())
    print(f"{folder.name}: {parts.number} sources, {len(asserted):,} triples, {len(whole.inferred):,} inferred")
    print(
        f"{sum(local)} of {len(local)} rules are local; {len(first)} with all that they read, {share:.0%} of the time"
    )
    print(f"reading which rules are local: {dividing} s (wall / processor)\n")
    print("| parts | local rules | others | both | equal |\n|---|---|---|---|---|")
    print(f"| one process | | | {alone} s | |")
    rest = [one for one in rules.rules if one not in set(first)]
    for number in numbers:
        groups = _groups(columns, settings.base, number)
        with _timed() as divided:
            inferred = _on_parts(first, dictionary, groups)
        with _timed() as together:
            found = evaluate(Program(rest), dictionary, asserted, inferred=inferred)
        absorb(found.inferred, lacking(inferred, asserted))
        equal = not len(lacking(found.inferred, whole.inferred)) and not len(lacking(whole.inferred, found.inferred))
        both = _Time(divided.wall + together.wall, divided.processor + together.processor)
        print(f"| {number} | {divided} s | {together} s | {both} s | {'yes' if equal else 'NO'} |", flush=True)


def _divisible(rules: Sequence[Rule], local: Sequence[bool]) -> list[Rule]:
    """Return the local rules that read only asserted facts and what such rules infer."""
    needs, found = edges(rules), {number for number, is_local in enumerate(local) if is_local}
    while left := {number for number in found if not needs[number].keys() <= found}:
        found -= left
    return [rules[number] for number in sorted(found)]


def _groups(columns: dict[NamedNode | None, Packed], base: str, number: int) -> list[Facts]:
    """Return the facts of parts of about the same size: those of some sources, with what all share."""
    owned: dict[str, list[Packed]] = {}
    common = []
    for graph, facts in columns.items():
        kind, _, rest = (graph.value if graph else "").removeprefix(f"{base}graph/").partition("/")
        if kind in {"source", "launch"}:
            owned.setdefault(rest.partition("/-/")[0], []).append(facts)
        else:  # ontologies, what sources share, and starts
            common.append(facts)
    groups: list[list[Packed]] = [[] for _ in range(number)]
    for _, given in sorted(owned.items(), key=lambda one: -sum(map(len, one[1]))):
        min(groups, key=lambda group: sum(map(len, group))).extend(given)
    return [union_of([*common, *group]) for group in groups]


def _on_parts(rules: Sequence[Rule], dictionary: Dictionary, groups: Sequence[Facts]) -> Facts:
    """Return what rules infer from parts, each in a process of its own."""
    program, pipes, processes = Program(rules), [], []
    for group in groups:
        here, there = _FORK.Pipe(duplex=False)
        processes.append(_FORK.Process(target=_infer, args=(program, dictionary, group, there)))
        processes[-1].start()
        there.close()
        pipes.append(here)
    found: list[Facts] = []
    for pipe, process in zip(pipes, processes, strict=True):
        parts = parts_of_lines(pipe.recv_bytes())
        process.join()
        if parts is None:
            raise ValueError("a process sent other text than lines of triples")
        rows = dictionary.intern_all(parts).reshape(-1, 3)
        found.append(Facts({predicate: distinct(keys) for predicate, keys in by_predicate(rows)}))
    return union_of(found)


def _infer(program: Program, dictionary: Dictionary, facts: Facts, pipe: Connection) -> None:
    inferred = evaluate(program, dictionary, facts).inferred
    pipe.send_bytes(b"".join(lines(inferred, dictionary)))
