"""From what several readers found to the node types of a package: each once, complete, and in a fixed order.

A class that is loaded by name and the executables that only start it are one node type with several ways to start.
They are known by running the same code: they declare the same interfaces and parameters by the same calls. An
executable that declares anything else, as a publisher of its `main`, is a node type of its own.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Final, TypeVar

from kg.facts import Interface, NodeKind, Parameter, Role
from kg.holes import is_partial
from kg.names import resolve

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kg.extract.marks import Extracted
    from kg.facts import Location, NodeType, PluginSlot

__all__ = ["merge", "own_name", "settled"]

_ROLES: Final = {role: position for position, role in enumerate(Role)}


def merge(read: Iterable[Extracted]) -> list[Extracted]:
    """Return each node once; one read twice (two entry points to the same code) has the facts of both.

    The first executable of a class is its `executable` and gives it its name; others are among its `aliases`.
    """
    known: dict[tuple[object, ...], Extracted] = {}
    for extracted in read:
        node = extracted.node
        key = (node.name, node.kind, node.executable, node.plugin, node.language)
        known[key] = _both(known[key], extracted) if key in known else extracted
    return _joined(known.values())


def _joined(found: Iterable[Extracted]) -> list[Extracted]:
    """Return nodes with each class and its executables as one."""
    classes: dict[object, Extracted] = {}
    others: list[Extracted] = []
    for extracted in found:
        node = extracted.node
        if node.plugin is None:
            others.append(extracted)
            continue
        key = (node.plugin, node.language, node.kind)
        classes[key] = _started_by(classes[key], extracted) if key in classes else extracted
    same: dict[object, list[object]] = {}
    for name, extracted in classes.items():
        same.setdefault(_declared(extracted), []).append(name)
    alone: list[Extracted] = []
    for extracted in others:
        keys = same.get(_declared(extracted), [])
        if extracted.node.kind is NodeKind.EXECUTABLE and len(keys) == 1 and _fits(classes[keys[0]], extracted):
            classes[keys[0]] = _started_by(classes[keys[0]], extracted)
        else:
            alone.append(extracted)
    return [*alone, *classes.values()]


def _declared(extracted: Extracted) -> object:
    """Return what a node declares, and at which calls of the framework."""
    node = extracted.node
    return (
        node.language,
        node.ros,
        frozenset((one.role, one.name, one.type, _call(one)) for one in node.interfaces),
        frozenset((one.name, one.access, _call(one)) for one in node.parameters),
        frozenset((mark.key, mark.namespace, mark.detail) for mark in extracted.marks),
    )


def _call(fact: Interface | Parameter) -> Location:
    return fact.via[-1] if fact.via else fact.location


def _fits(loaded: Extracted, executable: Extracted) -> bool:
    """Check whether a class and an executable that declare the same are one node: they do, and by one name."""
    one, other = loaded.node, executable.node
    names = {one.node_name, other.node_name} - {None}
    return bool(one.interfaces or one.parameters) and len(names) < 2  # noqa: PLR2004 - not two names


def _started_by(loaded: Extracted, executable: Extracted) -> Extracted:
    """Return a class with one more way to start it."""
    first, second = loaded.node, executable.node
    other = second.executable
    node = first if _declared(loaded) == _declared(executable) else _both(loaded, executable).node
    node = replace(
        node,
        node_name=first.node_name or second.node_name,
        sources=_once(first.sources + second.sources),
        interfaces=tuple(replace(one, resolved=None) for one in node.interfaces),
        bounds=_once(first.bounds + second.bounds),
        slots=_once(first.slots + second.slots),
    )
    if other is not None and first.executable is None:
        node = replace(node, name=other, executable=other)
    elif other is not None and first.executable != other:
        node = replace(node, aliases=_once((*first.aliases, other)))
    return replace(loaded, node=node)


def _both(one: Extracted, other: Extracted) -> Extracted:
    first, second = one.node, other.node
    node = replace(
        first,
        node_name=first.node_name or second.node_name,
        base_class=first.base_class or second.base_class,
        exported=first.exported or second.exported,
        sources=_once(first.sources + second.sources),
        interfaces=_once(first.interfaces + second.interfaces),
        parameters=_once(first.parameters + second.parameters),
        bounds=_once(first.bounds + second.bounds),
        slots=_once(first.slots + second.slots),
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
            slots=_ordered(_once(node.slots), _slot_order),
        )
        for node in nodes
    )
    return tuple(sorted(complete, key=_node_order))


def own_name(node: NodeType) -> str:
    """Return the name a node has when it is started alone: the one it gives itself, else that of its type."""
    if node.node_name and not is_partial(node.node_name):
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


def _slot_order(slot: PluginSlot) -> tuple[object, ...]:
    return (_place(slot.location), slot.base_class or "", slot.parameter or "")


def _node_order(node: NodeType) -> tuple[object, ...]:
    return (node.name, node.kind, node.language, node.plugin or "", node.executable or "", _place(node.location))
