"""Linking of references with the graph, in one store for the stored queries that count, and keeping them in the store.

A reference is linked to the nodes it describes, and its entries to ends or parameters: of the same role in the same
package, with the same name (as written, except for a leading `~` or `/`; `*` matches one unknown part). A topic of a
ROS 1 action (`move/goal`) is linked to the action.
"""

from __future__ import annotations

import re
from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from pyoxigraph import Literal, NamedNode, Quad, RdfFormat, Store

from kg.evaluate.references import PARAMETERS, Entry, Reference, owner_and_name, plain_name, short_name
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.ntriples import Writer, integer
from kg.pipeline.inferring import Inference
from kg.query import stored
from kg.query.core import run
from kg.query.result import Solutions
from kg.query.rows import rows
from kg.store.opening import writable
from kg.store.snapshot import MemorySnapshot

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kg.settings import Settings
    from kg.store.interface import Snapshot


_ACTION_TOPIC: Final = re.compile(r"(.+)/(goal|cancel|status|feedback|result)")
_HEARD: Final = frozenset({"goal", "cancel"})
_CLASSES: Final = {
    v.PUBLISHER: "publishes",
    v.SUBSCRIBER: "subscribes",
    v.SERVICE_SERVER: "services",
    v.SERVICE_CLIENT: "clients",
    v.ACTION_SERVER: "action_servers",
    v.ACTION_CLIENT: "action_clients",
    v.PARAMETER: PARAMETERS,
}
_PROPERTIES: Final = {
    kind: (
        NamedNode(v.bare(v.HAS_PARAMETER if kind == v.PARAMETER else v.HAS_COMPONENT)),
        NamedNode(v.bare(of)) if of else None,
    )
    for kind, of in (
        (v.PUBLISHER, v.ROS_HAS_MESSAGE),
        (v.SUBSCRIBER, v.ROS_HAS_MESSAGE),
        (v.SERVICE_SERVER, v.HAS_SERVICE_TYPE),
        (v.SERVICE_CLIENT, v.HAS_SERVICE_TYPE),
        (v.ACTION_SERVER, v.HAS_ACTION_TYPE),
        (v.ACTION_CLIENT, v.HAS_ACTION_TYPE),
        (v.PARAMETER, None),
    )
}
"""Properties from a node to an end or parameter of a class, and to its type."""
_CONTAINS, _TYPE, _NODE_TYPE, _NAME, _IMPLICIT, _LABEL = (
    NamedNode(v.bare(term)) for term in (v.CONTAINS, v.TYPE, v.NODE_TYPE, v.NAME, v.IMPLICIT, v.LABEL)
)
_PARTS: Final = """
SELECT ?package ?part ?class ?name WHERE {
  ?package rnkg:contains/(ros:hasComponent|rnkg:hasParameter) ?part .
  ?part a ?class ; rnkg:name ?name ; rnkg:implicit false .
}"""


@dataclass(frozen=True, slots=True)
class Linked:
    """A reference, the IRI of its package (None if the graph lacks it), and those of its nodes."""

    reference: Reference
    package: str | None
    nodes: tuple[str, ...]


class Ground:
    """The data of the stored queries: the interfaces of the references' repositories, and the references.

    `triples` are the references as N-Triples; `linked` are those of repositories in the store.
    """

    def __init__(self, store: Store, triples: bytes, linked: Sequence[Linked]) -> None:
        self._snapshot = MemorySnapshot(store)
        self.triples = triples
        self.linked = tuple(linked)

    def counts(self, query: str) -> dict[str, dict[str, int]]:
        """Return the counts of a stored query: the numbers of each row by name, under its first column."""
        answer = run(self._snapshot, stored.find(query).text)
        if not isinstance(answer, Solutions):
            raise TypeError(query)
        return {
            _value(first): {name: int(_value(term)) for name, term in zip(answer.variables[1:], numbers, strict=True)}
            for first, *numbers in answer.rows
        }


class Linker:
    """Links references with a snapshot, caching repositories."""

    def __init__(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        self._names = _Names(snapshot)
        self._read: dict[str, tuple[Quad, ...]] = {}

    def link(self, references: Iterable[Reference]) -> Ground:
        """Return the data for comparing references of repositories in the store."""
        repositories = self._names.repositories
        linked = [self._names.linked(one) for one in references if one.repository in repositories]
        store = Store()
        for repository in sorted({repositories[one.reference.repository] for one in linked}):
            if repository not in self._read:
                self._read[repository] = tuple(_interfaces(self._snapshot, repository))
            store.extend(self._read[repository])
        # Ends and parameters by package, role and plain name.
        parts: dict[str, dict[str, dict[str, list[str]]]] = {}
        for package, part, kind, name in rows(MemorySnapshot(store), _PARTS, union=True):
            role, plain = _CLASSES.get(f"<{kind}>"), plain_name(name)
            if role and plain:
                parts.setdefault(package, {}).setdefault(role, {}).setdefault(plain, []).append(part)
        writer = Writer()
        for number, one in enumerate(linked, 1):
            _write(writer, number, one, parts.get(one.package or "", {}))
        triples = writer.encoded()
        store.load(triples, format=RdfFormat.N_TRIPLES)
        return Ground(store, triples, linked)


class _Names:
    """The packages and nodes of a store by the names that references use."""

    def __init__(self, snapshot: Snapshot) -> None:
        self.repositories: dict[str, str] = {}
        self._packages: dict[tuple[str, str], str] = {}
        self._nodes: dict[tuple[str, str], dict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
        for repository, package, package_iri, node, name in rows(snapshot, stored.internal("node-names"), union=True):
            owner = owner_and_name(repository)
            self.repositories[owner] = repository
            self._packages[owner, package] = package_iri
            if node is not None:
                self._nodes[owner, package][short_name(name)].add(node)

    def linked(self, reference: Reference) -> Linked:
        key = reference.repository, reference.package
        by_name = self._nodes.get(key, {})
        nodes = sorted({node for name in reference.names for node in by_name.get(name, ())})
        if not nodes and reference.sole:
            every = sorted(set().union(*by_name.values()))
            nodes = every if len(every) == 1 else []
        return Linked(reference, self._packages.get(key), tuple(nodes))


def _interfaces(snapshot: Snapshot, repository: str) -> Iterator[Quad]:
    """Yield the interfaces of a repository; a CONSTRUCT query would be a hundred times as slow."""
    query = stored.internal("interfaces-of-repository")
    answer = run(snapshot, query, parameters={"repository": Literal(repository)})
    for row in answer.rows if isinstance(answer, Solutions) else ():
        package, node, part, kind, name, implicit, type_, label = row
        has, of = _PROPERTIES.get(f"<{_value(kind)}>", (None, None))
        if has is None:
            continue
        triples = [(package, _CONTAINS, node), (node, _TYPE, _NODE_TYPE), (node, has, part), (part, _TYPE, kind)]
        triples += [(part, _NAME, name), (part, _IMPLICIT, implicit)]
        if of is not None and type_ is not None:
            triples += [(part, of, type_), (type_, _LABEL, label)]
        yield from (Quad(*triple) for triple in triples)  # type: ignore[arg-type]  # columns of a SELECT hold any term


def _write(writer: Writer, number: int, linked: Linked, parts: dict[str, dict[str, list[str]]]) -> None:
    reference = linked.reference
    subject = f"<urn:kg:reference:{number}>"
    writer.described(subject, f"{reference.package} {', '.join(sorted(reference.names))}", v.REFERENCE_NODE)
    writer.text(subject, v.PATH, reference.place.path)
    writer.number(subject, v.LINE, reference.place.line)
    if linked.package:
        writer.add(subject, v.IN_PACKAGE, f"<{linked.package}>")
    for node in linked.nodes:
        writer.add(subject, v.DESCRIBES, f"<{node}>")
    for role in sorted(reference.closed):
        writer.text(subject, v.CLOSED_ROLE, role)
    for position, entry in enumerate(reference.entries, 1):
        part = f"<urn:kg:reference:{number}:{position}>"
        writer.add(subject, v.HAS_ENTRY, part)
        writer.add(part, v.TYPE, v.REFERENCE_ENTRY)
        writer.text(part, v.ROLE, entry.role)
        writer.text(part, v.PLAIN_NAME, entry.name)
        writer.text(part, v.TYPE_NAME, entry.type)
        writer.add(part, v.POSITION, integer(position))
        for match in _matches(entry, parts):
            writer.add(part, v.FOUND_AS, f"<{match}>")


def _matches(entry: Entry, parts: dict[str, dict[str, list[str]]]) -> list[str]:
    """Return the IRIs of the ends or parameters that match an entry."""
    if entry.name is None:
        return []
    matches = list(_named(entry.name, parts.get(entry.role, {})))
    topic = _ACTION_TOPIC.fullmatch(entry.name)
    if topic and entry.role in {"publishes", "subscribes"}:
        server = (topic[2] in _HEARD) == (entry.role == "subscribes")
        matches += _named(topic[1], parts.get("action_servers" if server else "action_clients", {}))
    return sorted(set(matches))


def _named(name: str, parts_by_name: dict[str, list[str]]) -> Iterator[str]:
    if "*" not in name:
        yield from parts_by_name.get(name, ())
        return
    pattern = re.compile(re.escape(name).replace(r"\*", "[^/]+"))
    for other, parts in parts_by_name.items():
        if pattern.fullmatch(other):
            yield from parts


def _value(term: object) -> str:
    return str(getattr(term, "value", ""))


_GRAPH_NAME: Final = "reference"


def keep(settings: Settings, triples: bytes) -> None:
    """Replace the references in the current store.

    Raises StoreError: KG301 no store, KG302 another process is writing, KG304 the disk is full.
    """
    graph = NamedNode(Iris(settings.base).graph(_GRAPH_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            transaction.replace_graphs({graph: [triples]})
            inference.run(transaction)
            inference.remember(transaction.commit())


def forget(settings: Settings) -> bool:
    """Remove the references from the current store; return whether there were any.

    Raises StoreError: KG301 no store, KG302 another process is writing.
    """
    graph = NamedNode(Iris(settings.base).graph(_GRAPH_NAME))
    with writable(settings, create=False) as target:
        inference = Inference(target, settings)
        with target.write("kg eval") as transaction:
            exists = graph in transaction.graphs()
            if exists:
                transaction.drop_graph(graph)
                inference.run(transaction)
                inference.remember(transaction.commit())
    return exists
