"""One node type, all that is known of it: the view `node`."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final, NamedTuple
from urllib.parse import unquote

from kg.errors import UnknownNameError
from kg.facts import Description, DescriptionKind, Interface, Location, Role
from kg.graph import vocabulary as v
from kg.graph.iris import Iris
from kg.graph.reading.classes import Grade, grades
from kg.graph.reading.nodes import NodeRecord, node_records
from kg.graph.records import how_to_start
from kg.graph.texts import descriptions_of
from kg.holes import is_known
from kg.query.rows import rows
from kg.views.evidence import Places, places
from kg.views.names import one_node
from kg.views.node_rows import fact, interface_rows, parameter_rows, slot_rows
from kg.views.terms import labels, listing, named_node, node_parts, role_of
from kg.views.wording import LANGUAGES

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kg.settings import Settings
    from kg.store.snapshot import EmbeddedSnapshot

_MOST: Final = 6  # so many neighbours of a channel are named; of all, how many there are
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
    channels = []
    for end, one in sorted(own.items()):
        ends = (end for end in others[wanted[end]] if end.role is one.role.opposite and end.node != record.iri)
        nodes = {other.node for other in ends if None in {other.type, one.type} or other.type == one.type}
        if nodes:
            channels.append(_neighbours(one, wanted[end], nodes, record))
    return list({(one["channel_iri"], one["outward"]): one for one in channels}.values())


def _neighbours(one: Interface, channel: str, nodes: Iterable[str], record: NodeRecord) -> dict[str, Any]:
    others = []
    for node in nodes:
        repository, package, name = node_parts(node)
        others.append({"iri": node, "name": name, "package": package, "repository": repository})
    others.sort(key=lambda other: (other["repository"] != record.repository, other["package"] != record.package,
                                  other["package"], other["name"], other["iri"]))  # fmt: skip
    return {
        "channel": one.resolved,
        "channel_iri": channel,
        "kind": one.role.channel,
        "outward": one.role.outward,
        "count": len(others),
        "nodes": others[:_MOST],
    }


def _others(snapshot: EmbeddedSnapshot, channels: Iterable[str]) -> dict[str, list[_End]]:
    """Return for each channel the ends at it."""
    ends = list(rows(snapshot, _ENDS % listing(channels)))
    types = dict(rows(snapshot, _TYPES % listing(end for _, end, _ in ends)))
    by_channel: defaultdict[str, list[_End]] = defaultdict(list)
    for channel, end, node in ends:
        kind = types.get(end)
        name = "/".join(unquote(kind).rsplit("/", 2)[-2:]) if kind else None
        by_channel[channel].append(_End(node, name, role_of(end)))
    return by_channel


def users(snapshot: EmbeddedSnapshot, iri: str, where: Places, iris: Iris) -> dict[str, Any]:
    """Return the starts of a node: `count`, and `instances`, at most a hundred, sorted by launch file and name.

    Each has `instance` (its IRI), `name`, `system` (the name of the launch configuration), `system_iri` and `evidence`,
    the line that starts it.
    """
    starts = []
    for instance, name, configuration, system, path, line, repository in rows(snapshot, _USERS % f"<{iri}>"):
        thing = iris.parse(configuration)
        place = Location(path, int(line), repository)
        evidence = where.evidence(thing.parts[0] if thing else "", place)
        starts.append(
            {"instance": instance, "name": name, "system": system, "system_iri": configuration, "evidence": evidence}
        )
    starts.sort(key=lambda one: (one["system"], one["name"], one["instance"]))
    return {"count": len(starts), "instances": starts[:_MOST_USERS]}


_REACHED: Final = "SELECT DISTINCT ?c { GRAPH ?g { <%s> ros:hasComponent ?end } GRAPH ?h { ?end rnkg:mayReach ?c } }"
_CLASSES: Final = {
    "functions": ("hasFunction",),
    "hardware": ("usesHardware",),
    "devices": ("usesDevice",),
    "capabilities": ("hasCapability", "mayHaveCapability"),
}
"""The properties of each list; a node may have the capabilities that it has."""


def node(
    snapshot: EmbeddedSnapshot, settings: Settings, *, iri: str = "", name: str = "", package: str = ""
) -> dict[str, Any]:
    """Return the node type with this `iri`, or else of this `name` (and `package`).

    `name` may also be `package/node`, `repository:package/node` or the class of a plugin. The keys:

    * what it is: `iri`, `name`, `full_name`, `kind`, `language`, `ros`, `package` and `repository` (each with
      `name` and `iri`), `commit`, `executable`, `plugin`, `node_name`, `node_namespace`, `aliases`,
      `base_class`, `exported` (evidence of what registers a plugin, or None), `start` (the command), `evidence`,
      `sources` (evidence of each), `also` (IRIs of other nodes that the package declares by this name).
    * `interfaces`, `parameters` and `slots`: see `kg.views.node_rows`; `neighbours` and `used_in`: see
      `kg.views.node`.
    * `descriptions`: `text`, `kind`, `heading`, `evidence`; the best first. `package_description`: the same of the
      package, what its manifest says if anything; or None.
    * `functions`, `hardware`, `devices`, `capabilities`: each a list of `iri`, `label`, `inferred`, `fact`, `grade`
      (`certain`, `strong`, `weak`, or empty) and `evidence` (what shows it: `name`, `text`, `code`); the node only may
      have weak capabilities; those of
      `capabilities` also `general`: no interface of the node reaches it, others imply it.

    A `fact` is `{"subject", "predicate", "object"}`, IRIs, as the view `why` takes them. `evidence` is as
    `kg.views.evidence.Places.evidence` returns it.

    Raises:
        UnknownNameError: KG001 with suggestions when there is no such node.
        UsageError: KG003 with the full names when there are several, or for what is not an IRI.
    """
    first, *others = _records(snapshot, iri, f"{package}/{name}" if package else name)
    where, iris = places(snapshot), Iris(settings.base)
    inferred = _inferred(snapshot, iris, first.iri)
    return {
        **_header(first, where, iris),
        "also": [one.iri for one in others],
        "interfaces": interface_rows(first, where, iris, inferred),
        "parameters": parameter_rows(first, where),
        "slots": slot_rows(first, where),
        "descriptions": [_description(one, first, where) for one in first.descriptions],
        "package_description": _of_package(snapshot, first, where, iris),
        **_classes(snapshot, first.iri, inferred),
        "neighbours": neighbours(snapshot, first, iris),
        "used_in": users(snapshot, first.iri, where, iris),
    }


def _records(snapshot: EmbeddedSnapshot, iri: str, name: str) -> list[NodeRecord]:
    if not iri:
        return one_node(snapshot, name)
    records = node_records(snapshot, iris=[named_node(iri).value])
    if not records:
        hint = f"`{iri.rstrip('/').rpartition('/')[2]}` may be the name of another node."
        raise UnknownNameError("KG001", f"the store has no node {iri}", hint=hint)
    return records


def _header(record: NodeRecord, where: Places, iris: Iris) -> dict[str, Any]:
    declared, repository = record.node, record.repository
    return {
        "iri": record.iri,
        "name": declared.name,
        "full_name": record.full_name,
        "kind": str(declared.kind),
        "language": LANGUAGES.get(declared.language, declared.language),
        "ros": declared.ros,
        "package": {"name": record.package, "iri": iris.package(repository, record.package)},
        "repository": {"name": repository, "iri": iris.repository(repository)},
        "commit": record.commit,
        "executable": declared.executable,
        "plugin": declared.plugin,
        "node_name": declared.node_name,
        "node_namespace": declared.node_namespace,
        "aliases": list(declared.aliases),
        "base_class": declared.base_class,
        "exported": where.evidence(repository, declared.exported) if declared.exported is not None else None,
        "start": how_to_start(record),
        "evidence": where.evidence(repository, declared.location),
        "sources": [where.evidence(repository, Location(path, 0)) for path in declared.sources],
    }


def _description(one: Description, record: NodeRecord, where: Places) -> dict[str, Any]:
    return {
        "text": one.text,
        "kind": str(one.kind),
        "heading": one.heading,
        "evidence": where.evidence(record.repository, one.location),
    }


def _of_package(snapshot: EmbeddedSnapshot, record: NodeRecord, where: Places, iris: Iris) -> dict[str, Any] | None:
    """Return the description of the package of a node; manifests come first, readers of a README see other parts."""
    iri = iris.package(record.repository, record.package)
    texts = descriptions_of(snapshot, f"VALUES ?node {{ <{iri}> }}").get(iri, ())
    best = min(texts, key=lambda one: one.kind is not DescriptionKind.MANIFEST, default=None)
    return _description(best, record, where) if best else None


def _inferred(snapshot: EmbeddedSnapshot, iris: Iris, iri: str) -> Mapping[str, frozenset[str]]:
    """Return the inferences about a thing: objects by property."""
    objects: defaultdict[str, set[str]] = defaultdict(set)
    query = f"SELECT ?p ?o {{ GRAPH <{iris.graph('inferred')}> {{ <{iri}> ?p ?o }} }}"
    for predicate, value in rows(snapshot, query):
        objects[predicate].add(value)
    return {predicate: frozenset(values) for predicate, values in objects.items()}


def _classes(
    snapshot: EmbeddedSnapshot, iri: str, inferred: Mapping[str, frozenset[str]]
) -> dict[str, list[dict[str, Any]]]:
    """Return the functions, the hardware and the capabilities of a node, with their proofs if inferred.

    Capabilities have whether they are general: no interface of the node reaches them.
    """
    predicates = " ".join(f"rnkg:{name}" for names in _CLASSES.values() for name in names)
    query = f"""SELECT DISTINCT ?p ?o {{ VALUES ?p {{ {predicates} }} GRAPH ?g {{ <{iri}> ?p ?o }}
      FILTER(?p != rnkg:mayHaveCapability || NOT EXISTS {{ GRAPH ?h {{ <{iri}> rnkg:hasCapability ?o }} }}) }}"""
    pairs = list(rows(snapshot, query))
    names, graded = labels(snapshot, {value for _, value in pairs}), grades(snapshot, iri)
    classes: dict[str, list[dict[str, Any]]] = {kind: [] for kind in _CLASSES}
    for kind, own in _CLASSES.items():
        for predicate, value in pairs:
            if predicate.removeprefix(v.RNKG) in own:
                label = names.get(value) or value.rpartition("#")[2]
                derived = value in inferred.get(predicate, ())
                grade = graded.get(value, Grade())
                classes[kind].append(
                    {
                        "iri": value,
                        "label": label,
                        "inferred": derived,
                        "fact": fact(iri, predicate, value),
                        "grade": grade.grade,
                        "evidence": list(grade.evidence),
                    }
                )
        classes[kind].sort(key=lambda one: (graded.get(one["iri"], Grade()).rank, one["label"], one["iri"]))
    reached = {capability for (capability,) in rows(snapshot, _REACHED % iri)}
    for one in classes["capabilities"]:
        one["general"] = one["iri"] not in reached
    return classes
