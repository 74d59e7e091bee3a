"""Lists over the whole store: its sources, its packages, its topics, services and actions, with counts."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from kg.graph import vocabulary as v

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.graph.reading import Queryable

__all__ = ["CHANNELS", "Channel", "PackageSummary", "channels", "package_names", "packages"]

_PREFIXES: Final = {"ros": v.ROS, "rnkg": v.RNKG, "rdfs": v.RDFS}
CHANNELS: Final = {
    "topic": ("ros:Publisher", "ros:Subscriber"),
    "service": ("ros:ServiceServer", "ros:ServiceClient"),
    "action": ("rnkg:ActionServer", "rnkg:ActionClient"),
}
"""For each kind of channel the component that gives (publishes, serves) and the one that takes."""
_PACKAGES: Final = """
SELECT ?package ?repository ?name ?version ?ros ?folder ?deprecated WHERE {
  ?package a rnkg:Package ; rnkg:name ?name .
  ?r rnkg:contains ?package ; a rnkg:Repository ; rnkg:name ?repository .
  OPTIONAL { ?package rnkg:version ?version }
  OPTIONAL { ?package rnkg:rosVersion ?ros }
  OPTIONAL { ?package rnkg:folder ?folder }
  OPTIONAL { ?package rnkg:deprecated ?deprecated }
}"""
_OWNED: Final = "SELECT ?package ?thing WHERE { ?package a rnkg:Package . %s }"
_ENDS: Final = """
SELECT ?channel ?class ?name ?package ?type WHERE {
  VALUES ?class { %s %s }
  ?end a ?class ; rnkg:connectsTo/rdfs:label ?channel ; rnkg:implicit ?implicit .
  FILTER(%s || !?implicit)
  ?node ros:hasComponent ?end ; rnkg:name ?name .
  ?p rnkg:contains ?node ; rnkg:name ?package .
  OPTIONAL { ?end ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?t . ?t rdfs:label ?type }
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
class Channel:
    """A topic, service or action with its types and the nodes at its two ends, as `package/node`."""

    name: str
    types: tuple[str, ...]
    givers: tuple[str, ...]
    takers: tuple[str, ...]


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
        for row in _rows(graph, _PACKAGES)
    ]
    return sorted(found, key=lambda one: (one.repository, one.name))


def package_names(graph: Queryable) -> list[str]:
    """Return the names of all packages, each once, sorted."""
    return sorted({row[0].value for row in _rows(graph, "SELECT ?name WHERE { ?p a rnkg:Package ; rnkg:name ?name }")})


def channels(graph: Queryable, kind: str, *, implicit: bool = False) -> list[Channel]:
    """Return all topics, services or actions by name; `implicit` adds the ends that frameworks make by themselves."""
    giver, taker = CHANNELS[kind]
    types: defaultdict[str, set[str]] = defaultdict(set)
    ends: defaultdict[str, tuple[set[str], set[str]]] = defaultdict(lambda: (set(), set()))
    local = giver.partition(":")[2]
    for row in _rows(graph, _ENDS % (giver, taker, "true" if implicit else "false")):
        name = row["channel"].value
        side = 0 if row["class"].value.endswith(f"#{local}") else 1
        ends[name][side].add(f"{row['package'].value}/{row['name'].value}")
        if row["type"] is not None:
            types[name].add(row["type"].value)
    return [
        Channel(name, tuple(sorted(types[name])), tuple(sorted(givers)), tuple(sorted(takers)))
        for name, (givers, takers) in sorted(ends.items())
    ]


def _rows(graph: Queryable, text: str) -> Iterable[Any]:
    rows: Iterable[Any] = graph.query(text, prefixes=_PREFIXES)
    return rows


def _text(term: Any) -> str | None:
    return None if term is None else term.value


def _count(graph: Queryable, pattern: str) -> Counter[str]:
    """Count what the pattern binds to ?thing, by the IRI of its package."""
    return Counter(row[0].value for row in _rows(graph, _OWNED % pattern))
