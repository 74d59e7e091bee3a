"""What of a system's graph is drawn as changed: the keys that `kg.render.system_graph` gives to nodes and channels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from kg.compare.changes import Kind, Level
from kg.facts import Role

if TYPE_CHECKING:
    from kg.compare.changes import Difference

__all__ = ["changed_keys", "changed_systems"]

_OF_NODES: Final = frozenset({Level.INSTANCE, Level.END, Level.SETTING, Level.REMAP})
_CAME_OR_WENT: Final = frozenset({Kind.NEW, Kind.GONE})


def changed_systems(difference: Difference) -> tuple[str, ...]:
    """Return the names of the launch files whose wiring differs, sorted."""
    return tuple(sorted({one.system for one in difference.changes if one.system and one.level is not Level.FINDING}))


def changed_keys(difference: Difference, system: str) -> frozenset[str]:
    """Return the nodes with another type, host, condition, name or setting, and the channels with other ends."""
    found = set()
    for change in difference.changes:
        if change.system != system or change.level not in _OF_NODES:
            continue
        if change.level is Level.INSTANCE and change.kind in _CAME_OR_WENT:
            continue
        found.add(change.owner)
        if change.kind in {Kind.TYPE, Kind.QOS} and change.role:
            found.add(f"{Role(change.role).channel} {change.name}")
    return frozenset(found)
