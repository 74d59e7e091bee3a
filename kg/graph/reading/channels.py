"""Topics, services and actions by name: who uses one in launched systems and in code, read for that name alone.

Reading whole systems for one name would take time in proportion to the store.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Final

from pyoxigraph import NamedNode

from kg.facts import Interface, Location, NodeReference, System
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.ntriples import literal
from kg.graph.reading.nodes import code_facts
from kg.graph.reading.queries import column, one_of, texts
from kg.graph.reading.systems import partial_systems
from kg.graph.usual_ends import channels_by_system, unstated_ends
from kg.holes import fits, is_partial

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from kg.store.interface import Queryable


CLASSES: Final = {
    "topic": f"{v.PUBLISHER} {v.SUBSCRIBER}",
    "service": f"{v.SERVICE_SERVER} {v.SERVICE_CLIENT}",
    "action": f"{v.ACTION_SERVER} {v.ACTION_CLIENT}",
}
"""The classes of the ends of each kind of channel."""
_AMONG: Final = {kind: classes.replace(" ", ", ") for kind, classes in CLASSES.items()}
"""The same for a filter: the engine begins with VALUES, and each class has many ends."""
_NAMES: Final = """
SELECT DISTINCT ?name WHERE {
  VALUES ?class { %s }
  ?code a ?class ; rnkg:implicit ?implicit .
  FILTER(!?implicit)
  ?end rnkg:declaredBy ?code ; rnkg:connectsTo/rdfs:label ?name .
}"""
_EVERY_NAME: Final = """
SELECT DISTINCT ?name WHERE {
  VALUES ?class { %s }
  ?code a ?class .
  ?end rnkg:declaredBy ?code ; rnkg:connectsTo/rdfs:label ?name .
}"""
_CALLED: Final = """
SELECT DISTINCT ?name WHERE {
  %s
  ?end rnkg:connectsTo/rdfs:label ?name ; rnkg:declaredBy ?code .
  ?code a ?class .
  FILTER(?class IN (%s))
}"""
_WRITTEN: Final = """
SELECT DISTINCT ?name WHERE {
  ?declared rnkg:name %s ; a ?class .
  FILTER(?class IN (%s))
  ?end rnkg:declaredBy ?declared ; rnkg:connectsTo/rdfs:label ?name .
}"""
_AT: Final = """
GRAPH ?graph {
  ?channel rdfs:label %s .
  ?part rnkg:connectsTo ?channel ; rnkg:declaredBy ?code .
  ?instance ros:hasComponent ?part .
}
?code a ?class .
FILTER(?class IN (%s))"""
_DEFINING: Final = """
SELECT DISTINCT ?repository ?path ?line WHERE {
  %s
  ?definition rnkg:defines/rdfs:label ?label ; rnkg:path ?path ; rnkg:line ?line .
  ?package rnkg:contains ?definition .
  ?source rnkg:contains ?package ; rnkg:name ?repository .
}"""
_FINDINGS: Final = """
SELECT ?system ?code ?severity ?message ?subject WHERE {
  ?finding rnkg:mainSubject %s ; a rnkg:Finding ; rnkg:inConfiguration ?system ; rnkg:code ?code ;
    rnkg:severity ?severity ; rnkg:message ?message ; rnkg:subject ?subject .
}"""


def names(graph: Queryable, kind: str, *, implicit: bool = False) -> list[str]:
    """Return the names of all topics, services or actions, of systems and of nodes started alone, sorted.

    Those that only frameworks use are there with `implicit` alone.
    """
    every = column(graph, (_EVERY_NAME if implicit else _NAMES) % CLASSES[kind])
    more = unstated_ends(graph) if implicit else ()
    return sorted(every | {end.name for end in more if end.role.channel == kind})


def every_name(graph: Queryable) -> dict[str, list[str]]:
    """Return the names of all topics, services and actions by kind, those that only frameworks use too, sorted."""
    by_kind = {kind: column(graph, _EVERY_NAME % classes) for kind, classes in CLASSES.items()}
    for end in unstated_ends(graph):
        by_kind[end.role.channel].add(end.name)
    return {kind: sorted(kind_names) for kind, kind_names in by_kind.items()}


def channels_called(graph: Queryable, called: Iterable[str]) -> list[tuple[str, str]]:
    """Return the topics, services and actions of some absolute names, as kind and name, sorted."""
    wanted = set(called)
    those = one_of("name", wanted)
    pairs = {(kind, name) for kind, classes in _AMONG.items() for name in column(graph, _CALLED % (those, classes))}
    pairs |= {(end.role.channel, end.name) for name in wanted for end in unstated_ends(graph, name)}
    return sorted(pairs)


def names_in(graph: Queryable, kind: str, systems: Iterable[str]) -> list[str]:
    """Return the names of topics, services or actions of some configurations, by their IRIs, sorted."""
    channels = channels_by_system(graph)
    return sorted({name for one in systems for own, name in channels.get(one, ()) if own == kind})


def names_written(graph: Queryable, kind: str, written: str) -> list[str]:
    """Return the names that ends have whose name in the code is `written`, in systems and started alone, sorted."""
    return sorted(column(graph, _WRITTEN % (literal(written), _AMONG[kind])))


def ends_in_code(graph: Queryable, kind: str, name: str, base: str) -> list[tuple[NodeReference, Interface]]:
    """Return the interfaces that have this name where their node is started alone, sorted."""
    channel = NamedNode(Iris(base).channel(kind, name))
    return _interfaces(graph, f"?subject rnkg:connectsTo {channel} .")


def possible_ends(
    graph: Queryable, kind: str, name: str, types: Collection[str] = ()
) -> list[tuple[NodeReference, Interface]]:
    """Return the interfaces in code that may have this name, sorted; none of frameworks.

    Parts of their names are unknown, and the others fit: a relative name may have any namespace in front, and at least
    one segment of it is known. Those whose whole name is unknown are there if they have one of some `types`.
    """
    unknown = f"?subject rnkg:resolution ?how ; rnkg:implicit false ; a ?kind . FILTER(?kind IN ({_AMONG[kind]}))"
    ends = _interfaces(graph, f"VALUES ?how {{ rnkg:partial rnkg:unresolved }} {unknown}")
    return [(owner, fact) for owner, fact in ends if (_may_be(fact.name, name) if fact.name else fact.type in types)]


def _may_be(partial: str, name: str) -> bool:
    segments = partial.removeprefix("~/").strip("/").split("/")
    if all(is_partial(one) for one in segments):
        return False
    if partial.startswith("/"):
        return fits(partial, name)
    return fits("/".join(segments), "/".join(name.split("/")[-len(segments) :]))


def _interfaces(graph: Queryable, those: str) -> list[tuple[NodeReference, Interface]]:
    facts_by_iri = code_facts(graph, those)
    ends = [(owner, fact) for owner, fact in facts_by_iri.values() if isinstance(fact, Interface)]
    return sorted(ends, key=lambda one: (one[1].role, one[0], str(one[1].location), one[1].type or ""))


def defining_places(graph: Queryable, types: Iterable[str]) -> list[tuple[str, Location]]:
    """Return where the store has the definitions of some types (`package/Type`): source and place, sorted."""
    rows = texts(graph, _DEFINING % one_of("label", set(types)))
    return sorted((repository, Location(path, int(line))) for repository, path, line in rows)


def systems_at(graph: Queryable, kind: str, name: str, base: str) -> list[System]:
    """Return the systems with a topic, service or action of this name; their instances have their ends there alone.

    Instances that do not use it are left out, and so are parameters and remappings that did not name an end.
    """
    pattern = _AT % (literal(name), _AMONG[kind])
    usual = [end for end in unstated_ends(graph, name) if end.role.channel == kind]
    return partial_systems(graph, None, [(v.HAS_COMPONENT, pattern)], base, usual)


def findings_about(graph: Queryable, name: str) -> dict[tuple[str, str, str], tuple[list[str], list[str]]]:
    """Return what rules found about a name: code, severity and message, each with its subjects and configurations.

    Of configurations these are the IRIs.
    """
    by_finding: defaultdict[tuple[str, str, str], tuple[set[str], set[str]]] = defaultdict(lambda: (set(), set()))
    for system, code, severity, message, subject in texts(graph, _FINDINGS % literal(name)):
        subjects, systems = by_finding[code, severity, message]
        subjects.add(subject)
        systems.add(system)
    return {key: (sorted(by_finding[key][0]), sorted(by_finding[key][1])) for key in sorted(by_finding)}
