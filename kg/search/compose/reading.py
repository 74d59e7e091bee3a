"""Read the network of a store by two large and two short queries, and cache it with the store."""

from __future__ import annotations

from collections import defaultdict
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final
from urllib.parse import unquote

import msgspec

from kg.graph import vocabulary as v
from kg.graph.iris import UNKNOWN, is_source_graph
from kg.holes import known_letters
from kg.names import FRAMEWORK
from kg.query.rows import rows
from kg.search.cache import keep, load_cached
from kg.search.compose.network import Network, Part, Port
from kg.search.folding import bare_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from kg.store.interface import Snapshot

_NODES: Final = """
?n ?kind ?ros ?path ?line ?x ?plugin ?own {
  ?n a rnkg:NodeType ; rnkg:kind ?kind ; rnkg:rosVersion ?ros ; rnkg:path ?path ; rnkg:line ?line
  OPTIONAL { ?n rnkg:hasExecutable/rnkg:name ?x } OPTIONAL { ?n rnkg:pluginName ?plugin }
  OPTIONAL { ?n rnkg:nodeName ?own }
}"""
_ENDS: Final = "?c ?t { ?c ros:hasMessage ?t ; rnkg:implicit false }"
_MORE: Final = """
?c ?p ?o { VALUES ?p { rnkg:parameterName rnkg:switchedBy rnkg:leastArguments rnkg:deprecated } ?c ?p ?o }"""
_STARTED: Final = "SELECT ?n ?g { GRAPH ?g { ?i rnkg:instanceOf ?n } }"
_LOADED: Final = ("nodelet", "component")
_ROLES: Final = ("publisher", "subscriber")
_FOLDER: Final = "compose"


def network(snapshot: Snapshot, cache: Path | None) -> Network:
    """Return the network of a snapshot, from the folder `cache` if present; else read it and save it there."""
    if cache is None:
        return read(snapshot)
    body = load_cached(cache / _FOLDER, snapshot.identity)
    if body is not None:
        return msgspec.json.decode(body, type=Network)
    network_read = read(snapshot)
    # In a read-only store the network is read each time.
    with suppress(OSError):
        keep(cache / _FOLDER, snapshot.identity, [msgspec.json.encode(network_read)])
    return network_read


def read(snapshot: Snapshot) -> Network:
    """Return the network of a snapshot: nodes that launch files can start and that have publishers or subscribers."""
    sources = _Sources(snapshot)
    more: defaultdict[str, defaultdict[str, set[str]]] = defaultdict(lambda: defaultdict(set))
    for subject, predicate, value in sources.rows(_MORE):
        more[subject][predicate].add(value)
    ports = _ports(sources.rows(_ENDS), more)
    launches = _numbered(rows(snapshot, _STARTED))
    parts_by_iri: dict[str, Part] = {}
    for iri, kind, ros, path, line, executable, plugin, own in sources.rows(_NODES):
        startable = executable or (plugin and kind.removeprefix(v.RNKG) in _LOADED)
        if iri in parts_by_iri or iri not in ports or not startable:
            continue
        repository, package, name = _names(iri)
        deprecated = v.bare(v.DEPRECATED) in more.get(_package_of(iri), ())
        parts_by_iri[iri] = Part(
            iri, repository, package, name, kind.removeprefix(v.RNKG), int(ros), path, int(line),
            executable or None, plugin or None, own or None, deprecated,
            launches=launches.get(iri, ()), inputs=_of(ports[iri], "subscriber"), outputs=_of(ports[iri], "publisher"),
        )  # fmt: skip
    parts = sorted(
        parts_by_iri.values(), key=lambda one: (one.repository, one.package, one.name, one.path, one.line, one.iri)
    )
    return Network(_with_families(parts))


class _Sources:
    """Rows of queries over the graphs of sources."""

    def __init__(self, snapshot: Snapshot) -> None:
        self.snapshot = snapshot
        self.graphs = " ".join(str(graph) for graph in snapshot.graphs() if is_source_graph(graph.value))

    def rows(self, body: str) -> Iterator[Any]:
        """Yield the rows of `variables { pattern }` over the graph of each source."""
        variables, _, pattern = body.partition("{")
        yield from rows(self.snapshot, f"SELECT {variables} {{ VALUES ?g {{ {self.graphs} }} GRAPH ?g {{ {pattern} }}")


def _numbered(rows: Iterable[tuple[str, ...]]) -> dict[str, tuple[int, ...]]:
    """Return the numbers of the graphs that contain each node."""
    pairs = sorted(set(rows))
    numbers = {graph: place for place, graph in enumerate(sorted({graph for _, graph in pairs}))}
    by_node: defaultdict[str, list[int]] = defaultdict(list)
    for node, graph in pairs:
        by_node[node].append(numbers[graph])
    return {node: tuple(sorted(places)) for node, places in by_node.items()}


def _ports(
    rows: Iterable[tuple[str, ...]], more: Mapping[str, Mapping[str, set[str]]]
) -> dict[str, list[tuple[str, Port]]]:
    """Return the ends of each node with their role, without those of frameworks."""
    by_node: defaultdict[str, list[tuple[str, Port]]] = defaultdict(list)
    for iri, type_iri in sorted(set(rows)):
        node, role, name = _split(iri)
        if role not in _ROLES or (name is not None and f"/{name.lstrip('/')}" in FRAMEWORK):
            continue
        properties = more.get(iri, {})
        port = Port(
            iri,
            name if name and known_letters(name) else None,
            unquote(type_iri.rpartition("/message/")[2]),
            min(properties.get(v.bare(v.PARAMETER_NAME), ()), default=None),
            tuple(sorted(properties.get(v.bare(v.SWITCHED_BY), ()))),
            int(min(properties.get(v.bare(v.LEAST_ARGUMENTS), ()), default="0")),
        )
        by_node[node].append((role, port))
    return by_node


def _of(ports: Iterable[tuple[str, Port]], role: str) -> tuple[Port, ...]:
    return tuple(port for one, port in ports if one == role)


def _split(iri: str) -> tuple[str, str, str | None]:
    """Return the node, the role and the name in the IRI of an end (`kg.graph.iris.fragment`)."""
    whole, _, part = iri.partition("#")
    again = ""
    if not part.startswith(_ROLES):  # fragments distinguish several nodes with the same name
        at = min((place for role in _ROLES if (place := part.find(f"/{role}/")) >= 0), default=-1)
        if at < 0:
            return whole, part.partition("/")[0], None
        again, part = f"#{part[:at]}", part[at + 1 :]
    role, _, name = part.partition("/")
    own = None if name.startswith(UNKNOWN) else unquote(name.partition("@")[0])
    return whole + again, role, own or None


def _package_of(iri: str) -> str:
    """Return the IRI of the package of a node."""
    return iri.replace("/node/", "/package/", 1).partition("#")[0].rpartition("/")[0]


def _names(iri: str) -> tuple[str, str, str]:
    """Return the repository, the package and the name of a node."""
    *repository, package, name = iri.partition("/node/")[2].partition("#")[0].split("/")
    return unquote("/".join(repository)), unquote(package), unquote(name)


def _with_families(parts: list[Part]) -> list[Part]:
    """Return the parts with their families: equal names of nodes and packages, ignoring words of form."""
    first: dict[tuple[int, str, str], int] = {}
    return [
        msgspec.structs.replace(part, family=first.setdefault((part.ros, part.package, bare_name(part.name)), place))
        for place, part in enumerate(parts)
    ]
