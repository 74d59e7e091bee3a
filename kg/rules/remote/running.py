"""Runs a rule set on a server, stratum by stratum, each to its fixpoint by rounds on what the last one added.

The graph of inferred triples changes in the last request only: whatever fails before leaves it as it was. Blank nodes
in heads are made by the server: they differ from run to run, and from those of the embedded engine, in their labels.
"""

from __future__ import annotations

import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.errors import StoreError
from kg.rules.engine.limits import Clock, Limits
from kg.rules.remote.gathering import Sources, gather
from kg.rules.remote.graphs import Graphs
from kg.rules.remote.updates import first_update, next_update
from kg.rules.stratify import stratify

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from pyoxigraph import DefaultGraph, NamedNode

    from kg.rules.files import RuleSet
    from kg.rules.remote.graphs import Channel
    from kg.rules.stratify import Stratum
    from kg.store.remote import RemoteStore

_GRACE_SECONDS: Final = 2.0
"""How long a server has behind the deadline for the update that it is at, which else might come after the clean-up."""


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
