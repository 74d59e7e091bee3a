"""Queries of ancestors on demand, beside a run of the rules that writes the whole closure.

The graphs are a tree in which each node has any of the nodes before it as its parent, and a chain of a tenth of its
edges. The queries ask for
the ancestors of one node, and for the nodes that have it as their ancestor; the engine's own path answers the same.
"""

from __future__ import annotations

import random
import time
from statistics import median
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from pathlib import Path

    from kg.rules.files import RuleSet
    from kg.store.embedded import EmbeddedStore

__all__ = ["measure", "query"]

_BASE: Final = "urn:benchmark:"
_PARENT: Final = f"<{_BASE}parent>"
_ANCESTOR: Final = f"<{_BASE}ancestor>"
_FORMS: Final = {
    "right": f"?x {_PARENT} ?y . ?y {_ANCESTOR} ?z",
    "left": f"?x {_ANCESTOR} ?y . ?y {_PARENT} ?z",
    "double": f"?x {_ANCESTOR} ?y . ?y {_ANCESTOR} ?z",
}
_QUERIES: Final = 10


def measure(edges: int, folder: Path) -> dict[str, Any]:
    """Measure graphs of so many edges, print, and return the processor seconds."""
    chance = random.Random(edges)  # noqa: S311 - to be the same each time, not to be secret
    tree = [(number, chance.randrange(number)) for number in range(1, edges + 1)]
    length = edges // 10
    chain = [(number, number - 1) for number in range(1, length + 1)]
    nodes = [chance.randrange(1, edges) for _ in range(_QUERIES)]
    found: dict[str, Any] = {"edges": edges}
    stored = _store(folder / "tree", tree)
    for name, step in _FORMS.items():
        rules = _rules(folder / name, step)
        found[f"tree, {name}"] = _queries(f"tree, {name}", stored, rules, nodes, folder / name)
    found["tree, run"] = _run(stored, _rules(folder / "right", _FORMS["right"]))
    stored = _store(folder / "chain", chain)
    for name, step in _FORMS.items():
        rules = _rules(folder / name, step)
        found[f"chain, {name}"] = _queries(f"chain, {name}", stored, rules, [length // 100], folder / f"chain {name}")
    return found


def _store(folder: Path, pairs: list[tuple[int, int]]) -> EmbeddedStore:
    from pyoxigraph import NamedNode  # noqa: PLC0415 - each engine loads its own

    from kg.store.embedded import EmbeddedStore  # noqa: PLC0415 - each engine loads its own

    folder.mkdir()
    store = EmbeddedStore.create(folder / ".kg")
    lines = "".join(f"<urn:n{one}> {_PARENT} <urn:n{other}> .\n" for one, other in pairs)
    with store.write("benchmark") as transaction:
        transaction.replace_graphs({NamedNode("urn:graph"): [lines.encode()]})
    return store


def _rules(folder: Path, step: str) -> RuleSet:
    from kg.rules.reading import discover  # noqa: PLC0415 - each engine loads its own

    folder.mkdir(exist_ok=True)
    for name, body in (("exit", f"?x {_PARENT} ?z"), ("step", step)):
        (folder / f"{name}.rq").write_text(f"# {name}\n\nCONSTRUCT {{ ?x {_ANCESTOR} ?z }} WHERE {{ {body} }}\n")
    return discover([folder])


def _queries(name: str, store: EmbeddedStore, rules: RuleSet, nodes: list[int], cache: Path) -> dict[str, Any]:
    """Measure queries for either end of each node; the first one reads the store, the others what it kept."""
    rows: dict[str, list[float]] = {}
    answers = 0
    for node in nodes:
        for kind, pattern in (
            ("ancestors", f"<urn:n{node}> {_ANCESTOR} ?x"),
            ("below", f"?x {_ANCESTOR} <urn:n{node}>"),
        ):
            seconds, found = query(store, rules, pattern, cache)
            expected = _count(store, pattern.replace(_ANCESTOR, f"{_PARENT}+"))
            if found != expected:
                raise SystemExit(f"{name}: {found} answers to {pattern}, and {expected} by a path")
            rows.setdefault(kind if rows else "first", []).append(seconds)
            answers += found
    figures = {kind: {"median": median(times), "most": max(times)} for kind, times in rows.items()}
    words = ", ".join(f"{kind} {each['median']:.3f} s (most {each['most']:.3f})" for kind, each in figures.items())
    print(f"{name}: {answers:,} answers; {words}", flush=True)
    return {"answers": answers, **figures}


def query(store: EmbeddedStore, rules: RuleSet, pattern: str, cache: Path) -> tuple[float, int]:
    """Return the processor seconds of one query on demand, with its copy of the store, and its number of answers."""
    from kg.query.core import run  # noqa: PLC0415 - each engine loads its own
    from kg.rules.demand.deriving import Base, derive  # noqa: PLC0415 - each engine loads its own
    from kg.rules.engine.limits import Limits  # noqa: PLC0415 - each engine loads its own
    from kg.rules.recording import Names  # noqa: PLC0415 - each engine loads its own
    from kg.store.overlay import overlaid  # noqa: PLC0415 - each engine loads its own

    begin = time.process_time()
    names, text = Names.of(_BASE, _BASE), f"SELECT ?x {{ {pattern} }}"
    with store.read() as snapshot:
        base = Base.of(rules, snapshot, snapshot.generation, names, cache)
        derived = derive(text, rules, base, Limits())
        with overlaid(snapshot, names.inferred, derived.chunks(), store.layout.cache) as extended:
            result: Any = run(extended, text)
    return time.process_time() - begin, len(result.rows)


def _count(store: EmbeddedStore, pattern: str) -> int:
    from kg.query.core import run  # noqa: PLC0415 - each engine loads its own

    with store.read() as snapshot:
        result: Any = run(snapshot, f"SELECT ?x {{ {pattern} }}")
    return len(result.rows)


def _run(store: EmbeddedStore, rules: RuleSet) -> dict[str, Any]:
    """Return the processor seconds of a run that writes everything into the store."""
    from kg.rules.recording import Names  # noqa: PLC0415 - each engine loads its own
    from kg.rules.running import Runner  # noqa: PLC0415 - each engine loads its own

    begin = time.process_time()
    report = Runner(Names.of(_BASE, _BASE), store.layout.cache).run(store, rules)
    seconds = time.process_time() - begin
    print(f"tree, a run: {report.inferred:,} triples inferred and written in {seconds:.2f} s", flush=True)
    return {"inferred": report.inferred, "seconds": seconds}
