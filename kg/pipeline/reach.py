"""Decide whether a change can reach any rule, from the names that rules mention.

Most small changes reach none. Then the inferences stay as they are, and neither rules nor columns are loaded, which
takes most of the time of such a change.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from pyoxigraph import NamedNode, RdfFormat, Triple, parse

from kg.rules.dependencies import pattern
from kg.rules.specialise import is_schema

if TYPE_CHECKING:
    from collections.abc import Set as AbstractSet

    from kg.rules.recording import Names
    from kg.store.changes import Changes
    from kg.store.transaction import EmbeddedTransaction


def newly_asserted(transaction: EmbeddedTransaction, names: Names, patterns: AbstractSet[str]) -> int | None:
    """Return by how many the asserted triples grew in a transaction whose changes no rule reads or derives.

    `patterns` are those of the rules (`kg.rules.dependencies.patterns`). None if a rule may be reached, or if the
    changes are unknown; if the schema changed, the rules themselves are others.
    """
    changed = _net(transaction.changes, names)
    if changed is None or not all(_beyond(triple, patterns) for triple in changed):
        return None
    return sum(_growth(transaction, names, triple, graphs) for triple, graphs in changed.items())


def _net(changes: Changes, names: Names) -> dict[Triple, dict[str, bool]] | None:
    """Return for each changed triple the graphs, each with whether it was there before; None if unknown."""
    net: defaultdict[Triple, dict[str, bool]] = defaultdict(dict)
    if changes.graphs is None or names.inferred.value in changes.graphs:
        return None
    for graph, patches in changes.graphs.items():
        if graph == names.builds.value:
            continue
        if patches is None:
            return None
        for patch in patches:
            for lines, there in zip(patch, (True, False), strict=True):
                for quad in parse(lines, RdfFormat.N_TRIPLES):
                    net[quad.triple].setdefault(graph, there)
    return net


def _beyond(triple: Triple, patterns: AbstractSet[str]) -> bool:
    """Return whether no rule reads or derives a triple."""
    predicate, value = triple.predicate, triple.object
    if is_schema(predicate, value):
        return False
    return patterns.isdisjoint({pattern(None, None), pattern(predicate, None), pattern(predicate, value)})


def _growth(transaction: EmbeddedTransaction, names: Names, triple: Triple, graphs: dict[str, bool]) -> int:
    """Return 1 if any graph that rules read has a triple now and none had it before, -1 for the reverse, else 0."""
    now = {
        graph.value if isinstance(graph := quad.graph_name, NamedNode) else ""
        for quad in transaction.copies(triple)
        if quad.graph_name not in {names.inferred, names.builds}
    }
    before = (now - graphs.keys()) | {graph for graph, there in graphs.items() if there}
    return bool(now) - bool(before)
