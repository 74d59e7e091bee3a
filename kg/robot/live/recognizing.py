"""Matching of running nodes to node types of a store, by name and interface.

A name alone is weak evidence (any robot has a `driver`), and so is an interface of one topic. So a node type of the
same name is accepted if it declares at least half of the node's interface. One of another name must declare all of it,
under the same names, and at least two ends. If several fit equally, none is accepted.
"""

from __future__ import annotations

import re
from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from pyoxigraph import Literal, NamedNode

from kg.graph.iris import Iris
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.names import resolve
from kg.query.stored import internal
from kg.robot.live.systems import Match, is_implicit
from kg.syntax.names import PREFIXES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.facts import Interface, NodeReference
    from kg.robot.connection import ComputationGraph, LiveEnd
    from kg.store.interface import Queryable

_ANONYMOUS: Final = re.compile(r"(_\d+)+$")  # suffix of the names of anonymous nodes
_FEW: Final = 2  # minimum number of ends, all under the names of the code, for a node type of another name
_BLOCK: Final = re.compile(r"VALUES \?(\w+) \{ UNDEF \}")


class Recognizer:
    """Matches nodes of one system; results are cached while store and node are unchanged.

    `records` are the node types found so far, by reference.
    """

    def __init__(self, base: str) -> None:
        self.records: dict[NodeReference, NodeRecord] = {}
        self._iris = Iris(base)
        self._cache: dict[tuple[str, tuple[LiveEnd, ...]], Match | None] = {}

    def forget(self) -> None:
        """Clear the cache, because the node types of the store changed."""
        self._cache.clear()
        self.records.clear()

    def matches(self, store: Queryable, graph: ComputationGraph) -> dict[str, Match]:
        """Return the node types of nodes by the names of these; nodes without one are left out."""
        ends: defaultdict[str, list[LiveEnd]] = defaultdict(list)
        for end in graph.ends:
            if not is_implicit(end.role, end.name, end.node, graph.ros):
                ends[end.node].append(end)
        keys = {node.name: (node.name, tuple(ends[node.name])) for node in graph.nodes}
        self._cache = {key: self._cache[key] for key in keys.values() if key in self._cache}
        self._recognize(store, [key for key in keys.values() if key not in self._cache])
        best = {name: self._cache[key] for name, key in keys.items()}
        return {name: match for name, match in best.items() if match is not None}

    def _recognize(self, store: Queryable, fresh: Sequence[tuple[str, tuple[LiveEnd, ...]]]) -> None:
        names = {_base(name) for name, _ in fresh}
        channels = {self._channel(end) for _, ends in fresh for end in ends}
        named = _query_values(store, "node-types-by-name", [Literal(name) for name in sorted(names)])
        wired = _query_values(store, "node-types-by-channel", [NamedNode(iri) for iri in sorted(channels)])
        wanted = {iri for iris in (*named.values(), *wired.values()) for iri in iris}
        records = {one.iri: one for one in node_records(store, iris=wanted)} if wanted else {}
        for name, ends in fresh:
            alike = [records[iri] for iri in sorted(named.get(_base(name), ())) if iri in records]
            sharing = {iri for end in ends for iri in wired.get(self._channel(end), ())}
            others = [records[iri] for iri in sorted(sharing) if iri in records]
            match = _best(name, ends, alike, same_name=True) or _best(name, ends, others, same_name=False)
            self._cache[name, ends] = match
            if match is not None:
                self.records.update((one.reference, one) for one in (*alike, *others) if one.reference == match.type)

    def _channel(self, end: LiveEnd) -> str:
        return self._iris.channel(end.role.channel, end.name)


def _query_values(store: Queryable, name: str, values: Sequence[Literal | NamedNode]) -> dict[str, set[str]]:
    """Return the second column of a stored query by its first, for several values of its parameter."""
    values_by_key: defaultdict[str, set[str]] = defaultdict(set)
    if values:
        text = _BLOCK.sub(lambda block: f"VALUES ?{block[1]} {{ {' '.join(map(str, values))} }}", internal(name))
        rows: Any = store.query(text, prefixes=dict(PREFIXES))
        for row in rows:
            values_by_key[row[0].value].add(row[1].value)
    return dict(values_by_key)


def _base(name: str) -> str:
    return _ANONYMOUS.sub("", name.rpartition("/")[2])


def _best(name: str, ends: Sequence[LiveEnd], records: Iterable[NodeRecord], *, same_name: bool) -> Match | None:
    """Return the best of some node types; None if none fits, or several fit equally."""
    ranked: list[tuple[tuple[int, int, int], Match]] = []
    for record in records:
        exact, moved = _paired(name, ends, record)
        half, whole = 2 * len(exact | moved) >= len(ends), len(exact) == len(ends) >= _FEW
        if half if same_name else whole:
            declared = sum(not one.implicit for one in record.node.interfaces)
            match = Match(record.reference, {**moved, **exact})
            ranked.append(((len(exact), len(moved), -declared), match))
    ranked.sort(key=lambda pair: pair[0], reverse=True)
    if not ranked or (len(ranked) > 1 and ranked[0][0] == ranked[1][0]):
        return None
    return ranked[0][1]


def _paired(
    name: str, ends: Sequence[LiveEnd], record: NodeRecord
) -> tuple[dict[LiveEnd, Interface], dict[LiveEnd, Interface]]:
    """Return the interfaces of a node type for ends: those of the same name, and those that must have been renamed."""
    namespace, _, base = name.rpartition("/")
    free = [one for one in record.node.interfaces if not one.implicit]
    exact: dict[LiveEnd, Interface] = {}
    moved: dict[LiveEnd, Interface] = {}
    for end in ends:
        names = ((one, one.name and resolve(one.name, base, namespace or "/")) for one in free if one.role is end.role)
        typed = ((one, full) for one, full in names if None in {one.type, end.type} or one.type == end.type)
        fitting = next((one for one, full in typed if full == end.name), None)
        if fitting is not None:
            exact[end] = fitting
            free.remove(fitting)
    for end in ends:
        if end not in exact and end.type is not None:
            fitting = next((one for one in free if one.type == end.type and one.role is end.role), None)
            if fitting is not None:
                moved[end] = fitting
                free.remove(fitting)
    return exact, moved
