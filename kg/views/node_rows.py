"""The rows of a node's page: its interfaces and its parameters, each with its evidence."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.facts import Interface, Parameter, Role
from kg.graph import vocabulary as v
from kg.graph.records import interface_object, parameter_object, slot_object
from kg.holes import is_known
from kg.views.wording import accesses, how, how_loaded, parameter_groups

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kg.graph.iris import Iris
    from kg.graph.reading.nodes import NodeRecord
    from kg.views.evidence import Places

DIRECT: Final = {role: role.relation.replace(" action", "Action") for role in Role}
"""The property of RNKG that leads from a node to the channel of an interface, by role."""
TYPES: Final = {"topic": "message", "service": "service-type", "action": "action-type"}
"""The kind of IRI that the type of a channel has."""


def fact(subject: str, predicate: str, value: str) -> dict[str, str]:
    """Return a triple of IRIs as the view `why` takes it."""
    return {"subject": subject, "predicate": predicate, "object": value}


def interface_rows(
    record: NodeRecord, where: Places, iris: Iris, inferred: Mapping[str, frozenset[str]]
) -> list[dict[str, Any]]:
    """Return the interfaces of a node by role, what frameworks make behind the others of a role.

    `inferred` has what rules derived of the node: objects by property. The keys are those of an interface in
    `kg nodes --json` (docs/formats.md), and `role`, `title`, `kind` (topic, service, action), `outward`, `iri`,
    `type_iri`, `channel_iri`, `quality` and `how` (words), `evidence`, `line_text` and
    `line_stored` (the statement: `kg.views.evidence.Places.code`), `calls` (evidence of the calls in wrappers and base
    classes, from the line to the framework), and `fact` where rules infer the direct relation.
    """
    chosen = sorted(record.node.interfaces, key=lambda one: (list(Role).index(one.role), one.implicit))
    return [_interface(one, record, where, iris, inferred) for one in chosen]


def _interface(
    one: Interface, record: NodeRecord, where: Places, iris: Iris, inferred: Mapping[str, frozenset[str]]
) -> dict[str, Any]:
    role, is_complete = one.role, is_known(one.resolved)
    channel = iris.channel(role.channel, one.resolved) if one.resolved and is_complete else None
    predicate = v.RNKG + DIRECT[role]
    return {
        **interface_object(one),
        "role": str(role),
        "title": role.heading,
        "kind": role.channel,
        "outward": role.outward,
        "iri": record.ends.get(one),
        "type_iri": iris.interface_type(TYPES[role.channel], one.type) if one.type else None,
        "channel_iri": channel,
        "quality": str(one.qos or ""),
        "how": how(one),
        "evidence": where.evidence(record.repository, one.location),
        **where.code(record.repository, one.location, whole=True),
        "calls": [where.evidence(record.repository, call) for call in one.via],
        "fact": fact(record.iri, predicate, channel) if channel and channel in inferred.get(predicate, ()) else None,
    }


def parameter_rows(record: NodeRecord, where: Places) -> list[dict[str, Any]]:
    """Return the parameters of a node, each once.

    The keys are those of a parameter in `kg nodes --json` of the line that declares it, `default`, `type` and
    `description` where any line has them, and `iri`, `does` (words), `evidence`, `line_text`, `line_stored`, `calls`
    as for an interface, and `places` (of each line its evidence and `access`).
    """
    return [_parameter(group, record, where) for group in parameter_groups(record.node.parameters)]


def slot_rows(record: NodeRecord, where: Places) -> list[dict[str, Any]]:
    """Return the plugin slots of a node.

    The keys are those of a slot in `kg nodes --json`, and `how` (words), `evidence` and `calls` as for an interface.
    Each of `defaults` also has `iri`, that of its node type, None where the store has none.
    """
    slots = []
    for one in record.node.slots:
        plain = slot_object(one, record)
        for default in plain["defaults"]:
            default["iri"] = record.plugins[default["class"]][1] if default["class"] in record.plugins else None
        slots.append(
            {
                **plain,
                "how": how_loaded(one),
                "evidence": where.evidence(record.repository, one.location),
                "calls": [where.evidence(record.repository, call) for call in one.via],
            }
        )
    return slots


def _parameter(group: Sequence[Parameter], record: NodeRecord, where: Places) -> dict[str, Any]:
    first, places = group[0], [where.evidence(record.repository, one.location) for one in group]
    shared = {
        key: next((value for one in group if (value := getattr(one, key)) is not None), None)
        for key in ("type", "default", "description")
    }
    return {
        **parameter_object(first),
        **shared,
        "iri": record.settable.get(first),
        "does": accesses(group),
        "evidence": places[0],
        **where.code(record.repository, first.location, whole=True),
        "calls": [where.evidence(record.repository, call) for call in first.via],
        "places": [{**place, "access": str(one.access)} for one, place in zip(group, places, strict=True)],
    }
