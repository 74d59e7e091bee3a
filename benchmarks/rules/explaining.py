"""What an explanation costs: proofs of facts that rules inferred, drawn evenly from each property and each length."""

from __future__ import annotations

import random
import statistics
import time
from typing import TYPE_CHECKING, Any, Final, cast

import generating
import rule_sets
from pyoxigraph import NamedNode

from kg.rules.explain.proof import Proof
from kg.rules.explain.view import View, Vocabulary
from kg.rules.explain.why import why
from kg.rules.explain.why_not import why_not
from kg.rules.recording import Names
from kg.rules.running import Runner
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

    from pyoxigraph import QueryTriples, Triple

    from kg.store.snapshot import EmbeddedSnapshot

__all__ = ["measure"]

_NAMES: Final = Names.of(generating.BASE, generating.RNKG)
_SOURCE: Final = NamedNode(f"{generating.BASE}graph/source/benchmark")
_OF_EACH: Final = 25


def measure(size: int, folder: Path) -> dict[str, Any]:
    """Measure proofs over a graph of one size, print, and return the figures; times are seconds of the processor."""
    store = EmbeddedStore.create(folder / f"why{size}")
    with store.write("benchmark") as transaction:
        transaction.replace_graphs({_SOURCE: (line.encode() for line in generating.triples(size))})
    rules = rule_sets.seventeen()
    report = Runner(_NAMES, store.layout.cache).run(store, rules)
    with store.read() as snapshot:
        facts = _sample(snapshot)
        proofs = [_timed(snapshot, rules.rules, fact) for fact in facts]
        absent = [_refused(snapshot, rules.rules, fact) for fact in facts[::_OF_EACH]]
    seconds = [took for took, _ in proofs]
    figures: dict[str, Any] = {
        "asserted": size,
        "inferred": report.inferred,
        "facts": len(facts),
        "why: median": statistics.median(seconds),
        "why: longest": max(seconds),
        "steps of the largest proof": max(steps for _, steps in proofs),
        "why-not: longest": max(absent),
    }
    for name, value in figures.items():
        print(f"{name:28} {value:.4f}" if isinstance(value, float) else f"{name:28} {value}")
    return figures


def _sample(snapshot: EmbeddedSnapshot) -> list[Triple]:
    """Return some inferred facts of each property, the same for the same graph."""
    query = f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ GRAPH {_NAMES.inferred} {{ ?s ?p ?o }} }}"
    by_property: dict[str, list[Triple]] = {}
    for fact in cast("QueryTriples", snapshot.query(query)):
        by_property.setdefault(fact.predicate.value, []).append(fact)
    draw = random.Random(0)  # noqa: S311 - a sample, the same each time
    chosen = []
    for name in sorted(by_property):
        known = sorted(by_property[name], key=str)
        chosen += draw.sample(known, min(_OF_EACH, len(known)))
    return chosen


def _timed(snapshot: EmbeddedSnapshot, rules: Any, fact: Triple) -> tuple[float, int]:
    begin = time.process_time()
    view = View(snapshot, Vocabulary(_NAMES.inferred, (_NAMES.builds,)), rules)
    proof = why(view, rules, fact)
    took = time.process_time() - begin
    return took, len({each.fact for _, each in proof.walk() if isinstance(each, Proof)})


def _refused(snapshot: EmbeddedSnapshot, rules: Any, fact: Triple) -> float:
    """Ask why a fact about another thing does not hold."""
    begin = time.process_time()
    view = View(snapshot, Vocabulary(_NAMES.inferred, (_NAMES.builds,)), rules)
    why_not(view, rules, type(fact)(NamedNode(f"{generating.BASE}node/none"), fact.predicate, fact.object))
    return time.process_time() - begin
