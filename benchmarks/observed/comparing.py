"""Two computation graphs as sets of (node, role, name), and what they have in common.

An observer sees publishers, subscribers and offered services of processes. So nodelets count for their manager, actions
as the topics that they consist of, and clients of services not at all.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

Item = tuple[str, str, str]

ROLES = ("publishes", "subscribes", "services")
TO_SERVER, FROM_SERVER = ("goal", "cancel"), ("status", "feedback", "result")
FRAMEWORK = (
    "/clock",
    "/diagnostics",
    "/rosout",
    "/tf",
    "/tf_static",
    "*/bond",
    "*/get_loggers",
    "*/list_controllers",
    "*/load_nodelet",
    "*/parameter_descriptions",
    "*/parameter_updates",
    "*/set_logger_level",
    "*/set_parameters",
    "*/unload_nodelet",
    "*manager/list",
)
"""Names that frameworks make; the peer leaves out the same ones."""


@dataclass(frozen=True)
class Comparison:
    """What was observed and what was resolved, with the number of nodes and of names that stayed unresolved."""

    observed: frozenset[Item] = field(default_factory=frozenset)
    resolved: frozenset[Item] = field(default_factory=frozenset)
    nodes: int = 0
    unresolved: int = 0

    def with_system(self, system: str, other: Comparison) -> Comparison:
        """Add another comparison, whose nodes are those of a system."""
        return Comparison(
            self.observed | {(system + node, role, name) for node, role, name in other.observed},
            self.resolved | {(system + node, role, name) for node, role, name in other.resolved},
            self.nodes + other.nodes,
            self.unresolved + other.unresolved,
        )

    def cells(self) -> tuple[str, ...]:
        """Return the figures as text, in the order of the table."""
        common = len(self.observed & self.resolved)
        return (
            str(self.nodes),
            str(len(self.observed)),
            str(len(self.resolved)),
            _percent(common, len(self.resolved)),
            _percent(common, len(self.observed)),
            str(self.unresolved),
        )


def compare(nodes: list[dict[str, Any]], instances: Iterable[dict[str, Any]]) -> Comparison:
    """Compare nodes that were observed with the instances of `kg`; other nodes are left out."""
    wanted = {node["name"] for node in nodes}
    seen = {(node["name"], role, name) for node in nodes for role in ROLES for name in node[role]}
    mine = [(instance, node) for instance in instances if (node := _process(instance)) in wanted]
    found = {(node, role, name) for instance, node in mine for role, name in _interfaces(instance) if name}
    unresolved = sum(not name for instance, _ in mine for _, name in _interfaces(instance))
    return Comparison(_without_framework(seen), _without_framework(found), len(nodes), unresolved)


def _process(instance: dict[str, Any]) -> str:
    """Return the node whose process has the instance: the manager of a nodelet, or itself."""
    return str(instance.get("host") or instance["name"])


def _interfaces(instance: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for role in ROLES:
        yield from ((role, entry.get("resolved") or "") for entry in instance.get(role, ()))
    for entry in instance.get("action_servers", ()):
        yield from _action(entry, "subscribes", "publishes")
    for entry in instance.get("action_clients", ()):
        yield from _action(entry, "publishes", "subscribes")


def _action(entry: dict[str, Any], to_server: str, from_server: str) -> Iterator[tuple[str, str]]:
    name = entry.get("resolved")
    yield from ((to_server, f"{name}/{part}" if name else "") for part in TO_SERVER)
    yield from ((from_server, f"{name}/{part}" if name else "") for part in FROM_SERVER)


def _without_framework(items: set[Item]) -> frozenset[Item]:
    return frozenset(item for item in items if not any(fnmatchcase(item[2], pattern) for pattern in FRAMEWORK))


def _percent(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f} %" if whole else "-"
