"""The lists over the whole store: `LISTS` declares each once, for the view `list`, pages, commands and exports.

`kg.views.list_rows` and `kg.views.vocabulary` make the rows; `kg.views.listing` filters, sorts and pages them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Final

from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.store.snapshot import EmbeddedSnapshot

    Rows = Sequence[dict[str, Any]]

with lazily():
    from kg.graph.ntriples import literal
    from kg.views.list_rows import (
        channels,
        classes,
        findings,
        node_objects,
        nodes,
        packages,
        parameters,
        systems,
        types,
    )
    from kg.views.vocabulary import classes as vocabulary_classes
    from kg.views.vocabulary import properties as vocabulary_properties


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its title, its key in the rows, the shape of its cells, and their link.

    `shape` is `text`, `mono`, `number`, `tags` or `place`. `to` is a path and its query parameters, each with the key
    in the rows of its value. Tables of commands have the title `head` and drop `spare` columns on narrow terminals
    (`kg.cli.output.Column`).
    """

    title: str
    key: str
    shape: str = "text"
    to: tuple[str, Mapping[str, str]] | None = None
    head: str = ""
    spare: int = 0


@dataclass(frozen=True, slots=True)
class Facet:
    """A filter: its SPARQL pattern, and the key of the rows and the label, by default its name.

    `%s` in the pattern is the value as a literal; filters with few values have a pattern for each. A filter that SPARQL
    does not give exactly has none.
    """

    name: str
    where: str | Mapping[str, str] | None = None
    key: str = ""
    label: str = ""


@dataclass(frozen=True, slots=True)
class Query:
    """The rows of a list as SPARQL, for readers who go on from it: head, patterns and end.

    `rest` follows the patterns that filters add. `name` is the variable whose words are searched, empty where the list
    also searches elsewhere.
    """

    head: str
    where: Sequence[str]
    end: str
    name: str = ""
    rest: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class List:
    """A list: its title, the singular name of its things, a sentence about it, its rows, and the columns of its page.

    `words` are the keys that words are searched in. `many` is the plural, where it is not the title. `objects` makes
    what other programs read of rows (docs/formats.md), where that is more than the rows themselves. `command` has the
    columns in tables of commands, where they are not those of the page. There is no `query` where SPARQL does not give
    the rows exactly.
    """

    title: str
    one: str
    lead: str
    rows: Callable[[EmbeddedSnapshot, str], Rows]
    columns: Sequence[Column]
    facets: Mapping[str, Facet] = field(default_factory=dict)
    words: Sequence[str] = ("name",)
    query: Query | None = None
    many: str = ""
    objects: Callable[[EmbeddedSnapshot, Rows], Rows] | None = None
    command: Sequence[Column] = ()

    @property
    def in_commands(self) -> Sequence[Column]:
        """The columns in tables of commands."""
        return self.command or self.columns

    def called(self, number: int) -> str:
        """Return the name for a number of things."""
        return self.one if number == 1 else self.many or self.title[0].lower() + self.title[1:]

    def label(self, facet: str) -> str:
        """Return the label of a filter."""
        return self.facets[facet].label or facet.capitalize()

    def query_of(self, words: Sequence[str], given: Mapping[str, str]) -> str | None:
        """Return the query for the rows that have some words and values of filters; None if there is none."""
        query = self.query
        if query is None or (words and not query.name):
            return None
        added = [f"FILTER(CONTAINS(LCASE(STR({query.name})), {literal(word)}))" for word in words]
        for name, value in given.items():
            pattern = self.facets[name].where
            if pattern is not None and not isinstance(pattern, str):
                pattern = pattern.get(value)
            if pattern is None:
                return None
            added.append(pattern.replace("%s", literal(value)))
        patterns = "".join(f"  {line}\n" for line in (*query.where, *added, *query.rest))
        return f"{query.head} WHERE {{\n{patterns}}}\n{query.end}\n"


_NODE: Final = Column("Node", "node", to=("/node", {"iri": "iri"}))
_PACKAGE: Final = Column("Package", "package", to=("/nodes", {"package": "package"}))
_KIND: Final = Column("Kind", "kind", "tags", spare=1)
_ROS: Final = Column("ROS", "ros", "number")
_INTERFACES: Final = tuple(
    Column(title, key, "number", spare=2)
    for title, key in (
        ("Pub", "publishes"),
        ("Sub", "subscribes"),
        ("Srv", "services"),
        ("Cli", "clients"),
        ("Act", "actions"),
        ("Par", "parameters"),
    )
)
_PLACE: Final = Column("Line", "place", "place", head="file:line", spare=3)

_OWNED: Final = "?owner a rnkg:Package ; rnkg:contains ?node ; rnkg:name ?package ."
_TYPED: Final = "?end rnkg:implicit false ; (ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType)/rdfs:label %s ."
_TYPES: Final = ("message", "service", "action")
_OF_PACKAGE: Final = Facet("package", "VALUES ?package { %s }")
_SOURCE: Final = Facet("repository", label="Source")
_SOURCE_OF_NODE: Final = replace(_SOURCE, where="?source a rnkg:Repository ; rnkg:contains ?owner ; rnkg:name %s .")


def _facets(*facets: Facet | str) -> dict[str, Facet]:
    every = [Facet(one) if isinstance(one, str) else one for one in facets]
    return {one.name: one for one in every}


def _ros(subject: str) -> Facet:
    return Facet("ros", f"{subject} rnkg:rosVersion ?ros . FILTER(STR(?ros) = %s)", label="ROS version")


def _labelled(name: str, path: str, key: str) -> Facet:
    return Facet(name, f"?node {path} ?{name}_ . ?{name}_ rdfs:label ?{name} . FILTER(STR(?{name}) = %s)", key)


def _channels(kind: str, ends: str, giving: Sequence[str], taking: Sequence[str]) -> List:
    """Return the list of a kind of channel; `giving` and `taking` are the titles of its ends, and those in commands."""
    columns = (
        Column("Name", "name", "mono", (f"/channel?kind={kind}", {"name": "name"}), head=kind),
        Column("Types", "types", "mono", head="type"),
        Column(giving[0], "giving", "number", head=giving[1], spare=1),
        Column(taking[0], "taking", "number", head=taking[1], spare=1),
        Column("Launch files", "systems", "number", spare=1),
    )
    patterns = (
        f"VALUES ?class {{ {ends} }}",
        "?end rnkg:declaredBy ?code .  # the end itself, or that of a launched node in the code",
        "?code a ?class ; rnkg:implicit false .",
        f"?end rnkg:connectsTo ?{kind} . ?{kind} rdfs:label ?name .",
    )
    return List(
        f"{kind.capitalize()}s",
        kind,
        "Names in launched systems, after remapping, and of nodes started alone; none that only frameworks use.",
        partial(channels, kind=kind),
        (*columns, Column("Ends", "ends")),
        _facets(Facet("type", key="types"), Facet("package", key="packages"), "ends"),
        query=Query("SELECT DISTINCT ?name", patterns, "ORDER BY ?name", "?name"),
        command=columns,
    )


def _classes(title: str, one: str, lead: str, properties: str, **more: Any) -> List:
    """Return the list of the classes that `properties` of nodes have."""
    columns = (
        Column("Name", "name", to=("/resource", {"iri": "iri"})),
        Column("Nodes", "nodes", "number", ("/nodes", {one.rpartition(" ")[2]: "name"})),
        *(Column(title, title.lower(), "number") for title in ("Certain", "Strong", "Weak")),
    )
    patterns = (
        f"VALUES ?property {{ {properties} }}",
        "?node a rnkg:NodeType ; ?property ?class . ?class rdfs:label ?name .",
    )
    head = "SELECT ?class ?name (COUNT(DISTINCT ?node) AS ?nodes)"
    query = Query(head, patterns, "GROUP BY ?class ?name ?property\nORDER BY ?name", "?name")
    return List(title, one, lead, partial(classes, of=title.lower()), columns, query=query, **more)


LISTS: Final[Mapping[str, List]] = {
    "nodes": List(
        "Nodes",
        "node",
        "Every node that code or packages declare. Numbers leave out what frameworks create.",
        nodes,
        (_NODE, _PACKAGE, Column("Description", "description"), _KIND, _ROS, *_INTERFACES),
        _facets(
            _OF_PACKAGE,
            Facet("kind", "?node rnkg:kind/skos:notation %s ."),
            _labelled("function", "rnkg:hasFunction", "functions"),
            _labelled("hardware", "rnkg:usesHardware|rnkg:usesDevice", "hardware"),
            Facet("type", f"?node ros:hasComponent ?end . {_TYPED}", "types"),
            _labelled("capability", "rnkg:hasCapability", "capabilities"),
            _SOURCE_OF_NODE,
            _ros("?node"),
            Facet("language", "?node rnkg:language %s ."),
        ),
        ("node", "package", "description", "plugin"),
        Query(
            "SELECT DISTINCT ?package ?name ?node",
            ("?node a rnkg:NodeType ; rnkg:name ?name .", _OWNED),
            "ORDER BY ?package ?name",
        ),
        objects=node_objects,
        command=(_PACKAGE, _NODE, _KIND, replace(_ROS, spare=2), *_INTERFACES, _PLACE),
    ),
    "packages": List(
        "Packages",
        "package",
        "Every package of the sources.",
        packages,
        (
            Column("Package", "name", to=("/resource", {"iri": "iri"})),
            Column("Version", "version"),
            _ROS,
            Column("Nodes", "nodes", "number", ("/nodes", {"package": "name", "repository": "repository"})),
            Column("Definitions", "definitions", "number"),
            Column("Problems", "problems", "number"),
            Column("Source", "repository", to=("/packages", {"repository": "repository"}), spare=1),
            Column("Folder", "folder", "mono", spare=1),
        ),
        _facets(replace(_SOURCE, where="VALUES ?repository { %s }"), _ros("?package"), "deprecated"),
        ("name", "folder"),
        Query(
            "SELECT DISTINCT ?name ?package ?repository",
            (
                "?package a rnkg:Package ; rnkg:name ?name .",
                "?source a rnkg:Repository ; rnkg:contains ?package ; rnkg:name ?repository .",
            ),
            "ORDER BY ?name",
        ),
    ),
    "topics": _channels(
        "topic", "ros:Publisher ros:Subscriber", ("Publishers", "publish"), ("Subscribers", "subscribe")
    ),
    "services": _channels("service", "ros:ServiceServer ros:ServiceClient", ("Servers", "offer"), ("Clients", "call")),
    "actions": _channels("action", "rnkg:ActionServer rnkg:ActionClient", ("Servers", "offer"), ("Clients", "call")),
    "types": List(
        "Types",
        "type",
        "Types of messages, services and actions that nodes use or packages define.",
        types,
        (
            Column("Type", "name", "mono", ("/resource", {"iri": "iri"})),
            _KIND,
            Column("Nodes", "nodes", "number", ("/nodes", {"type": "name"})),
            Column("Defined", "defined"),
            Column("Sources", "repositories"),
        ),
        _facets(
            Facet("kind", {name: f"FILTER(?kind = rnkg:{name.capitalize()}Type)" for name in _TYPES}),
            Facet("package", 'FILTER(STRBEFORE(?name, "/") = %s)'),
            Facet(
                "defined",
                {
                    "in this store": "FILTER EXISTS { ?definition rnkg:defines ?type }",
                    "elsewhere": "FILTER NOT EXISTS { ?definition rnkg:defines ?type }",
                },
            ),
        ),
        query=Query(
            "SELECT DISTINCT ?name ?type ?kind",
            (
                "VALUES ?kind { rnkg:MessageType rnkg:ServiceType rnkg:ActionType }",
                "?type a ?kind ; rdfs:label ?name .",
            ),
            "ORDER BY ?name",
            "?name",
        ),
    ),
    "hardware": _classes(
        "Hardware",
        "kind of hardware",
        "Kinds of hardware and known devices that nodes work with, with the number of nodes by grade of evidence.",
        "rnkg:usesHardware rnkg:usesDevice",
        facets=_facets(
            Facet(
                "kind",
                {"kind": "FILTER(?property = rnkg:usesHardware)", "device": "FILTER(?property = rnkg:usesDevice)"},
            )
        ),
        many="kinds of hardware",
    ),
    "functions": _classes(
        "Functions",
        "function",
        "What nodes are for, with the number of nodes by grade of evidence.",
        "rnkg:hasFunction",
    ),
    "capabilities": _classes(
        "Capabilities",
        "capability",
        "What nodes enable a robot to do, with the number of nodes by grade of evidence. "
        "Nodes with weak evidence alone are not in the first number.",
        "rnkg:hasCapability",
    ),
    "systems": List(
        "Launch files",
        "launch file",
        "Every launch file, evaluated with the defaults of its arguments: the nodes it starts and their connections.",
        systems,
        (
            Column("Launch file", "name", to=("/system", {"name": "iri"})),
            Column("Source", "repository", to=("/systems", {"repository": "repository"})),
            _ROS,
            *(Column(title, title.lower(), "number") for title in ("Nodes", "Topics", "Services", "Actions")),
            Column("Findings", "problems", "number"),
            Column("Worst", "worst", "tags"),
            Column("Use", "use"),
        ),
        _facets(
            "package",
            _SOURCE,
            _ros("?system"),
            Facet(
                "use",
                {
                    "included by others": "FILTER EXISTS { ?other rnkg:includes ?system }",
                    "started by itself": "FILTER NOT EXISTS { ?other rnkg:includes ?system }",
                },
            ),
            Facet("worst", label="Worst finding"),
        ),
        ("name", "repository"),
        Query(
            "SELECT DISTINCT ?name ?system",
            ("?system a rnkg:LaunchConfiguration ; rnkg:name ?name .",),
            "ORDER BY ?name",
        ),
    ),
    "parameters": List(
        "Parameters",
        "parameter",
        "Parameters of nodes, without those that frameworks create.",
        parameters,
        (
            Column("Parameter", "name", "mono", ("/parameters", {"name": "name"})),
            _NODE,
            _PACKAGE,
            Column("Type", "type", "mono"),
            Column("Default", "default", "mono"),
            Column("Access", "access", "tags"),
            Column("Description", "description"),
            _PLACE,
        ),
        _facets(
            _OF_PACKAGE,
            Facet("node", "VALUES ?node_name { %s }"),
            "type",
            Facet("access", "?parameter rnkg:access/skos:notation %s ."),
            _SOURCE_OF_NODE,
            Facet("name", "?parameter rnkg:name %s ."),
        ),
        ("name", "node", "description"),
        Query(
            "SELECT DISTINCT ?package ?node_name ?node ?name",
            ("?node a rnkg:NodeType ; rnkg:name ?node_name .", _OWNED, "?node rnkg:hasParameter ?parameter ."),
            "ORDER BY ?package ?node_name ?name",
            rest=("MINUS { ?parameter rnkg:implicit true }", "OPTIONAL { ?parameter rnkg:name ?name }"),
        ),
    ),
    "findings": List(
        "Findings",
        "finding",
        "Problems in the wiring of launch files, as `kg lint` reports them.",
        findings,
        (
            Column("Severity", "severity", "tags"),
            Column("Code", "code", "mono", ("/findings", {"code": "code"})),
            Column("Message", "message", to=("/resource", {"iri": "iri"})),
            Column("Launch file", "system", to=("/system", {"name": "system", "repository": "repository"})),
            Column("Other launch files", "others", "number"),
            _PLACE,
        ),
        _facets(
            "severity",
            "code",
            Facet("package", key="packages"),
            Facet("system", key="systems", label="Launch file"),
            _SOURCE,
        ),
        ("message", "systems", "rule"),
    ),
    "classes": List(
        "Classes",
        "class",
        "Classes with instances in this store, and the properties of these, counted in a sample of large classes.",
        vocabulary_classes,
        (
            Column("Class", "name", "mono", ("/resource", {"iri": "iri"})),
            Column("Instances", "instances", "number", ("/resource?predicate=rdf:type&direction=in", {"iri": "iri"})),
            Column("Subclass of", "parents", "mono"),
            Column("Properties", "properties", "number", ("/properties", {"subject": "name"})),
            Column("Most used", "first", "mono"),
            Column("Meaning", "description"),
        ),
        _facets("vocabulary", Facet("parent", key="parents", label="Subclass of")),
        ("name", "description"),
        Query(
            "SELECT ?class (COUNT(DISTINCT ?instance) AS ?instances)",
            ("?instance a ?class FILTER(ISIRI(?class))",),
            "GROUP BY ?class\nORDER BY DESC(?instances)",
        ),
    ),
    "properties": List(
        "Properties",
        "property",
        "Properties with facts in this store, and the classes that they connect, the most frequent first.",
        vocabulary_properties,
        (
            Column("Property", "name", "mono", ("/resource", {"iri": "iri"})),
            Column("Facts", "facts", "number"),
            Column("From", "first_subjects", "mono"),
            Column("To", "first_values", "mono"),
            Column("Meaning", "description"),
        ),
        _facets("vocabulary", Facet("subject", key="subjects", label="From"), Facet("value", key="values", label="To")),
        ("name", "description"),
        Query(
            "SELECT ?property (COUNT(*) AS ?facts)",
            ("?subject ?property ?value",),
            "GROUP BY ?property\nORDER BY DESC(?facts)",
        ),
    ),
}
"""Name to list; the name is also the path of its page."""
