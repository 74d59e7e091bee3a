"""The way back: node types are read from the graph as the facts they were written from.

`kg.graph.nodes` and `kg.graph.interfaces` write what this module reads; a test holds the two together.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeAlias

from kg.facts import Access, Interface, Location, NodeKind, NodeType, Parameter, Qos, Resolution, Role
from kg.graph import vocabulary as v
from kg.graph.ntriples import literal

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["NodeRecord", "Queryable", "node_names", "node_records"]

_Properties: TypeAlias = "Mapping[str, list[str]]"

_PREFIXES: Final = {"ros": v.ROS, "rnkg": v.RNKG, "rdf": v.RDF, "rdfs": v.RDFS}
_ROLES: Final = {
    v.bare(v.PUBLISHER): Role.PUBLISHES,
    v.bare(v.SUBSCRIBER): Role.SUBSCRIBES,
    v.bare(v.SERVICE_SERVER): Role.SERVICES,
    v.bare(v.SERVICE_CLIENT): Role.CLIENTS,
    v.bare(v.ACTION_SERVER): Role.ACTION_SERVERS,
    v.bare(v.ACTION_CLIENT): Role.ACTION_CLIENTS,
}
_OWNERS: Final = """
SELECT ?node ?package ?repository ?commit WHERE {
  %s
  ?p rnkg:contains ?node ; rnkg:name ?package .
  ?r rnkg:contains ?p ; rnkg:name ?repository .
  OPTIONAL { ?r rnkg:commit ?commit }
}"""
_NODES: Final = "SELECT ?subject ?predicate ?object WHERE { %s ?node ?predicate ?object BIND(?node AS ?subject) }"
_SOURCES: Final = "SELECT ?subject ?path WHERE { %s ?node rnkg:hasSource/rnkg:path ?path BIND(?node AS ?subject) }"
_EXECUTABLES: Final = (
    "SELECT ?subject ?name WHERE { %s ?node rnkg:hasExecutable/rnkg:name ?name BIND(?node AS ?subject) }"
)
_PARTS: Final = """
SELECT ?subject ?predicate ?object WHERE {
  %s
  ?node ros:hasComponent|rnkg:hasParameter ?subject .
  ?subject ?predicate ?object .
}"""
_TYPES: Final = """
SELECT DISTINCT ?type ?label WHERE {
  VALUES ?class { ros:Message rnkg:ServiceType rnkg:ActionType }
  ?type a ?class ; rdfs:label ?label .
}"""
_QOS: Final = "SELECT ?subject ?predicate ?object WHERE { ?subject a rnkg:Qos ; ?predicate ?object }"


class Queryable(Protocol):
    """What can be asked in SPARQL; `kg.store.interface.Snapshot` is one."""

    def query(self, text: str, /, *, prefixes: dict[str, str] | None = None) -> Any:
        """Run a query over the union of all graphs."""
        ...


@dataclass(frozen=True, slots=True)
class NodeRecord:
    """A node type and where it belongs; `commit` is None where the source is no git checkout."""

    repository: str
    commit: str | None
    package: str
    node: NodeType

    @property
    def full_name(self) -> str:
        """`repository:package/node`, which names one node of the store."""
        return f"{self.repository}:{self.package}/{self.node.name}"


def node_records(graph: Queryable, *, package: str | None = None, node: str | None = None) -> list[NodeRecord]:
    """Return the node types of the store, or those of a package or of a name, sorted by source, package and name."""
    which = _which(package, node)
    owners = {_text(row["node"]): row for row in _rows(graph, _OWNERS % which)}
    properties = _grouped(_rows(graph, _NODES % which))
    sources = _listed(_rows(graph, _SOURCES % which))
    executables = _listed(_rows(graph, _EXECUTABLES % which))
    parts = _parts(graph, which, owners)
    found = []
    for iri, owner in owners.items():
        fact = _node(properties[iri], sources.get(iri, []), executables.get(iri, []), parts.get(iri, ([], [])))
        commit = owner["commit"]
        found.append(NodeRecord(_text(owner["repository"]), commit and _text(commit), _text(owner["package"]), fact))
    return sorted(found, key=lambda one: (one.repository, one.package, one.node.name, str(one.node.location)))


def node_names(graph: Queryable) -> list[str]:
    """Return the names of all node types, each once, sorted."""
    return sorted(
        {_text(row["name"]) for row in _rows(graph, "SELECT ?name WHERE { ?n a rnkg:NodeType ; rnkg:name ?name }")}
    )


def _which(package: str | None, node: str | None) -> str:
    """Return the pattern that binds ?node; `package` may have its repository in front, with a colon."""
    lines = ["?node a rnkg:NodeType ."]
    if node is not None:
        lines.append(f"?node rnkg:name {literal(node)} .")
    if package is not None:
        repository, _, name = package.rpartition(":")
        lines.append(f"?itsPackage rnkg:contains ?node ; rnkg:name {literal(name)} .")
        if repository:
            lines.append(f"?itsRepository rnkg:contains ?itsPackage ; rnkg:name {literal(repository)} .")
    return " ".join(lines)


def _rows(graph: Queryable, text: str) -> Iterable[Any]:
    rows: Iterable[Any] = graph.query(text, prefixes=_PREFIXES)
    return rows


def _text(term: Any) -> str:
    value: str = term.value
    return value


def _grouped(rows: Iterable[Any]) -> dict[str, dict[str, list[str]]]:
    """Return the properties of each subject; the keys of properties are IRIs."""
    found: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    for subject, predicate, value in rows:
        found[subject.value][predicate.value].append(value.value)
    return {subject: dict(properties) for subject, properties in found.items()}


def _listed(rows: Iterable[Any]) -> dict[str, list[str]]:
    found: defaultdict[str, list[str]] = defaultdict(list)
    for row in rows:
        found[row[0].value].append(row[1].value)
    return {subject: sorted(set(values)) for subject, values in found.items()}


def _parts(graph: Queryable, which: str, owners: Iterable[str]) -> dict[str, tuple[list[Interface], list[Parameter]]]:
    nodes: defaultdict[str, list[str]] = defaultdict(list)
    for owner in owners:
        nodes[owner.partition("#")[0]].append(owner)
    types = {row["type"].value: row["label"].value for row in _rows(graph, _TYPES)}
    qualities = {iri: _qos(properties) for iri, properties in _grouped(_rows(graph, _QOS)).items()}
    found: defaultdict[str, tuple[list[Interface], list[Parameter]]] = defaultdict(lambda: ([], []))
    for iri, properties in _grouped(_rows(graph, _PARTS % which)).items():
        interfaces, parameters = found[_owner(iri, nodes)]
        roles = [_ROLES[kind] for kind in properties[v.bare(v.TYPE)] if kind in _ROLES]
        if roles:
            interfaces.append(_interface(roles[0], properties, types, qualities))
        else:
            parameters.append(_parameter(properties))
    return found


def _owner(part: str, nodes: Mapping[str, list[str]]) -> str:
    """Return the node that a part belongs to: its IRI is a fragment of that of its node (`kg.graph.iris.fragment`).

    `nodes` has the IRIs of nodes by what stands before their fragment; only nodes of one name have one of their own.
    """
    whole = part.partition("#")[0]
    return max((one for one in nodes.get(whole, ()) if part.startswith(one)), key=len, default=whole)


def _one(properties: _Properties, term: str) -> str | None:
    values = properties.get(v.bare(term))
    return min(values) if values else None


def _word(properties: _Properties, term: str) -> str:
    """Return the local name of a term of RNKG."""
    return (_one(properties, term) or "").removeprefix(v.RNKG)


def _location(properties: _Properties) -> Location:
    path, line, repository = (_one(properties, term) for term in (v.PATH, v.LINE, v.IN_REPOSITORY))
    return Location(path or "", int(line or 0), repository)


def _node(
    properties: _Properties,
    sources: list[str],
    executables: list[str],
    parts: tuple[list[Interface], list[Parameter]],
) -> NodeType:
    return NodeType(
        name=_one(properties, v.NAME) or "",
        kind=NodeKind(_word(properties, v.KIND)),
        language=_one(properties, v.LANGUAGE) or "",
        ros=int(_one(properties, v.ROS_VERSION) or 0),
        location=_location(properties),
        executable=executables[0] if executables else None,
        plugin=_one(properties, v.PLUGIN_NAME),
        node_name=_one(properties, v.NODE_NAME),
        base_class=_one(properties, v.BASE_CLASS),
        aliases=tuple(sorted(properties.get(v.bare(v.ALIAS), ()))),
        sources=tuple(sources),
        interfaces=tuple(sorted(parts[0], key=_order)),
        parameters=tuple(sorted(parts[1], key=_order)),
    )


def _order(fact: Interface | Parameter) -> tuple[str, str, str, int, str]:
    role = str(fact.role if isinstance(fact, Interface) else fact.access)
    return role, fact.name or "~~", fact.location.path, fact.location.line, fact.type or ""


def _interface(
    role: Role, properties: _Properties, types: Mapping[str, str], qualities: Mapping[str, Qos]
) -> Interface:
    terms = (v.ROS_HAS_MESSAGE, v.HAS_SERVICE_TYPE, v.HAS_ACTION_TYPE)
    type_iri = next((iri for term in terms if (iri := _one(properties, term))), None)
    return Interface(
        role=role,
        name=_one(properties, v.NAME),
        type=types.get(type_iri) if type_iri else None,
        resolution=Resolution(_word(properties, v.RESOLUTION)),
        location=_location(properties),
        resolved=_one(properties, v.RESOLVED_NAME),
        written=_one(properties, v.WRITTEN),
        parameter=_one(properties, v.PARAMETER_NAME),
        implicit=_one(properties, v.IMPLICIT) == "true",
        origin=_one(properties, v.ORIGIN),
        qos=qualities.get(_one(properties, v.HAS_QOS) or ""),
        reason=_one(properties, v.REASON),
    )


def _qos(properties: _Properties) -> Qos:
    reliability, durability, history, depth = (
        _one(properties, term) for term in (v.RELIABILITY, v.DURABILITY, v.HISTORY, v.DEPTH)
    )
    deadline, lifespan, lease = (_one(properties, term) for term in (v.DEADLINE, v.LIFESPAN, v.LEASE_DURATION))
    return Qos(
        reliability,
        durability,
        history,
        None if depth is None else int(depth),
        deadline=None if deadline is None else float(deadline),
        lifespan=None if lifespan is None else float(lifespan),
        liveliness=_one(properties, v.LIVELINESS),
        lease_duration=None if lease is None else float(lease),
    )


def _parameter(properties: _Properties) -> Parameter:
    return Parameter(
        name=_one(properties, v.NAME),
        type=_one(properties, v.PARAMETER_TYPE),
        default=_one(properties, v.DEFAULT_VALUE),
        access=Access(_word(properties, v.ACCESS)),
        location=_location(properties),
        resolution=Resolution(_word(properties, v.RESOLUTION)),
        implicit=_one(properties, v.IMPLICIT) == "true",
        origin=_one(properties, v.ORIGIN),
        reason=_one(properties, v.REASON),
        description=_one(properties, v.DESCRIPTION),
    )
