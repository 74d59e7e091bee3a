"""Which node types and definitions a change to a name may reach, looked up by exact terms.

Reading all of them for one name would take time in proportion to the store.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.graph.ntriples import literal
from kg.graph.reading.queries import among, column, one_of, texts

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.store.interface import Queryable


_PARTS: Final = "ros:hasComponent|rnkg:hasParameter|rnkg:hasPluginSlot"


def nodes_at_channel(graph: Queryable, name: str) -> set[str]:
    """Return the IRIs of the node types that have an end of this absolute name when they are started alone."""
    return _nodes(graph, f"?part rnkg:resolvedName {literal(name)} . ?node ros:hasComponent ?part")


def nodes_of_types(graph: Queryable, names: Iterable[str]) -> set[str]:
    """Return the IRIs of the node types with ends whose messages, services or actions have types, as `package/Type`."""
    typed = "?part ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?type . ?node ros:hasComponent ?part"
    return _nodes(graph, f"{one_of('label', names)} ?type rdfs:label ?label . {typed}")


def nodes_called(graph: Queryable, name: str, *, at_run_time: bool = False) -> set[str]:
    """Return the IRIs of the node types that `name` means, as `node` or `package/node`.

    With `at_run_time` also those that call themselves so.
    """
    iris = _nodes(graph, f"?node rnkg:name {literal(name)}")
    if at_run_time:
        iris |= _nodes(graph, f"?node rnkg:nodeName {literal(name)}")
    splits = [(name[:at], name[at + 1 :]) for at, sign in enumerate(name) if sign == "/"]
    pairs = " ".join(f"({literal(package)} {literal(node)})" for package, node in splits)
    inside = "?node rnkg:name ?name . ?package rnkg:contains ?node ; rnkg:name ?owner"
    return iris | (_nodes(graph, f"VALUES (?owner ?name) {{ {pairs} }} {inside}") if pairs else set())


def nodes_loading(graph: Queryable, plugins: Iterable[str]) -> set[str]:
    """Return the IRIs of the node types that load plugins of some classes unless parameters say otherwise."""
    spelled = {text for one in plugins for text in (one, one.replace("/", "::"), one.replace("::", "/"))}
    loading = "?default rnkg:className ?class . ?node rnkg:hasPluginSlot/rnkg:hasDefaultPlugin ?default"
    return _nodes(graph, f"{one_of('class', spelled)} {loading}") if spelled else set()


def nodes_with_parameter(graph: Queryable, names: Iterable[str]) -> set[str]:
    """Return the IRIs of the node types with a parameter of one of some names, as their code spells it."""
    return _nodes(graph, f"{one_of('name', names)} ?part rnkg:name ?name . ?node rnkg:hasParameter ?part")


def nodes_in_file(graph: Queryable, path: str) -> set[str]:
    """Return the IRIs of the node types that are declared, built or registered in a file, whatever its source."""
    text = literal(path)
    exported = _nodes(graph, f"?node rnkg:exportedAt ?at FILTER(CONTAINS(?at, {text}))")
    declared = f"?part rnkg:path {text} . ?node {_PARTS}|rnkg:hasSource ?part"
    return exported | _nodes(graph, declared) | _nodes(graph, f"?node rnkg:path {text}")


def definitions_of(graph: Queryable, names: Iterable[str]) -> set[str]:
    """Return the IRIs of the definitions of some types, as `package/Type`, and of all that embed them."""
    iris: set[str] = set()
    seen: set[str] = set()
    queue = set(names)
    while queue:
        seen |= queue
        values = one_of("label", queue)
        iris |= _definitions(graph, f"{values} ?definition rdfs:label ?label")
        holding = _definitions(
            graph, f"{values} ?type rdfs:label ?label . ?definition rnkg:hasField/rnkg:hasFieldType ?type"
        )
        iris |= holding
        labels = f"{among('definition', holding)} ?definition rdfs:label ?label"
        queue = column(graph, f"SELECT ?label WHERE {{ {labels} }}") - seen
    return iris


def definitions_at(graph: Queryable, path: str) -> set[str]:
    """Return the IRIs of the definitions in a file, whatever its source."""
    return _definitions(graph, f"?definition rnkg:path {literal(path)}")


def types_called(graph: Queryable, name: str) -> list[str]:
    """Return `name`, as `package/Type`, if a message, service or action has it."""
    classes = "ros:Message, rnkg:ServiceType, rnkg:ActionType"
    text = literal(name)
    query = f"SELECT ?type WHERE {{ ?type rdfs:label {text} ; a ?class FILTER(?class IN ({classes})) }} LIMIT 1"
    return [name for _ in column(graph, query)]


def qualified_names(graph: Queryable) -> set[str]:
    """Return the names of node types, as `node` and as `package/node`."""
    pattern = "?node a rnkg:NodeType ; rnkg:name ?name . ?p rnkg:contains ?node ; rnkg:name ?package"
    rows = texts(graph, f"SELECT ?package ?name WHERE {{ {pattern} }}")
    return {name for package, node in rows for name in (node, f"{package}/{node}")}


def settable_names(graph: Queryable) -> set[str]:
    """Return the names of the parameters of node types, alone and behind `node.`."""
    pattern = "?n a rnkg:NodeType ; rnkg:name ?node ; rnkg:hasParameter/rnkg:name ?name"
    rows = texts(graph, f"SELECT ?node ?name WHERE {{ {pattern} }}")
    return {name for node, parameter in rows if parameter for name in (parameter, f"{node}.{parameter}")}


def _nodes(graph: Queryable, pattern: str) -> set[str]:
    return column(graph, f"SELECT DISTINCT ?node WHERE {{ {pattern} . ?node a rnkg:NodeType }}")


def _definitions(graph: Queryable, pattern: str) -> set[str]:
    return column(graph, f"SELECT DISTINCT ?definition WHERE {{ {pattern} . ?definition a rnkg:InterfaceDefinition }}")
