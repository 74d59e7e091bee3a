"""Lists over the whole store: its packages, files and nodes, its topics, services and actions, with counts."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.facts import FileKind, Location, NodeKind
from kg.graph import vocabulary as v
from kg.graph.reading.nodes import which
from kg.graph.reading.queries import column, one_of, texts
from kg.graph.usual_ends import unstated_ends

if TYPE_CHECKING:
    from collections.abc import Collection

    from kg.store.interface import Queryable


_CHANNELS: Final = {
    "topic": ("ros:Publisher", "ros:Subscriber", "ros:hasMessage"),
    "service": ("ros:ServiceServer", "ros:ServiceClient", "rnkg:hasServiceType"),
    "action": ("rnkg:ActionServer", "rnkg:ActionClient", "rnkg:hasActionType"),
}
"""For each kind of channel, the component that gives (publishes, serves), the one that takes, and the property of
the type.
"""
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
# Ordered for the engine (docs/query-core.md): what every end has is in a group that begins from nodes, since most
# ends are of launch files; the LIMIT, which no store reaches, makes the engine look up the rest end by end, and
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
    node: str
    kind: NodeKind
    ros: int
    place: Location
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

    @property
    def giving(self) -> int:
        """Number of nodes that publish to the topic, or serve."""
        return len(self.givers)

    @property
    def taking(self) -> int:
        """Number of nodes that subscribe, or call."""
        return len(self.takers)


def packages(graph: Queryable) -> list[PackageSummary]:
    """Return the packages of the store, sorted by source and name."""
    nodes = _count(graph, "?package rnkg:contains ?thing . ?thing a rnkg:NodeType .")
    definitions = _count(graph, "?package rnkg:contains ?thing . ?thing a rnkg:InterfaceDefinition .")
    problems = _count(graph, "?package rnkg:hasProblem ?thing .")
    summaries = (
        PackageSummary(
            *(repository, name, version, int(ros or 0), folder or ""),
            *(nodes[iri], definitions[iri], problems[iri]),
            deprecated=deprecated is not None,
        )
        for iri, repository, name, version, ros, folder, deprecated in texts(graph, _PACKAGES)
    )
    return sorted(summaries, key=lambda one: (one.repository, one.name))


def files(graph: Queryable) -> list[FileSummary]:
    """Return the files of the packages, sorted by source, package and path."""
    counts: Counter[tuple[str, str]] = Counter()
    for iri, kind, number in texts(graph, _IN_FILES):
        counts[iri, kind.removeprefix(v.RNKG)] += int(number)
    summaries = []
    for iri, repository, package, path, kind in texts(graph, _FILES):
        descriptions = counts[iri, "Description"]
        is_code, is_text = kind in _CODE, kind == FileKind.TEXT or descriptions > 0
        sort = "both" if is_code and is_text else "code" if is_code else "text" if is_text else "other"
        summaries.append(
            FileSummary(repository, package, path, FileKind(kind), sort, counts[iri, "NodeType"], descriptions)
        )
    return sorted(summaries, key=lambda one: (one.repository, one.package, one.path))


def nodes(graph: Queryable, package: str | None = None) -> list[NodeSummary]:
    """Return the node types of the store, or of one package, sorted by source, package, name and place."""
    those = which(package)
    declared: defaultdict[str, Counter[str]] = defaultdict(Counter)
    for node, kind, number in texts(graph, _DECLARED % those):
        declared[node][_DECLARES.get(kind, "")] += int(number)
    for node, number in texts(graph, _PARAMETERS % those):
        declared[node]["parameters"] = int(number)
    numbers = [*dict.fromkeys(_DECLARES.values()), "parameters"]
    summaries = (
        NodeSummary(
            *(repository, owner, name, NodeKind(kind.removeprefix(v.RNKG)), int(ros), Location(path, int(line))),
            *(declared[iri][number] for number in numbers),
        )
        for iri, repository, owner, name, kind, ros, path, line in texts(graph, _NODES % those)
    )
    return sorted(summaries, key=lambda one: (one.repository, one.package, one.node, str(one.place)))


def package_names(graph: Queryable) -> list[str]:
    """Return the names of all packages, each once, sorted."""
    return sorted(column(graph, "SELECT ?name WHERE { ?p a rnkg:Package ; rnkg:name ?name }"))


def channels(
    graph: Queryable, kind: str, *, implicit: bool = False, named: Collection[str] | None = None
) -> list[Channel]:
    """Return all topics, services or actions by name, or those `named`.

    `implicit` adds names whose ends are all made by frameworks. Of other names such ends count too.
    """
    giver, taker, typed = _CHANNELS[kind]
    values = "" if named is None else one_of("channel", named)
    given = {"classes": f"{giver} {taker}", "typed": typed, "named": _named(values), "own": ""}
    names: defaultdict[str, list[str]] = defaultdict(list)
    for node, name, package in texts(graph, _OWNERS):
        names[node].append(f"{package}/{name}")
    types: defaultdict[str, set[str]] = defaultdict(set)
    ends: defaultdict[str, tuple[set[str], set[str]]] = defaultdict(lambda: (set(), set()))
    local = giver.partition(":")[2]
    rows = _ends(graph, given if implicit else given | {"own": "FILTER(!?implicit)"})
    if not implicit and rows:
        own = one_of("channel", {name for name, *_ in rows})
        rows += _ends(graph, given | {"named": _named(own), "own": "FILTER(?implicit)"})
    for name, role, node, message in rows:
        side = 0 if role.endswith(f"#{local}") else 1
        ends[name][side].update(names[node] if node is not None else ())
        types[name].update({message} if message else ())
    launches: defaultdict[str, set[str]] = defaultdict(set)
    for name, configuration in texts(graph, _LAUNCHES % given):
        launches[name].add(configuration)
    for end in unstated_ends(graph):
        if end.role.channel != kind or not (implicit or end.name in ends) or end.name not in (named or {end.name}):
            continue
        launches[end.name].add(end.system)
        ends[end.name][0 if end.role.gives else 1].update(names[end.node])
        types[end.name].update({end.type} if end.type else ())
    return [
        Channel(name, tuple(sorted(types[name])), tuple(sorted(givers)), tuple(sorted(takers)), len(launches[name]))
        for name, (givers, takers) in sorted(ends.items())
    ]


def _named(values: str) -> str:
    return values and f"{values} ?c rdfs:label ?channel ."


def _ends(graph: Queryable, given: dict[str, str]) -> list[tuple[Any, ...]]:
    """Return name, class, node and type of each end, in code and in systems."""
    return [*texts(graph, _IN_CODE % given), *texts(graph, _IN_SYSTEMS % given)]


def _count(graph: Queryable, pattern: str) -> Counter[str]:
    """Count what the pattern binds to ?thing, by the IRI of its package."""
    return Counter(package for package, _ in texts(graph, _OWNED % pattern))
