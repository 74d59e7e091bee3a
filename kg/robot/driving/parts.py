"""Parts of robots that are moved: by one thing at a time, through whichever topics and actions it is reached."""

from __future__ import annotations

from contextlib import contextmanager
from itertools import groupby
from typing import TYPE_CHECKING

from kg.errors import RobotError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kg.robot.capability import Capabilities
    from kg.robot.driving.channels import Command
    from kg.robot.driving.routes import Route

__all__ = ["Parts", "robots_of"]


class Parts:
    """Who moves what: `Capability.moves` says which part, the namespace of the node which of several robots."""

    def __init__(self, capabilities: Capabilities) -> None:
        self._holders: dict[Command, Route] = {}
        self._robots: frozenset[str] = frozenset()
        self.know(capabilities)

    def know(self, capabilities: Capabilities) -> None:
        """Take what the robots can do now; who has a part keeps it."""
        self._robots = robots_of(way.node for one in capabilities.capabilities if one.moves for way in one.ways)

    @contextmanager
    def held(self, command: Command, route: Route) -> Iterator[None]:
        """Let a command have the part that it moves, if it moves one.

        On the same topic or action the later command takes over, so that what is driven can be driven otherwise; by
        another way two would tear at the part, and the later one is refused.

        Raises:
            RobotError: KG827 when something else has the part.
        """
        for other in self._holders.values():
            if self._same(route, other):
                doing, way = other.capability.name, other.way
                told = f"`{route.capability.name}` would move what `{doing}` moves (by the {way.kind} {way.name})"
                raise RobotError("KG827", told, hint=f"Stop `{doing}` first, or wait until it has ended.")
        self._holders[command] = route
        try:
            yield
        finally:
            del self._holders[command]

    def _same(self, one: Route, other: Route) -> bool:
        if one.capability.moves is None or one.capability.moves != other.capability.moves:
            return False
        different = (one.way.kind, one.way.name) != (other.way.kind, other.way.name)
        return different and self.may_be_one_robot(one.way.node, other.way.node)

    def may_be_one_robot(self, one: str, other: str) -> bool:
        """Tell whether two nodes do not belong to different robots."""
        return len({self._robot(one), self._robot(other)} - {None}) <= 1

    def _robot(self, node: str) -> str | None:
        namespace = _split(node)[1]
        return namespace if namespace in self._robots else None


def robots_of(nodes: Iterable[str]) -> frozenset[str]:
    """Return the namespaces that are robots of their own: those with a node that another has under the same name."""
    named = groupby(sorted({_split(node) for node in nodes}), key=lambda one: one[0])
    spaces = ([namespace for _, namespace in each if namespace] for _, each in named)
    return frozenset(namespace for each in spaces if len(each) > 1 for namespace in each)


def _split(node: str) -> tuple[str, str]:
    """Return the name of a node within its outermost namespace, and that namespace."""
    namespace, _, name = node.strip("/").partition("/")
    return (name, namespace) if name else (namespace, "")
