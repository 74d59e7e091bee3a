"""What a change costs beside a full run.

What is taken out and put back is one triple, one in a hundred that stand together (a source that is read again), and
each hundredth one, which falls on what many others follow from too.

The columns are kept in memory, as in a server; `apply` is reading the change, maintaining what follows from it and
writing that into the open transaction. What the transaction costs by itself (a checkpoint, a pointer) is told apart.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Final

import generating
import rule_sets
from pyoxigraph import NamedNode, RdfFormat

from kg.rules.recording import Names
from kg.rules.running import Runner
from kg.store.embedded import EmbeddedStore

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["measure"]

_NAMES: Final = Names.of(generating.BASE, generating.RNKG)
_SOURCE: Final = NamedNode(f"{generating.BASE}graph/source/benchmark")


def measure(size: int, folder: Path) -> dict[str, Any]:
    """Measure a graph of one size, print, and return the figures in seconds."""
    lines = [line.encode() for line in generating.triples(size)]
    store = EmbeddedStore.create(folder / f"changes{size}")
    with store.write("benchmark") as transaction:
        transaction.replace_graphs({_SOURCE: [b"".join(lines)]})
    runner, rules = Runner(_NAMES, store.layout.cache), rule_sets.seventeen()
    begin, cpu = time.perf_counter(), time.process_time()
    full = runner.run(store, rules)
    figures: dict[str, Any] = {"asserted": size, "inferred": full.inferred}
    figures["full run"] = {"seconds": time.perf_counter() - begin, "cpu": time.process_time() - cpu}
    before = _inferred(store)
    together = lines[size // 2 : size // 2 + size // 100]
    one = [line for line in lines if b"connectsTo" in line][-1:]
    _change(store, runner, rules, one, b"")
    _change(store, runner, rules, [], b"".join(one))
    for name, gone in (("one triple", one), ("1 % together", together), ("1 % scattered", lines[100::100])):
        figures[f"{name}, out"] = _change(store, runner, rules, gone, b"")
        figures[f"{name}, in"] = _change(store, runner, rules, [], b"".join(gone))
    figures["same triples"] = _inferred(store) == before
    for name, value in figures.items():
        print(f"{name:20} {_shown(value)}")
    return figures


def _change(store: EmbeddedStore, runner: Runner, rules: Any, gone: list[bytes], come: bytes) -> dict[str, float]:
    begin = time.perf_counter()
    with store.write("benchmark") as transaction:
        transaction.patch_graph(_SOURCE, b"".join(gone), come)
        patched, cpu = time.perf_counter(), time.process_time()
        report = runner.run_within(transaction, rules)
        applied, cpu = time.perf_counter(), time.process_time() - cpu
    committed = time.perf_counter()
    runner.remember(store.layout.current())
    return {
        "apply": applied - patched,
        "cpu": cpu,
        "of it reading": report.seconds.read,
        "of it evaluating": report.seconds.evaluate,
        "of it writing": report.seconds.write,
        "transaction": patched - begin + committed - applied,
        "changed": report.added + report.removed,
    }


def _shown(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {figure:.4g}" for name, figure in value.items())
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _inferred(store: EmbeddedStore) -> bytes:
    with store.read() as snapshot:
        return snapshot.dump(RdfFormat.N_TRIPLES, graph=_NAMES.inferred)
