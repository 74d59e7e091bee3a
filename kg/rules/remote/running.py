"""Runs a rule set on a server by SPARQL updates, stratum by stratum, each to its fixpoint by semi-naive rounds.

The graph of inferred triples changes only in the last request, so a failure before leaves it unchanged. Blank nodes in
heads are created by the server, with labels that differ in each run.

The asserted triples are in one graph: the server's only one, or a copy of the parts of several that rules read. A run
has these temporary graphs:

    <inferred>/delta-3f2a/asserted      asserted triples, without duplicates
    <inferred>/delta-3f2a/derived       derived triples so far; becomes <inferred> at the end
    <inferred>/delta-3f2a/new           results of rules in this round, known or not
    <inferred>/delta-3f2a/delta         new triples of the last round
    <inferred>/delta-3f2a/auxiliary...  the last three for predicates that decomposition introduced
    <inferred>/delta-3f2a/stated        triples that only rule files state

`asserted` and `derived` are disjoint, so rules that read both see each triple once: servers differ on duplicates in two
graphs, and aggregates would count them twice. Auxiliary triples have separate graphs, since a variable predicate must
not match them.
"""

from __future__ import annotations

import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final
from uuid import uuid4

from pyoxigraph import DefaultGraph, NamedNode, RdfFormat, serialize

from kg.errors import StoreError
from kg.rules import form
from kg.rules.columns import wanted
from kg.rules.dependencies import depends, reads
from kg.rules.engine.limits import Clock, Limits
from kg.rules.sparql import Placed, distinct_solutions, group, triple
from kg.rules.stratify import Stratum, stratify
from kg.store.remote import SYSTEM_GRAPHS, RemoteSnapshot, RemoteStore

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kg.rules.files import RuleSet

_GRACE_SECONDS: Final = 2.0
"""Seconds for a server to finish the current update after the deadline, before the clean-up."""

_ANY: Final = "?s ?p ?o"


@dataclass(frozen=True, slots=True)
class Channel:
    """The graphs for one kind of triple: all derived ones, those of this round, and the new ones of the last."""

    derived: NamedNode
    new: NamedNode
    delta: NamedNode


@dataclass(frozen=True, slots=True)
class Graphs:
    """The graphs of one run; `asserted` is one of the server's own if it has a single one."""

    prefix: str
    asserted: NamedNode
    stated: NamedNode
    plain: Channel
    auxiliary: Channel

    @classmethod
    def below(cls, inferred: NamedNode) -> Graphs:
        """Return unused names of graphs."""
        prefix = f"{inferred.value}/delta-{uuid4().hex[:8]}/"

        def named(name: str) -> NamedNode:
            return NamedNode(prefix + name)

        def channel(start: str) -> Channel:
            return Channel(named(f"{start}derived"), named(f"{start}new"), named(f"{start}delta"))

        return cls(prefix, named("asserted"), named("stated"), channel(""), channel("auxiliary-"))

    @property
    def channels(self) -> tuple[Channel, Channel]:
        """The channels of plain and of auxiliary triples."""
        return self.plain, self.auxiliary

    def channel(self, predicate: form.Pattern) -> Channel:
        """Return the channel for triples of a predicate."""
        return self.auxiliary if form.is_auxiliary(predicate) else self.plain

    @property
    def temporary(self) -> list[NamedNode]:
        """All temporary graphs of the run."""
        graphs = [graph for each in self.channels for graph in (each.derived, each.new, each.delta)]
        return [*graphs, self.stated, NamedNode(self.prefix + "asserted")]


def first_update(rule: form.Rule, graphs: Graphs) -> str:
    """Return the update that applies a rule to all data."""
    return _insert(rule, [_placed(rule.body, graphs)], graphs)


def next_update(rule: form.Rule, stratum: Stratum, graphs: Graphs) -> str | None:
    """Return the update that applies a rule to the delta of the last round, None if it does not read any.

    For each atom that a rule of the stratum feeds, one variant takes that atom from the delta. A block of SPARQL cannot
    be split, so a rule with a fed block is applied to everything.
    """
    heads = [head for other in stratum.rules for head in other.head]
    blocks = replace(
        rule, body=tuple(each for each, _ in form.readers_of(rule.body) if isinstance(each, form.EngineBlock))
    )
    if any(depends(read.atom, head) for read in reads(blocks) for head in heads):
        return first_update(rule, graphs)
    variants = list(_variants(rule.body, heads, graphs))
    return _insert(rule, variants, graphs) if variants else None


def _insert(rule: form.Rule, bodies: Sequence[tuple[form.Element, ...]], graphs: Graphs) -> str:
    head = " ".join(f"GRAPH {graphs.channel(atom.predicate).new} {{ {triple(atom)} }}" for atom in rule.head)
    groups = [group(body) for body in bodies]
    where = groups[0] if len(groups) == 1 else "\nUNION\n".join(f"{{\n{text}\n}}" for text in groups)
    if rule.creates_nodes:
        # Each solution gives one blank node, however many variants find it.
        where = f"{{ {distinct_solutions(rule)} {{\n{where}\n}} }}"
    read = (graphs.asserted, graphs.plain.derived)
    placed = (graphs.asserted, graphs.plain.delta, graphs.auxiliary.derived, graphs.auxiliary.delta)
    using = [*(f"USING {graph}" for graph in read), *(f"USING NAMED {graph}" for graph in placed)]
    return f"INSERT {{ {head} }}\n{' '.join(using)}\nWHERE {{\n{where}\n}}"


def _placed(body: Sequence[form.Element], graphs: Graphs) -> tuple[form.Element, ...]:
    """Return a body whose atoms on asserted data and auxiliary predicates name their graphs."""
    result: list[form.Element] = []
    for element in body:
        if isinstance(element, form.Exists | form.Aggregate):
            result.append(replace(element, body=_placed(element.body, graphs)))
        elif not isinstance(element, form.Atom) or isinstance(element, Placed):
            result.append(element)
        elif form.is_auxiliary(element.predicate):
            result.append(_at(element, graphs.auxiliary.derived))
        else:
            result.append(_at(element, graphs.asserted) if element.asserted else element)
    return tuple(result)


def _at(atom: form.Atom, graph: NamedNode) -> Placed:
    return Placed(*atom.positions, asserted=atom.asserted, place=atom.place, graph=graph)


def _variants(
    body: tuple[form.Element, ...], heads: Sequence[form.Atom], graphs: Graphs
) -> Iterator[tuple[form.Element, ...]]:
    """Yield a variant of a body for each of its atoms that `heads` feed, with that atom read from the delta."""
    for index, element in enumerate(body):
        before, behind = body[:index], body[index + 1 :]
        if isinstance(element, form.Atom) and not element.asserted and any(depends(element, head) for head in heads):
            atom = _at(element, graphs.channel(element.predicate).delta)
            # The delta is small, and some servers join from left to right.
            moved = (atom, *before, *behind) if _may_lead(atom, before) else (*before, atom, *behind)
            yield _placed(moved, graphs)
        elif isinstance(element, form.Exists) and not element.negated:
            for inner in _variants(element.body, heads, graphs):
                yield _placed((*before, form.Exists(inner), *behind), graphs)


def _may_lead(atom: form.Atom, before: Sequence[form.Element]) -> bool:
    """Return whether an atom may move before the elements in front of it, which then use its bindings."""
    bound = form.binds(atom)
    seen = frozenset[object]()
    for element in before:
        if isinstance(element, form.Filter | form.Exists) and form.mentions(element) & bound - seen:
            return False
        if isinstance(element, form.Assignment) and element.variable in bound:
            return False
        seen |= form.binds(element)
    return True


@dataclass(frozen=True, slots=True)
class Sources:
    """The graphs of asserted triples: named ones, by a condition on `?g`, and possibly the default graph."""

    named: tuple[NamedNode, ...]
    condition: str
    default: bool

    @classmethod
    def chosen(cls, graphs: Sequence[NamedNode | DefaultGraph]) -> Sources:
        """Return the named graphs as sources."""
        named = tuple(graph for graph in graphs if isinstance(graph, NamedNode))
        return cls(named, f"?g IN ({', '.join(map(str, named))})", len(named) < len(graphs))

    @classmethod
    def all_but(cls, inferred: NamedNode, snapshot: RemoteSnapshot) -> Sources:
        """Return all graphs but `inferred`, those below it, its sibling `builds`, and the server's system graphs."""
        builds = f"<{inferred.value.rpartition('/')[0]}/builds>"
        left = ", ".join([str(inferred), builds, *map(str, SYSTEM_GRAPHS)])
        condition = f'?g NOT IN ({left}) && !STRSTARTS(STR(?g), "{inferred.value}/")'
        # Grouped, since Virtuoso 7 needs seconds for SELECT DISTINCT.
        query = f"SELECT ?g WHERE {{ GRAPH ?g {{ {_ANY} }} FILTER({condition}) }} GROUP BY ?g"
        named = (row["g"] for row in snapshot.rows(query))
        return cls(tuple(graph for graph in named if isinstance(graph, NamedNode)), condition, default=True)


def gather(store: RemoteStore, graphs: Graphs, sources: Sources, rule_set: RuleSet) -> Graphs:
    """Create the asserted graph, including triples that rule files state, and return `graphs` with its name.

    A single named graph is read in place. Otherwise triples are copied whose predicates rules read or write.

    Raises StoreError: KG225 the server failed.
    """
    apart = _default_pattern(store, graphs) if sources.default else None
    if len(sources.named) == 1 and not apart and not rule_set.data:
        return replace(graphs, asserted=sources.named[0])
    what = wanted(rule_set.rules)
    names = what.names.union(triple.predicate for triple in rule_set.data)
    shapes = [_ANY] if what.predicates is None else [f"?s {name} ?o" for name in sorted(map(str, names))]
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
    """Return the pattern of the default graph, None if it is empty.

    On some servers the default graph of a query is the union of all. A probe detects this; then only triples in no
    named graph are known to be in the default graph.
    """
    probe = f"{graphs.stated} {graphs.stated} {graphs.stated}"
    store.update(f"INSERT DATA {{ GRAPH {graphs.stated} {{ {probe} }} }}")
    snapshot = store.read()
    union = _some(snapshot, probe)
    store.update(f"DROP SILENT GRAPH {graphs.stated}")
    pattern = f"{_ANY} FILTER NOT EXISTS {{ GRAPH ?g {{ {_ANY} }} }}" if union else _ANY
    return pattern if _some(snapshot, pattern) else None


def _some(snapshot: RemoteSnapshot, pattern: str) -> bool:
    """Return whether a pattern has a solution; Virtuoso answers ASK with a row."""
    return next(iter(snapshot.rows(f"SELECT * WHERE {{ {pattern} }} LIMIT 1")), None) is not None


def _stated(graphs: Graphs, rule_set: RuleSet) -> Iterator[str]:
    """Add triples stated by rule files to the asserted graph; those not asserted elsewhere also to their own."""
    if not rule_set.data:
        return
    triples = (serialize(rule_set.data, format=RdfFormat.N_TRIPLES) or b"").decode()
    stated, asserted = f"GRAPH {graphs.stated} {{ {_ANY} }}", f"GRAPH {graphs.asserted} {{ {_ANY} }}"
    yield f"INSERT DATA {{ GRAPH {graphs.stated} {{\n{triples}}} }}"
    yield f"DELETE {{ {stated} }} WHERE {{ {stated} {asserted} }}"
    yield f"INSERT {{ {asserted} }} WHERE {{ {stated} }}"


@dataclass(frozen=True, slots=True)
class StratumReport:
    """The results of a stratum's rules that run together: their names, rounds, and added triples.

    `derived` includes auxiliary triples; `number` is that of the stratum, which may have several such groups.
    """

    number: int
    rules: tuple[str, ...]
    rounds: int
    derived: int
    seconds: float


@dataclass(frozen=True, slots=True)
class RemoteReport:
    """The results of a run: the number of inferred triples in the graph, and the time."""

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
    """Replace the content of `inferred_graph` on the server by the triples inferred from the asserted graphs.

    The default `asserted_graphs` are all but `inferred_graph`, graphs below it, and its sibling `builds`. Runs must not
    overlap: the last one to finish determines the result.

    Raises:
        RuleError: KG202 and KG204 as `stratify`, KG205 a limit is reached, KG209 a blank node of the data in a body,
            which SPARQL cannot express.
        StoreError: KG225 the server failed.
    """
    limits = limits or Limits()
    began = time.monotonic()
    strata = stratify(rule_set.rules, bounded=limits.bounded)
    graphs = Graphs.below(inferred_graph)
    with _dropped_at_the_end(store, graphs):
        chosen = Sources.chosen(asserted_graphs) if asserted_graphs else Sources.all_but(inferred_graph, store.read())
        progress = _Run(store, gather(store, graphs, chosen, rule_set), limits)
        reports = tuple(progress.stratum(stratum) for stratum in strata)
        derived, stated, target = (
            f"GRAPH {graph} {{ ?s ?p ?o }}" for graph in (graphs.plain.derived, graphs.stated, inferred_graph)
        )
        store.update(
            f"DROP SILENT GRAPH {inferred_graph} ;\n"
            f"INSERT {{ {target} }} WHERE {{ {{ {derived} }} UNION {{ {stated} }} }}"
        )
        count = store.read().count(inferred_graph)
    return RemoteReport(count, time.monotonic() - began, reports)


@contextmanager
def _dropped_at_the_end(store: RemoteStore, graphs: Graphs) -> Iterator[None]:
    """Drop the temporary graphs after the body; a failure of the body takes precedence."""
    drop = " ;\n".join(f"DROP SILENT GRAPH {graph}" for graph in graphs.temporary)
    try:
        yield
    except BaseException:
        with suppress(StoreError):
            store.update(drop)
        raise
    store.update(drop)


class _Run:
    """The state of one run: its graphs are on the server, its counts of triples here."""

    def __init__(self, store: RemoteStore, graphs: Graphs, limits: Limits) -> None:
        self._store = store
        self._graphs = graphs
        self._clock = Clock(limits)
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
        """Apply rules and return the number of new triples, which are the next delta."""
        self._clock.round = number
        for self._clock.rule, update in updates.items():
            self._update(update)
        self._update(" ;\n".join(_advance(channel, self._graphs) for channel in channels))
        counts = {channel: self._store.read().count(channel.delta) for channel in channels}
        self._inferred += counts.get(self._graphs.plain, 0)
        self._clock.check(self._inferred)
        return sum(counts.values())

    def _update(self, text: str) -> None:
        """Run an update within the remaining time plus a grace period; StoreError KG225 without an answer."""
        self._clock.check(self._inferred)
        left = self._clock.left
        try:
            self._store.update(text, timeout=None if left is None else left + _GRACE_SECONDS)
        except StoreError:
            self._clock.check(self._inferred)
            raise


def _advance(channel: Channel, graphs: Graphs) -> str:
    """Return the operations that make the new triples of this round the delta, and add them to the derived ones."""
    new, delta, derived, asserted = (
        f"GRAPH {graph} {{ ?s ?p ?o }}" for graph in (channel.new, channel.delta, channel.derived, graphs.asserted)
    )
    absent = f"FILTER NOT EXISTS {{ {asserted} }} FILTER NOT EXISTS {{ {derived} }}"
    return " ;\n".join(
        [
            f"DROP SILENT GRAPH {channel.delta}",
            f"INSERT {{ {delta} }} WHERE {{ {new} {absent} }}",
            f"INSERT {{ {derived} }} WHERE {{ {delta} }}",
            f"DROP SILENT GRAPH {channel.new}",
        ]
    )
