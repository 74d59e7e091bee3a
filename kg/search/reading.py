"""Read documents from a snapshot of the store: few large queries, one source graph at a time.

Joins over the union of all graphs cost many times as much, because most triples in the graphs of systems and of
inferences are about interfaces.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote

from kg.facts import DescriptionKind
from kg.graph import vocabulary as v
from kg.graph.fields import one as value_of
from kg.graph.interfaces import SHAPES
from kg.graph.iris import UNKNOWN, is_source_graph
from kg.graph.reading.nodes import owner_of
from kg.graph.reading.queries import grouped
from kg.query.rows import rows
from kg.search.documents import Document, End, PackageDocument, Text
from kg.search.folding import TRANSFORM_TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from kg.store.interface import Snapshot

_NODES: Final = (
    "?s ?p ?o { ?s a rnkg:NodeType ; ?p ?o "
    "FILTER(?p NOT IN (ros:hasComponent, rnkg:hasParameter, rnkg:hasSource, rnkg:imports, rnkg:importedAt)) }"
)
_PACKAGES: Final = (
    "?s ?p ?o { ?s a rnkg:Package ; ?p ?o "
    "FILTER(?p NOT IN (rnkg:contains, rnkg:hasDependency, rnkg:dependsOn, rnkg:defines, rnkg:hasProblem)) }"
)
_OWNED: Final = (
    "?n ?p ?r { ?p a rnkg:Package ; rnkg:contains ?n . ?n a rnkg:NodeType . ?r rnkg:contains ?p ; a rnkg:Repository }"
)
_PROGRAMS: Final = "?n ?x { ?n rnkg:hasExecutable/rnkg:name ?x }"
_ENDS: Final = (
    "?c ?p ?l { ?c rnkg:implicit false ; rnkg:path ?p ; rnkg:line ?l FILTER(!CONTAINS(STR(?c), '#parameter/')) }"
)
_TRANSFORMS: Final = (
    "?c ?p ?l { VALUES ?t { %s } ?c ros:hasMessage ?t ; rnkg:implicit true ; rnkg:path ?p ; rnkg:line ?l }"
)
_TYPES: Final = "?c ?t { ?c ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?t }"
_PARAMETERS: Final = "?c { ?c rnkg:implicit false FILTER(CONTAINS(STR(?c), 'parameter/')) }"
_SPEAKING: Final = "SELECT DISTINCT ?p { GRAPH ?g { ?p rnkg:speaksFor ?n } }"
_TOLD: Final = "?c ?d { ?c dcterms:description ?d }"
_TEXTS: Final = (
    "?n ?d ?p ?o { ?n rnkg:hasDescription ?d . ?d ?p ?o "
    "FILTER(?p IN (rnkg:text, rnkg:descriptionKind, rnkg:path, rnkg:line, rnkg:heading)) }"
)
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
_ROLES: Final = {shape.component: role for role, shape in SHAPES.items()}
_PARAMETER: Final = "parameter"
_USAGE: Final = str(DescriptionKind.USAGE)
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


def read(snapshot: Snapshot) -> Content:
    """Return the documents of a snapshot: packages by source and name, their nodes by name."""
    return _Reading(snapshot).content()


class _Reading:
    def __init__(self, snapshot: Snapshot) -> None:
        self.snapshot = snapshot
        self.graphs = [graph for graph in snapshot.graphs() if is_source_graph(graph.value)]
        self.terms: defaultdict[str, list[str]] = defaultdict(list)
        self.texts = self._texts()
        ontologies = (graph for graph in snapshot.graphs() if graph.value.endswith(_ONTOLOGY))
        self.individuals = grouped(row for graph in ontologies for row in rows(self.snapshot, _CONCEPTS % graph))

    def content(self) -> Content:
        owners = {node: (package, source) for node, package, source in self._sources(_OWNED)}
        for node in owners:
            self.terms[node.partition("#")[0]].append(node)
        packages = self._packages(owners.values())
        places = {package.iri: place for place, package in enumerate(packages)}
        return Content(packages, self._nodes(owners, places), self._concepts())

    def _sources(self, body: str) -> Iterator[Any]:
        """Yield the rows of `variables { pattern }` over each source graph, one after another."""
        variables, _, pattern = body.partition("{")
        for graph in self.graphs:
            yield from rows(self.snapshot, f"SELECT {variables} {{ GRAPH {graph} {{ {pattern} }}")

    def _texts(self) -> dict[str, tuple[Text, ...]]:
        owners: dict[str, str] = {}
        parts: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
        for owner, part, predicate, value in self._sources(_TEXTS):
            owners[part] = owner
            parts[part][predicate].append(value)
        by_owner: defaultdict[str, list[Text]] = defaultdict(list)
        for part, properties in parts.items():
            get = partial(value_of, properties)
            text, kind, path = get(v.DESCRIPTION_TEXT), get(v.DESCRIPTION_KIND), get(v.PATH)
            if text and _LICENCE.search(text):
                continue
            by_owner[owners[part]].append(
                Text(text or "", kind or "", path or "", int(get(v.LINE) or 0), get(v.HEADING))
            )
        return {
            owner: tuple(sorted(texts, key=lambda one: (one.path, one.line, one.text)))
            for owner, texts in by_owner.items()
        }

    def _packages(self, owners: Iterable[tuple[str, str]]) -> list[PackageDocument]:
        sources = dict(owners)
        names = {iri: unquote(iri.partition("repository/")[2]) for iri in sources.values()}
        copies: defaultdict[str, set[str]] = defaultdict(set)
        speaking = {iri for (iri,) in rows(self.snapshot, _SPEAKING)}
        for one, other in rows(self.snapshot, "SELECT ?a ?b { GRAPH ?g { ?a rnkg:copyOf ?b } }"):
            copies[one].add(other)
            copies[other].add(one)
        packages = []
        for iri, properties in grouped(self._sources(_PACKAGES)).items():
            if iri not in sources:
                continue
            get = partial(value_of, properties)
            spdx = [one.rpartition("/")[2] for one in properties.get(v.bare(v.LICENSE), ())]
            packages.append(
                PackageDocument(
                    iri=iri,
                    repository=names[sources[iri]],
                    name=get(v.NAME) or "",
                    version=get(v.VERSION),
                    ros=int(get(v.ROS_VERSION) or 0),
                    path=get(v.PATH) or "",
                    deprecated=v.bare(v.DEPRECATED) in properties,
                    description=get(v.DESCRIPTION),
                    licenses=tuple(sorted({*spdx, *properties.get(v.bare(v.LICENSE_NAME), ())})),
                    texts=tuple(one for one in self.texts.get(iri, ()) if one.kind != _USAGE or iri in speaking),
                    copies=tuple(sorted(copies.get(iri, ()))),
                )
            )
        return sorted(packages, key=lambda one: (one.repository, one.name, one.path))

    def _nodes(self, owners: Mapping[str, tuple[str, str]], places: Mapping[str, int]) -> list[Document]:
        ends, parameters = self._ends(), self._parameters()
        programs = dict(self._sources(_PROGRAMS))
        classes = self._classes()
        starts = self._starts()
        nodes = []
        for iri, properties in grouped(self._sources(_NODES)).items():
            if iri not in owners or owners[iri][0] not in places:
                continue
            get = partial(value_of, properties)
            nodes.append(
                Document(
                    iri=iri,
                    name=get(v.NAME) or "",
                    kind=(get(v.KIND) or "").removeprefix(v.RNKG),
                    package=places[owners[iri][0]],
                    ros=int(get(v.ROS_VERSION) or 0),
                    path=get(v.PATH) or "",
                    line=int(get(v.LINE) or 0),
                    executable=programs.get(iri),
                    plugin=get(v.PLUGIN_NAME),
                    node_name=get(v.NODE_NAME),
                    aliases=tuple(sorted(properties.get(v.bare(v.ALIAS), ()))),
                    texts=self.texts.get(iri, ()),
                    ends=ends.get(iri, ()),
                    parameters=parameters.get(iri, ()),
                    hardware=classes[iri, "hardware"],
                    functions=classes[iri, "functions"],
                    capabilities=classes[iri, "capabilities"],
                    starts=starts[iri],
                )
            )
        return sorted(nodes, key=lambda one: (one.package, one.name, one.path, one.line, one.iri))

    def _ends(self) -> dict[str, tuple[End, ...]]:
        types = dict(self._sources(_TYPES))
        by_node: defaultdict[str, set[tuple[str, str, str, str, int]]] = defaultdict(set)
        messages = {iri.rpartition("/message/")[0] for iri in types.values() if "/message/" in iri}
        transforms = " ".join(f"<{base}/message/{name}>" for base in sorted(messages) for name in TRANSFORM_TYPES)
        for body in (_ENDS, _TRANSFORMS % transforms):
            for part, path, line in self._sources(body):
                node = owner_of(part, self.terms)
                role, name = _part(node, part)
                if role in _ROLES:
                    by_node[node].add((_ROLES[role], name or "", _type_name(types.get(part)) or "", path, int(line)))
        return {
            node: tuple(
                End(role, name or None, kind or None, path, line) for role, name, kind, path, line in sorted(ends)
            )
            for node, ends in by_node.items()
        }

    def _parameters(self) -> dict[str, tuple[tuple[str, str | None], ...]]:
        descriptions = dict(self._sources(_TOLD))
        by_node: defaultdict[str, dict[str, str | None]] = defaultdict(dict)
        for (part,) in self._sources(_PARAMETERS):
            node = owner_of(part, self.terms)
            kind, name = _part(node, part)
            if kind == _PARAMETER and name is not None:
                by_node[node][name] = descriptions.get(part) or by_node[node].get(name)
        return {node: tuple(sorted(named.items())) for node, named in by_node.items()}

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


def _part(node: str, part: str) -> tuple[str, str | None]:
    """Return the kind and the name in the IRI of a part of a node (`kg.graph.iris.fragment`)."""
    kind, _, name = part[len(node) + 1 :].partition("/")
    name = unquote(name.partition("@")[0]) if not name.startswith(UNKNOWN) else ""
    return kind, name or None


def _type_name(iri: str | None) -> str | None:
    if iri is None:
        return None
    package, name = iri.split("/")[-2:]
    return f"{unquote(package)}/{unquote(name)}"
