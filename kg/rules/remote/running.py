"""Runs a rule set on a server, stratum by stratum, each to its fixpoint by rounds on what the last one added.

The graph of inferred triples changes in the last request only: whatever fails before leaves it as it was. Blank nodes
in heads are made by the server: they differ from run to run, and from those of the embedded engine, in their labels.

The asserted triples in one graph: the only one of the server, or a copy from several of what rules read.

The temporary graphs of one run on a server.

    <inferred>/delta-3f2a/asserted      what rules read as asserted, each triple once
    <inferred>/delta-3f2a/derived       what was derived so far; becomes <inferred> at the end
    <inferred>/delta-3f2a/new           what rules gave in this round, known or not
    <inferred>/delta-3f2a/delta         what was new in the last round
    <inferred>/delta-3f2a/auxiliary...  the last three for predicates that decomposition introduced
    <inferred>/delta-3f2a/stated        triples that rule files state and nothing else asserts

`asserted` and `derived` share nothing, so rules that read both meet each triple once: what a server makes of a triple
that two graphs have differs, and aggregates would count it twice. Auxiliary triples have graphs of their own, for a
variable in the place of a predicate must not match them.

A rule as an update that adds its derivations to the graph of new triples, from all data or from a delta.
"""

from __future__ import annotations

import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final
from uuid import uuid4

from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, serialize

from kg.errors import StoreError
from kg.rules.dependencies import depends, reads, writes
from kg.rules.engine.limits import Clock, Limits
from kg.rules.form import (
    Aggregate,
    Assignment,
    Atom,
    Element,
    EngineBlock,
    Exists,
    Filter,
    Pattern,
    Rule,
    binds,
    bound_in,
    has_blank,
    is_auxiliary,
    mentions,
    readers_of,
)
from kg.rules.sparql import Placed, group, spelling, triple
from kg.rules.stratify import Stratum, stratify

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleSet
    from kg.store.remote import RemoteSnapshot, RemoteStore

_GRACE_SECONDS: Final = 2.0
"""How long a server has behind the deadline for the update that it is at, which else might come after the clean-up."""

_ANY: Final = "?s ?p ?o"
_OF_VIRTUOSO: Final = (
    "<http://www.openlinksw.com/schemas/virtrdf#>",
    "<http://localuriqaserver/sparql>",
    "<http://www.w3.org/ns/ldp#>",
)
"""Graphs of each of its databases, where its settings and vocabularies stand."""


@dataclass(frozen=True, slots=True)
class Channel:
    """Where triples of one kind go: all that were derived, those of this round, and the new ones of the last."""

    derived: NamedNode
    new: NamedNode
    delta: NamedNode


@dataclass(frozen=True, slots=True)
class Graphs:
    """The graphs of one run; `asserted` is one of the server's own where it has a single one."""

    prefix: str
    asserted: NamedNode
    stated: NamedNode
    plain: Channel
    auxiliary: Channel

    @classmethod
    def below(cls, inferred: NamedNode) -> Graphs:
        """Return names that no other run has."""
        prefix = f"{inferred.value}/delta-{uuid4().hex[:8]}/"

        def named(name: str) -> NamedNode:
            return NamedNode(prefix + name)

        def channel(start: str) -> Channel:
            return Channel(named(f"{start}derived"), named(f"{start}new"), named(f"{start}delta"))

        return cls(prefix, named("asserted"), named("stated"), channel(""), channel("auxiliary-"))

    @property
    def channels(self) -> tuple[Channel, Channel]:
        """That of plain triples and that of auxiliary ones."""
        return self.plain, self.auxiliary

    def channel(self, predicate: Pattern) -> Channel:
        """Return where triples of a predicate go."""
        return self.auxiliary if is_auxiliary(predicate) else self.plain

    @property
    def temporary(self) -> list[NamedNode]:
        """All graphs that the run makes."""
        made = [graph for each in self.channels for graph in (each.derived, each.new, each.delta)]
        return [*made, self.stated, NamedNode(self.prefix + "asserted")]


def first_update(rule: Rule, graphs: Graphs) -> str:
    """Return the update that applies a rule to all data."""
    return _insert(rule, [_placed(rule.body, graphs)], graphs)


def next_update(rule: Rule, stratum: Stratum, graphs: Graphs) -> str | None:
    """Return the update that applies a rule to what is new since the last round, None for one that reads none of it.

    For each atom that a rule of the stratum feeds there is one reading in which that atom is taken from the delta. A
    block of SPARQL cannot be read so: a rule with one that the stratum feeds is applied to everything.
    """
    heads = [head for other in stratum.rules for head in writes(other)]
    if _fed_block(rule, heads):
        return first_update(rule, graphs)
    variants = list(_variants(rule.body, heads, graphs))
    return _insert(rule, variants, graphs) if variants else None


def _insert(rule: Rule, bodies: Sequence[tuple[Element, ...]], graphs: Graphs) -> str:
    head = " ".join(f"GRAPH {graphs.channel(atom.predicate).new} {{ {triple(atom)} }}" for atom in rule.head)
    groups = [group(body) for body in bodies]
    where = groups[0] if len(groups) == 1 else "\nUNION\n".join(f"{{\n{text}\n}}" for text in groups)
    if any(has_blank(position) for atom in rule.head for position in atom.positions):
        # Each solution gives one blank node, however many of the readings find it.
        names = " ".join(sorted(map(spelling, bound_in(rule.body)))) or "*"
        where = f"{{ SELECT DISTINCT {names} WHERE {{\n{where}\n}} }}"
    read = (graphs.asserted, graphs.plain.derived)
    placed = (graphs.asserted, graphs.plain.delta, graphs.auxiliary.derived, graphs.auxiliary.delta)
    using = [*(f"USING {graph}" for graph in read), *(f"USING NAMED {graph}" for graph in placed)]
    return f"INSERT {{ {head} }}\n{' '.join(using)}\nWHERE {{\n{where}\n}}"


def _placed(body: Sequence[Element], graphs: Graphs) -> tuple[Element, ...]:
    """Return a body whose atoms on asserted data and auxiliary predicates name their graphs."""
    return tuple(_placed_element(element, graphs) for element in body)


def _placed_element(element: Element, graphs: Graphs) -> Element:
    if isinstance(element, Placed):
        return element
    if isinstance(element, Atom) and is_auxiliary(element.predicate):
        return _at(element, graphs.auxiliary.derived)
    if isinstance(element, Atom) and element.asserted:
        return _at(element, graphs.asserted)
    if isinstance(element, Exists | Aggregate):
        return replace(element, body=_placed(element.body, graphs))
    return element


def _at(atom: Atom, graph: NamedNode) -> Placed:
    return Placed(*atom.positions, asserted=atom.asserted, place=atom.place, graph=graph)


def _fed_block(rule: Rule, heads: Sequence[Atom]) -> bool:
    blocks = replace(rule, body=tuple(each for each, _ in readers_of(rule.body) if isinstance(each, EngineBlock)))
    return any(depends(read.atom, head) for read in reads(blocks) for head in heads)


def _variants(body: tuple[Element, ...], heads: Sequence[Atom], graphs: Graphs) -> Iterator[tuple[Element, ...]]:
    """Yield a body once for each of its atoms that `heads` feed, with that atom read from the delta."""
    for index, element in enumerate(body):
        before, behind = body[:index], body[index + 1 :]
        if isinstance(element, Atom) and not element.asserted and any(depends(element, head) for head in heads):
            atom = _at(element, graphs.channel(element.predicate).delta)
            # The delta is small, and servers join from left to right where they know no better.
            moved = (atom, *before, *behind) if _may_lead(atom, before) else (*before, atom, *behind)
            yield _placed(moved, graphs)
        elif isinstance(element, Exists) and not element.negated:
            for inner in _variants(element.body, heads, graphs):
                yield _placed((*before, Exists(inner), *behind), graphs)


def _may_lead(atom: Atom, before: Sequence[Element]) -> bool:
    """Return whether an atom means the same in front of what is before it, which then sees what it binds."""
    bound = binds(atom)
    seen = frozenset[object]()
    for element in before:
        if isinstance(element, Filter | Exists) and mentions(element) & bound - seen:
            return False
        if isinstance(element, Assignment) and element.variable in bound:
            return False
        seen |= binds(element)
    return True


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


@dataclass(frozen=True, slots=True)
class StratumReport:
    """Results of rules of a stratum that run together: their names, rounds, the triples they added.

    `derived` counts auxiliary triples too; `number` is that of the stratum, which may have several such groups.
    """

    number: int
    rules: tuple[str, ...]
    rounds: int
    derived: int
    seconds: float


@dataclass(frozen=True, slots=True)
class RemoteReport:
    """Results of a run: the number of inferred triples in the graph, and the time it took."""

    inferred: int
    seconds: float
    strata: tuple[StratumReport, ...]


def run(
    store: RemoteStore,
    rule_set: RuleSet,
    *,
    inferred_graph: NamedNode,
    asserted_graphs: Sequence[NamedNode | DefaultGraph] | None = None,
    limits: Limits | None = None,
) -> RemoteReport:
    """Give `inferred_graph` on the server what the rules derive from the asserted graphs, and nothing else.

    Without `asserted_graphs` those are all but `inferred_graph`, graphs below it, and its sibling `builds`. One run
    at a time: two that end at once leave the triples of the later one.

    Raises:
        RuleError: KG202 and KG204 as `stratify`, KG205 when a limit is reached, KG209 for a blank node of the data
            in a body, which SPARQL cannot say.
        StoreError: KG225 when the server fails.
    """
    limits = limits or Limits()
    began = time.monotonic()
    strata = stratify(rule_set.rules, bounded=limits.bounded)
    graphs = Graphs.below(inferred_graph)
    with _dropped_at_the_end(store, graphs):
        chosen = Sources.chosen(asserted_graphs) if asserted_graphs else Sources.all_but(inferred_graph, store.read())
        progress = _Run(store, gather(store, graphs, chosen, rule_set), limits)
        reports = tuple(progress.stratum(stratum) for stratum in strata)
        derived, stated, target = (f"GRAPH {graph} {{ ?s ?p ?o }}" for graph in _results(graphs, inferred_graph))
        store.update(
            f"DROP SILENT GRAPH {inferred_graph} ;\n"
            f"INSERT {{ {target} }} WHERE {{ {{ {derived} }} UNION {{ {stated} }} }}"
        )
        count = store.read().count(inferred_graph)
    return RemoteReport(count, time.monotonic() - began, reports)


def _results(graphs: Graphs, inferred: NamedNode) -> tuple[NamedNode, NamedNode, NamedNode]:
    return graphs.plain.derived, graphs.stated, inferred


@contextmanager
def _dropped_at_the_end(store: RemoteStore, graphs: Graphs) -> Iterator[None]:
    """Drop the temporary graphs after the body; a failure of the body is the one reported."""
    drop = " ;\n".join(f"DROP SILENT GRAPH {graph}" for graph in graphs.temporary)
    try:
        yield
    except BaseException:
        with suppress(StoreError):
            store.update(drop)
        raise
    store.update(drop)


class _Run:
    """The state of one run: its graphs are on the server, its count of triples is here."""

    def __init__(self, store: RemoteStore, graphs: Graphs, limits: Limits) -> None:
        self._store = store
        self._graphs = graphs
        self._clock = Clock(limits)
        self._end = None if limits.deadline is None else time.monotonic() + limits.deadline
        self._inferred = 0

    def stratum(self, stratum: Stratum) -> StratumReport:
        """Run the rules of a stratum to their fixpoint."""
        began, rounds = time.monotonic(), 1
        written = {self._graphs.channel(atom.predicate): None for rule in stratum.rules for atom in rule.head}
        channels = tuple(written)
        updates = {str(rule): first_update(rule, self._graphs) for rule in stratum.rules}
        derived = added = self._round(updates, channels, rounds)
        if stratum.recursive:
            readings = ((str(rule), next_update(rule, stratum, self._graphs)) for rule in stratum.rules)
            updates = {name: update for name, update in readings if update}
        while stratum.recursive and added:
            rounds += 1
            added = self._round(updates, channels, rounds)
            derived += added
        names = tuple(map(str, stratum.rules))
        return StratumReport(stratum.level, names, rounds, derived, time.monotonic() - began)

    def _round(self, updates: dict[str, str], channels: Sequence[Channel], number: int) -> int:
        """Apply rules and return how many triples are new; those are the delta now."""
        self._clock.round = number
        for self._clock.rule, update in updates.items():
            self._update(update)
        self._update(" ;\n".join(_advance(channel, self._graphs) for channel in channels))
        counts = {channel: self._store.read().count(channel.delta) for channel in channels}
        self._inferred += counts.get(self._graphs.plain, 0)
        self._clock.check(self._inferred)
        return sum(counts.values())

    def _update(self, text: str) -> None:
        """Run an update in the time that is left, or a moment more; StoreError KG225 when the server is silent."""
        self._clock.check(self._inferred)
        left = None if self._end is None else max(self._end - time.monotonic(), 0.0) + _GRACE_SECONDS
        try:
            self._store.update(text, timeout=left)
        except StoreError:
            self._clock.check(self._inferred)
            raise


def _advance(channel: Channel, graphs: Graphs) -> str:
    """Return the operations that make the delta what is new in this round, and add it to what is derived."""
    new, delta, derived, asserted = (
        f"GRAPH {graph} {{ ?s ?p ?o }}" for graph in (channel.new, channel.delta, channel.derived, graphs.asserted)
    )
    known = f"FILTER NOT EXISTS {{ {asserted} }} FILTER NOT EXISTS {{ {derived} }}"
    return " ;\n".join(
        [
            f"DROP SILENT GRAPH {channel.delta}",
            f"INSERT {{ {delta} }} WHERE {{ {new} {known} }}",
            f"INSERT {{ {derived} }} WHERE {{ {delta} }}",
            f"DROP SILENT GRAPH {channel.new}",
        ]
    )
