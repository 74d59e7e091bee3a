"""Why a robot can do something, in words: which of its parts take or give the messages for it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import msgspec

if TYPE_CHECKING:
    from kg.robot.capability import Capability, Way

__all__ = ["described"]

_WORDS: Final = {
    ("topic", "write"): "Its node `{node}` subscribes to `{name}` (`{type}`).",
    ("topic", "read"): "Its node `{node}` publishes it to `{name}` (`{type}`).",
    ("service", "write"): "Its node `{node}` does it through the service `{name}` (`{type}`).",
    ("service", "read"): "Its node `{node}` reports it through the service `{name}` (`{type}`).",
    ("action", "write"): "Its node `{node}` accepts goals for it through the action `{name}` (`{type}`).",
    ("action", "read"): "Its node `{node}` reports it while it executes the action `{name}` (`{type}`).",
}


def described(capability: Capability) -> dict[str, Any]:
    """Return a capability as pages show it: its members, and `because`, the reasons."""
    members: dict[str, Any] = msgspec.to_builtins(capability)
    empty: dict[str, Any] = {"comment": "", "kinds": (), "parameters": (), "ways": ()}
    reasons = dict.fromkeys(_reason(way, capability.modality) for way in capability.ways)
    return {**empty, **members, "because": list(reasons)}


def _reason(way: Way, modality: str) -> str:
    return _WORDS[way.kind, modality].format(node=way.node, name=way.name, type=way.type)
