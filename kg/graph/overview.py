"""Lists over the whole store: its packages, files and nodes, its topics, services and actions, with counts."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.facts import FileKind, Location, NodeKind, Role
from kg.graph import vocabulary as v
from kg.graph.ntriples import literal
from kg.graph.queries import select
from kg.graph.reading import Queryable, which
from kg.graph.usual_ends import unstated_ends

if TYPE_CHECKING:
    from collections.abc import Collection


_CHANNELS: Final = {
    "topic": ("ros:Publisher", "ros:Subscriber", "ros:hasMessage"),
    "service": ("ros:ServiceServer", "ros:ServiceClient", "rnkg:hasServiceType"),
    "action": ("rnkg:ActionServer", "rnkg:ActionClient", "rnkg:hasActionType"),
}
"""For each kind of channel the component that gives (publishes, serves), the one that takes, what leads to the type."""
_GIVERS: Final = frozenset({Role.PUBLISHES, Role.SERVICES, Role.ACTION_SERVERS})
_DECLARES: Final = {
    v.bare(v.PUBLISHER): "publishes",
    v.bare(v.SUBSCRIBER): "subscribes",
    v.bare(v.SERVICE_SERVER): "services",
    v.bare(v.SERVICE_CLIENT): "clients",
    v.bare(v.ACTION_SERVER): "actions",
    v.bare(v.ACTION_CLIENT): "actions",
}
"""For each kind of component the number of `NodeSummary` that it counts in."""
_PACKAGES: Final = """
SELECT ?package ?repository ?name ?version ?ros ?folder ?deprecated WHERE {
  ?package a rnkg:Package ; rnkg:name ?name .
  ?r rnkg:contains ?package ; a rnkg:Repository ; rnkg:name ?repository .
  OPTIONAL { ?package rnkg:version ?version }
  OPTIONAL { ?package rnkg:rosVersion ?ros }
  OPTIONAL { ?package rnkg:folder ?folder }
  OPTIONAL { ?package rnkg:deprecated ?deprecated }
}"""
_FILES: Final = """
SELECT ?file ?repository ?package ?path ?kind WHERE {
  ?r a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?p .
  ?p rnkg:name ?package ; rnkg:contains ?file .
  ?file rnkg:fileKind ?kind ; rnkg:path ?path .
}"""
_IN_FILES: Final = """
SELECT ?file ?class (COUNT(DISTINCT ?thing) AS ?number) WHERE {
  VALUES ?class { rnkg:NodeType rnkg:Description }
  ?thing rnkg:declaredIn|rnkg:hasSource ?file ; a ?class .
}
GROUP BY ?file ?class"""
_CODE: Final = frozenset(
    {FileKind.CPP, FileKind.PYTHON, FileKind.MESSAGE, FileKind.SERVICE, FileKind.ACTION, FileKind.LAUNCH}
)
"""The kinds that RNKG counts as code (section 3.1.2: src, include, scripts, msg and srv folders, launch files)."""
_OWNED: Final = "SELECT ?package ?thing WHERE { ?package a rnkg:Package . %s }"
_OWNERS: Final = """
SELECT ?node ?name ?package WHERE {
  ?p rnkg:name ?package ; rnkg:contains ?node .
  ?node a rnkg:NodeType ; rnkg:name ?name .
}"""
_NODES: Final = """
SELECT ?node ?repository ?package ?name ?kind ?ros ?path ?line WHERE {
  ?r a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?p .
  ?p rnkg:name ?package ; rnkg:contains ?node .
  %s
  ?node rnkg:name ?name ; rnkg:kind ?kind ; rnkg:rosVersion ?ros ; rnkg:path ?path ; rnkg:line ?line .
}"""
# Ordered for the engine (docs/query-core.md): what every end has stands in a group that begins from nodes, since most
# ends are of launch files; the LIMIT, which no store reaches, lets the engine look up what follows end by end, and
# MINUS reads what frameworks make once.
_DECLARED: Final = """
SELECT ?node ?class (COUNT(?end) AS ?number) WHERE {
  { SELECT * WHERE { %s ?node ros:hasComponent ?end } LIMIT 1000000000 }
  MINUS { ?end rnkg:implicit true }
  ?end a ?class .
}
GROUP BY ?node ?class"""
_PARAMETERS: Final = """
SELECT ?node (COUNT(DISTINCT ?known) AS ?number) WHERE {
  { SELECT * WHERE { %s ?node rnkg:hasParameter ?parameter } LIMIT 1000000000 }
  MINUS { ?parameter rnkg:implicit true }
  OPTIONAL { ?parameter rnkg:name ?name }
  BIND(COALESCE(?name, 0) AS ?known)
}
GROUP BY ?node"""
_IN_CODE: Final = """
SELECT DISTINCT ?channel ?class ?node ?type WHERE {
  {
    SELECT * WHERE {
      %(named)s
      ?node a rnkg:NodeType ; ros:hasComponent ?end .
      ?end a ?class ; rnkg:connectsTo ?c ; rnkg:implicit ?implicit .
      %(own)s
    }
    LIMIT 1000000000
  }
  VALUES ?class { %(classes)s }
  ?c rdfs:label ?channel .
  OPTIONAL { ?end %(typed)s/rdfs:label ?type }
}"""
_IN_SYSTEMS: Final = """
SELECT DISTINCT ?channel ?class ?node ?type WHERE {
  {
    SELECT * WHERE {
      %(named)s
      ?instance a rnkg:NodeInstance ; ros:hasComponent ?end .
      ?end rnkg:connectsTo ?c ; rnkg:declaredBy ?code .
      ?code rnkg:implicit ?implicit .
      ?c rdfs:label ?channel .
      %(own)s
    }
    LIMIT 1000000000
  }
  VALUES ?class { %(classes)s }
  ?code a ?class .
  OPTIONAL { ?instance rnkg:instanceOf ?node }
  OPTIONAL { ?code %(typed)s/rdfs:label ?type }
}"""
_LAUNCHES: Final = """
SELECT DISTINCT ?channel ?configuration WHERE {
  %(named)s
  VALUES ?class { %(classes)s }
  ?configuration rnkg:hasInstance/ros:hasComponent ?end .
  ?end rnkg:declaredBy/a ?class ; rnkg:connectsTo ?c .
  ?c rdfs:label ?channel .
}"""


@dataclass(frozen=True, slots=True)
class PackageSummary:
    """A package with how much was found in it."""

    repository: str
    name: str
    version: str | None
    ros: int
    folder: str
    nodes: int
    definitions: int
    problems: int
    deprecated: bool


@dataclass(frozen=True, slots=True)
class FileSummary:
    """A file of a package, sorted into code and text as RNKG does (section 3.1.2, figure 2).

    `sort` is `code`, `text`, `both` for code with comments that describe something, or `other`. `nodes` counts the
    node types that are made from it, `texts` the descriptions that were taken from it.
    """

    repository: str
    package: str
    path: str
    kind: FileKind
    sort: str
    nodes: int
    texts: int


@dataclass(frozen=True, slots=True)
class NodeSummary:
    """A node type with how much its code declares; what frameworks make by themselves is not counted."""

    repository: str
    package: str
    name: str
    kind: NodeKind
    ros: int
    location: Location
    publishes: int
    subscribes: int
    services: int
    clients: int
    actions: int
    parameters: int


@dataclass(frozen=True, slots=True)
class Channel:
    """A topic, service or action with its types and the nodes at its two ends, as `package/node`.

    The nodes have it where they are started alone, or in one of so many `systems`, as launch files start them.
    """

    name: str
    types: tuple[str, ...]
    givers: tuple[str, ...]
    takers: tuple[str, ...]
    systems: int


def packages(graph: Queryable) -> list[PackageSummary]:
    """Return the packages of the store, sorted by source and name."""
    nodes = _count(graph, "?package rnkg:contains ?thing . ?thing a rnkg:NodeType .")
    definitions = _count(graph, "?package rnkg:defines ?thing .")
    problems = _count(graph, "?package rnkg:hasProblem ?thing .")
    found = [
        PackageSummary(
            repository=_text(row["repository"]) or "",
            name=_text(row["name"]) or "",
            version=_text(row["version"]),
            ros=int(_text(row["ros"]) or 0),
            folder=_text(row["folder"]) or "",
            nodes=nodes[row["package"].value],
            definitions=definitions[row["package"].value],
            problems=problems[row["package"].value],
            deprecated=row["deprecated"] is not None,
        )
        for row in select(graph, _PACKAGES)
    ]
    return sorted(found, key=lambda one: (one.repository, one.name))


def files(graph: Queryable) -> list[FileSummary]:
    """Return the files of the packages, sorted by source, package and path."""
    counts: Counter[tuple[str, str]] = Counter()
    for row in select(graph, _IN_FILES):
        counts[row["file"].value, row["class"].value.removeprefix(v.RNKG)] += int(row["number"].value)
    found = []
    for row in select(graph, _FILES):
        kind, iri = FileKind(row["kind"].value), row["file"].value
        texts = counts[iri, "Description"]
        is_code, is_text = kind in _CODE, kind is FileKind.TEXT or texts > 0
        sort = "both" if is_code and is_text else "code" if is_code else "text" if is_text else "other"
        place = (row["repository"].value, row["package"].value, row["path"].value)
        found.append(FileSummary(*place, kind, sort, counts[iri, "NodeType"], texts))
    return sorted(found, key=lambda one: (one.repository, one.package, one.path))


def nodes(graph: Queryable, package: str | None = None) -> list[NodeSummary]:
    """Return the node types of the store, or of one package, sorted by source, package, name and place."""
    those = which(package)
    declared: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for row in select(graph, _DECLARED % those):
        declared[row["node"].value][_DECLARES.get(row["class"].value, "")] += int(row["number"].value)
    for row in select(graph, _PARAMETERS % those):
        declared[row["node"].value]["parameters"] = int(row["number"].value)
    numbers = [*dict.fromkeys(_DECLARES.values()), "parameters"]
    found = [
        NodeSummary(
            repository=row["repository"].value,
            package=row["package"].value,
            name=row["name"].value,
            kind=NodeKind(row["kind"].value.removeprefix(v.RNKG)),
            ros=int(row["ros"].value),
            location=Location(row["path"].value, int(row["line"].value)),
            **{number: declared[row["node"].value][number] for number in numbers},
        )
        for row in select(graph, _NODES % those)
    ]
    return sorted(found, key=lambda one: (one.repository, one.package, one.name, str(one.location)))


def package_names(graph: Queryable) -> list[str]:
    """Return the names of all packages, each once, sorted."""
    return sorted({row[0].value for row in select(graph, "SELECT ?name WHERE { ?p a rnkg:Package ; rnkg:name ?name }")})


def channels(
    graph: Queryable, kind: str, *, implicit: bool = False, named: Collection[str] | None = None
) -> list[Channel]:
    """Return all topics, services or actions by name, or those `named`.

    `implicit` adds the ends that frameworks make by themselves, and names that have no others.
    """
    giver, taker, typed = _CHANNELS[kind]
    values = "" if named is None else f"VALUES ?channel {{ {' '.join(map(literal, sorted(named)))} }}"
    given = {"classes": f"{giver} {taker}", "typed": typed}
    given |= {"named": values and f"{values} ?c rdfs:label ?channel .", "own": "" if implicit else "FILTER(!?implicit)"}
    names: defaultdict[str, list[str]] = defaultdict(list)
    for row in select(graph, _OWNERS):
        names[row["node"].value].append(f"{row['package'].value}/{row['name'].value}")
    types: defaultdict[str, set[str]] = defaultdict(set)
    ends: defaultdict[str, tuple[set[str], set[str]]] = defaultdict(lambda: (set(), set()))
    local = giver.partition(":")[2]
    for row in (*select(graph, _IN_CODE % given), *select(graph, _IN_SYSTEMS % given)):
        name = row["channel"].value
        side = 0 if row["class"].value.endswith(f"#{local}") else 1
        ends[name][side].update(names[row["node"].value] if row["node"] is not None else ())
        if row["type"] is not None:
            types[name].add(row["type"].value)
    launches: defaultdict[str, set[str]] = defaultdict(set)
    for row in select(graph, _LAUNCHES % given):
        launches[row["channel"].value].add(row["configuration"].value)
    for end in unstated_ends(graph):
        if end.role.channel != kind or not (implicit or end.name in ends) or end.name not in (named or {end.name}):
            continue
        launches[end.name].add(end.system)
        if implicit:
            ends[end.name][0 if end.role in _GIVERS else 1].update(names[end.node])
            types[end.name].update({end.type} if end.type else ())
    return [
        Channel(name, tuple(sorted(types[name])), tuple(sorted(givers)), tuple(sorted(takers)), len(launches[name]))
        for name, (givers, takers) in sorted(ends.items())
    ]


def _text(term: Any) -> str | None:
    return None if term is None else term.value


def _count(graph: Queryable, pattern: str) -> Counter[str]:
    """Count what the pattern binds to ?thing, by the IRI of its package."""
    return Counter(row[0].value for row in select(graph, _OWNED % pattern))
