"""The store as a tree that is opened branch by branch: the view `tree`."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any, Final

from kg.errors import UnknownNameError
from kg.facts import Role
from kg.graph.iris import Iris
from kg.query.rows import rows
from kg.render.text import NAME_UNKNOWN
from kg.views.arguments import whole
from kg.views.remembered import once
from kg.views.terms import listing, named_node, node_parts, role_of

if TYPE_CHECKING:
    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 1000
_PACKAGES: Final = """SELECT ?package ?name ?ros {
  GRAPH ?g { ?package a rnkg:Package ; rnkg:name ?name . OPTIONAL { ?package rnkg:rosVersion ?ros } }
}"""
_NODES: Final = "SELECT ?package ?node { GRAPH ?g { ?node a rnkg:NodeType . ?package rnkg:contains ?node } }"
_OF_PACKAGE: Final = """SELECT ?node ?name ?kind {
  GRAPH ?g { %s rnkg:contains ?node . ?node a rnkg:NodeType ; rnkg:name ?name ; rnkg:kind ?kind }
}"""
_ENDS: Final = """SELECT ?node ?end {
  VALUES ?node { %s } GRAPH ?g { ?node ros:hasComponent ?end . ?end rnkg:implicit false }
}"""
_PARTS: Final = """SELECT ?part ?name ?implicit {
  GRAPH ?g { %s %s ?part . ?part rnkg:implicit ?implicit . OPTIONAL { ?part rnkg:name ?name } }
}"""
_SYSTEMS: Final = "SELECT ?system ?name { GRAPH ?g { ?system rnkg:launchDialect ?dialect ; rnkg:name ?name } }"
_STARTED: Final = "SELECT ?system ?instance { VALUES ?system { %s } GRAPH ?g { ?system rnkg:hasInstance ?instance } }"
_INSTANCES: Final = """SELECT ?instance ?name ?kind ?package ?program {
  GRAPH ?g {
    %s rnkg:hasInstance ?instance . ?instance rnkg:name ?name .
    OPTIONAL { ?instance rnkg:instanceOf ?kind }
  }
  OPTIONAL { ?instance rnkg:startedWith/rnkg:startsPackage ?package }
  OPTIONAL { ?instance rnkg:startedWith/rnkg:startsExecutable ?program }
}"""
_CHANNELS: Final = "SELECT ?channel ?label { GRAPH <%s> { ?channel a %s ; rdfs:label ?label } }"
_AT: Final = """SELECT ?channel ?end {
  VALUES ?channel { %s } GRAPH ?g { ?end rnkg:connectsTo ?channel ; rnkg:implicit false }
}"""
_AT_ONE: Final = """SELECT ?node ?end {
  GRAPH ?g { ?end rnkg:connectsTo %s ; rnkg:implicit false . ?node ros:hasComponent ?end }
}"""
_CLASSES: Final = {"topics": "ros:Topic", "services": "ros:Service", "actions": "rnkg:Action"}
_ROOTS: Final = ("packages", "systems", *_CLASSES)
_PARAMETERS: Final = "parameters"

_Branch = dict[str, Any]


def tree(  # noqa: PLR0913 - the branch, and the part of it
    snapshot: EmbeddedSnapshot,
    settings: Settings,
    *,
    parent: str = "",
    kind: str = "",
    offset: str = "0",
    limit: str = "500",
) -> dict[str, Any]:
    """Return one level of the tree of the store's content.

    The root (`parent` empty) has the branches `packages`, `systems`, `topics`, `services` and `actions`. Packages hold
    nodes, nodes the groups of their interfaces and their parameters, systems the instances that they start, topics,
    services and actions the nodes at them.

    The answer is `{"parent", "kind", "total", "offset", "children"}`. A child has `iri` (None for a group), `label`,
    `kind` (package, node, publishes, ..., parameter, system, instance, topic, ...), `count` (how much is below it), a
    `detail` in words, and `open`: the arguments `parent` and `kind` that open it, None for a leaf. Children are sorted
    by label; at most `limit` (1,000 at most) are given, from `offset` on.

    UnknownNameError KG001 for a parent that is not a branch, UsageError KG003 for one that is not an IRI.
    """
    start, most = whole(offset, 0), min(whole(limit, 500), _MOST)
    branches = _children(snapshot, Iris(settings.base), parent, kind)
    shown = branches[start : start + most]
    # Counting the ends of all topics of a large store is slow, so only those that are shown are counted.
    if parent in _CLASSES:
        _count(snapshot, shown, _AT)
    elif parent == "systems":
        _count(snapshot, shown, _STARTED)
    return {"parent": parent, "kind": kind, "total": len(branches), "offset": start, "children": shown}


def _children(snapshot: EmbeddedSnapshot, iris: Iris, parent: str, kind: str) -> list[_Branch]:
    if not parent:
        counts = {name: len(_listed(snapshot, iris, name)) for name in _ROOTS}
        return [
            {**_branch(name, "group", count=number), "open": {"parent": name, "kind": ""}}
            for name, number in counts.items()
        ]
    if parent in _ROOTS:
        return [dict(one) for one in _listed(snapshot, iris, parent)]
    iri = named_node(parent).value
    thing = iris.parse(iri.partition("#")[0])
    what = thing.kind if thing else ""
    if what not in _BRANCHES:
        hint = "Begin with `packages`, `systems`, `topics`, `services` or `actions`."
        raise UnknownNameError("KG001", f"the tree has no branch {parent}", hint=hint)
    return _BRANCHES[what](snapshot, iri, kind)


def _branch(label: str, kind: str, iri: str | None = None, detail: str = "", count: int = 0) -> _Branch:
    """Return a branch that its own IRI opens."""
    opened = {"parent": iri, "kind": ""} if iri else None
    return {"iri": iri, "label": label, "kind": kind, "count": count, "detail": detail, "open": opened}


@once
def _packages(snapshot: EmbeddedSnapshot, iris: Iris) -> tuple[_Branch, ...]:
    nodes = Counter(package for package, _ in rows(snapshot, _NODES))
    branches = []
    for package, name, ros in rows(snapshot, _PACKAGES):
        thing = iris.parse(package)
        detail = f"{thing.parts[0] if thing else ''}{f', ROS {ros}' if ros and ros != '0' else ''}"
        branches.append(_branch(name, "package", package, detail, nodes[package]))
    return tuple(sorted(branches, key=_order))


@once
def _systems(snapshot: EmbeddedSnapshot, iris: Iris) -> tuple[_Branch, ...]:
    branches = []
    for system, name in rows(snapshot, _SYSTEMS):
        thing = iris.parse(system)
        branches.append(_branch(name, "system", system, thing.parts[0] if thing else ""))
    return tuple(sorted(branches, key=_order))


@once
def _channels(snapshot: EmbeddedSnapshot, iris: Iris, group: str) -> tuple[_Branch, ...]:
    query = _CHANNELS % (iris.graph("shared"), _CLASSES[group])
    return tuple(sorted((_branch(name, group[:-1], iri) for iri, name in rows(snapshot, query)), key=_order))


def _listed(snapshot: EmbeddedSnapshot, iris: Iris, group: str) -> tuple[_Branch, ...]:
    """Return the children of a branch of the root."""
    if group in _CLASSES:
        return _channels(snapshot, iris, group)
    return _packages(snapshot, iris) if group == "packages" else _systems(snapshot, iris)


def alike(snapshot: EmbeddedSnapshot, iris: Iris, kind: str) -> list[str]:
    """Return the names of all packages, topics, services or actions, as `kind` says; none of another kind."""
    group = f"{kind}s"
    return [one["label"] for one in _listed(snapshot, iris, group)] if group in {"packages", *_CLASSES} else []


def _count(snapshot: EmbeddedSnapshot, shown: list[_Branch], query: str) -> None:
    """Add to branches the number of their children."""
    below = Counter(one for one, _ in rows(snapshot, query % listing(each["iri"] for each in shown)))
    for each in shown:
        each["count"] = below[each["iri"]]


def _of_package(snapshot: EmbeddedSnapshot, iri: str, _kind: str) -> list[_Branch]:
    branches = [
        _branch(name, "node", node, kind.rpartition("#")[2])
        for node, name, kind in rows(snapshot, _OF_PACKAGE % f"<{iri}>")
    ]
    _count(snapshot, branches, _ENDS)
    return sorted(branches, key=_order)


def _of_node(snapshot: EmbeddedSnapshot, iri: str, kind: str) -> list[_Branch]:
    if kind == _PARAMETERS:
        parts = rows(snapshot, _PARTS % (f"<{iri}>", "rnkg:hasParameter"))
        return _leaves(parts, "parameter")
    components = list(rows(snapshot, _PARTS % (f"<{iri}>", "ros:hasComponent")))
    by_role = {role: [row for row in components if role_of(row[0]) is role] for role in Role}
    if kind in by_role:
        return _leaves(by_role[Role(kind)], kind)
    groups = {str(role): (role.heading, len(by_role[role])) for role in Role}
    groups[_PARAMETERS] = (_PARAMETERS, sum(1 for _ in rows(snapshot, _PARTS % (f"<{iri}>", "rnkg:hasParameter"))))
    return [
        {**_branch(title, name, count=number), "open": {"parent": iri, "kind": name}}
        for name, (title, number) in groups.items()
        if number
    ]


def _leaves(parts: Any, kind: str) -> list[_Branch]:
    branches = {
        part: {
            **_branch(name or NAME_UNKNOWN, kind, part, "made by a framework" if implicit == "true" else ""),
            "open": None,
        }
        for part, name, implicit in parts
    }
    return sorted(branches.values(), key=_order)


def _of_system(snapshot: EmbeddedSnapshot, iri: str, _kind: str) -> list[_Branch]:
    branches = {}
    for instance, name, kind, package, program in rows(snapshot, _INSTANCES % f"<{iri}>"):
        label = "/".join(node_parts(kind)[1:]) if kind else f"{package or '?'}/{program or '?'}"
        branches[instance] = {**_branch(name, "instance", instance, label), "open": None, "node": kind}
    return sorted(branches.values(), key=_order)


def _of_channel(snapshot: EmbeddedSnapshot, iri: str, _kind: str) -> list[_Branch]:
    by_role = {}
    for node, end in rows(snapshot, _AT_ONE % f"<{iri}>"):
        role, (_, package, name) = role_of(end), node_parts(node)
        by_role[node, role] = _branch(f"{package}/{name}", "node", node, role.heading if role else "")
    branches = [*by_role.values()]
    _count(snapshot, branches, _ENDS)
    return sorted(branches, key=_order)


_BRANCHES: Final = {
    "package": _of_package,
    "node": _of_node,
    "configuration": _of_system,
    "topic": _of_channel,
    "service": _of_channel,
    "action": _of_channel,
}


def _order(one: _Branch) -> tuple[str, str, str]:
    return one["label"], one["detail"], one["iri"] or ""
