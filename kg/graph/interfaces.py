"""Interfaces of nodes become components (onto-ros, K-CAP 2017, section 4); rules derive the direct relations of RNKG.

A component stands for one end of a topic, service or action in one node; it carries where and how the fact was
read. Topics, services, actions and interface types are shared by all sources. A name with an unknown part names no
topic: its component has none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from kg.facts import Interface, Qos, Resolution, Role
from kg.graph import vocabulary as v
from kg.graph.fields import INTERFACE, QOS
from kg.graph.ntriples import plain
from kg.holes import is_known

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.graph.scope import Scope


@dataclass(frozen=True, slots=True)
class _TypeShape:
    """How an interface type of one kind is written; `parts` are its messages as section, relation and class."""

    kind: str
    type_class: tuple[str, ...]
    parts: tuple[tuple[str, str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Shape:
    """How a role is written: the component, what it connects to, and the type of that.

    `component` is the part of an IRI, the classes and relations are terms; `type_kind` is msg, srv or action.
    """

    component: str
    component_class: str
    channel_class: str
    has_type: str
    channel_has_type: str
    type_kind: str


_TYPES: Final = {
    "msg": _TypeShape("message", (v.MESSAGE, v.MESSAGE_TYPE)),
    "srv": _TypeShape(
        "service-type",
        (v.SERVICE_TYPE,),
        (("request", v.HAS_REQUEST, v.REQUEST), ("response", v.HAS_RESPONSE, v.RESPONSE)),
    ),
    "action": _TypeShape(
        "action-type",
        (v.ACTION_TYPE,),
        (
            ("goal", v.HAS_GOAL, v.GOAL),
            ("result", v.HAS_RESULT, v.RESULT),
            ("feedback", v.HAS_FEEDBACK, v.FEEDBACK),
        ),
    ),
}
_ON_TOPIC: Final = (v.TOPIC, v.ROS_HAS_MESSAGE, v.HAS_MESSAGE, "msg")
_ON_SERVICE: Final = (v.SERVICE, v.HAS_SERVICE_TYPE, v.HAS_SERVICE_TYPE, "srv")
_ON_ACTION: Final = (v.ACTION, v.HAS_ACTION_TYPE, v.HAS_ACTION_TYPE, "action")
SHAPES: Final[Mapping[Role, Shape]] = {
    Role.PUBLISHES: Shape("publisher", v.PUBLISHER, *_ON_TOPIC),
    Role.SUBSCRIBES: Shape("subscriber", v.SUBSCRIBER, *_ON_TOPIC),
    Role.SERVICES: Shape("service-server", v.SERVICE_SERVER, *_ON_SERVICE),
    Role.CLIENTS: Shape("service-client", v.SERVICE_CLIENT, *_ON_SERVICE),
    Role.ACTION_SERVERS: Shape("action-server", v.ACTION_SERVER, *_ON_ACTION),
    Role.ACTION_CLIENTS: Shape("action-client", v.ACTION_CLIENT, *_ON_ACTION),
}
ROLE_OF_CLASS: Final = {v.bare(shape.component_class): role for role, shape in SHAPES.items()}
"""The role of a node at a component, by the IRI of its class."""
_NAMELESS: Final = frozenset({Resolution.PARTIAL, Resolution.UNRESOLVED})


def interface(scope: Scope, owner: str, fact: Interface) -> str:
    """Write one interface of the node whose IRI is `owner`; return its IRI."""
    shape, writer = SHAPES[fact.role], scope.writer
    node, part = f"<{owner}>", scope.part(owner, shape.component, fact.name)
    writer.add(node, v.HAS_COMPONENT, part)
    writer.add(part, v.TYPE, shape.component_class)
    writer.add(part, v.DECLARED_BY, part)
    INTERFACE.write(writer, part, fact)
    scope.evidence(part, fact.location, fact.via)
    kind = interface_type(scope, shape.type_kind, fact.type) if fact.type else None
    if kind:
        writer.add(part, shape.has_type, kind)
    if is_known(fact.resolved) and fact.resolution not in _NAMELESS:
        channel = f"<{scope.iris.channel(fact.role.channel, fact.resolved)}>"
        writer.described(channel, fact.resolved, shape.channel_class)
        writer.add(part, v.CONNECTS_TO, channel)
        if kind:
            writer.once(channel, shape.channel_has_type, kind)
    if fact.qos is not None:
        writer.add(part, v.HAS_QOS, quality(scope, fact.qos))
    return part[1:-1]


def quality(scope: Scope, qos: Qos) -> str:
    """Return the spelled IRI of a combination of policies, described once."""
    depth = None if qos.depth is None else str(qos.depth)
    words = [word if word is not None else "-" for word in (qos.reliability, qos.durability, qos.history, depth)]
    rarer = {
        "deadline": qos.deadline,
        "lifespan": qos.lifespan,
        "liveliness": qos.liveliness,
        "lease": qos.lease_duration,
    }
    more = [f"{name}:{value if isinstance(value, str) else plain(value)}" for name, value in rarer.items() if value]
    iri, writer = f"<{scope.iris.qos(*words, *more)}>", scope.writer
    if writer.described(iri, " ".join([*words, *more]), v.QOS):
        QOS.write(writer, iri, qos)
    return iri


def interface_type(scope: Scope, kind: str, name: str) -> str:
    """Return the spelled IRI of the type `name` (`package/Type`) of `kind` (msg, srv, action), described once."""
    shape, writer = _TYPES[kind], scope.writer
    bare = scope.iris.interface_type(shape.kind, name)
    iri = f"<{bare}>"
    if writer.described(iri, name, *shape.type_class):
        for section, relation, part_class in shape.parts:
            part = f"<{bare}#{section}>"
            writer.add(iri, relation, part)
            writer.described(part, f"{name} {section}", part_class)
    return iri
