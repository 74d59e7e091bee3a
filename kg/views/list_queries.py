"""The rows of lists as SPARQL, for readers who go on from a list: the same rows, with names and what the filters read.

A list or filter that SPARQL does not give exactly has no query: findings depend on kg.toml, words of nodes are also
looked for in descriptions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

from kg.graph.ntriples import literal

_NAMED: Final = "FILTER(STR({0}) = {1})"


@dataclass(frozen=True, slots=True)
class _Query:
    """A query without filters: its head, patterns and end, and for each filter the pattern that it adds.

    `%s` in the pattern of a filter is its value as a literal; filters with few values have a pattern for each. `rest`
    follows what filters add. `name` is the variable whose words are searched, empty where the list searches elsewhere.
    """

    head: str
    where: Sequence[str]
    end: str
    filters: Mapping[str, str | Mapping[str, str]] = field(default_factory=dict)
    name: str = ""
    rest: Sequence[str] = ()


def _labelled(path: str, variable: str) -> str:
    return f"?node {path} ?{variable}_ . ?{variable}_ rdfs:label ?{variable} . " + _NAMED.format(f"?{variable}", "%s")


_OWNED: Final = "?owner a rnkg:Package ; rnkg:contains ?node ; rnkg:name ?package ."
_OF_NODE: Final = {
    "package": "VALUES ?package { %s }",
    "repository": "?source a rnkg:Repository ; rnkg:contains ?owner ; rnkg:name %s .",
}
_VERSION: Final = " rnkg:rosVersion ?ros . " + _NAMED.format("?ros", "%s")
_TYPED: Final = "ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType"


def _channels(kind: str, giver: str, taker: str) -> _Query:
    return _Query(
        "SELECT DISTINCT ?name",
        (
            f"VALUES ?class {{ {giver} {taker} }}",
            "?end rnkg:declaredBy ?code .  # the end itself, or that of a launched node in the code",
            "?code a ?class ; rnkg:implicit false .",
            f"?end rnkg:connectsTo ?{kind} . ?{kind} rdfs:label ?name .",
        ),
        "ORDER BY ?name",
        name="?name",
    )


def _classes(properties: str, filters: Mapping[str, str | Mapping[str, str]]) -> _Query:
    return _Query(
        "SELECT ?class ?name (COUNT(DISTINCT ?node) AS ?nodes)",
        (
            f"VALUES ?property {{ {properties} }}",
            "?node a rnkg:NodeType ; ?property ?class . ?class rdfs:label ?name .",
        ),
        "GROUP BY ?class ?name ?property\nORDER BY ?name",
        filters,
        "?name",
    )


_QUERIES: Final[Mapping[str, _Query]] = {
    "nodes": _Query(
        "SELECT DISTINCT ?package ?name ?node",
        ("?node a rnkg:NodeType ; rnkg:name ?name .", _OWNED),
        "ORDER BY ?package ?name",
        {
            **_OF_NODE,
            "kind": "?node rnkg:kind/skos:notation %s .",
            "function": _labelled("rnkg:hasFunction", "function"),
            "hardware": _labelled("rnkg:usesHardware|rnkg:usesDevice", "hardware"),
            "capability": _labelled("rnkg:hasCapability", "capability"),
            "type": f"?node ros:hasComponent ?end . ?end rnkg:implicit false ; ({_TYPED})/rdfs:label %s .",
            "ros": f"?node{_VERSION}",
            "language": "?node rnkg:language %s .",
        },
    ),
    "packages": _Query(
        "SELECT DISTINCT ?name ?package ?repository",
        (
            "?package a rnkg:Package ; rnkg:name ?name .",
            "?source a rnkg:Repository ; rnkg:contains ?package ; rnkg:name ?repository .",
        ),
        "ORDER BY ?name",
        {"repository": "VALUES ?repository { %s }", "ros": f"?package{_VERSION}"},
    ),
    "topics": _channels("topic", "ros:Publisher", "ros:Subscriber"),
    "services": _channels("service", "ros:ServiceServer", "ros:ServiceClient"),
    "actions": _channels("action", "rnkg:ActionServer", "rnkg:ActionClient"),
    "types": _Query(
        "SELECT DISTINCT ?name ?type ?kind",
        ("VALUES ?kind { rnkg:MessageType rnkg:ServiceType rnkg:ActionType }", "?type a ?kind ; rdfs:label ?name ."),
        "ORDER BY ?name",
        {
            "kind": {
                name: f"FILTER(?kind = rnkg:{name.capitalize()}Type)" for name in ("message", "service", "action")
            },
            "package": 'FILTER(STRBEFORE(?name, "/") = %s)',
            "defined": {
                "in this store": "FILTER EXISTS { ?definition rnkg:defines ?type }",
                "elsewhere": "FILTER NOT EXISTS { ?definition rnkg:defines ?type }",
            },
        },
        "?name",
    ),
    "hardware": _classes(
        "rnkg:usesHardware rnkg:usesDevice",
        {"kind": {"kind": "FILTER(?property = rnkg:usesHardware)", "device": "FILTER(?property = rnkg:usesDevice)"}},
    ),
    "functions": _classes("rnkg:hasFunction", {}),
    "capabilities": _classes("rnkg:hasCapability", {}),
    "systems": _Query(
        "SELECT DISTINCT ?name ?system",
        ("?system a rnkg:LaunchConfiguration ; rnkg:name ?name .",),
        "ORDER BY ?name",
        {
            "ros": f"?system{_VERSION}",
            "use": {
                "included by others": "FILTER EXISTS { ?other rnkg:includes ?system }",
                "started by itself": "FILTER NOT EXISTS { ?other rnkg:includes ?system }",
            },
        },
    ),
    "parameters": _Query(
        "SELECT DISTINCT ?package ?node_name ?node ?name",
        (
            "?node a rnkg:NodeType ; rnkg:name ?node_name .",
            _OWNED,
            "?node rnkg:hasParameter ?parameter .",
        ),
        "ORDER BY ?package ?node_name ?name",
        {
            **_OF_NODE,
            "node": "VALUES ?node_name { %s }",
            "name": "?parameter rnkg:name %s .",
            "access": "?parameter rnkg:access/skos:notation %s .",
        },
        rest=("MINUS { ?parameter rnkg:implicit true }", "OPTIONAL { ?parameter rnkg:name ?name }"),
    ),
    "classes": _Query(
        "SELECT ?class (COUNT(DISTINCT ?instance) AS ?instances)",
        ("?instance a ?class FILTER(ISIRI(?class))",),
        "GROUP BY ?class\nORDER BY DESC(?instances)",
    ),
    "properties": _Query(
        "SELECT ?property (COUNT(*) AS ?facts)",
        ("?subject ?property ?value",),
        "GROUP BY ?property\nORDER BY DESC(?facts)",
    ),
}


def query_of(of: str, words: Sequence[str], given: Mapping[str, str]) -> str | None:
    """Return the query for the rows of a list that have some words and values of filters; None if there is none."""
    query = _QUERIES.get(of)
    if query is None or (words and not query.name):
        return None
    added = [f"FILTER(CONTAINS(LCASE(STR({query.name})), {literal(word)}))" for word in words]
    for name, value in given.items():
        pattern = query.filters.get(name)
        if pattern is not None and not isinstance(pattern, str):
            pattern = pattern.get(value)
        if pattern is None:
            return None
        added.append(pattern.replace("%s", literal(value)))
    patterns = "".join(f"  {line}\n" for line in (*query.where, *added, *query.rest))
    return f"{query.head} WHERE {{\n{patterns}}}\n{query.end}\n"
