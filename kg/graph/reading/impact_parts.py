"""The parts of systems that a change to a name may reach, as `kg.graph.reading.systems.partial_systems` takes them.

Each is a relation and a pattern that binds ?graph, ?instance and ?part. Whole systems would take time in proportion to
the store.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Final, TypeAlias

from kg.graph import vocabulary as v
from kg.graph.ntriples import literal
from kg.graph.reading.queries import among, column, one_of
from kg.graph.usual_ends import UsualEnd, unstated_ends
from kg.holes import fits

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.store.interface import Queryable


_Parts: TypeAlias = "list[tuple[str, str]]"
_HAVING: Final = "?instance ros:hasComponent ?part"
_STARTED: Final = "GRAPH ?graph { ?instance rnkg:startedWith ?part }"
_NAMED: Final = "GRAPH ?graph { ?instance rnkg:name ?name }"
_UNKNOWN: Final = 'SELECT DISTINCT ?name WHERE { ?end rnkg:resolvedName ?name FILTER(CONTAINS(?name, "{")) }'
_HOLDING: Final = "SELECT DISTINCT ?value WHERE { ?part rnkg:value ?value FILTER(CONTAINS(?value, %s)) }"
_SETTABLE: Final = """
SELECT DISTINCT ?name WHERE { ?start rnkg:hasSetting ?part . ?part rnkg:name|(rnkg:sets/rnkg:name) ?name }"""


def partial_names(graph: Queryable) -> list[str]:
    """Return the names of ends with unknown parts, sorted."""
    return sorted(column(graph, _UNKNOWN))


def set_names(graph: Queryable) -> list[str]:
    """Return the names of the settings of instances and those of the parameters that they set, sorted."""
    return sorted(column(graph, _SETTABLE))


def at_channel(graph: Queryable, kind: str, name: str, partly: Iterable[str]) -> tuple[_Parts, list[UsualEnd]]:
    """Return the ends that have a name or may have it, and the settings and remappings that hold it.

    `partly` are the names that are not known whole.
    """
    text, bare = literal(name), literal(name.lstrip("/"))
    # All values are read for this, once.
    holding = one_of("value", column(graph, _HOLDING % bare))
    unknown = {own for own in partly if fits(own, name)}
    ends = (
        f"GRAPH ?graph {{ ?channel rdfs:label {text} . ?part rnkg:connectsTo ?channel . {_HAVING} }}",
        f"{one_of('name', unknown)} GRAPH ?graph {{ ?part rnkg:resolvedName ?name . {_HAVING} }}",
        f"?remap rnkg:from {text} . GRAPH ?graph {{ ?part rnkg:remappedBy ?remap . {_HAVING} }}",
        f"{holding} ?setting rnkg:value ?value . GRAPH ?graph {{ ?part rnkg:namedBy ?setting . {_HAVING} }}",
    )
    usual = [end for end in unstated_ends(graph, name) if end.role.channel == kind]
    return [
        *((v.HAS_COMPONENT, end) for end in ends),
        (v.HAS_SETTING, _setting(f"{holding} ?part rnkg:value ?value .")),
    ], usual


def at_parameter(name: str, candidates: Iterable[str]) -> _Parts:
    """Return the settings whose name may be that of a parameter, the ends that these name, and whom those meet.

    `candidates` are the names of settings and of the parameters that they set.
    """
    last = re.split(r"[./~]", name)[-1]
    names = {one for one in candidates if last in one}
    if not names:
        return []
    named = f"{_named('?setting', names)} GRAPH ?graph {{ ?named rnkg:namedBy ?setting }}"
    return [
        (v.HAS_SETTING, _setting(_named("?part", names))),
        (
            v.HAS_COMPONENT,
            f"{named} GRAPH ?graph {{ ?named rnkg:connectsTo ?met . ?part rnkg:connectsTo ?met . {_HAVING} }}",
        ),
        (
            v.HAS_COMPONENT,
            f"{named} GRAPH ?graph {{ ?named rnkg:resolvedName ?met . ?part rnkg:resolvedName ?met . {_HAVING} }}",
        ),
    ]


def at_node(graph: Queryable, name: str, types: Iterable[str]) -> _Parts:
    """Return the instances of a name or of node types (IRIs), whom they meet, and what hosts, loads or lists them."""
    kinds = among("type", types)

    def own(variable: str) -> str:
        return (
            f"{{ GRAPH ?graph {{ {variable} rnkg:name {literal(name)} ; rnkg:startedWith ?own }} }} UNION"
            f" {{ {kinds} GRAPH ?graph {{ {variable} rnkg:instanceOf ?type ; rnkg:startedWith ?own }} }}"
        )

    names = column(graph, f"SELECT DISTINCT ?name WHERE {{ {own('?instance')} {_NAMED} }}") | {name}
    lasts = {one.rpartition("/")[2] for one in names if one.startswith("/")}
    tests = " || ".join(f"CONTAINS(?value, {literal(last)})" for last in sorted(lasts))
    meeting = f"?named ros:hasComponent/rnkg:connectsTo ?met . ?part rnkg:connectsTo ?met . {_HAVING}"
    return [
        (v.STARTED_WITH, f"{own('?instance')} {_STARTED}"),
        (v.HAS_COMPONENT, f"{own('?instance')} GRAPH ?graph {{ {_HAVING} }}"),
        (v.HAS_SETTING, f"{own('?instance')} ?own rnkg:hasSetting ?part ."),
        (v.HAS_COMPONENT, f"{own('?named')} GRAPH ?graph {{ {meeting} }}"),
        (v.HOST, f"{own('?part')} GRAPH ?graph {{ ?instance rnkg:host ?part }}"),
        (v.STARTED_WITH, f"{kinds} GRAPH ?graph {{ ?instance rnkg:loadsPlugin ?type }} {_STARTED}"),
        *((v.HAS_SETTING, _setting(f"?part rnkg:value ?value FILTER({tests})")) for _ in range(bool(tests))),
    ]


def at_file(path: str) -> _Parts:
    """Return the instances that a file starts, and the settings that it holds."""
    pattern = f"?part rnkg:path {literal(path)} ."
    return [
        (v.STARTED_WITH, f"GRAPH ?graph {{ ?instance rnkg:path {literal(path)} ; rnkg:startedWith ?part }}"),
        (v.HAS_SETTING, _setting(pattern)),
    ]


def of_types(graph: Queryable, names: Iterable[str]) -> tuple[_Parts, list[UsualEnd]]:
    """Return the ends whose messages, services or actions are of types, as `package/Type`."""
    wanted = set(names)
    relations = "ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType"
    pattern = (
        f"{one_of('label', wanted)} ?type rdfs:label ?label . ?code {relations} ?type ."
        f" GRAPH ?graph {{ ?part rnkg:declaredBy|rnkg:overrides ?code . {_HAVING} }}"
    )
    return [(v.HAS_COMPONENT, pattern)], unstated_ends(graph, types=wanted)


def _setting(pattern: str) -> str:
    """Return the pattern of settings of instances; `pattern` is one for ?part."""
    return f"{pattern} ?start rnkg:hasSetting ?part . GRAPH ?graph {{ ?instance rnkg:startedWith ?start }}"


def _named(variable: str, names: Iterable[str]) -> str:
    return f"{one_of('name', names)} {variable} rnkg:name|(rnkg:sets/rnkg:name) ?name ."
