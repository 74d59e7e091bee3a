"""Relations of a node type to others: the nodes on the other side of its channels, the systems that start it."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from urllib.parse import unquote

from kg.facts import Location
from kg.holes import is_known
from kg.query.rows import rows
from kg.views.terms import listing, node_parts, role_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kg.facts import Interface, Role
    from kg.graph.iris import Iris
    from kg.graph.reading import NodeRecord
    from kg.store.snapshot import EmbeddedSnapshot
    from kg.views.evidence import Places

__all__ = ["neighbours", "users"]

_MOST: Final = 6
"""So many neighbours of a channel are named; of all, how many there are."""
_MOST_USERS: Final = 100
_ENDS: Final = """SELECT ?channel ?end ?node {
  VALUES ?channel { %s }
  GRAPH ?g { ?end rnkg:connectsTo ?channel ; rnkg:implicit false . ?node ros:hasComponent ?end }
}"""
_TYPES: Final = """SELECT ?end ?type {
  VALUES ?end { %s }
  GRAPH ?g { ?end ?has ?type }
  FILTER(?has IN (ros:hasMessage, rnkg:hasServiceType, rnkg:hasActionType))
}"""
_USERS: Final = """SELECT DISTINCT ?instance ?name ?configuration ?system ?path ?line ?repository {
  VALUES ?relation { rnkg:instanceOf rnkg:loadsPlugin }
  GRAPH ?g {
    ?instance ?relation %s ; rnkg:name ?name ; rnkg:path ?path ; rnkg:line ?line .
    ?configuration rnkg:hasInstance ?instance ; rnkg:name ?system .
    OPTIONAL { ?instance rnkg:repository ?repository }
  }
}"""


class _End(NamedTuple):
    """An interface of another node; `type` is `package/Type`."""

    node: str
    type: str | None
    role: Role | None


def neighbours(snapshot: EmbeddedSnapshot, record: NodeRecord, iris: Iris) -> list[dict[str, Any]]:
    """Return for each channel of a node the nodes at its other side, by name and type, those of its source first.

    Each has `channel` (its name), `channel_iri`, `kind`, `outward` (the node begins: it publishes or calls), `count`,
    and `nodes`: at most six of `iri`, `name`, `package`, `repository`. Ends that frameworks make are left out, and ends
    of another type.
    """
    own = {iri: one for one, iri in record.ends.items() if not one.implicit and is_known(one.resolved)}
    wanted = {end: iris.channel(one.role.channel, one.resolved or "") for end, one in own.items()}
    others = _others(snapshot, wanted.values())
    found = []
    for end, one in sorted(own.items()):
        ends = (end for end in others[wanted[end]] if end.role is one.role.opposite and end.node != record.iri)
        nodes = {other.node for other in ends if None in {other.type, one.type} or other.type == one.type}
        if nodes:
            found.append(_neighbours(one, wanted[end], nodes, record))
    return list({(one["channel_iri"], one["outward"]): one for one in found}.values())


def _neighbours(one: Interface, channel: str, nodes: Iterable[str], record: NodeRecord) -> dict[str, Any]:
    known = [_named(node) for node in nodes]
    known.sort(key=lambda other: (other["repository"] != record.repository, other["package"] != record.package,
                                  other["package"], other["name"], other["iri"]))  # fmt: skip
    return {
        "channel": one.resolved,
        "channel_iri": channel,
        "kind": one.role.channel,
        "outward": one.role.outward,
        "count": len(known),
        "nodes": known[:_MOST],
    }


def _others(snapshot: EmbeddedSnapshot, channels: Iterable[str]) -> dict[str, list[_End]]:
    """Return for each channel the ends at it."""
    ends = list(rows(snapshot, _ENDS % listing(channels)))
    types = dict(rows(snapshot, _TYPES % listing(end for _, end, _ in ends)))
    found: defaultdict[str, list[_End]] = defaultdict(list)
    for channel, end, node in ends:
        kind = types.get(end)
        name = "/".join(unquote(kind).rsplit("/", 2)[-2:]) if kind else None
        found[channel].append(_End(node, name, role_of(end)))
    return found


def _named(node: str) -> dict[str, str]:
    repository, package, name = node_parts(node)
    return {"iri": node, "name": name, "package": package, "repository": repository}


def users(snapshot: EmbeddedSnapshot, iri: str, where: Places, iris: Iris) -> dict[str, Any]:
    """Return the starts of a node: `count`, and `instances`, at most a hundred, sorted by launch file and name.

    Each has `instance` (its IRI), `name`, `system` (the name of the launch configuration), `system_iri` and `evidence`,
    the line that starts it.
    """
    found = []
    for instance, name, configuration, system, path, line, repository in rows(snapshot, _USERS % f"<{iri}>"):
        thing = iris.parse(configuration)
        place = Location(path, int(line), repository)
        evidence = where.evidence(thing.parts[0] if thing else "", place)
        found.append(
            {"instance": instance, "name": name, "system": system, "system_iri": configuration, "evidence": evidence}
        )
    found.sort(key=lambda one: (one["system"], one["name"], one["instance"]))
    return {"count": len(found), "instances": found[:_MOST_USERS]}
