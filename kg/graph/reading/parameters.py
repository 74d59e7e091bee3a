"""Parameters by name: what code declares them, and what launch and parameter files set them to, for that name alone."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.facts import Location, NodeReference, Parameter
from kg.graph import vocabulary as v
from kg.graph.fields import one, place_of
from kg.graph.ntriples import literal
from kg.graph.reading.nodes import code_facts
from kg.graph.reading.queries import among, column, one_of, properties_in, texts

if TYPE_CHECKING:
    from collections.abc import Collection

    from kg.store.interface import Queryable


_DECLARED: Final = "SELECT DISTINCT ?name WHERE { ?parameter rnkg:access ?access ; rnkg:name ?name }"
_DECLARED_AMONG: Final = """
SELECT DISTINCT ?name WHERE {
  %s
  ?parameter rnkg:name ?name .
  ?parameter rnkg:access ?access .
}"""
_SET_NAMES: Final = """
SELECT DISTINCT ?node ?name WHERE {
  { ?owner rnkg:startedWith/rnkg:hasSetting ?setting }
  UNION { ?owner a rnkg:LaunchConfiguration ; rnkg:hasSetting ?setting }
  ?owner rnkg:name ?node .
  ?setting rnkg:name ?name .
}"""
_SET: Final = """
SELECT DISTINCT ?setting ?owner ?name WHERE {
  { SELECT ?setting ?name { ?setting rnkg:name ?name . %s } }
  { SELECT ?setting ?of { ?of rnkg:hasSetting ?setting } }
  { SELECT ?of ?owner { { ?owner rnkg:startedWith ?of } UNION { ?of a rnkg:LaunchConfiguration BIND(?of AS ?owner) } } }
}"""
"""Nested SELECTs are joined by hashing: looked up one by one, the settings of 77 repositories took minutes."""
_PROPERTIES: Final = """
SELECT ?subject ?predicate ?object WHERE {
  %s
  ?subject ?predicate ?object .
  FILTER(?predicate NOT IN (ros:hasComponent, rnkg:hasSetting, rnkg:readsEntry, rnkg:hasRemap))
}"""
_SYSTEMS: Final = """
SELECT ?instance ?system WHERE {
  %s
  ?system rnkg:hasInstance ?instance .
}"""
_NAMED: Final = """
SELECT DISTINCT ?instance ?type WHERE {
  %s
  ?instance rnkg:name ?name .
  ?instance rnkg:instanceOf ?type .
}"""
_INSTANCES: Final = """
SELECT DISTINCT ?instance WHERE {
  %s
  ?instance rnkg:instanceOf ?type .
}"""

_OPEN: Final = """
SELECT ?instance ?setting ?name WHERE {
  %s
  ?instance rnkg:startedWith/rnkg:hasSetting ?setting .
  ?setting rnkg:name ?name FILTER(STRENDS(?name, "/{}"))
}"""


@dataclass(frozen=True, slots=True)
class Start:
    """A start of a node: its absolute name, the IRI of the configuration, that of its type, and the launch line."""

    iri: str
    name: str
    system: str
    type: str | None
    location: Location


@dataclass(frozen=True, slots=True)
class SetParameter:
    """A parameter that a launch or parameter file sets: `name` relative to the node, `absolute` with its name.

    `start` is None where it is set for all nodes of a configuration; `declared` is the IRI of the declaration in code.
    `value` is a text of YAML, None where it is not known, for this `reason`. `location` is None for the default in
    the code.
    """

    name: str
    absolute: str
    value: str | None
    reason: str | None
    location: Location | None
    system: str
    start: Start | None
    declared: str | None


def declared_names(graph: Queryable) -> list[str]:
    """Return the names of parameters as code declares them, sorted; some have unknown parts."""
    return sorted(column(graph, _DECLARED))


def declared_among(graph: Queryable, names: Collection[str]) -> set[str]:
    """Return those of some names that parameters have in code, without a look at other parameters."""
    return column(graph, _DECLARED_AMONG % one_of("name", names))


def set_names(graph: Queryable) -> list[str]:
    """Return the names of parameters that files set, relative to their nodes, sorted."""
    return sorted({name.removeprefix(f"{node}/") for node, name in texts(graph, _SET_NAMES)})


def declarations(
    graph: Queryable, named: Collection[str], iris: Collection[str], owners: Collection[str] | None = None
) -> dict[str, tuple[NodeReference, Parameter]]:
    """Return what code does with parameters of some names, and with those of some IRIs, by IRI; with the node types.

    With `owners` relative names are those of parameters of these node types alone.
    """
    relative = [] if owners is None else [one for one in named if not one.startswith("/")]
    those = []
    if absolute := set(named).difference(relative):
        those.append(f"{one_of('name', absolute)} ?subject rnkg:name ?name")
    if relative and owners:
        having = f"{among('owner', owners)} ?owner ros:hasComponent|rnkg:hasParameter ?subject"
        those.append(
            f"{having} . ?subject rnkg:name ?name FILTER(?name IN ({', '.join(map(literal, sorted(relative)))}))"
        )
    if iris:
        those.append(among("subject", iris))
    if not those:
        return {}
    either = " UNION ".join(f"{{ {one} }}" for one in those)
    facts_by_iri = code_facts(graph, f"{{ {either} }} ?subject rnkg:access ?access .")
    parameters = {iri: (owner, fact) for iri, (owner, fact) in facts_by_iri.items() if isinstance(fact, Parameter)}
    return dict(sorted(parameters.items(), key=lambda one: (one[1][0], str(one[1][1].access), str(one[1][1].location))))


def set_parameters(graph: Queryable, name: str) -> list[SetParameter]:
    """Return the parameters that files set and that have a name, relative to the node or absolute."""
    # An absolute name is looked up; another one is the end of absolute names, all of which are read.
    those = one_of("name", [name]) if name.startswith("/") else f"FILTER(STRENDS(?name, {literal(name)}))"
    rows = list(texts(graph, _SET % those))
    owners = {start.iri: start for start in _starts(graph, {owner for _, owner, _ in rows})}
    properties = _properties(graph, {setting for setting, _, _ in rows})
    values = []
    for setting, owner, full in rows:
        own, start = properties[setting], owners.get(owner)
        values.append(
            SetParameter(
                name=full.removeprefix(f"{start.name}/") if start else full,
                absolute=full,
                value=one(own, v.VALUE),
                reason=one(own, v.REASON),
                location=place_of(own),
                system=start.system if start else owner,
                start=start,
                declared=one(own, v.SETS),
            )
        )
    values = [one for one in values if name in {one.name, one.absolute}]
    return sorted(values, key=lambda one: (one.absolute, one.system, str(one.location)))


def types_started(graph: Queryable, names: Collection[str]) -> set[str]:
    """Return the IRIs of the node types of instances of some names."""
    return {kind for _, kind in texts(graph, _NAMED % one_of("name", names))}


def starts(graph: Queryable, types: Collection[str], names: Collection[str] | None = None) -> list[Start]:
    """Return the starts of nodes of some types, by their IRIs; with `names` those of instances of these names alone."""
    if names is None:
        return _starts(graph, column(graph, _INSTANCES % among("type", types)) if types else set())
    rows = texts(graph, _NAMED % one_of("name", names)) if types and names else ()
    return _starts(graph, {instance for instance, kind in rows if kind in types})


def unknown_files(graph: Queryable, starts: Collection[Start]) -> dict[str, SetParameter]:
    """Return the first unknown parameter file of each start that loads one, by the IRI of the start."""
    by_iri = {start.iri: start for start in starts}
    rows = sorted(texts(graph, _OPEN % among("instance", by_iri))) if by_iri else []
    properties = _properties(graph, {setting for _, setting, _ in rows})
    files: dict[str, SetParameter] = {}
    for iri, setting, name in rows:
        own, start = properties[setting], by_iri[iri]
        file = SetParameter("{}", name, None, one(own, v.REASON), place_of(own), start.system, start, None)
        files.setdefault(iri, file)
    return files


def _starts(graph: Queryable, instances: Collection[str]) -> list[Start]:
    systems: defaultdict[str, str] = defaultdict(str)
    systems.update(texts(graph, _SYSTEMS % among("instance", instances)))
    return [
        Start(iri, one(own, v.NAME) or "", systems[iri], one(own, v.INSTANCE_OF), place_of(own))
        for iri, own in sorted(_properties(graph, set(systems)).items())
    ]


def _properties(graph: Queryable, iris: Collection[str]) -> dict[str, dict[str, list[str]]]:
    return properties_in(graph, _PROPERTIES % among("subject", iris)) if iris else {}
