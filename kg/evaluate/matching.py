"""Nodes whose interface contains the one that is asked for, by subgraph monomorphism.

The pattern of a need is a graph: the node, a vertex for each end that it must have, labelled with its role, and a
vertex for the type of that end. A node's own graph has the same shape for all its ends. A node matches when the
pattern occurs in its graph (a monomorphism: the graph may have more edges). networkx does that with VF2
(`GraphMatcher`); its VF2++ tests only whether two graphs as wholes are isomorphic.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kg.evaluate.judged_needs import Constraints
    from kg.search.documents import Document

_ROLES: Final = {
    "subscribes": ("subscribes",),
    "publishes": ("publishes",),
    "provides": ("services", "action_servers"),
    "calls": ("clients", "action_clients"),
}
"""Kinds of constraints by the roles of ends that meet them."""
_KINDS: Final = {role: kind for kind, roles in _ROLES.items() for role in roles}


class Patterns:
    """The interfaces of nodes, in which patterns are looked for."""

    def __init__(self, nodes: Sequence[Document]) -> None:
        self._ends = [
            [(_KINDS[end.role], end.type) for end in node.ends if end.type and end.role in _KINDS] for node in nodes
        ]
        self._counts = [Counter(ends) for ends in self._ends]
        self._graphs: dict[int, Any] = {}

    def scores(self, constraints: Constraints | None) -> list[float]:
        """Return for each node one by the number of its ends when it matches, else 0; no constraints, no match."""
        wanted = [(kind, type_) for kind in _ROLES for type_ in getattr(constraints, kind, ())]
        if not wanted:
            return [0.0] * len(self._ends)
        pattern, counts = _graph(wanted), Counter(wanted)
        return [self._score(place, pattern, counts) for place in range(len(self._ends))]

    def _score(self, place: int, pattern: Any, wanted: Counter[tuple[str, str]]) -> float:
        # Most nodes lack an end of the pattern, which counting tells without a search.
        if any(self._counts[place][end] < number for end, number in wanted.items()):
            return 0.0
        from networkx.algorithms.isomorphism import (  # noqa: PLC0415 - an extra
            GraphMatcher,
            categorical_node_match,
        )

        if place not in self._graphs:
            self._graphs[place] = _graph(self._ends[place])
        matcher = GraphMatcher(self._graphs[place], pattern, categorical_node_match("label", None))
        return 1 / len(self._ends[place]) if matcher.subgraph_is_monomorphic() else 0.0


def _graph(ends: Iterable[tuple[str, str]]) -> Any:
    from networkx import Graph  # noqa: PLC0415 - an extra

    graph = Graph()
    graph.add_node("node", label="node")
    for number, (kind, type_) in enumerate(ends):
        graph.add_node(number, label=kind)
        graph.add_node(type_, label=type_)
        graph.add_edge("node", number)
        graph.add_edge(number, type_)
    return graph
