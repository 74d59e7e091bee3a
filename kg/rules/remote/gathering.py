"""The asserted triples in one graph: the only one of the server, or a copy from several of what rules read."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, serialize

from kg.rules.form import EngineBlock, is_auxiliary, readers_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleSet
    from kg.rules.remote.graphs import Graphs
    from kg.store.remote import RemoteSnapshot, RemoteStore

_ANY: Final = "?s ?p ?o"
_OF_VIRTUOSO: Final = (
    "<http://www.openlinksw.com/schemas/virtrdf#>",
    "<http://localuriqaserver/sparql>",
    "<http://www.w3.org/ns/ldp#>",
)
"""Graphs of each of its databases, where its settings and vocabularies stand."""


@dataclass(frozen=True, slots=True)
class Sources:
    """The graphs of asserted triples: named ones, by a condition on `?g`, and perhaps the default graph."""

    named: tuple[NamedNode, ...]
    condition: str
    default: bool

    @classmethod
    def chosen(cls, graphs: Sequence[NamedNode | DefaultGraph]) -> Sources:
        """Return the graphs that somebody named."""
        named = tuple(graph for graph in graphs if isinstance(graph, NamedNode))
        return cls(named, f"?g IN ({', '.join(map(str, named))})", len(named) < len(graphs))

    @classmethod
    def all_but(cls, inferred: NamedNode, snapshot: RemoteSnapshot) -> Sources:
        """Return all graphs but `inferred`, what is below it, its sibling `builds`, and those of the server's own."""
        builds = f"<{inferred.value.rpartition('/')[0]}/builds>"
        left = ", ".join([str(inferred), builds, *_OF_VIRTUOSO])
        condition = f'?g NOT IN ({left}) && !STRSTARTS(STR(?g), "{inferred.value}/")'
        asked = f"SELECT DISTINCT ?g WHERE {{ GRAPH ?g {{ {_ANY} }} FILTER({condition}) }}"
        named = (row["g"] for row in snapshot.rows(asked))
        return cls(tuple(graph for graph in named if isinstance(graph, NamedNode)), condition, default=True)


def gather(store: RemoteStore, graphs: Graphs, sources: Sources, rule_set: RuleSet) -> Graphs:
    """Make the asserted graph, with what rule files state, and return `graphs` with its name.

    A single named graph is read where it is. Otherwise the triples whose predicates rules read or write are copied.

    Raises:
        StoreError: KG225 when the server fails.
    """
    apart = _default_pattern(store, graphs) if sources.default else None
    if len(sources.named) == 1 and not apart and not rule_set.data:
        return replace(graphs, asserted=sources.named[0])
    predicates = predicates_of(rule_set)
    shapes = [_ANY] if predicates is None else [f"?s {name} ?o" for name in sorted(map(str, predicates))]
    patterns = [f"GRAPH ?g {{ {shape} }} FILTER({sources.condition})" for shape in shapes if sources.named]
    copies = [_copy(graphs, shape, pattern) for shape, pattern in zip(shapes, patterns, strict=False)]
    if apart:
        copies += [_copy(graphs, shape, apart.replace(_ANY, shape)) for shape in shapes]
    if operations := [*copies, *_stated(graphs, rule_set)]:
        store.update(" ;\n".join(operations))
    return graphs


def _copy(graphs: Graphs, shape: str, pattern: str) -> str:
    return f"INSERT {{ GRAPH {graphs.asserted} {{ {shape} }} }} WHERE {{ {pattern} }}"


def _default_pattern(store: RemoteStore, graphs: Graphs) -> str | None:
    """Return the pattern for what is in the default graph, None when it is empty.

    On some servers the default graph of a query is the union of all. A probe detects this; then only
    triples that no named graph has are known to be in the default graph.
    """
    probe = f"{graphs.stated} {graphs.stated} {graphs.stated}"
    store.update(f"INSERT DATA {{ GRAPH {graphs.stated} {{ {probe} }} }}")
    snapshot = store.read()
    union = _some(snapshot, probe)
    store.update(f"DROP SILENT GRAPH {graphs.stated}")
    pattern = f"{_ANY} FILTER NOT EXISTS {{ GRAPH ?g {{ {_ANY} }} }}" if union else _ANY
    return pattern if _some(snapshot, pattern) else None


def _some(snapshot: RemoteSnapshot, pattern: str) -> bool:
    """Return whether a pattern has a solution; to ASK, Virtuoso answers with a row."""
    return next(iter(snapshot.rows(f"SELECT * WHERE {{ {pattern} }} LIMIT 1")), None) is not None


def _stated(graphs: Graphs, rule_set: RuleSet) -> Iterator[str]:
    """Add what rule files state to the asserted graph, and keep what nothing else asserts in a graph of its own."""
    if not rule_set.data:
        return
    triples = (serialize(rule_set.data, format=RdfFormat.N_TRIPLES) or b"").decode()
    stated, asserted = f"GRAPH {graphs.stated} {{ {_ANY} }}", f"GRAPH {graphs.asserted} {{ {_ANY} }}"
    yield f"INSERT DATA {{ GRAPH {graphs.stated} {{\n{triples}}} }}"
    yield f"DELETE {{ {stated} }} WHERE {{ {stated} {asserted} }}"
    yield f"INSERT {{ {asserted} }} WHERE {{ {stated} }}"


def predicates_of(rule_set: RuleSet) -> frozenset[NamedNode] | None:
    """Return the predicates that rules read, write or state, None when they may be any."""
    found: set[NamedNode] = set()
    heads = (atom for rule in rule_set.rules for atom in rule.head)
    for part in [*heads, *(part for rule in rule_set.rules for part, _ in readers_of(rule.body))]:
        if isinstance(part, EngineBlock):
            if part.reads is None:
                return None
            found |= part.reads
        elif not isinstance(part.predicate, NamedNode):
            return None
        elif not is_auxiliary(part.predicate):
            found.add(part.predicate)
    return frozenset(found.union(triple.predicate for triple in rule_set.data))
