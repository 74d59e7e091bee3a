"""Reads node types from the graph, as the facts that `kg.graph.nodes` and `kg.graph.interfaces` wrote.

`kg.graph.fields` declares the plain values for both ways. A test compares the facts written with those read.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from kg import facts
from kg.graph import vocabulary as v
from kg.graph.chains import chain_of
from kg.graph.fields import INTERFACE, NODE, PARAMETER, QOS, Properties, one, place_of
from kg.graph.interfaces import ROLE_OF_CLASS, SHAPES
from kg.graph.nodes import order
from kg.graph.ntriples import literal
from kg.graph.plugin_slots import NAMED, SLOTS, class_key, plugins_by_class, slots_by_node
from kg.graph.reading.queries import Texts, among, column, one_of, properties_in, texts
from kg.graph.texts import descriptions_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from kg.store.interface import Queryable


_Ends: TypeAlias = "list[tuple[facts.Interface, str]]"
_Settable: TypeAlias = "list[tuple[facts.Parameter, str]]"

_KIND: Final = v.bare(v.TYPE)
_ANY: Final = "?node a rnkg:NodeType ."
_PLACE: Final = (v.PATH, v.LINE, v.IN_REPOSITORY)
_OF_NODES: Final = (*NODE.terms, *_PLACE, v.BOUND, v.EXPORTED_AT, v.IMPORTED_AT)
"""The properties of node types that facts have."""
_TYPE_OF: Final = tuple(dict.fromkeys(shape.has_type for shape in SHAPES.values()))
"""The properties that hold the type of an end."""
_BARE_TYPE_OF: Final = tuple(map(v.bare, _TYPE_OF))
_OF_PARTS: Final = dict.fromkeys((v.TYPE, *_TYPE_OF, v.HAS_QOS, *INTERFACE.terms, *PARAMETER.terms, *_PLACE, v.VIA))
"""The properties of interfaces and parameters that facts have."""
_OWNERS: Final = """
SELECT ?node ?package ?repository ?commit WHERE {
  %s
  ?p rnkg:contains ?node ; rnkg:name ?package .
  ?r rnkg:contains ?p ; rnkg:name ?repository .
  OPTIONAL { ?r rnkg:commit ?commit }
}"""
_SOURCES: Final = "SELECT ?subject ?path WHERE { %s ?node rnkg:hasSource/rnkg:path ?path BIND(?node AS ?subject) }"
_EXECUTABLES: Final = (
    "SELECT ?subject ?name WHERE { %s ?node rnkg:hasExecutable/rnkg:name ?name BIND(?node AS ?subject) }"
)
# The engine takes most of its time to make texts of terms, so what nobody reads here is left out,
# by a join with VALUES that the LIMIT, which no store reaches, keeps from being asked once for each property.
_NODES: Final = f"""
SELECT ?subject ?predicate ?object WHERE {{
  {{ SELECT * WHERE {{ %s ?node ?predicate ?object BIND(?node AS ?subject) }} LIMIT 1000000000 }}
  VALUES ?predicate {{ {" ".join(_OF_NODES)} }}
}}"""
_PARTS: Final = f"""
SELECT ?subject ?predicate ?object WHERE {{
  {{
    SELECT * WHERE {{
      %s
      ?node ros:hasComponent|rnkg:hasParameter ?subject .
      ?subject ?predicate ?object .
    }}
    LIMIT 1000000000
  }}
  VALUES ?predicate {{ {" ".join(_OF_PARTS)} }}
}}"""
_FACTS: Final = f"""
SELECT ?subject ?predicate ?object WHERE {{
  {{ SELECT DISTINCT * WHERE {{ %s ?subject ?predicate ?object }} LIMIT 1000000000 }}
  VALUES ?predicate {{ {" ".join(_OF_PARTS)} }}
}}"""
_OWNED: Final = """
SELECT DISTINCT ?subject ?node WHERE {
  { SELECT * WHERE { %s ?node ros:hasComponent|rnkg:hasParameter ?subject } LIMIT 1000000000 }
  ?node a rnkg:NodeType .
}"""
_REFERENCES: Final = """
SELECT ?node ?name ?package ?repository WHERE {
  %s
  ?node rnkg:name ?name .
  ?p rnkg:contains ?node ; rnkg:name ?package .
  ?r rnkg:contains ?p ; rnkg:name ?repository .
}"""
_TYPES: Final = """
SELECT DISTINCT ?type ?label WHERE {
  VALUES ?class { ros:Message rnkg:ServiceType rnkg:ActionType }
  ?type a ?class ; rdfs:label ?label .
}"""
_LABELS: Final = "SELECT DISTINCT ?type ?label WHERE { %s ?type rdfs:label ?label }"
_QOS: Final = "SELECT ?subject ?predicate ?object WHERE { %s ?subject a rnkg:Qos ; ?predicate ?object }"
_FEW: Final = 200
"""So many things are asked for one by one; of more, all that the store has."""


@dataclass(frozen=True, slots=True)
class NodeRecord:
    """A node type and where it belongs; `commit` is None where the source is not a git checkout."""

    repository: str
    commit: str | None
    package: str
    node: facts.NodeType
    iri: str = field(default="", compare=False)
    ends: Mapping[facts.Interface, str] = field(default_factory=dict, repr=False, compare=False)
    """The IRIs of its interfaces."""
    settable: Mapping[facts.Parameter, str] = field(default_factory=dict, repr=False, compare=False)
    """The IRIs of its parameters."""
    descriptions: tuple[facts.Description, ...] = field(default=(), repr=False, compare=False)
    """What people wrote about it, the best first."""
    plugins: Mapping[str, tuple[facts.NodeReference, str]] = field(default_factory=dict, repr=False, compare=False)
    """The node types of the default plugins of its slots, by class, with their IRIs; those of its source first."""

    @property
    def reference(self) -> facts.NodeReference:
        """The reference of the node type in facts about instances."""
        return facts.NodeReference(self.repository, self.package, self.node.name)

    @property
    def full_name(self) -> str:
        """`repository:package/node`, which names one node of the store."""
        return f"{self.repository}:{self.package}/{self.node.name}"


def node_records(
    graph: Queryable,
    *,
    package: str | None = None,
    node: str | None = None,
    packages: Iterable[str] | None = None,
    iris: Collection[str] | None = None,
) -> list[NodeRecord]:
    """Return the node types of the store, sorted by source, package and name.

    They may be limited to those of a package, of any of several `packages` (their names), of a name, or to those
    of some IRIs.
    """
    those = which(package, node, packages) if iris is None else f"{among('node', iris)} {_ANY}"
    owners = {at: place for at, *place in texts(graph, _OWNERS % those)}
    properties = properties_in(graph, _NODES % those)
    sources = _listed(texts(graph, _SOURCES % those))
    executables = _listed(texts(graph, _EXECUTABLES % those))
    parts = _parts(graph, those, owners)
    slots = slots_by_node(
        texts(graph, SLOTS % those), lambda records: (place_of(records), chain_of(one(records, v.VIA)))
    )
    plugins = _plugins(
        graph, {one.class_name for records in slots.values() for slot in records for one in slot.defaults}
    )
    texts_by_node = descriptions_of(graph, those)
    records = []
    for at, (owner, repository, commit) in owners.items():
        ends, settable = parts.get(at, ([], []))
        fact = _node(
            properties[at],
            sources.get(at, []),
            executables.get(at, []),
            ([end for end, _ in ends], [parameter for parameter, _ in settable]),
        )
        fact = replace(fact, slots=slots.get(at, ()))
        record = NodeRecord(repository, commit, owner, fact, at, dict(ends), dict(settable))
        loaded = {
            kind: min(nodes, key=lambda pair: (pair[0].repository != record.repository, pair[0]))
            for kind in {one.class_name for slot in fact.slots for one in slot.defaults}
            if (nodes := plugins.get(class_key(kind)))
        }
        records.append(replace(record, descriptions=texts_by_node.get(at, ()), plugins=loaded))
    return sorted(records, key=lambda one: (one.repository, one.package, one.node.name, str(one.node.location)))


def code_facts(
    graph: Queryable, those: str
) -> dict[str, tuple[facts.NodeReference, facts.Interface | facts.Parameter]]:
    """Return interfaces and parameters of node types by their IRIs, with their node types.

    `those` is a pattern that binds ?subject to them and ends in a full stop; the prefixes ros: and rnkg: are known.
    """
    owners: dict[str, str] = dict(texts(graph, _OWNED % those))
    named = references(graph, set(owners.values()))
    facts_by_iri = _facts(graph, properties_in(graph, _FACTS % those))
    return {iri: (named[owners[iri]], fact) for iri, fact in facts_by_iri.items() if owners.get(iri) in named}


def references(graph: Queryable, iris: Collection[str]) -> dict[str, facts.NodeReference]:
    """Return the references of the node types with some IRIs; unknown ones are left out."""
    return {
        iri: facts.NodeReference(repository, package, name)
        for iri, name, package, repository in texts(graph, _REFERENCES % these(graph, "node", iris))
        if iri in iris
    }


def these(graph: Queryable, name: str, iris: Collection[str]) -> str:
    """Return a pattern that binds a variable to some node types, or to all where these are read as soon."""
    if len(iris) > _FEW and isinstance(graph, Texts):
        return f"?{name} a rnkg:NodeType ."
    return among(name, iris)


def _plugins(graph: Queryable, classes: set[str]) -> dict[str, list[tuple[facts.NodeReference, str]]]:
    """Return the node types of plugins of some classes, by the keys of these, with their IRIs."""
    if not classes:
        return {}
    spelled = {one.replace("::", "/") for one in classes} | {one.replace("/", "::") for one in classes} | classes
    return plugins_by_class(texts(graph, NAMED % one_of("class", spelled)))


def programs(graph: Queryable) -> dict[str, set[str]]:
    """Return what each package of the store installs to be started; all packages are there."""
    by_package: defaultdict[str, set[str]] = defaultdict(set)
    pattern = "?p a rnkg:Package ; rnkg:name ?package OPTIONAL { ?p rnkg:installs ?program }"
    for package, program in texts(graph, f"SELECT ?package ?program WHERE {{ {pattern} }}"):
        by_package[package].update({program} if program else ())
    return dict(by_package)


def data_files(graph: Queryable) -> list[facts.DataFile]:
    """Return the files of the store that nodes read when they run, sorted."""
    pattern = (
        "?r rnkg:contains ?p ; rnkg:name ?repository . ?p rnkg:contains ?file ; rnkg:name ?package . "
        "?file rnkg:content ?text ; rnkg:path ?path"
    )
    files = (
        facts.DataFile(*row) for row in texts(graph, f"SELECT ?repository ?package ?path ?text WHERE {{ {pattern} }}")
    )
    return sorted(files, key=lambda one: (one.repository, one.package, one.path))


def node_names(graph: Queryable) -> list[str]:
    """Return the names of all node types, each once, sorted."""
    return sorted(column(graph, "SELECT ?name WHERE { ?n a rnkg:NodeType ; rnkg:name ?name }"))


def loaded_as(graph: Queryable, name: str) -> list[str]:
    """Return the names of the node types whose plugin is `name`, whole (`pkg::Class`) or by its last part, sorted."""
    query = "SELECT ?name ?plugin { ?n a rnkg:NodeType ; rnkg:name ?name ; rnkg:pluginName ?plugin }"
    return sorted(
        one
        for one, plugin in dict(texts(graph, query)).items()
        if plugin == name or plugin.replace("::", "/").endswith(f"/{name}")
    )


def which(package: str | None, node: str | None = None, packages: Iterable[str] | None = None) -> str:
    """Return the pattern that binds ?node to node types; `package` may have its repository in front, with a colon."""
    lines = [_ANY]
    if packages is not None:
        lines.append(f"{one_of('oneOf', packages)} ?oneOfThese rnkg:contains ?node ; rnkg:name ?oneOf .")
    if node is not None:
        lines.append(f"?node rnkg:name {literal(node)} .")
    if package is not None:
        repository, _, name = package.rpartition(":")
        lines.append(f"?itsPackage rnkg:contains ?node ; rnkg:name {literal(name)} .")
        if repository:
            lines.append(f"?itsRepository rnkg:contains ?itsPackage ; rnkg:name {literal(repository)} .")
    return " ".join(lines)


def end_of(properties: Properties, types: Mapping[str, str]) -> facts.Interface | None:
    """Return the interface of an end with properties of its own; `types` are names of types by IRI."""
    roles = [ROLE_OF_CLASS[kind] for kind in properties.get(_KIND, ()) if kind in ROLE_OF_CLASS]
    return _interface(roles[0], properties, types.get(type_of(properties) or ""), {}) if roles else None


def type_of(properties: Properties) -> str | None:
    """Return the IRI of the type of an end."""
    return next((min(iris) for term in _BARE_TYPE_OF if (iris := properties.get(term))), None)


def _listed(rows: Iterable[Any]) -> dict[str, list[str]]:
    by_subject: defaultdict[str, list[str]] = defaultdict(list)
    for subject, value in rows:
        by_subject[subject].append(value)
    return {subject: sorted(set(values)) for subject, values in by_subject.items()}


def _parts(graph: Queryable, those: str, owners: Iterable[str]) -> dict[str, tuple[_Ends, _Settable]]:
    nodes: defaultdict[str, list[str]] = defaultdict(list)
    for owner in owners:
        nodes[owner.partition("#")[0]].append(owner)
    by_node: defaultdict[str, tuple[_Ends, _Settable]] = defaultdict(lambda: ([], []))
    for iri, fact in _facts(graph, properties_in(graph, _PARTS % those)).items():
        interfaces, parameters = by_node[_owner_of(iri, nodes)]
        if isinstance(fact, facts.Interface):
            interfaces.append((fact, iri))
        else:
            parameters.append((fact, iri))
    return by_node


def _facts(graph: Queryable, parts: Mapping[str, Properties]) -> dict[str, facts.Interface | facts.Parameter]:
    """Return interfaces and parameters from their properties, by their IRIs."""
    ends = {
        iri: (role, type_of(properties))
        for iri, properties in parts.items()
        if (role := next((ROLE_OF_CLASS[kind] for kind in properties.get(_KIND, ()) if kind in ROLE_OF_CLASS), None))
    }
    types = _types(graph, {kind for _, kind in ends.values() if kind})
    quality_by_iri = qualities(
        graph, {iri for properties in parts.values() for iri in properties.get(v.bare(v.HAS_QOS), ())}
    )
    by_iri: dict[str, facts.Interface | facts.Parameter] = {}
    for iri, properties in parts.items():
        if iri in ends:
            role, kind = ends[iri]
            by_iri[iri] = _interface(role, properties, types.get(kind or ""), quality_by_iri)
        else:
            by_iri[iri] = _parameter(properties)
    return by_iri


def _types(graph: Queryable, wanted: Collection[str]) -> dict[str, str]:
    """Return the names of types by their IRIs, those `wanted` at least."""
    return dict(texts(graph, _LABELS % among("type", wanted) if len(wanted) <= _FEW else _TYPES))


def qualities(graph: Queryable, wanted: Collection[str] | None = None) -> dict[str, facts.Qos]:
    """Return the combinations of policies of the store by their IRIs, those `wanted` at least."""
    few = among("subject", wanted) if wanted is not None and len(wanted) <= _FEW else ""
    return {iri: facts.Qos(**QOS.read(properties)) for iri, properties in properties_in(graph, _QOS % few).items()}


def _owner_of(part: str, nodes: Mapping[str, list[str]]) -> str:
    """Return the node that a part belongs to: its IRI is a fragment of that of its node (`kg.graph.iris.fragment`).

    `nodes` has the IRIs of nodes by their part before the fragment; only nodes of one name have one of their own.
    """
    whole = part.partition("#")[0]
    named = nodes.get(whole, ())
    if named == [whole]:  # most names have one node
        return whole
    return max((one for one in named if part.startswith(one)), key=len, default=whole)


def _node(
    properties: Properties,
    sources: list[str],
    executables: list[str],
    parts: tuple[list[facts.Interface], list[facts.Parameter]],
) -> facts.NodeType:
    return facts.NodeType(
        location=place_of(properties),
        executable=executables[0] if executables else None,
        sources=tuple(sources),
        interfaces=tuple(sorted(parts[0], key=order)),
        parameters=tuple(sorted(parts[1], key=order)),
        bounds=tuple(map(_bound, sorted(properties.get(v.bare(v.BOUND), ())))),
        imports=tuple(sorted(map(_import, properties.get(v.bare(v.IMPORTED_AT), ())), key=lambda one: one.name)),
        exported=next(iter(chain_of(one(properties, v.EXPORTED_AT))), None),
        **NODE.read(properties),
    )


def _bound(text: str) -> facts.Bound:
    limit, _, place = text.partition(" ")
    return facts.Bound(limit, *chain_of(place))


def _import(text: str) -> facts.Import:
    name, _, place = text.partition(" ")
    return facts.Import(name, *chain_of(place))


def _interface(
    role: facts.Role, properties: Properties, kind: str | None, qualities: Mapping[str, facts.Qos]
) -> facts.Interface:
    return facts.Interface(
        role=role,
        type=kind,
        location=place_of(properties),
        qos=qualities.get(one(properties, v.HAS_QOS) or ""),
        via=chain_of(one(properties, v.VIA)),
        **INTERFACE.read(properties),
    )


def _parameter(properties: Properties) -> facts.Parameter:
    via = chain_of(one(properties, v.VIA))
    return facts.Parameter(location=place_of(properties), via=via, **PARAMETER.read(properties))
