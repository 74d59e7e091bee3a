"""Node types as other programs read them: the objects of `kg nodes --json`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kg.facts import NodeKind, Role

if TYPE_CHECKING:
    from kg.facts import Interface, Location, Parameter, Qos
    from kg.graph.reading import NodeRecord

__all__ = ["how_to_start", "node_object"]


def node_object(record: NodeRecord) -> dict[str, Any]:
    """Return a node with its interface as plain values, ready for JSON; the fields of docs/formats.md."""
    node = record.node
    fields: dict[str, Any] = {
        "repository": record.repository,
        "commit": record.commit,
        "package": record.package,
        "node": node.name,
        "kind": str(node.kind),
        "executable": node.executable,
        "plugin": node.plugin,
        "language": node.language,
        "ros": node.ros,
        "sources": list(node.sources),
        "node_name": node.node_name,
        "node_aliases": list(node.aliases),
        "base_class": node.base_class,
        "start": how_to_start(record),
        **_place(node.location),
    }
    for role in Role:
        fields[str(role)] = [_interface(one) for one in node.interfaces if one.role == role]
    fields["parameters"] = [_parameter(one) for one in node.parameters]
    return fields


def how_to_start(record: NodeRecord) -> str | None:
    """Return the command that starts a node alone, None where code only can."""
    node = record.node
    if node.executable:
        return f"{'ros2 run' if node.ros == 2 else 'rosrun'} {record.package} {node.executable}"  # noqa: PLR2004 - ROS 2
    if node.kind is NodeKind.NODELET and node.plugin:
        return f"rosrun nodelet nodelet standalone {node.plugin}"
    if node.kind is NodeKind.COMPONENT and node.plugin:
        return f"ros2 component standalone {record.package} {node.plugin}"
    return None


def _place(location: Location) -> dict[str, Any]:
    return {"file": location.path, "line": location.line, "file_repository": location.repository}


def _interface(fact: Interface) -> dict[str, Any]:
    return {
        "name": fact.name,
        "type": fact.type,
        "resolution": str(fact.resolution),
        "parameter": fact.parameter,
        "implicit": fact.implicit,
        "qos": _qos(fact.qos) if fact.qos else None,
        "resolved": fact.resolved,
        "written": fact.written,
        "origin": fact.origin,
        "reason": fact.reason,
        **_place(fact.location),
    }


def _qos(qos: Qos) -> dict[str, Any]:
    rarer = {
        "deadline": qos.deadline,
        "lifespan": qos.lifespan,
        "liveliness": qos.liveliness,
        "lease_duration": qos.lease_duration,
    }
    return {
        "reliability": qos.reliability,
        "durability": qos.durability,
        "history": qos.history,
        "depth": qos.depth,
        **{name: value for name, value in rarer.items() if value is not None},
    }


def _parameter(fact: Parameter) -> dict[str, Any]:
    return {
        "name": fact.name,
        "type": fact.type,
        "default": fact.default,
        "access": str(fact.access),
        "resolution": str(fact.resolution),
        "implicit": fact.implicit,
        "description": fact.description,
        "origin": fact.origin,
        "reason": fact.reason,
        **_place(fact.location),
    }
