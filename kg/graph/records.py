"""Node types and instances as other programs read them: the objects of `kg nodes --json`, `kg instances --json`."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

from kg import facts
from kg.graph.chains import chain_text
from kg.graph.texts import summary
from kg.lazily import lazily

if TYPE_CHECKING:
    from kg.graph.reading.nodes import NodeRecord

with lazily():
    import yaml


def node_object(record: NodeRecord) -> dict[str, Any]:
    """Return a node with its interface as plain values, ready for JSON; the fields of docs/formats.md."""
    node = record.node
    data: dict[str, Any] = {
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
        "node_namespace": node.node_namespace,
        "node_aliases": list(node.aliases),
        "base_class": node.base_class,
        "start": how_to_start(record),
        "description": summary(record.descriptions),
        **_place(node.location),
    }
    for role in facts.Role:
        data[str(role)] = [interface_object(one) for one in node.interfaces if one.role == role]
    data["parameters"] = [parameter_object(one) for one in node.parameters]
    data["slots"] = [slot_object(one, record) for one in node.slots]
    data["exported"] = _place(node.exported) if node.exported is not None else None
    data["bounds"] = [{"limit": one.limit, **_place(one.location)} for one in node.bounds]
    return data


def instance_object(system: facts.System, instance: facts.NodeInstance) -> dict[str, Any]:
    """Return a node instance with its resolved interface as plain values; the fields of docs/formats.md."""
    started, kind = instance.started, instance.type
    data: dict[str, Any] = {
        "system": system.configuration.name,
        "name": instance.name,
        "namespace": instance.namespace,
        "repository": kind.repository if kind else None,
        "package": kind.package if kind else started.package,
        "node": kind.node if kind else None,
        "executable": started.executable,
        "plugin": started.plugin,
        "kind": str(started.kind),
        "host": instance.host,
        "ros": system.configuration.ros,
        "condition": started.condition,
        "missing": str(instance.missing) if instance.missing else None,
        "reason": instance.reason,
        "complete": instance.complete,
        "loads": [str(one) for one in instance.plugins],
        "remaps": {one.source: one.target for one in reversed(instance.remaps)},
        "parameters": {one.name: _yaml(one.set.value) for one in instance.parameters},
        "arguments": list(started.arguments),
        **_place(started.location),
        "chain": [_place(one) for one in started.chain],
    }
    for role in facts.Role:
        data[str(role)] = [end_object(one) for one in instance.interfaces if one.declared.role == role]
    return data


def end_object(end: facts.InstanceInterface) -> dict[str, Any]:
    """Return an end of an instance as plain values; the fields of docs/formats.md."""
    remap, setting = end.remap, end.parameter
    return {
        **interface_object(end.declared),
        "resolved": end.resolved,
        "resolution": str(end.resolution),
        "qos": _qos(end.qos) if end.qos else None,
        "reason": end.reason,
        "switches": list(end.switches),
        "owner": str(end.owner) if end.owner.node else None,
        "remap": {"from": remap.source, "to": remap.target, **_place(remap.location)} if remap else None,
        "set_by": {"name": setting.name, "value": _yaml(setting.value), **_place(setting.location)}
        if setting
        else None,
    }


def _yaml(text: str | None) -> Any:
    """Return the value of a YAML text if JSON can represent it; else the text."""
    if text is None:
        return None
    try:
        value = yaml.safe_load(text)
    except (yaml.YAMLError, ValueError, RecursionError):
        return text
    return value if isinstance(value, str | int | float | bool | list | dict) else text


def how_to_start(record: NodeRecord) -> str | None:
    """Return the command that starts a node alone, None where code only can."""
    node = record.node
    if node.executable:
        return f"{'ros2 run' if node.ros == 2 else 'rosrun'} {record.package} {node.executable}"  # noqa: PLR2004 - ROS 2
    if node.kind is facts.NodeKind.NODELET and node.plugin:
        return f"rosrun nodelet nodelet standalone {node.plugin}"
    if node.kind is facts.NodeKind.COMPONENT and node.plugin:
        return f"ros2 component standalone {record.package} {node.plugin}"
    return None


def _place(location: facts.Location) -> dict[str, Any]:
    return {"file": location.path, "line": location.line, "file_repository": location.repository}


def interface_object(fact: facts.Interface) -> dict[str, Any]:
    """Return an interface as plain values; the fields of docs/formats.md."""
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
        "switches": list(fact.switches),
        "never_publishes": fact.silent,
        "ignores_messages": fact.ignored,
        "publishes_upon": list(fact.upon),
        "leaves_unset": list(fact.unset),
        **_place(fact.location),
        "via": chain_text(fact.via[-1:]),
    }


def _qos(qos: facts.Qos) -> dict[str, Any]:
    """Return the policies of an end; those that are rarely set only where they are."""
    always = {"reliability", "durability", "history", "depth"}
    policies = {field.name: getattr(qos, field.name) for field in fields(qos)}
    return {name: value for name, value in policies.items() if value is not None or name in always}


def slot_object(fact: facts.PluginSlot, record: NodeRecord) -> dict[str, Any]:
    """Return a plugin slot as plain values; the fields of docs/formats.md."""
    return {
        "base_class": fact.base_class,
        "names": fact.names,
        "parameter": fact.parameter,
        "defaults": [
            {
                "name": one.name,
                "class": one.class_name,
                "node": str(record.plugins[one.class_name][0]) if one.class_name in record.plugins else None,
            }
            for one in fact.defaults
        ],
        "fixed": fact.fixed,
        "reason": fact.reason,
        **_place(fact.location),
        "via": chain_text(fact.via[-1:]),
    }


def parameter_object(fact: facts.Parameter) -> dict[str, Any]:
    """Return what one line of code does with a parameter as plain values; the fields of docs/formats.md."""
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
        "via": chain_text(fact.via[-1:]),
    }
