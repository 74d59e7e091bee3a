"""From what several readers found to the node types of a package: each once, complete, and in a fixed order."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

from kg.facts import Interface, Parameter, Role
from kg.names import resolve

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.extract.marks import Extracted
    from kg.facts import Location, NodeType

__all__ = ["merge", "own_name", "settled"]

_ROLES: Final = {role: position for position, role in enumerate(Role)}


def merge(read: Iterable[Extracted]) -> list[Extracted]:
    """Return each node once; one read twice (two entry points to the same code) has the facts of both."""
    known: dict[tuple[object, ...], Extracted] = {}
    for extracted in read:
        node = extracted.node
        key = (node.name, node.kind, node.executable, node.plugin, node.language)
        known[key] = _both(known[key], extracted) if key in known else extracted
    return list(known.values())


def _both(one: Extracted, other: Extracted) -> Extracted:
    first, second = one.node, other.node
    node = replace(
        first,
        node_name=first.node_name or second.node_name,
        base_class=first.base_class or second.base_class,
        sources=_once(first.sources + second.sources),
        interfaces=_once(first.interfaces + second.interfaces),
        parameters=_once(first.parameters + second.parameters),
        bounds=_once(first.bounds + second.bounds),
    )
    return replace(one, node=node, marks=_once(one.marks + other.marks))


_Item = TypeVar("_Item")


def _once(items: tuple[_Item, ...]) -> tuple[_Item, ...]:
    return tuple(dict.fromkeys(items))


def settled(nodes: Iterable[NodeType]) -> tuple[NodeType, ...]:
    """Return the nodes with resolved names, without exact duplicates, and everything in an order of its own."""
    complete = (
        replace(
            node,
            sources=tuple(sorted(set(node.sources))),
            interfaces=_ordered(_once(tuple(_resolved(node))), _interface_order),
            parameters=_ordered(_once(node.parameters), _parameter_order),
        )
        for node in nodes
    )
    return tuple(sorted(complete, key=_node_order))


def own_name(node: NodeType) -> str:
    """Return the name a node has when it is started alone: the one it gives itself, else that of its type."""
    if node.node_name and "{}" not in node.node_name:
        return node.node_name
    return node.name.rpartition("::")[2].rpartition("/")[2].removesuffix(".py")


def _resolved(node: NodeType) -> Iterable[Interface]:
    for interface in node.interfaces:
        if interface.resolved is None and interface.name is not None:
            yield replace(interface, resolved=resolve(interface.name, own_name(node)))
        else:
            yield interface


def _place(location: Location) -> tuple[str, str, int]:
    return (location.repository or "", location.path, location.line)


def _ordered(items: tuple[_Item, ...], key: Callable[[_Item], tuple[object, ...]]) -> tuple[_Item, ...]:
    """Return items by their keys; those of equal keys by all they are, which takes long to spell."""
    keyed = [(key(item), item) for item in items]
    equal = Counter(place for place, _ in keyed)
    keyed.sort(key=lambda pair: (*pair[0], repr(pair[1]) if equal[pair[0]] > 1 else ""))
    return tuple(item for _, item in keyed)


def _interface_order(interface: Interface) -> tuple[object, ...]:
    return (
        interface.implicit,
        _ROLES[interface.role],
        _place(interface.location),
        interface.name or "",
        interface.type or "",
    )


def _parameter_order(parameter: Parameter) -> tuple[object, ...]:
    return (parameter.implicit, _place(parameter.location), parameter.name or "", parameter.access)


def _node_order(node: NodeType) -> tuple[object, ...]:
    return (node.name, node.kind, node.language, node.plugin or "", node.executable or "", _place(node.location))
