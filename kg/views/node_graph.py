"""The entities that a node is related to, and the names of the relations, as RNKG has them (its figures 5 and 6)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, Final

from kg.facts import Role
from kg.render.node_graph import Relation

_CLASSES: Final = {
    "functions": "has function",
    "hardware": "uses hardware",
    "devices": "uses device",
    "capabilities": "has capability",
}
_KINDS: Final = {"functions": "function", "hardware": "hardware", "devices": "device", "capabilities": "capability"}
_ROLES: Final = (Role.SUBSCRIBES, Role.PUBLISHES, *(role for role in Role if role.channel != "topic"))
_TYPES: Final = {"topic": "has message", "service": "has service type", "action": "has action type"}


def node_relations(node: Mapping[str, Any], *, every: bool = False) -> tuple[Relation, ...]:
    """Return the relations of a node, from the view `node`; those of one name follow each other.

    An interface that the code declares is read, not inferred; functions, hardware and capabilities are what rules say.
    `every` adds what frameworks create, capabilities that follow from others, and those that the node only may have.
    """
    return tuple(dict.fromkeys(_relations(node, every=every)))


def _relations(data: Mapping[str, Any], *, every: bool) -> Iterator[Relation]:
    node = data["name"]
    package, repository = f"package {data['package']['name']}", f"repository {data['repository']['name']}"
    yield Relation(node, "in package", package)
    yield Relation(package, "in repository", repository)
    if data["executable"]:
        yield Relation(node, "has executable", f"executable {data['executable']}")
    for kind, name in _CLASSES.items():
        for one in data[kind]:
            possible = kind == "capabilities" and one.get("grade") == "weak"
            if every or not (possible or one.get("general")):
                what = "may have capability" if possible else name
                yield Relation(node, what, f"{_KINDS[kind]} {one['label']}", one["inferred"])
    for role in _ROLES:
        for one in data["interfaces"]:
            if one["role"] != role or (one["implicit"] and not every):
                continue
            channel = f"{one['kind']} {one['resolved'] or one['written'] or 'of unknown name'}"
            yield Relation(node, role.relation, channel)
            if one["type"]:
                yield Relation(channel, _TYPES[one["kind"]], one["type"])
