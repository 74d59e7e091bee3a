"""What `kg.impact` needs in addition to nodes and systems: packages, definitions, files, and systems naming a thing."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from kg.facts import Dependency, Field, FileKind, InterfaceDefinition, Location
from kg.graph.definitions import message_of
from kg.graph.ntriples import literal
from kg.graph.reading.queries import among, column, one_of, texts
from kg.impact.model import DefinitionRecord, FileRecord, PackageRecord

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from kg.store.interface import Queryable


_DEPENDENTS: Final = """
SELECT ?package ?repository ?name ?folder ?manifest ?on ?kind ?line WHERE {
  VALUES ?on { %s }
  ?dependency rnkg:onPackage/rdfs:label ?on ; rnkg:dependencyKind ?kind ; rnkg:line ?line .
  ?package rnkg:hasDependency ?dependency ; a rnkg:Package ; rnkg:name ?name ; rnkg:path ?manifest .
  ?r rnkg:contains ?package ; a rnkg:Repository ; rnkg:name ?repository .
  OPTIONAL { ?package rnkg:folder ?folder }
}"""
_DEFINITIONS: Final = """
SELECT ?definition ?repository ?package ?name ?kind ?path ?line WHERE {
  %s
  ?r a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?p .
  ?p rnkg:name ?package ; rnkg:contains ?definition .
  ?definition a rnkg:InterfaceDefinition ; rnkg:name ?name ; rnkg:definitionKind ?kind ; rnkg:path ?path ;
    rnkg:line ?line .
}"""
_FIELDS: Final = """
SELECT ?definition ?section ?name ?type ?line ?default ?constant WHERE {
  %s
  ?definition a rnkg:InterfaceDefinition ; rnkg:hasField ?field .
  ?field rnkg:section ?section ; rnkg:name ?name ; rnkg:fieldType ?type ; rnkg:line ?line .
  OPTIONAL { ?field rnkg:defaultValue ?default }
  OPTIONAL { ?field rnkg:constantValue ?constant }
}
ORDER BY ?definition ?line"""
_FILES: Final = """
SELECT ?repository ?package ?path ?kind WHERE {
  %s
  ?r a rnkg:Repository ; rnkg:name ?repository ; rnkg:contains ?p .
  ?p rnkg:name ?package ; rnkg:contains ?file .
  ?file rnkg:fileKind ?kind ; rnkg:path ?path .
}"""
_LABELS: Final = "SELECT DISTINCT ?name WHERE { ?thing a %s ; rdfs:label ?name %s }"
_ARGUMENTS: Final = """
SELECT DISTINCT ?name ?launch WHERE {
  %s
  ?argument a rnkg:LaunchArgument ; rnkg:name ?name .
  ?configuration rnkg:hasArgument ?argument ; rnkg:name ?launch .
}"""
_DECLARING: Final = """
SELECT DISTINCT ?configuration WHERE {
  ?argument rnkg:name %s ; a rnkg:LaunchArgument .
  ?configuration rnkg:hasArgument ?argument .
}"""
_DESCRIBED: Final = """
SELECT DISTINCT ?configuration WHERE {
  %s
  GRAPH ?graph { ?configuration rnkg:launchDialect ?dialect }
}"""
_TYPES: Final = ("ros:Message", "rnkg:ServiceType", "rnkg:ActionType")
_STATING: Final = """
SELECT DISTINCT ?graph WHERE {
  { VALUES ?value { %(values)s } GRAPH ?graph { ?thing ?predicate ?value } } UNION
  { VALUES ?value { %(values)s } ?start ?predicate ?value . GRAPH ?graph { ?instance rnkg:startedWith ?start } } UNION
  {
    VALUES ?value { %(values)s }
    ?part ?predicate ?value . ?start rnkg:hasSetting|rnkg:readsEntry|rnkg:hasRemap ?part .
    GRAPH ?graph { ?instance rnkg:startedWith ?start }
  }
}"""
"""What instances are started with is in a separate graph, shared by systems that start the same."""
_STARTING: Final = """
SELECT DISTINCT ?graph WHERE {
  VALUES ?type { %(values)s }
  GRAPH ?graph { ?instance rnkg:instanceOf|rnkg:loadsPlugin ?type }
}"""
_INCLUDING: Final = """
SELECT DISTINCT ?graph WHERE {
  VALUES ?configuration { %(values)s }
  { GRAPH ?graph { ?other rnkg:includes ?configuration } } UNION
  { GRAPH ?graph { ?configuration rnkg:launchDialect ?dialect } }
}"""


def dependents(graph: Queryable, package: str) -> list[PackageRecord]:
    """Return the packages that depend on one, with their dependencies on it, sorted by source and name."""
    packages: dict[str, PackageRecord] = {}
    lines: defaultdict[str, list[Dependency]] = defaultdict(list)
    for iri, repository, name, folder, manifest, on, kind, line in texts(graph, _DEPENDENTS % literal(package)):
        packages[iri] = PackageRecord(repository, name, folder or ".", manifest)
        lines[iri].append(Dependency(on, kind, int(line)))
    whole = [replace(one, dependencies=tuple(sorted(lines[iri], key=repr))) for iri, one in packages.items()]
    return sorted(whole, key=lambda one: (one.repository, one.name, one.folder))


def definition_records(graph: Queryable, iris: Collection[str] | None = None) -> list[DefinitionRecord]:
    """Return the definitions of the store, or those of some IRIs, sorted by source, name and kind."""
    those = "" if iris is None else among("definition", iris)
    fields: defaultdict[str, list[Field]] = defaultdict(list)
    for iri, section, name, kind, line, default, constant in texts(graph, _FIELDS % those):
        fields[iri].append(
            Field(section=section, name=name, type=kind, line=int(line), default=default, constant=constant)
        )
    records = []
    for iri, repository, package, name, kind, path, line in texts(graph, _DEFINITIONS % those):
        own = tuple(fields[iri])
        definition = InterfaceDefinition(kind, package, name, own, Location(path, int(line)))
        embeds = {f"{one.section}/{one.name}": message for one in own if (message := message_of(one.type, package))}
        records.append(DefinitionRecord(repository, definition, embeds))
    return sorted(records, key=lambda one: (one.repository, one.name, one.definition.kind))


def file_records(
    graph: Queryable, *, sources: Iterable[str] | None = None, path: str | None = None, ending: str | None = None
) -> list[FileRecord]:
    """Return the files of the packages of the store, sorted by source and path.

    They may be limited to those of some sources, of one path, or to those whose path ends in some segments.
    """
    those = "" if sources is None else one_of("repository", sources)
    if path is not None:
        those = one_of("path", [path])
    elif ending is not None:
        those = f'FILTER(STRENDS(CONCAT("/", ?path), {literal(f"/{ending}")}))'
    records = (
        FileRecord(repository, package, at, FileKind(kind))
        for repository, package, at, kind in texts(graph, _FILES % those)
    )
    return sorted(records, key=lambda one: (one.repository, one.path))


def arguments(graph: Queryable, name: str | None = None) -> list[tuple[str, str]]:
    """Return the launch arguments, or those of a name, each with the launch file that declares it, sorted."""
    return sorted(texts(graph, _ARGUMENTS % ("" if name is None else one_of("name", [name]))))


def configurations_with(graph: Queryable, argument: str) -> set[str]:
    """Return the IRIs of the launch configurations that declare an argument."""
    return column(graph, _DECLARING % literal(argument))


def configurations_in(graph: Queryable, graphs: Iterable[str]) -> set[str]:
    """Return the IRIs of the configurations that some named graphs describe."""
    return column(graph, _DESCRIBED % among("graph", graphs))


def type_names(graph: Queryable, last: str | None = None) -> list[str]:
    """Return the names of the types of messages, services and actions, or those with a `last` part, sorted."""
    chosen = "" if last is None else f'FILTER(STRENDS(CONCAT("/", ?name), {literal(f"/{last}")}))'
    return sorted(set().union(*(column(graph, _LABELS % (term, chosen)) for term in _TYPES)))


def systems_naming(
    graph: Queryable, texts: Iterable[str], types: Iterable[str], included: Iterable[str] = ()
) -> set[str]:
    """Return the named graphs that state one of some texts, start a node type, or include a launch configuration.

    `types` and `included` are IRIs.
    """
    queries = (
        (_STATING, " ".join(map(literal, sorted(set(texts))))),
        (_STARTING, " ".join(f"<{iri}>" for iri in sorted(set(types)))),
        (_INCLUDING, " ".join(f"<{iri}>" for iri in sorted(set(included)))),
    )
    return {
        graph_name for query, values in queries if values for graph_name in column(graph, query % {"values": values})
    }
