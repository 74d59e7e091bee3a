"""Read documents from a snapshot of the store: nodes from their facts, packages and concepts by queries.

Joins over the union of all graphs cost many times as much as queries over one source graph after another, because most
triples in the graphs of systems and of inferences are about interfaces.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.facts import DescriptionKind
from kg.graph import vocabulary as v
from kg.graph.fields import one as value_of
from kg.graph.iris import is_source_graph
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.reading.queries import grouped
from kg.graph.texts import descriptions_of
from kg.query.rows import rows
from kg.rules.selecting import columns_of
from kg.search.documents import Document, End, PackageDocument, Text
from kg.search.folding import TRANSFORM_TYPES

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from kg.facts import Description
    from kg.store.snapshot import EmbeddedSnapshot

_PACKAGES: Final = (
    "?s ?p ?o { ?s a rnkg:Package ; ?p ?o "
    "FILTER(?p NOT IN (rnkg:contains, rnkg:hasDependency, rnkg:dependsOn, rnkg:defines, rnkg:hasProblem)) }"
)
_OWNED: Final = "?p ?name { ?p a rnkg:Package . ?r rnkg:contains ?p ; a rnkg:Repository ; rnkg:name ?name }"
_SPEAKING: Final = "SELECT DISTINCT ?p { GRAPH ?g { ?p rnkg:speaksFor ?n } }"
_CONCEPTS: Final = """
SELECT ?s ?p ?o {
  GRAPH %s { ?s a owl:NamedIndividual ; ?p ?o }
}"""
_ONTOLOGY: Final = "/graph/ontology"
_CLASSES: Final = {
    "hardware": v.rnkg("usesHardware"),
    "functions": v.rnkg("hasFunction"),
    "capabilities": v.rnkg("hasCapability"),
}
_SCHEMES: Final = {"hardware": "/hardware#", "function": "/function#", "capability": "/capability#"}
_EVIDENCE: Final = {f"{v.RNKG}{name}" for name in ("Sign", "Context", "Bystander", "Exclusion", "CapabilityParameter")}
"""Classes of individuals of the schemes that rules use, but nobody searches for."""
_ALTERNATIVE: Final = f"{v.SKOS}altLabel"
_BROADER: Final = f"{v.SKOS}broader"
_LICENCE: Final = re.compile(
    r"\bcopyright\b|\ball rights reserved\b|\bredistribut|\bwarrant(?:y|ies)\b"
    r"|\b(?:licensed|distributed|released) under\b|\bpermitted provided\b|\bdisclaimer\b|\bmerchantability\b",
    re.IGNORECASE,
)
"""Texts with these words are about the licence, not about the function."""


@dataclass(frozen=True, slots=True)
class Concept:
    """A kind of hardware, a function or a capability: its label, other labels, and the labels of broader concepts."""

    label: str
    kind: str
    others: tuple[str, ...] = ()
    wider: tuple[str, ...] = ()


@dataclass(slots=True)
class Content:
    """All documents of a store, and the concepts to search for."""

    packages: list[PackageDocument] = field(default_factory=list)
    nodes: list[Document] = field(default_factory=list)
    concepts: list[Concept] = field(default_factory=list)


def read(snapshot: EmbeddedSnapshot) -> Content:
    """Return the documents of a snapshot: packages by source and name, their nodes by name."""
    return _Reading(snapshot).content()


class _Reading:
    def __init__(self, snapshot: EmbeddedSnapshot) -> None:
        self.snapshot = snapshot
        self.columns = columns_of(snapshot)
        self.graphs = [graph for graph in snapshot.graphs() if is_source_graph(graph.value)]
        ontologies = (graph for graph in snapshot.graphs() if graph.value.endswith(_ONTOLOGY))
        self.individuals = grouped(row for graph in ontologies for row in rows(self.snapshot, _CONCEPTS % graph))

    def content(self) -> Content:
        records = node_records(self.columns)
        packages = self._packages({(one.repository, one.package) for one in records})
        places = {(package.repository, package.name): place for place, package in enumerate(packages)}
        return Content(packages, self._nodes(records, places), self._concepts())

    def _sources(self, body: str) -> Iterator[Any]:
        """Yield the rows of `variables { pattern }` over each source graph, one after another."""
        variables, _, pattern = body.partition("{")
        for graph in self.graphs:
            yield from rows(self.snapshot, f"SELECT {variables} {{ GRAPH {graph} {{ {pattern} }}")

    def _packages(self, owners: Collection[tuple[str, str]]) -> list[PackageDocument]:
        """Return the packages of some sources and names."""
        repositories = dict(self._sources(_OWNED))
        texts = descriptions_of(self.columns, "?node a rnkg:Package .")
        copies: defaultdict[str, set[str]] = defaultdict(set)
        speaking = {iri for (iri,) in rows(self.snapshot, _SPEAKING)}
        for one, other in rows(self.snapshot, "SELECT ?a ?b { GRAPH ?g { ?a rnkg:copyOf ?b } }"):
            copies[one].add(other)
            copies[other].add(one)
        packages = []
        for iri, properties in grouped(self._sources(_PACKAGES)).items():
            get = partial(value_of, properties)
            repository, name = repositories.get(iri, ""), get(v.NAME) or ""
            if (repository, name) not in owners:
                continue
            spdx = [one.rpartition("/")[2] for one in properties.get(v.bare(v.LICENSE), ())]
            said = (one for one in texts.get(iri, ()) if one.kind is not DescriptionKind.USAGE or iri in speaking)
            packages.append(
                PackageDocument(
                    iri=iri,
                    repository=repository,
                    name=name,
                    version=get(v.VERSION),
                    ros=int(get(v.ROS_VERSION) or 0),
                    path=get(v.PATH) or "",
                    deprecated=v.bare(v.DEPRECATED) in properties,
                    description=get(v.DESCRIPTION),
                    licenses=tuple(sorted({*spdx, *properties.get(v.bare(v.LICENSE_NAME), ())})),
                    texts=_texts(said),
                    copies=tuple(sorted(copies.get(iri, ()))),
                )
            )
        return sorted(packages, key=lambda one: (one.repository, one.name, one.path))

    def _nodes(self, records: Iterable[NodeRecord], places: Mapping[tuple[str, str], int]) -> list[Document]:
        classes = self._classes()
        starts = self._starts()
        nodes = [
            Document(
                iri=one.iri,
                name=one.node.name,
                kind=str(one.node.kind),
                package=places[one.repository, one.package],
                ros=one.node.ros,
                path=one.node.location.path,
                line=one.node.location.line,
                executable=one.node.executable,
                plugin=one.node.plugin,
                node_name=one.node.node_name,
                aliases=tuple(sorted(one.node.aliases)),
                texts=_texts(one.descriptions),
                ends=_ends(one),
                parameters=_parameters(one),
                hardware=classes[one.iri, "hardware"],
                functions=classes[one.iri, "functions"],
                capabilities=classes[one.iri, "capabilities"],
                starts=starts[one.iri],
            )
            for one in records
            if (one.repository, one.package) in places
        ]
        return sorted(nodes, key=lambda one: (one.package, one.name, one.path, one.line, one.iri))

    def _classes(self) -> Mapping[tuple[str, str], tuple[str, ...]]:
        """Return the labels of the classes of nodes, by node and field of a document."""
        labels = {iri: value_of(properties, v.LABEL) for iri, properties in self.individuals.items()}
        by_field: defaultdict[tuple[str, str], set[str]] = defaultdict(set)
        for name, predicate in _CLASSES.items():
            for node, concept in rows(self.snapshot, f"SELECT ?n ?c {{ GRAPH ?g {{ ?n {predicate} ?c }} }}"):
                by_field[node, name].add(labels.get(concept) or concept.rpartition("#")[2])
        return defaultdict(tuple, {key: tuple(sorted(names)) for key, names in by_field.items()})

    def _starts(self) -> Counter[str]:
        return Counter(node for _, node in rows(self.snapshot, "SELECT ?i ?n { GRAPH ?g { ?i rnkg:instanceOf ?n } }"))

    def _concepts(self) -> list[Concept]:
        concepts = []
        for iri, properties in self.individuals.items():
            kind = next((kind for kind, place in _SCHEMES.items() if place in iri), None)
            label = value_of(properties, v.LABEL)
            types = properties.get(v.bare(v.TYPE), ())
            if kind is not None and label is not None and _EVIDENCE.isdisjoint(types):
                concepts.append(Concept(label, kind, tuple(sorted(properties.get(_ALTERNATIVE, ()))), self._wider(iri)))
        return sorted(concepts, key=lambda one: (one.kind, one.label))

    def _wider(self, iri: str) -> tuple[str, ...]:
        wider: dict[str, str] = {}
        waiting = list(self.individuals[iri].get(_BROADER, ()))
        while waiting:
            one = waiting.pop()
            if one not in wider and one in self.individuals:
                wider[one] = value_of(self.individuals[one], v.LABEL) or ""
                waiting += self.individuals[one].get(_BROADER, ())
        return tuple(sorted(filter(None, wider.values())))


def _texts(descriptions: Iterable[Description]) -> tuple[Text, ...]:
    texts = (
        Text(one.text, str(one.kind), one.location.path, one.location.line, one.heading)
        for one in descriptions
        if not _LICENCE.search(one.text)
    )
    return tuple(sorted(texts, key=lambda one: (one.path, one.line, one.text)))


def _ends(record: NodeRecord) -> tuple[End, ...]:
    """Return the interfaces of a node that its code creates, and those for transforms, which frameworks create."""
    ends = {
        End(str(one.role), one.name or None, one.type, one.location.path, one.location.line)
        for one in record.node.interfaces
        if not one.implicit or one.type in TRANSFORM_TYPES
    }
    return tuple(sorted(ends, key=lambda one: (one.role, one.name or "", one.type or "", one.path, one.line)))


def _parameters(record: NodeRecord) -> tuple[tuple[str, str | None], ...]:
    described: dict[str, str | None] = {}
    for one in record.node.parameters:
        if not one.implicit and one.name:
            described[one.name] = one.description or described.get(one.name)
    return tuple(sorted(described.items()))
