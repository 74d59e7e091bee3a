"""What systems need not state of each instance, since it follows from the instance's name and node type.

First of all the ends that a framework gives every node, such as its services for parameters.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from urllib.parse import unquote

from kg.facts import InstanceInterface, Interface, LaunchParameter, NodeReference, Resolution, Role
from kg.graph.interfaces import ROLE_OF_CLASS
from kg.graph.reading.queries import among, column, one_of, texts
from kg.holes import is_known
from kg.launch.wiring.place import Place

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from kg.store.interface import Queryable


_MET: Final = """
SELECT DISTINCT ?system ?channel ?name WHERE {
  GRAPH ?g {
    ?system rnkg:hasInstance ?instance . ?instance ros:hasComponent ?end .
    ?end rnkg:connectsTo ?channel . ?channel rdfs:label ?name .
  }
}"""
_STATED: Final = """
SELECT ?instance ?code WHERE {
  GRAPH ?g {
    %s
    ?instance rnkg:without|(ros:hasComponent/(rnkg:declaredBy|rnkg:overrides)) ?code
  }
}"""
_STARTED: Final = """
SELECT ?system ?instance ?name ?namespace ?type WHERE {
  GRAPH ?g {
    %s
    ?system rnkg:hasInstance ?instance ; rnkg:declaredIn ?file . ?instance rnkg:instanceOf ?type ; rnkg:name ?name .
    OPTIONAL { ?instance rnkg:namespace ?namespace }
  }
}"""
_IMPLICIT: Final = """
SELECT ?node ?code ?class ?name ?origin ?type WHERE {
  GRAPH ?g {
    %s
    ?node a rnkg:NodeType ; ros:hasComponent ?code .
    ?code rnkg:implicit true ; rnkg:name ?name ; rnkg:origin ?origin ; a ?class .
    OPTIONAL { ?code ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?type }
  }
}"""
_TYPED: Final = """
SELECT DISTINCT ?node WHERE {
  %s
  ?type rdfs:label ?label . ?code ros:hasMessage|rnkg:hasServiceType|rnkg:hasActionType ?type ; rnkg:implicit true .
  ?node ros:hasComponent ?code .
}"""
_ORIGINS: Final = ("ros1.node", "ros2.node", "ros2.lifecycle", "bond")
"""Prefixes of the origins of such ends. Other implicit ends (transforms, diagnostics) describe what a node does."""


def usual_ends(
    name: str, namespace: str, owner: NodeReference, ends: Mapping[str, Interface]
) -> dict[str, InstanceInterface]:
    """Return the usual ends of an instance by the IRIs of the interfaces of its type, as nothing changes them.

    `name` is the absolute name of the instance, `owner` its node type, `ends` are interfaces of that by IRI.
    """
    place = Place(namespace, "", private=name)
    return {
        iri: InstanceInterface(
            declared,
            owner,
            place.resolve(declared.name),
            declared.resolution,
            qos=declared.qos,
            reason=declared.reason,
        )
        for iri, declared in ends.items()
        if declared.implicit and declared.name is not None and (declared.origin or "").startswith(_ORIGINS)
    }


class UsualEnd(NamedTuple):
    """An end that a system has without stating it.

    `system`, `instance`, `node` (its type) and `code` (the interface of that) are IRIs, `type` is `package/Type`.
    """

    system: str
    instance: str
    node: str
    code: str
    role: Role
    name: str
    type: str | None


def unstated_ends(graph: Queryable, name: str | None = None, types: Collection[str] | None = None) -> list[UsualEnd]:
    """Return the usual ends that systems have without stating them, or those of one absolute name, or of some types."""
    if name is not None:
        implicit, started = _near(graph, name)
    elif types is not None:
        having = column(graph, _TYPED % one_of("label", types))
        implicit = list(texts(graph, _IMPLICIT % among("node", having)))
        started = list(texts(graph, _STARTED % among("type", having)))
    else:
        implicit, started = list(texts(graph, _everywhere(_IMPLICIT))), list(texts(graph, _everywhere(_STARTED)))
    usual: defaultdict[str, list[tuple[str, Role, str, str | None]]] = defaultdict(list)
    for node, code, role, own, origin, kind in implicit:
        if not (origin.startswith(_ORIGINS) and role in ROLE_OF_CLASS):
            continue
        label = "/".join(unquote(kind).rsplit("/", 2)[-2:]) if kind else None
        if types is None or label in types:
            usual[node].append((code, ROLE_OF_CLASS[role], own, label))
    ends = []
    for system, instance, full, namespace, node in started:
        place = Place(namespace or namespace_of(full), "", private=full)
        ends += [
            UsualEnd(system, instance, node, code, role, place.resolve(own), label)
            for code, role, own, label in usual.get(node, ())
        ]
    ends = [end for end in ends if name in {None, end.name}]
    if not ends:
        return []
    these = among("instance", [end.instance for end in ends])
    stated = set(texts(graph, _everywhere(_STATED) if name is None else _STATED % these))
    return [end for end in ends if (end.instance, end.code) not in stated]


def _everywhere(query: str) -> str:
    """Return a query for all there is, in the union of all graphs; columns have no others.

    Of few things the store finds those of one graph sooner.
    """
    return query.replace("GRAPH ?g", "") % ""


def _near(graph: Queryable, name: str) -> tuple[list[Any], list[Any]]:
    """Return the implicit ends, and the instances, of which an end with an absolute name can come, and few others.

    The name of such an end is that of the instance and a private name, or it ends in the name that the code has.
    """
    parts = name.strip("/").split("/")
    owners = ["/" + "/".join(parts[: at + 1]) for at in range(len(parts))]
    started = set(texts(graph, _STARTED % one_of("name", owners)))
    implicit = set(texts(graph, _IMPLICIT % among("node", [row[4] for row in started])))
    written = ["/".join(parts[at:]) for at in range(len(parts))]
    others = set(texts(graph, _IMPLICIT % one_of("name", [*written, name])))
    started.update(texts(graph, _STARTED % among("type", [row[0] for row in others])))
    return sorted(implicit | others, key=str), sorted(started, key=str)


def channels_by_system(graph: Queryable) -> dict[str, set[tuple[str, str]]]:
    """Return what ends of each system meet at, those that a framework gives every node too: kind and name.

    The keys are IRIs of configurations, the kinds `topic`, `service` and `action`.
    """
    by_system: defaultdict[str, set[tuple[str, str]]] = defaultdict(set)
    for system, channel, name in texts(graph, _MET):
        by_system[system].add((channel.partition("#")[2].partition("/")[0], name))
    for end in unstated_ends(graph):
        by_system[end.system].add((end.role.channel, end.name))
    return dict(by_system)


def namespace_of(name: str) -> str:
    """Return the namespace that the absolute name of a node shows."""
    return name.rpartition("/")[0] or "/"


def usual_resolution(declared: Interface, resolved: str | None, parameter: LaunchParameter | None) -> Resolution:
    """Return how the name of an end of an instance becomes known where nothing else is said."""
    if parameter is not None:
        return Resolution.LAUNCH_ARGUMENT
    is_complete = declared.resolution is Resolution.PARTIAL and is_known(resolved)
    return Resolution.CONSTANT if is_complete else declared.resolution
