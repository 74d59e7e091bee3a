"""Facts of the graph about nodes, as a population for samples.

A fact is a relation of a node to an end, a parameter, a function, hardware or a capability. Listing reads only IRIs;
the details of a fact are read when it is drawn.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final
from urllib.parse import unquote

from kg.facts import Role
from kg.graph import vocabulary as v
from kg.graph.chains import chain_of
from kg.graph.interfaces import SHAPES
from kg.graph.iris import is_source_graph
from kg.query.rows import rows

if TYPE_CHECKING:
    from kg.facts import Location
    from kg.store.interface import Snapshot

STATED: Final = {**{role.relation: SHAPES[role].component_class for role in Role}, "has parameter": v.PARAMETER}
"""Relations read from code, by the class of their objects."""
INFERRED: Final = {
    "has function": v.rnkg("hasFunction"),
    "uses hardware": v.rnkg("usesHardware"),
    "has capability": v.rnkg("hasCapability"),
}
"""Inferred relations."""
RELATIONS: Final = (*STATED, *INFERRED)
_PARTS: Final = """
SELECT ?node ?part ?class { GRAPH %s {
  ?node a rnkg:NodeType ; ros:hasComponent|rnkg:hasParameter ?part . ?part rnkg:implicit false ; a ?class
} }"""
_RULED: Final = "SELECT ?node ?what { ?node %s ?what . ?node a rnkg:NodeType }"
_OWNER: Final = """
SELECT ?repository ?package ?name ?path ?line {
  ?package_ rnkg:contains %(node)s ; a rnkg:Package ; rnkg:name ?package .
  ?repository_ rnkg:contains ?package_ ; a rnkg:Repository ; rnkg:name ?repository .
  %(node)s rnkg:name ?name ; rnkg:path ?path ; rnkg:line ?line .
}"""
_TYPES: Final = ("/message/", "/service-type/", "/action-type/")
_TYPE_OF: Final = (v.bare(v.ROS_HAS_MESSAGE), v.bare(v.HAS_SERVICE_TYPE), v.bare(v.HAS_ACTION_TYPE))


@dataclass(frozen=True, slots=True)
class Fact:
    """A statement about a node, with its place; an inferred one has the place of its node.

    `repository` is the node's source, `file_repository` that of the file. `value` is the name of the end or parameter,
    None if it is unknown, or the label of the inferred class; `written` is the expression in the code.
    """

    relation: str
    repository: str
    package: str
    node: str
    value: str | None
    type: str | None
    written: str | None
    file_repository: str
    path: str
    line: int
    call: Location | None = None
    """The call of the framework, if it is in a wrapper or base class of another package."""


class Facts:
    """The facts of a store by relation."""

    def __init__(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        self.listed: dict[str, list[tuple[str, str]]] = {}
        """For each relation, sorted pairs of IRIs: the node and the object."""
        pairs: defaultdict[str, set[tuple[str, str]]] = defaultdict(set)
        relations = {v.bare(kind): relation for relation, kind in STATED.items()}
        for graph in snapshot.graphs():
            if is_source_graph(graph.value):
                for node, part, kind in rows(snapshot, _PARTS % graph):
                    if kind in relations:
                        pairs[relations[kind]].add((node, part))
        for relation, term in INFERRED.items():
            pairs[relation].update((node, what) for node, what in rows(snapshot, _RULED % term, union=True))
        self.listed = {relation: sorted(pairs[relation]) for relation in RELATIONS if pairs[relation]}

    def fact(self, relation: str, pair: tuple[str, str]) -> Fact:
        """Return the details of a listed fact."""
        node, part = pair
        repository, package, name, path, line = min(rows(self._snapshot, _OWNER % {"node": f"<{node}>"}, union=True))
        if relation in INFERRED:
            labels = rows(self._snapshot, f"SELECT ?label {{ <{part}> rdfs:label ?label }}", union=True)
            label = min((row[0] for row in labels), default=part)
            return Fact(relation, repository, package, name, label, None, None, repository, path, int(line))
        properties = dict(rows(self._snapshot, f"SELECT ?p ?o {{ <{part}> ?p ?o }}", union=True))
        kind = next(
            (_type_name(properties[term]) for term in _TYPE_OF if term in properties),
            properties.get(v.bare(v.PARAMETER_TYPE)),
        )
        return Fact(
            relation,
            repository,
            package,
            name,
            properties.get(v.bare(v.NAME)),
            kind,
            properties.get(v.bare(v.WRITTEN)),
            properties.get(v.bare(v.IN_REPOSITORY), repository),
            properties[v.bare(v.PATH)],
            int(properties[v.bare(v.LINE)]),
            next(reversed(chain_of(properties.get(v.bare(v.VIA)))), None),
        )


def _type_name(iri: str) -> str | None:
    return next((unquote(iri.partition(kind)[2]) for kind in _TYPES if kind in iri), None)
