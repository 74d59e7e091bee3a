"""Plugin slots of nodes as triples, and back."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any, Final

from kg.facts import Location, NodeReference, PluginDefault, PluginSlot
from kg.graph import vocabulary as v
from kg.graph.fields import SLOT

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from kg.graph.scope import Scope

NAMED: Final = """
SELECT ?node ?name ?package ?repository ?class WHERE {
  %s
  ?node a rnkg:NodeType ; rnkg:pluginName ?class ; rnkg:name ?name .
  ?p rnkg:contains ?node ; rnkg:name ?package .
  ?r rnkg:contains ?p ; rnkg:name ?repository .
}"""
"""The node types of plugins by their class."""

SLOTS: Final = """
SELECT ?node ?slot ?predicate ?object ?name WHERE {
  %s
  ?node rnkg:hasPluginSlot ?slot .
  ?slot ?predicate ?value .
  OPTIONAL { ?value rnkg:className ?class OPTIONAL { ?value rnkg:name ?name } }
  BIND(COALESCE(?class, ?value) AS ?object)
}"""
"""The properties of the slots of nodes; of a default plugin its class, with its name if it has one."""


def plugin_slot(scope: Scope, owner: str, fact: PluginSlot) -> None:
    """Write a slot of the node with the IRI `owner`."""
    writer, part = scope.writer, scope.part(owner, "slot", fact.base_class)
    writer.add(f"<{owner}>", v.HAS_PLUGIN_SLOT, part)
    writer.add(part, v.TYPE, v.PLUGIN_SLOT)
    SLOT.write(writer, part, fact)
    for one in fact.defaults:
        default = scope.part(part[1:-1], "default", one.name or one.class_name)
        writer.add(part, v.HAS_DEFAULT_PLUGIN, default)
        writer.add(default, v.TYPE, v.DEFAULT_PLUGIN)
        writer.text(default, v.NAME, one.name)
        writer.text(default, v.CLASS_NAME, one.class_name)
    scope.evidence(part, fact.location, fact.via)


def slots_by_node(
    rows: Iterable[Any], place_of: Callable[[Mapping[str, list[str]]], tuple[Location, tuple[Location, ...]]]
) -> dict[str, tuple[PluginSlot, ...]]:
    """Return the slots of each node in the order of their places, from rows of `SLOTS`."""
    owners: dict[str, str] = {}
    properties: defaultdict[str, defaultdict[str, list[str]]] = defaultdict(lambda: defaultdict(list))
    defaults: defaultdict[str, set[PluginDefault]] = defaultdict(set)
    for node, slot, predicate, value, name in rows:
        owners[slot] = node
        if predicate == v.bare(v.HAS_DEFAULT_PLUGIN):
            defaults[slot].add(PluginDefault(value, name))
        else:
            properties[slot][predicate].append(value)
    by_node: defaultdict[str, list[PluginSlot]] = defaultdict(list)
    for iri, node in owners.items():
        place, via = place_of(properties[iri])
        ordered = tuple(sorted(defaults[iri], key=lambda one: (one.name or "", one.class_name)))
        by_node[node].append(PluginSlot(location=place, via=via, defaults=ordered, **SLOT.read(properties[iri])))
    return {node: tuple(sorted(slots, key=_order)) for node, slots in by_node.items()}


def class_key(name: str) -> str:
    """Return the class of a plugin as pluginlib compares it: `package/Class` and `package::Class` are the same."""
    return name.replace("::", "/")


def plugins_by_class(rows: Iterable[Any]) -> dict[str, list[tuple[NodeReference, str]]]:
    """Return the node types of plugins by the key of their class, with their IRIs, from rows of `NAMED`."""
    by_class: defaultdict[str, list[tuple[NodeReference, str]]] = defaultdict(list)
    for node, name, package, repository, kind in rows:
        by_class[class_key(kind)].append((NodeReference(repository, package, name), node))
    return {key: sorted(set(nodes)) for key, nodes in by_class.items()}


def _order(slot: PluginSlot) -> tuple[str, str, int, str, str]:
    place = slot.location
    return (place.repository or "", place.path, place.line, slot.base_class or "", slot.parameter or "")
