"""Interfaces that boolean parameters turn on and off."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kg.wiring.values import parsed

if TYPE_CHECKING:
    from kg.facts import NodeType
    from kg.wiring.place import Place
    from kg.wiring.values import Settings

__all__ = ["switched_on"]


def switched_on(node: NodeType, settings: Settings, place: Place) -> NodeType:
    """Return a node type without the interfaces that parameters, as they are set or by default, keep from being made.

    `place` is that of the node, or of the plugin whose type it is. What is not known turns nothing off.
    """
    if not any(one.switches for one in node.interfaces):
        return node
    kept = (one for one in node.interfaces if all(_may_be(switch, node, settings, place) for switch in one.switches))
    return replace(node, interfaces=tuple(kept))


def _may_be(switch: str, node: NodeType, settings: Settings, place: Place) -> bool:
    name, wanted = switch.removeprefix("!"), not switch.startswith("!")
    setting = settings.get(name, place)
    if setting is not None:
        value = parsed(setting.value)
    else:
        defaults = {parsed(one.default) for one in node.parameters if one.name == name and one.default is not None}
        value = defaults.pop() if len(defaults) == 1 else None
    return value is wanted or not isinstance(value, bool)
