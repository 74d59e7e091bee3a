"""The instances of a system as rows: how each is started, and each of its ends with its partners."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from kg.facts import InstanceInterface, LaunchParameter, Location, NodeInstance, NodeReference, Role, System
from kg.graph.iris import Iris, fragment
from kg.graph.records import end_object
from kg.render.system_graph import SystemGraph, channel_of, of_framework
from kg.render.system_notations import nobody_at
from kg.views.node_rows import TYPES
from kg.views.wording import quality

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kg.views.evidence import Places


MISMATCHES: Final = frozenset({"KG403", "KG405", "KG410"})
"""Findings that say of two ends of one name that nothing passes between them: their types or QoS do not fit."""


def instance_rows(  # noqa: PLR0913 - a system, and what is known of it
    system: System, keys: Mapping[str, NodeInstance], graph: SystemGraph, where: Places, iris: Iris, *, every: bool
) -> list[dict[str, Any]]:
    """Return the instances of a system by name; `keys` and `graph` are theirs (`kg.render.system_graph`).

    Each has `key` (its name, with a number behind the second of a name), `iri`, `name`, `namespace`, `kind`,
    `ros`, `node` (`name`, `iri` of its node type, None where that is not in the store), `starts` (package and program),
    `missing` and `reason` (why its ends are not known), `complete`, `condition`, `host`, `loads` (as `node`),
    `arguments`, `evidence` (the launch line), `chain` (the lines of includes that led to it), and

    * `ends`: those of an instance in `kg instances --json` (docs/formats.md), and `role`, `title`, `kind`, `outward`,
      `written_as` (the name in the code), `type_iri`, `quality`, `debug` (what frameworks make), `channel` (its key),
      `others` (keys of instances at the other side), `nobody` (what is lacking where there are none), `evidence` (the
      line of code), `set_at` (`words` and `evidence` of the launch line that gave it its name); what frameworks make is
      there with `every` alone, otherwise `left_out` is how many they are;
    * `remaps`: `from`, `to`, `used`, `evidence`; `parameters`: `name`, `value`, `reason`, `declared`, `evidence`.
    """
    rows = _Rows(system, graph, where, iris)
    return [rows.instance(key, one, every=every) for key, one in keys.items()]


def setting_row(setting: LaunchParameter, source: str, where: Places) -> dict[str, Any]:
    """Return a parameter that a launch file sets."""
    return {
        "name": setting.name,
        "value": setting.value,
        "reason": setting.reason,
        "evidence": where.evidence(source, setting.location),
    }


class _Rows:
    def __init__(self, system: System, graph: SystemGraph, where: Places, iris: Iris) -> None:
        self._source = system.configuration.repository
        self._iri = iris.configuration(self._source, system.configuration.path)
        self._ros = system.configuration.ros
        self._ends = graph.ends()
        self._where = where
        self._iris = iris

    def instance(self, key: str, one: NodeInstance, *, every: bool) -> dict[str, Any]:
        """Return one instance."""
        started = one.started
        ends = [end for end in one.interfaces if every or not of_framework(end)]
        ends.sort(key=lambda end: (list(Role).index(end.declared.role), of_framework(end)))
        return {
            "key": key,
            "iri": fragment(self._iri, "instance", one.name),
            "name": one.name,
            "namespace": one.namespace,
            "kind": str(started.kind),
            "ros": self._ros,
            "node": self._node(one.type) if one.type else None,
            "starts": one.started_type,
            "missing": str(one.missing) if one.missing else None,
            "reason": one.reason,
            "complete": one.complete,
            "condition": started.condition,
            "host": one.host,
            "loads": [self._node(plugin) for plugin in one.plugins],
            "arguments": list(started.arguments),
            "evidence": self._place(started.location),
            "chain": [self._place(step) for step in started.chain],
            "ends": [self._end(key, end) for end in ends],
            "left_out": len(one.interfaces) - len(ends),
            "remaps": [
                {
                    "from": remap.source,
                    "to": remap.target,
                    "used": remap.used,
                    "evidence": self._place(remap.remap.location),
                }
                for remap in one.remaps
            ],
            "parameters": [
                {**setting_row(setting.set, self._source, self._where), "declared": setting.declared is not None}
                for setting in one.parameters
            ],
        }

    def _node(self, kind: NodeReference) -> dict[str, str]:
        iri = self._iris.node(kind.repository, kind.package, kind.node)
        return {"name": f"{kind.package}/{kind.node}", "iri": iri}

    def _place(self, location: Location) -> dict[str, Any]:
        return self._where.evidence(self._source, location)

    def _end(self, key: str, end: InstanceInterface) -> dict[str, Any]:
        declared, channel = end.declared, channel_of(key, end)
        role = declared.role
        others = sorted(set(self._ends[channel.key][1 if role.outward else 0]))
        return {
            **end_object(end),
            "role": str(role),
            "title": role.heading,
            "kind": role.channel,
            "outward": role.outward,
            "written_as": declared.name or declared.written,
            "type_iri": self._iris.interface_type(TYPES[role.channel], declared.type) if declared.type else None,
            "quality": quality(end.switches, end.qos),
            "debug": of_framework(end),
            "channel": channel.key,
            "others": others,
            "nobody": "" if others else nobody_at(channel, outward=role.outward),
            "evidence": self._where.evidence(end.owner.repository, declared.location),
            "set_at": set_at(end, self._source, self._where),
        }


def set_at(end: InstanceInterface, source: str, where: Places) -> dict[str, Any] | None:
    """Return the `words` and `evidence` of the launch line that gave an end its name, in a system of this source."""
    if end.remap:
        return {"words": f"remapped from {end.remap.source}", "evidence": where.evidence(source, end.remap.location)}
    if end.parameter:
        return {"words": f"parameter {end.parameter.name}", "evidence": where.evidence(source, end.parameter.location)}
    return None
